/* SPDX-License-Identifier: Apache-2.0 */
/* USART3 (RM0090 section 30): eight bits, no parity; a terminal at 115 200 bit/s at the other end.
 */
#include "parts.h"

enum { BITS_OF_A_BYTE = 10, BIT_RATE = 115200, TOLERANCE_PER_MILLE = 20 };

void chip_serial_reset(chip_t *chip)
{
    chip->serial.holds = false;
    chip->serial.shifted = 0;
    chip->serial.next_byte = CHIP_NEVER;
    /* The description has these two bits 16 places too high; 30.6.1 has 0x00C0. */
    *chip_at(chip, CHIP_USART3_SR) = CHIP_USART3_SR_TXE | CHIP_USART3_SR_TC;
}

/* Ticks of a byte at the rate that the chip has set; 0 if the terminal could not read it. */
static chip_ticks_t byte_ticks(chip_t *chip)
{
    const uint32_t divider = chip_get(chip, CHIP_USART3_BRR);
    const uint32_t ticks = divider * chip_bus_ticks(chip, CHIP_RCC_CFGR_PPRE1);
    const uint32_t right = (uint32_t)(CHIP_TICKS_PER_SECOND / BIT_RATE);
    const uint32_t off = ticks > right ? ticks - right : right - ticks;
    if (off * 1000U > right * TOLERANCE_PER_MILLE || !chip_pin_function(chip, 'B', 10, 7)) {
        chip_note(chip, "serial line: %u bit/s, or no pin",
                  ticks == 0 ? 0 : (uint32_t)(CHIP_TICKS_PER_SECOND / ticks));
        return 0;
    }
    return (chip_ticks_t)BITS_OF_A_BYTE * ticks;
}

static void shift_out(chip_t *chip, uint8_t byte)
{
    const chip_ticks_t duration = byte_ticks(chip);
    chip_serial_t *serial = &chip->serial;
    if (duration > 0 && serial->size + 1U < CHIP_TEXT_BYTES) {
        serial->text[serial->size] = (char)byte;
        serial->size++;
    }
    serial->shifted = chip->now + (duration > 0 ? duration : CHIP_TICKS_PER_US);
}

bool chip_serial_write(chip_t *chip, uint32_t address, uint32_t value)
{
    chip_serial_t *serial = &chip->serial;
    if (address == CHIP_USART3_SR) {
        *chip_at(chip, address) &= value | CHIP_USART3_SR_TXE;
        return true;
    }
    if (address != CHIP_USART3_DR) {
        return false;
    }
    const uint32_t on = CHIP_USART3_CR1_UE | CHIP_USART3_CR1_TE;
    if ((chip_get(chip, CHIP_USART3_CR1) & on) != on) {
        return true;
    }
    if (serial->holds) {
        chip_note(chip, "serial line: a byte written over another");
    } else if (chip->now < serial->shifted) {
        serial->holds = true;
        serial->next = (uint8_t)value;
        *chip_at(chip, CHIP_USART3_SR) &= ~CHIP_USART3_SR_TXE;
    } else {
        shift_out(chip, (uint8_t)value);
    }
    return true;
}

uint32_t chip_serial_read(chip_t *chip, uint32_t address)
{
    const uint32_t value = chip_get(chip, address);
    if (address == CHIP_USART3_DR) {
        *chip_at(chip, CHIP_USART3_SR) &= ~(CHIP_USART3_SR_RXNE | CHIP_USART3_SR_ORE);
    }
    return value;
}

chip_ticks_t chip_serial_next(chip_t *chip)
{
    const chip_serial_t *serial = &chip->serial;
    const chip_ticks_t sent = serial->holds ? serial->shifted : CHIP_NEVER;
    return sent < serial->next_byte ? sent : serial->next_byte;
}

static void receive(chip_t *chip)
{
    chip_serial_t *serial = &chip->serial;
    const uint32_t on = CHIP_USART3_CR1_UE | CHIP_USART3_CR1_RE;
    const uint8_t byte = (uint8_t)serial->typed[serial->typed_first];
    serial->typed_first = (serial->typed_first + 1U) % sizeof serial->typed;
    serial->typed_count--;
    serial->next_byte = serial->typed_count > 0
                            ? chip->now + CHIP_TICKS_PER_SECOND * BITS_OF_A_BYTE / BIT_RATE
                            : CHIP_NEVER;
    if ((chip_get(chip, CHIP_USART3_CR1) & on) != on || !chip_pin_function(chip, 'B', 11, 7)) {
        return;
    }
    uint32_t *status = chip_at(chip, CHIP_USART3_SR);
    if ((*status & CHIP_USART3_SR_RXNE) != 0) {
        *status |= CHIP_USART3_SR_ORE; /* the earlier byte is kept */
        return;
    }
    *chip_at(chip, CHIP_USART3_DR) = byte;
    *status |= CHIP_USART3_SR_RXNE;
    chip->needs_attention = true;
}

void chip_serial_events(chip_t *chip)
{
    chip_serial_t *serial = &chip->serial;
    if (serial->holds && chip->now >= serial->shifted) {
        serial->holds = false;
        *chip_at(chip, CHIP_USART3_SR) |= CHIP_USART3_SR_TXE;
        shift_out(chip, serial->next);
        chip->needs_attention = true;
    }
    if (chip->now >= serial->next_byte) {
        receive(chip);
    }
}
