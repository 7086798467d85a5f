/* SPDX-License-Identifier: Apache-2.0 */
/* GPIO ports (RM0090 section 8, RM0440 section 9), the encoder's timer (18.3.12, 29.4.22), and the
 * edges at pins that EXTI listens to (12.2.4, 16.4). */
#include "parts.h"

enum { MODE_OUTPUT = 1, MODE_ALTERNATE = 2, MODE_ANALOG = 3, PULL_UP = 1 };
enum { ENCODER_BOTH_EDGES = 3 };
static const uint32_t MODER[6] = {CHIP_PORT_MODERS};

static uint32_t of(char port, uint32_t address_in_a)
{
    return address_in_a - CHIP_GPIOA_MODER + MODER[port - 'A'];
}

static uint32_t mode(const chip_t *chip, char port, unsigned pin)
{
    return chip_get(chip, of(port, CHIP_GPIOA_MODER)) >> 2U * pin & 3U;
}

bool chip_pin_is_analog(const chip_t *chip, char port, unsigned pin)
{
    return mode(chip, port, pin) == MODE_ANALOG;
}

bool chip_pin_function(const chip_t *chip, char port, unsigned pin, unsigned function)
{
    const uint32_t at = of(port, pin < 8 ? CHIP_GPIOA_AFRL : CHIP_GPIOA_AFRH);
    return mode(chip, port, pin) == MODE_ALTERNATE &&
           (chip_get(chip, at) >> 4U * (pin & 7U) & 0xFU) == function;
}

bool chip_pin_is_output(const chip_t *chip, char port, unsigned pin)
{
    return mode(chip, port, pin) == MODE_OUTPUT;
}

bool chip_pin_level(chip_t *chip, char port, unsigned pin)
{
    const unsigned bit = 1U << pin;
    bool driven;
    if (chip_part_level(chip, port, pin, &driven)) {
        return driven;
    }
    if (mode(chip, port, pin) == MODE_OUTPUT) {
        return (chip_get(chip, of(port, CHIP_GPIOA_ODR)) & bit) != 0;
    }
    if ((chip->in.driven[port - 'A'] & bit) != 0) {
        return (chip->in.level[port - 'A'] & bit) != 0;
    }
    return (chip_get(chip, of(port, CHIP_GPIOA_PUPDR)) >> 2U * pin & 3U) == PULL_UP;
}

static uint32_t read_port(chip_t *chip, char port)
{
    uint32_t value = 0;
    for (unsigned pin = 0; pin < 16; pin++) {
        const bool high = mode(chip, port, pin) != MODE_ANALOG && chip_pin_level(chip, port, pin);
        value |= high ? 1U << pin : 0U;
    }
    return value;
}

/* Both inputs of the encoder on their pins, counted at both edges. */
static bool encoder_counts(const chip_t *chip)
{
    static const chip_pin_t PINS[2] = {CHIP_ENCODER_PINS};
    return (chip_get(chip, CHIP_ENCODER_CR1) & CHIP_ENCODER_CR1_CEN) != 0 &&
           chip_field(chip, CHIP_ENCODER_SMCR, CHIP_ENCODER_SMCR_SMS) == ENCODER_BOTH_EDGES &&
           chip_pin_selects(chip, PINS[0]) && chip_pin_selects(chip, PINS[1]);
}

static uint32_t read_encoder(chip_t *chip, uint32_t address)
{
    if (!encoder_counts(chip)) {
        return chip_get(chip, address);
    }
    switch (address) {
    case CHIP_ENCODER_SR:
        if (chip->in.encoder_index) {
            chip->in.encoder_index = false;
            *chip_at(chip, address) |= CHIP_ENCODER_SR_CC3IF;
            *chip_at(chip, CHIP_ENCODER_CCR3) = chip->in.encoder_index_count;
        }
        return chip_get(chip, address);
    case CHIP_ENCODER_CCR3:
        *chip_at(chip, CHIP_ENCODER_SR) &= ~CHIP_ENCODER_SR_CC3IF;
        return chip_get(chip, address);
    case CHIP_ENCODER_CNT:
        return chip->in.encoder_count;
    default:
        return chip_get(chip, address);
    }
}

uint32_t chip_pins_read(chip_t *chip, uint32_t address)
{
    for (char port = 'A'; port <= 'F'; port++) {
        if (MODER[port - 'A'] == 0) {
            continue;
        }
        if (address == of(port, CHIP_GPIOA_IDR)) {
            const uint32_t spike = chip->in.spike[port - 'A'];
            chip->in.spike[port - 'A'] = 0;
            return read_port(chip, port) ^ spike;
        }
    }
    return (address ^ CHIP_ENCODER_CR1) < 0x400U ? read_encoder(chip, address)
                                                 : chip_get(chip, address);
}

bool chip_pins_write(chip_t *chip, uint32_t address, uint32_t value)
{
    for (char port = 'A'; port <= 'F'; port++) {
        if (MODER[port - 'A'] == 0) {
            continue;
        }
        if (address == of(port, CHIP_GPIOA_BSRR)) {
            uint32_t *output = chip_at(chip, of(port, CHIP_GPIOA_ODR));
            *output = (*output & ~(value >> 16)) | (value & 0xFFFFU);
            chip_part_pins_written(chip);
            return true;
        }
        if (address == of(port, CHIP_GPIOA_MODER)) {
            *chip_at(chip, address) = value;
            chip_part_pins_written(chip);
            return true;
        }
    }
    if (address == CHIP_ENCODER_SR) {
        *chip_at(chip, address) &= value;
        return true;
    }
    return false;
}

/* Which line listens to which port: four bits each from EXTICR1 on (9.2.3). */
static char port_of_line(const chip_t *chip, unsigned line)
{
    const uint32_t at = CHIP_SYSCFG_EXTICR1 + 4U * (line / 4U);
    return (char)('A' + (chip_get(chip, at) >> 4U * (line % 4U) & 0xFU));
}

void chip_pins_watch(chip_t *chip)
{
    const uint32_t listening = chip_get(chip, CHIP_LINES_MASK) & 0xFFFFU;
    for (unsigned line = 0; listening >> line != 0; line++) {
        const uint32_t bit = 1U << line;
        const char port = port_of_line(chip, line);
        if ((listening & bit) == 0 || port > 'F' || MODER[port - 'A'] == 0) {
            continue;
        }
        const bool high = chip_pin_level(chip, port, line);
        const bool was = (chip->pin_levels & bit) != 0;
        const uint32_t edges = chip_get(chip, high ? CHIP_LINES_RISING : CHIP_LINES_FALLING);
        if (high != was && (edges & bit) != 0) {
            *chip_at(chip, CHIP_LINES_PENDING) |= bit;
            chip->needs_attention = true;
        }
        chip->pin_levels = (uint16_t)(high ? chip->pin_levels | bit : chip->pin_levels & ~bit);
    }
}

bool chip_drives_high(chip_t *chip, char port, unsigned pin)
{
    return chip_pin_is_output(chip, port, pin) && chip_pin_level(chip, port, pin);
}

bool chip_drives_low(chip_t *chip, char port, unsigned pin)
{
    return chip_pin_is_output(chip, port, pin) && !chip_pin_level(chip, port, pin);
}
