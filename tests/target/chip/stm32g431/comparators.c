/* SPDX-License-Identifier: Apache-2.0 */
/* Comparators 1, 2 and 4 (RM0440 section 24) on the shunts' inputs PA1, PA7 and PB0, their
 * thresholds from DAC 3 (22), and TIM1's second break input (28.3.17). */
#include "analog.h"

enum {
    COMPARATORS = 3,
    INPUT_FIRST_PIN = 0,
    THRESHOLD_DAC3 = 4, /* INMSEL: channel 1 for comparator 1, channel 2 for 2 and 4 */
    DAC_INSIDE = 3,     /* MODE: to the chip's own parts, without buffer */
    DAC_SETTLES_us = 1  /* data sheet, DAC 3 */
};
typedef struct {
    uint32_t control, source; /* of TIM1_AF2 */
    uint32_t polarity;
    unsigned dac_channel;
    char port;
    uint8_t pin;
} comparator_t;
static const comparator_t EACH[COMPARATORS] = {
    {CHIP_COMP_C1CSR, CHIP_TIM1_AF2_BK2CMP1E, CHIP_TIM1_AF2_BK2CMP1P, 1, 'A', 1},
    {CHIP_COMP_C2CSR, CHIP_TIM1_AF2_BK2CMP2E, CHIP_TIM1_AF2_BK2CMP2P, 2, 'A', 7},
    {CHIP_COMP_C4CSR, CHIP_TIM1_AF2_BK2CMP4E, CHIP_TIM1_AF2_BK2CMP4P, 2, 'B', 0}};

void comparators_reset(chip_t *chip)
{
    chip->break_since = CHIP_NEVER;
    *chip_at(chip, CHIP_TIM1_AF2) = CHIP_TIM1_AF2_BKINE; /* 28.6.26; the description has 0 */
}

static double threshold_V(const chip_t *chip, unsigned channel)
{
    const bool first = channel == 1;
    const uint32_t on =
        chip_get(chip, CHIP_DAC3_DAC_CR) & (first ? CHIP_DAC3_DAC_CR_EN1 : CHIP_DAC3_DAC_CR_EN2);
    const uint32_t mode = chip_field(chip, CHIP_DAC3_DAC_MCR,
                                     first ? CHIP_DAC3_DAC_MCR_MODE1 : CHIP_DAC3_DAC_MCR_MODE2);
    const uint32_t code =
        chip_get(chip, first ? CHIP_DAC3_DAC_DHR12R1 : CHIP_DAC3_DAC_DHR12R2) & 0xFFFU;
    return on != 0 && mode == DAC_INSIDE ? code * (ANALOG_REFERENCE_uV / 1e6) / ANALOG_CODES : 0.0;
}

/* The output behind its polarity; low while it is off. */
static bool is_high(const chip_t *chip, const comparator_t *each)
{
    const uint32_t settings = chip_get(chip, each->control);
    if ((settings & CHIP_COMP_C1CSR_EN) == 0 || chip->fault.comparators_dead) {
        return false;
    }
    const bool above =
        (settings & CHIP_COMP_C1CSR_INPSEL) == INPUT_FIRST_PIN &&
        (settings & CHIP_COMP_C1CSR_INMSEL) >> 4 == THRESHOLD_DAC3 &&
        chip_pin_is_analog(chip, each->port, each->pin) &&
        analog_pin_V(chip, each->port, each->pin) > threshold_V(chip, each->dac_channel);
    return above != ((settings & CHIP_COMP_C1CSR_POL) != 0);
}

uint32_t comparators_read(chip_t *chip, uint32_t address)
{
    for (unsigned i = 0; i < COMPARATORS; i++) {
        if (address == EACH[i].control) {
            return (chip_get(chip, address) & ~CHIP_COMP_C1CSR_VALUE) |
                   (is_high(chip, &EACH[i]) ? CHIP_COMP_C1CSR_VALUE : 0);
        }
    }
    if (address == CHIP_DAC3_DAC_DOR1 || address == CHIP_DAC3_DAC_DOR2) {
        return chip_get(chip, address == CHIP_DAC3_DAC_DOR1 ? CHIP_DAC3_DAC_DHR12R1
                                                            : CHIP_DAC3_DAC_DHR12R2);
    }
    return chip_get(chip, address);
}

bool comparators_write(chip_t *chip, uint32_t address, uint32_t value)
{
    const uint32_t before = chip_get(chip, address);
    for (unsigned i = 0; i < COMPARATORS; i++) {
        if (address == EACH[i].control && (before & CHIP_COMP_C1CSR_LOCK) != 0) {
            chip_note(chip, "comparator %u written while it is locked", i + 1U);
            return true;
        }
    }
    if (address == CHIP_DAC3_DAC_MCR &&
        (chip_get(chip, CHIP_DAC3_DAC_CR) & (CHIP_DAC3_DAC_CR_EN1 | CHIP_DAC3_DAC_CR_EN2)) != 0 &&
        value != before) {
        chip_note(chip, "DAC3: its mode written while it is on");
    }
    return false;
}

/* Time that the input has to be active (BK2F, 28.6.20), with CKD = 0. */
static chip_ticks_t filter_ticks(const chip_t *chip)
{
    static const uint16_t CLOCKS[16] = {0,  2,  4,  8,  12,  16,  24,  32,
                                        48, 64, 80, 96, 128, 160, 192, 256};
    return (chip_ticks_t)CLOCKS[chip_field(chip, CHIP_TIM1_BDTR, CHIP_TIM1_BDTR_BK2F)] *
           chip->ticks_per_cycle;
}

static bool input_is_active(const chip_t *chip)
{
    const uint32_t sources = chip_get(chip, CHIP_TIM1_AF2);
    const uint32_t settings = chip_get(chip, CHIP_TIM1_BDTR);
    if ((settings & CHIP_TIM1_BDTR_BK2E) == 0) {
        return false;
    }
    const bool active_high = (settings & CHIP_TIM1_BDTR_BK2P) != 0;
    /* The pin's input, which no pin of this board is, is low. */
    bool any = (sources & CHIP_TIM1_AF2_BKINE) != 0 &&
               active_high == ((sources & CHIP_TIM1_AF2_BK2INP) != 0);
    for (unsigned i = 0; i < COMPARATORS; i++) {
        const bool inverted = (sources & EACH[i].polarity) != 0;
        any = any || ((sources & EACH[i].source) != 0 &&
                      (is_high(chip, &EACH[i]) != inverted) == active_high);
    }
    return any;
}

static void follow(chip_t *chip)
{
    if (!input_is_active(chip)) {
        chip->break_since = CHIP_NEVER;
    } else if (chip->break_since == CHIP_NEVER) {
        chip->break_since = chip->now;
    }
}

chip_ticks_t comparators_next(chip_t *chip)
{
    follow(chip);
    if (chip->break_since == CHIP_NEVER ||
        (chip_get(chip, CHIP_TIM1_SR) & CHIP_TIM1_SR_B2IF) != 0) {
        return CHIP_NEVER;
    }
    const chip_ticks_t due = chip->break_since + filter_ticks(chip);
    return due > chip->now ? due : chip->now;
}

uint32_t comparators_break(chip_t *chip)
{
    follow(chip);
    const uint32_t both = CHIP_TIM1_BDTR_OSSI | CHIP_TIM1_BDTR_OSSR;
    if (chip->break_since == CHIP_NEVER || chip->now < chip->break_since + filter_ticks(chip)) {
        return 0;
    }
    if ((chip_get(chip, CHIP_TIM1_BDTR) & both) != both) {
        chip_note(chip, "the second break input without OSSI and OSSR"); /* 28.3.17 */
    }
    return CHIP_TIM1_SR_B2IF;
}
