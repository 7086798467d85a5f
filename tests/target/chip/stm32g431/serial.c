/* SPDX-License-Identifier: Apache-2.0 */
/* USART2 with its FIFO (RM0440 section 37): eight bits, no parity; a terminal at 115 200 bit/s at
 * the other end. */
#include <string.h>

#include "parts.h"

enum { BITS_OF_A_BYTE = 10, BIT_RATE = 115200, TOLERANCE_PER_MILLE = 20, FIFO_BYTES = 8 };

static void show_status(chip_t *chip)
{
    const chip_serial_t *serial = &chip->serial;
    const bool with_fifo = (chip_get(chip, CHIP_USART2_CR1) & CHIP_USART2_CR1_FIFOEN) != 0;
    const unsigned holds = with_fifo ? FIFO_BYTES : 1U;
    uint32_t status = chip_get(chip, CHIP_USART2_ISR) &
                      ~(CHIP_USART2_ISR_TXE | CHIP_USART2_ISR_TC | CHIP_USART2_ISR_RXNE);
    status |= serial->out_count < holds ? CHIP_USART2_ISR_TXE : 0;
    status |= serial->out_count == 0 && chip->now >= serial->shifted ? CHIP_USART2_ISR_TC : 0;
    status |= serial->in_count > 0 ? CHIP_USART2_ISR_RXNE : 0;
    *chip_at(chip, CHIP_USART2_ISR) = status;
}

void chip_serial_reset(chip_t *chip)
{
    chip->serial.out_count = 0;
    chip->serial.in_count = 0;
    chip->serial.shifted = 0;
    chip->serial.next_byte = CHIP_NEVER;
    show_status(chip);
}

/* Ticks of a byte at the rate that the chip has set; 0 if the terminal could not read it. */
static chip_ticks_t byte_ticks(chip_t *chip)
{
    const uint32_t divider = chip_get(chip, CHIP_USART2_BRR);
    const uint32_t ticks = divider * chip_bus_ticks(chip, CHIP_RCC_CFGR_PPRE1);
    const uint32_t right = (uint32_t)(CHIP_TICKS_PER_SECOND / BIT_RATE);
    const uint32_t off = ticks > right ? ticks - right : right - ticks;
    const bool plain = (chip_get(chip, CHIP_USART2_CR1) & CHIP_USART2_CR1_OVER8) == 0 &&
                       chip_get(chip, CHIP_USART2_PRESC) == 0 &&
                       chip_field(chip, CHIP_RCC_CCIPR, CHIP_RCC_CCIPR_USART2SEL) == 0;
    if (!plain || off * 1000ULL > right * (unsigned long long)TOLERANCE_PER_MILLE ||
        !chip_pin_function(chip, 'B', 3, 7)) {
        chip_note(chip, "serial line: %u bit/s, or no pin",
                  ticks == 0 ? 0 : (uint32_t)(CHIP_TICKS_PER_SECOND / ticks));
        return 0;
    }
    return (chip_ticks_t)BITS_OF_A_BYTE * ticks;
}

static void shift_out(chip_t *chip)
{
    const chip_ticks_t duration = byte_ticks(chip);
    chip_serial_t *serial = &chip->serial;
    if (duration > 0 && serial->size + 1U < CHIP_TEXT_BYTES) {
        serial->text[serial->size] = (char)serial->out[0];
        serial->size++;
    }
    serial->out_count--;
    memmove(&serial->out[0], &serial->out[1], serial->out_count);
    serial->shifted = chip->now + (duration > 0 ? duration : CHIP_TICKS_PER_US);
}

bool chip_serial_write(chip_t *chip, uint32_t address, uint32_t value)
{
    chip_serial_t *serial = &chip->serial;
    const uint32_t control = chip_get(chip, CHIP_USART2_CR1);
    const uint32_t on = CHIP_USART2_CR1_UE | CHIP_USART2_CR1_TE;
    switch (address) {
    case CHIP_USART2_CR1:
        if ((control & value & CHIP_USART2_CR1_UE) != 0 &&
            ((control ^ value) & CHIP_USART2_CR1_FIFOEN) != 0) {
            chip_note(chip, "FIFOEN changed while the USART is on");
        }
        *chip_at(chip, address) = value;
        show_status(chip);
        return true;
    case CHIP_USART2_BRR:
        if ((control & CHIP_USART2_CR1_UE) != 0) {
            chip_note(chip, "BRR written while the USART is on");
        }
        return false;
    case CHIP_USART2_ICR: /* cleared by writing 1 */
        *chip_at(chip, CHIP_USART2_ISR) &= ~(value & CHIP_USART2_ICR_ORECF);
        return true;
    case CHIP_USART2_TDR:
        if ((control & on) == on && (chip_get(chip, CHIP_USART2_ISR) & CHIP_USART2_ISR_TXE) != 0) {
            serial->out[serial->out_count] = (uint8_t)value;
            serial->out_count++;
        } else if ((control & on) == on) {
            chip_note(chip, "serial line: a byte written into a full FIFO");
        }
        if (serial->out_count > 0 && chip->now >= serial->shifted) {
            shift_out(chip);
        }
        show_status(chip);
        return true;
    default:
        return false;
    }
}

uint32_t chip_serial_read(chip_t *chip, uint32_t address)
{
    chip_serial_t *serial = &chip->serial;
    if (address == CHIP_USART2_RDR && serial->in_count > 0) {
        const uint32_t value = serial->in[0];
        serial->in_count--;
        memmove(&serial->in[0], &serial->in[1], serial->in_count);
        show_status(chip);
        return value;
    }
    return chip_get(chip, address);
}

chip_ticks_t chip_serial_next(chip_t *chip)
{
    const chip_serial_t *serial = &chip->serial;
    const chip_ticks_t sent = serial->out_count > 0 ? serial->shifted : CHIP_NEVER;
    return sent < serial->next_byte ? sent : serial->next_byte;
}

static void receive(chip_t *chip)
{
    chip_serial_t *serial = &chip->serial;
    const uint32_t control = chip_get(chip, CHIP_USART2_CR1);
    const uint32_t on = CHIP_USART2_CR1_UE | CHIP_USART2_CR1_RE;
    const unsigned holds = (control & CHIP_USART2_CR1_FIFOEN) != 0 ? FIFO_BYTES : 1U;
    const uint8_t byte = (uint8_t)serial->typed[serial->typed_first];
    serial->typed_first = (serial->typed_first + 1U) % sizeof serial->typed;
    serial->typed_count--;
    serial->next_byte = serial->typed_count > 0
                            ? chip->now + CHIP_TICKS_PER_SECOND * BITS_OF_A_BYTE / BIT_RATE
                            : CHIP_NEVER;
    if ((control & on) != on || !chip_pin_function(chip, 'B', 4, 7)) {
        return;
    }
    if (serial->in_count >= holds) {
        *chip_at(chip, CHIP_USART2_ISR) |= CHIP_USART2_ISR_ORE; /* the earlier bytes are kept */
    } else {
        serial->in[serial->in_count] = byte;
        serial->in_count++;
    }
    chip->needs_attention = true;
}

void chip_serial_events(chip_t *chip)
{
    chip_serial_t *serial = &chip->serial;
    if (serial->out_count > 0 && chip->now >= serial->shifted) {
        shift_out(chip);
        chip->needs_attention = true;
    }
    if (chip->now >= serial->next_byte) {
        receive(chip);
    }
    show_status(chip);
}
