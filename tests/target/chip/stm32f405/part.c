/* SPDX-License-Identifier: Apache-2.0 */
/* What the STM32F405 has of parts, and the gate driver's signals of its board. */
#include "boards.h"
#include "parts.h"

const chip_route_t CHIP_ROUTES[] = {
    {CHIP_ADC1_SR, chip_adc_read, chip_adc_write},
    {CHIP_TIM1_CR1, chip_timer1_read, chip_timer1_write},
    {CHIP_TIM8_CR1, chip_timer8_read, chip_timer8_write},
    {CHIP_GPIOA_MODER, chip_pins_read, chip_pins_write},
    {CHIP_GPIOB_MODER, chip_pins_read, chip_pins_write},
    {CHIP_GPIOC_MODER, chip_pins_read, chip_pins_write},
    {CHIP_GPIOD_MODER, chip_pins_read, chip_pins_write},
    {CHIP_TIM3_CR1, chip_pins_read, chip_pins_write},
    {CHIP_CAN1_MCR, chip_can_read, chip_can_write},
    {CHIP_USART3_SR, chip_serial_read, chip_serial_write},
    {CHIP_DMA1_LISR, chip_dma_read, chip_dma_write},
    {CHIP_RCC_CR, chip_clocks_read, chip_clocks_write},
    {CHIP_PWR_CR, chip_clocks_read, chip_clocks_write},
    {CHIP_IWDG_KR, chip_clocks_read, chip_clocks_write},
    {CHIP_EXTI_IMR, chip_clocks_read, chip_clocks_write},
    {CHIP_RNG_CR, chip_noise_read, chip_noise_write},
    {CHIP_FLASH_ACR, chip_flash_read, chip_flash_register},
    {0, NULL, NULL},
};

void chip_part_reset(chip_t *chip)
{
    chip_driver_reset(chip);
}

void chip_part_watch(chip_t *chip)
{
    chip_driver_watch(chip);
    chip_dma_serve(chip);
}

chip_ticks_t chip_part_next(chip_t *chip)
{
    return chip->driver.ready > chip->now ? chip->driver.ready : CHIP_NEVER;
}

void chip_part_lines(chip_t *chip)
{
    const uint32_t serial = chip_get(chip, CHIP_USART3_SR);
    const uint32_t wanted = chip_get(chip, CHIP_USART3_CR1);
    const uint32_t pins = chip_get(chip, CHIP_EXTI_PR) & chip_get(chip, CHIP_EXTI_IMR);
    chip_line(chip, INTERRUPT_ADC,
              (chip_get(chip, CHIP_ADC1_SR) & CHIP_ADC1_SR_JEOC) != 0 &&
                  (chip_get(chip, CHIP_ADC1_CR1) & CHIP_ADC1_CR1_JEOCIE) != 0);
    chip_line(chip, INTERRUPT_SERIAL,
              ((serial & (CHIP_USART3_SR_RXNE | CHIP_USART3_SR_ORE)) != 0 &&
               (wanted & CHIP_USART3_CR1_RXNEIE) != 0) ||
                  ((serial & CHIP_USART3_SR_TXE) != 0 && (wanted & CHIP_USART3_CR1_TXEIE) != 0));
    chip_line(chip, EXCEPTION_NMI, (chip_get(chip, CHIP_RCC_CIR) & CHIP_RCC_CIR_CSSF) != 0);
    chip_line(chip, INTERRUPT_PVD, (pins & CHIP_EXTI_PR_PR16) != 0);
    chip_line(chip, INTERRUPT_PINS_5_TO_9, (pins & 0x03E0U) != 0);
    chip_line(chip, INTERRUPT_PINS_10_TO_15, (pins & 0xFC00U) != 0);
}

/* 17.3.12: a crystal that stops; PB12. */
uint32_t chip_part_break(chip_t *chip)
{
    const uint32_t settings = chip_get(chip, CHIP_TIM1_BDTR);
    if ((settings & CHIP_TIM1_BDTR_BKE) == 0) {
        return 0;
    }
    if ((chip_get(chip, CHIP_RCC_CIR) & CHIP_RCC_CIR_CSSF) != 0) {
        return CHIP_TIM1_SR_BIF;
    }
    if (!chip_pin_function(chip, 'B', 12, 1)) {
        return 0;
    }
    const bool active = chip_pin_level(chip, 'B', 12) == ((settings & CHIP_TIM1_BDTR_BKP) != 0);
    return active ? CHIP_TIM1_SR_BIF : 0;
}

void chip_part_pins_written(chip_t *chip)
{
    chip_driver_pins(chip);
}

bool chip_part_level(const chip_t *chip, char port, unsigned pin, bool *level)
{
    const board_t *board = boards_chosen();
    if (wire_is(board->fault, port, pin)) {
        *level = !chip_driver_pulls_fault(chip);
        return !*level || board->enable.port == 0; /* open drain, or driven high */
    }
    if (wire_is(board->sdo, port, pin) && !chip_pin_is_output(chip, port, pin)) {
        *level = chip_driver_data(chip);
        return true;
    }
    return false;
}

chip_drivers_t chip_part_drivers(const chip_t *chip)
{
    if (!chip_driver_drives(chip)) {
        return CHIP_DRIVERS_OFF;
    }
    return chip_driver_holds_a_leg(chip) ? CHIP_DRIVERS_HOLD_A_LEG : CHIP_DRIVERS_FOLLOW;
}
