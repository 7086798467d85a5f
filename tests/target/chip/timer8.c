/* SPDX-License-Identifier: Apache-2.0 */
/* TIM8 as an upward count that requests a transfer at its overflow (RM0090 sections 17.3.2, 17.4;
 * RM0440 sections 28.3.2, 28.6). */
#include "parts.h"

static chip_ticks_t clock_ticks(const chip_t *chip)
{
    return (chip_ticks_t)chip_timer_ticks(chip) * (chip_get(chip, CHIP_TIM8_PSC) + 1U);
}

static bool runs(const chip_t *chip)
{
    return (chip_get(chip, CHIP_TIM8_CR1) & CHIP_TIM8_CR1_CEN) != 0;
}

/* Without preload of the top, which this model does not have. */
static uint32_t count(const chip_t *chip)
{
    return runs(chip) ? (uint32_t)((chip->now - chip->timer8_zero) / clock_ticks(chip))
                      : chip_get(chip, CHIP_TIM8_CNT);
}

void chip_timer8_reset(chip_t *chip)
{
    chip->timer8_zero = chip->now;
}

static void write_control(chip_t *chip, uint32_t value)
{
    const uint32_t before = count(chip);
    if ((value & ~(uint32_t)(CHIP_TIM8_CR1_CEN | CHIP_TIM8_CR1_URS | CHIP_TIM8_CR1_OPM)) != 0) {
        chip_note(chip, "TIM8: control 0x%08X is not modelled", value);
    }
    *chip_at(chip, CHIP_TIM8_CR1) = value;
    *chip_at(chip, CHIP_TIM8_CNT) = before;
    chip->timer8_zero = chip->now - before * clock_ticks(chip);
}

bool chip_timer8_write(chip_t *chip, uint32_t address, uint32_t value)
{
    switch (address) {
    case CHIP_TIM8_CR1:
        write_control(chip, value);
        return true;
    case CHIP_TIM8_CNT:
        *chip_at(chip, address) = value & 0xFFFFU;
        chip->timer8_zero = chip->now - (value & 0xFFFFU) * clock_ticks(chip);
        return true;
    case CHIP_TIM8_SR: /* cleared by writing 0 */
        *chip_at(chip, address) &= value;
        return true;
    case CHIP_TIM8_ARR:
    case CHIP_TIM8_DIER:
        return false;
    default:
        chip_note(chip, "TIM8: 0x%08X is not modelled", address);
        return true;
    }
}

uint32_t chip_timer8_read(chip_t *chip, uint32_t address)
{
    return address == CHIP_TIM8_CNT ? count(chip) : chip_get(chip, address);
}

chip_ticks_t chip_timer8_next(chip_t *chip)
{
    const chip_ticks_t counts = (chip_ticks_t)chip_get(chip, CHIP_TIM8_ARR) + 1U;
    return runs(chip) ? chip->timer8_zero + counts * clock_ticks(chip) : CHIP_NEVER;
}

void chip_timer8_events(chip_t *chip)
{
    while (chip->now >= chip_timer8_next(chip)) {
        chip->timer8_zero = chip_timer8_next(chip);
        if ((chip_get(chip, CHIP_TIM8_CR1) & CHIP_TIM8_CR1_OPM) != 0) {
            *chip_at(chip, CHIP_TIM8_CR1) &= ~(uint32_t)CHIP_TIM8_CR1_CEN;
            *chip_at(chip, CHIP_TIM8_CNT) = 0;
        }
        *chip_at(chip, CHIP_TIM8_SR) |= CHIP_TIM8_SR_UIF;
        if ((chip_get(chip, CHIP_TIM8_DIER) & CHIP_TIM8_DIER_UDE) != 0) {
            chip_dma_serve_timer8(chip);
        }
    }
}
