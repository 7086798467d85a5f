/* SPDX-License-Identifier: Apache-2.0 */
/* What the STM32G431 has of parts. Its board, the B-G431B-ESC1, has gate drivers with inputs
 * only. */
#include "analog.h"

const chip_route_t CHIP_ROUTES[] = {
    {CHIP_ADC1_ISR, chip_adc_read, chip_adc_write},
    {CHIP_TIM1_CR1, chip_timer1_read, chip_timer1_write},
    {CHIP_TIM8_CR1, chip_timer8_read, chip_timer8_write},
    {CHIP_GPIOA_MODER, chip_pins_read, chip_pins_write},
    {CHIP_GPIOB_MODER, chip_pins_read, chip_pins_write},
    {CHIP_GPIOC_MODER, chip_pins_read, chip_pins_write},
    {CHIP_GPIOF_MODER, chip_pins_read, chip_pins_write},
    {CHIP_TIM4_CR1, chip_pins_read, chip_pins_write},
    {CHIP_FDCAN1_CREL, chip_can_read, chip_can_write},
    {CHIP_FDCAN1_RAM_000, chip_can_read, chip_can_write},
    {CHIP_USART2_CR1, chip_serial_read, chip_serial_write},
    {CHIP_DMA1_ISR, chip_dma_read, chip_dma_write},
    {CHIP_DMAMUX_C0CR, chip_dma_read, chip_dma_write},
    {CHIP_RCC_CR, chip_clocks_read, chip_clocks_write},
    {CHIP_PWR_CR1, chip_clocks_read, chip_clocks_write},
    {CHIP_IWDG_KR, chip_clocks_read, chip_clocks_write},
    {CHIP_EXTI_IMR1, chip_clocks_read, chip_clocks_write},
    {CHIP_FLASH_ACR, chip_flash_read, chip_flash_register},
    {CHIP_SYSCFG_MEMRMP, comparators_read, comparators_write}, /* COMP and OPAMP are there, too */
    {CHIP_DAC3_DAC_CR, comparators_read, comparators_write},
    {0, NULL, NULL},
};

void chip_part_reset(chip_t *chip)
{
    comparators_reset(chip);
}

void chip_part_watch(chip_t *chip)
{
    chip_dma_serve(chip);
}

chip_ticks_t chip_part_next(chip_t *chip)
{
    return comparators_next(chip);
}

void chip_part_lines(chip_t *chip)
{
    const uint32_t converted = (chip_get(chip, CHIP_ADC1_ISR) & chip_get(chip, CHIP_ADC1_IER)) |
                               (chip_get(chip, CHIP_ADC2_ISR) & chip_get(chip, CHIP_ADC2_IER));
    const uint32_t serial = chip_get(chip, CHIP_USART2_ISR);
    const uint32_t wanted = chip_get(chip, CHIP_USART2_CR1);
    const uint32_t pins = chip_get(chip, CHIP_EXTI_PR1) & chip_get(chip, CHIP_EXTI_IMR1);
    chip_line(chip, INTERRUPT_ADC, converted != 0);
    chip_line(chip, INTERRUPT_SERIAL,
              ((serial & (CHIP_USART2_ISR_RXNE | CHIP_USART2_ISR_ORE)) != 0 &&
               (wanted & CHIP_USART2_CR1_RXNEIE) != 0) ||
                  ((serial & CHIP_USART2_ISR_TXE) != 0 && (wanted & CHIP_USART2_CR1_TXEIE) != 0));
    chip_line(chip, INTERRUPT_PVD, (pins & CHIP_EXTI_PR1_PIF16) != 0);
}

/* The first break input (28.3.16) is not modelled: the board wires none. */
uint32_t chip_part_break(chip_t *chip)
{
    if ((chip_get(chip, CHIP_TIM1_BDTR) & CHIP_TIM1_BDTR_BKE) != 0) {
        chip_note(chip, "TIM1: the first break input is not modelled");
    }
    return comparators_break(chip);
}

void chip_part_pins_written(chip_t *chip)
{
    (void)chip;
}

bool chip_part_level(const chip_t *chip, char port, unsigned pin, bool *level)
{
    (void)chip;
    (void)port;
    (void)pin;
    (void)level;
    return false;
}

chip_drivers_t chip_part_drivers(const chip_t *chip)
{
    return chip->fault.gate_driver_fault ? CHIP_DRIVERS_OFF : CHIP_DRIVERS_FOLLOW;
}
