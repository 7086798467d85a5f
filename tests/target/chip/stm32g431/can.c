/* SPDX-License-Identifier: Apache-2.0 */
/* FDCAN 1 with classic frames on a bus of 500 kbit/s (RM0440 section 46): message memory, filters
 * of standard identifiers, reception FIFO 0, three transmit elements as FIFO or as queue,
 * cancellation. */
#include <string.h>

#include "parts.h"

enum {
    CRYSTAL_TICKS = 170, /* 8 MHz */
    JOIN_BITS = 11,
    ELEMENTS = 3,
    RECEIVE_0 = 0xB0, /* in the message memory (46.3.6) */
    TRANSMIT = 0x278,
    ELEMENT_BYTES = 72,
    FILTERS = 28,
    FILTER_RANGE = 0,
    FILTER_TWO = 1,
    FILTER_MASK = 2,
    INTO_FIFO_0 = 1,
    ACTIVITY_SYNCHRONISING = 0,
    ACTIVITY_IDLE = 1,
    IDENTIFIER_SHIFT = 18,
    EXTENDED = 1 << 30, /* XTD of an element (46.3.6) */
    LENGTH_SHIFT = 16,
    QUEUE_MODE = 1 << 24 /* TXBC.TFQM (46.4.25); the description has the place of another chip */
};

static uint32_t ram_address(uint32_t offset)
{
    return CHIP_FDCAN1_RAM_000 + offset;
}

void chip_can_reset(chip_t *chip)
{
    chip_can_t *can = &chip->can;
    can->fifo_count = 0;
    can->fifo_get = 0;
    can->fifo_lost = false;
    can->order_count = 0;
    can->put = 0;
    can->sender = can->sender == CHIP_ITSELF ? CHIP_IDLE : can->sender;
    can->joined = CHIP_NEVER;
    for (uint32_t at = CHIP_FDCAN1_RAM_000; at <= CHIP_FDCAN1_RAM_211; at += 4U) {
        *chip_at(chip, at) = chip_random(chip); /* not initialised by a reset */
    }
}

static bool timing_is_right(chip_t *chip)
{
    const uint32_t quanta = 3U + chip_field(chip, CHIP_FDCAN1_NBTP, CHIP_FDCAN1_NBTP_NTSEG1) +
                            chip_field(chip, CHIP_FDCAN1_NBTP, CHIP_FDCAN1_NBTP_NTSEG2);
    const uint32_t quantum =
        CRYSTAL_TICKS * (chip_field(chip, CHIP_FDCAN1_NBTP, CHIP_FDCAN1_NBTP_NBRP) + 1U);
    const bool fed = chip_field(chip, CHIP_RCC_CCIPR, CHIP_RCC_CCIPR_FDCANSEL) == 0 &&
                     chip_get(chip, CHIP_FDCAN1_CKDIV) == 0 && chip->now >= chip->crystal_ready;
    if (!fed || quanta * quantum != CHIP_CAN_BIT_TICKS) {
        chip_note(chip, "CAN: a bit of %u ns on a bus of 2000", quanta * quantum * 1000U / 1360U);
        return false;
    }
    if ((chip_get(chip, CHIP_FDCAN1_CCCR) & CHIP_FDCAN1_CCCR_FDOE) != 0) {
        chip_note(chip, "CAN: frames of another format on a classic bus");
    }
    return chip_pin_function(chip, 'A', 11, 9) && chip_pin_function(chip, 'B', 9, 9);
}

/* The transceiver's shutdown is PC11, active high. */
static bool is_on_bus(chip_t *chip)
{
    return chip->now >= chip->can.joined && !chip->fault.can_silent &&
           chip_drives_low(chip, 'C', 11);
}

/* 46.3.7: no filter of 29-bit identifiers is modelled; ANFE says where they go. */
static bool is_extended_accepted(chip_t *chip)
{
    if (chip_field(chip, CHIP_FDCAN1_RXGFC, CHIP_FDCAN1_RXGFC_LSE) > 0) {
        chip_note(chip, "CAN: filters of 29-bit identifiers");
    }
    return chip_field(chip, CHIP_FDCAN1_RXGFC, CHIP_FDCAN1_RXGFC_ANFE) < 2U;
}

/* 46.3.7, 46.4.4: what no filter takes goes where ANFS says. */
static bool is_accepted(chip_t *chip, uint32_t identifier)
{
    const uint32_t count = chip_field(chip, CHIP_FDCAN1_RXGFC, CHIP_FDCAN1_RXGFC_LSS);
    for (uint32_t i = 0; i < count && i < FILTERS; i++) {
        const uint32_t filter = chip_get(chip, ram_address(4U * i));
        const uint32_t first = filter >> 16 & 0x7FFU;
        const uint32_t second = filter & 0x7FFU;
        const uint32_t kind = filter >> 30;
        const bool fits = (kind == FILTER_RANGE && identifier >= first && identifier <= second) ||
                          (kind == FILTER_TWO && (identifier == first || identifier == second)) ||
                          (kind == FILTER_MASK && (identifier & second) == (first & second));
        if (!fits) {
            continue;
        }
        if ((filter >> 27 & 7U) != INTO_FIFO_0) {
            chip_note(chip, "CAN: filter %u is of a kind that is not modelled", i);
        }
        return true;
    }
    if (chip_field(chip, CHIP_FDCAN1_RXGFC, CHIP_FDCAN1_RXGFC_ANFS) < 2U) {
        chip_note(chip, "CAN: frames that no filter takes are accepted");
    }
    return false;
}

void chip_can_received(chip_t *chip, const chip_frame_t *frame)
{
    chip_can_t *can = &chip->can;
    const bool extended = frame->identifier >= CHIP_EXTENDED;
    if (!is_on_bus(chip) ||
        !(extended ? is_extended_accepted(chip) : is_accepted(chip, frame->identifier))) {
        return;
    }
    if (can->fifo_count == ELEMENTS) {
        can->fifo_lost = true; /* blocking mode: the new one is lost */
        return;
    }
    const uint32_t index = (can->fifo_get + can->fifo_count) % ELEMENTS;
    const uint32_t at = ram_address(RECEIVE_0 + index * ELEMENT_BYTES);
    uint32_t words[2];
    memcpy(words, frame->data, sizeof words);
    *chip_at(chip, at) = extended ? (frame->identifier & ~CHIP_EXTENDED) | EXTENDED
                                  : frame->identifier << IDENTIFIER_SHIFT;
    *chip_at(chip, at + 4U) = (uint32_t)frame->length << LENGTH_SHIFT;
    *chip_at(chip, at + 8U) = words[0];
    *chip_at(chip, at + 12U) = words[1];
    can->fifo_count++;
}

static bool is_queue(const chip_t *chip)
{
    return (chip_get(chip, CHIP_FDCAN1_TXBC) & QUEUE_MODE) != 0;
}

/* 46.3.5: in turn in the FIFO; the lowest free element of the queue. */
static uint32_t put_index(const chip_t *chip)
{
    const uint32_t pending = chip_get(chip, CHIP_FDCAN1_TXBRP);
    uint32_t index = is_queue(chip) ? 0 : chip->can.put;
    while (is_queue(chip) && index < ELEMENTS - 1 && (pending >> index & 1U) != 0) {
        index++;
    }
    return index;
}

uint32_t chip_can_read(chip_t *chip, uint32_t address)
{
    const chip_can_t *can = &chip->can;
    const uint32_t value = chip_get(chip, address);
    switch (address) {
    case CHIP_FDCAN1_PSR:
        return (value & ~CHIP_FDCAN1_PSR_ACT) |
               (is_on_bus(chip) ? ACTIVITY_IDLE : ACTIVITY_SYNCHRONISING) * 8U;
    case CHIP_FDCAN1_RXF0S:
        return can->fifo_count | can->fifo_get << 8 |
               (can->fifo_get + can->fifo_count) % ELEMENTS << 16 |
               (can->fifo_count == ELEMENTS ? CHIP_FDCAN1_RXF0S_F0F : 0) |
               (can->fifo_lost ? CHIP_FDCAN1_RXF0S_RF0L : 0);
    case CHIP_FDCAN1_TXFQS:
        return (is_queue(chip) ? 0 : ELEMENTS - can->order_count) | put_index(chip) << 16 |
               (can->order_count == ELEMENTS ? CHIP_FDCAN1_TXFQS_TFQF : 0);
    default:
        return value;
    }
}

static void write_control(chip_t *chip, uint32_t value)
{
    const uint32_t before = chip_get(chip, CHIP_FDCAN1_CCCR);
    uint32_t after = value;
    if ((value & CHIP_FDCAN1_CCCR_CCE) != 0 && (before & CHIP_FDCAN1_CCCR_INIT) == 0) {
        chip_note(chip, "CAN: CCE set outside of initialisation");
        after &= ~CHIP_FDCAN1_CCCR_CCE;
    }
    if ((value & CHIP_FDCAN1_CCCR_INIT) != 0) {
        chip->can.joined = CHIP_NEVER;
    } else {
        after &= ~CHIP_FDCAN1_CCCR_CCE; /* cleared with INIT */
        if ((before & CHIP_FDCAN1_CCCR_INIT) != 0) {
            chip->can.joined = timing_is_right(chip)
                                   ? chip->now + (chip_ticks_t)JOIN_BITS * CHIP_CAN_BIT_TICKS
                                   : CHIP_NEVER;
        }
    }
    *chip_at(chip, CHIP_FDCAN1_CCCR) = after;
}

/* One frame a write, at the put index (46.3.5). */
static void request(chip_t *chip, uint32_t value)
{
    chip_can_t *can = &chip->can;
    const uint32_t index = put_index(chip);
    if (value != 1U << index || can->order_count == ELEMENTS) {
        chip_note(chip, "CAN: a request for element %X, the put index is %u", value, index);
        return;
    }
    *chip_at(chip, CHIP_FDCAN1_TXBRP) |= value;
    *chip_at(chip, CHIP_FDCAN1_TXBTO) &= ~value;
    *chip_at(chip, CHIP_FDCAN1_TXBCF) &= ~value;
    chip_can_request(chip, index);
    can->put = (can->put + 1U) % ELEMENTS;
}

static void finish(chip_t *chip, unsigned element, uint32_t outcome)
{
    const uint32_t bit = 1U << element;
    chip_can_forget(chip, element);
    *chip_at(chip, CHIP_FDCAN1_TXBRP) &= ~bit;
    *chip_at(chip, CHIP_FDCAN1_TXBCR) &= ~bit;
    *chip_at(chip, outcome) |= bit;
}

/* 46.3.5: a pending element is cancelled at once, one on the bus comes to its end. */
static void cancel(chip_t *chip, uint32_t value)
{
    for (unsigned element = 0; element < ELEMENTS; element++) {
        const bool pending = (chip_get(chip, CHIP_FDCAN1_TXBRP) >> element & 1U) != 0;
        if ((value >> element & 1U) != 0 && pending && !chip_can_sends(chip, element)) {
            finish(chip, element, CHIP_FDCAN1_TXBCF);
        }
    }
}

bool chip_can_write(chip_t *chip, uint32_t address, uint32_t value)
{
    chip_can_t *can = &chip->can;
    const uint32_t open = CHIP_FDCAN1_CCCR_INIT | CHIP_FDCAN1_CCCR_CCE;
    switch (address) {
    case CHIP_FDCAN1_CCCR:
        write_control(chip, value);
        return true;
    case CHIP_FDCAN1_NBTP:
    case CHIP_FDCAN1_RXGFC:
    case CHIP_FDCAN1_TXBC:
        if ((chip_get(chip, CHIP_FDCAN1_CCCR) & open) != open) {
            chip_note(chip, "CAN: a protected register written outside of initialisation");
            return true;
        }
        return false;
    case CHIP_FDCAN1_RXF0A:
        if (can->fifo_count == 0 || value != can->fifo_get) {
            chip_note(chip, "CAN: element %u acknowledged, which is not the oldest", value);
            return true;
        }
        can->fifo_get = (can->fifo_get + 1U) % ELEMENTS;
        can->fifo_count--;
        return true;
    case CHIP_FDCAN1_TXBAR:
        request(chip, value);
        return true;
    case CHIP_FDCAN1_TXBCR:
        cancel(chip, value);
        return true;
    default:
        return false;
    }
}

chip_frame_t chip_can_mailbox(const chip_t *chip, unsigned element)
{
    const uint32_t at = ram_address(TRANSMIT + element * ELEMENT_BYTES);
    const uint32_t word = chip_get(chip, at);
    const bool extended = (word & EXTENDED) != 0;
    chip_frame_t frame = {.identifier = extended ? (word & 0x1FFFFFFFU) | CHIP_EXTENDED
                                                 : word >> IDENTIFIER_SHIFT & 0x7FFU,
                          .length = (uint8_t)(chip_get(chip, at + 4U) >> LENGTH_SHIFT & 0xFU)};
    const uint32_t words[2] = {chip_get(chip, at + 8U), chip_get(chip, at + 12U)};
    memcpy(frame.data, words, sizeof words);
    return frame;
}

/* 46.3.5: in the order of the requests; of the queue the lowest identifier. */
unsigned chip_can_offered(chip_t *chip)
{
    const chip_can_t *can = &chip->can;
    const bool silent = chip->fault.can_silent || !chip_drives_low(chip, 'C', 11);
    if (can->order_count == 0 || silent) {
        return CHIP_MAILBOXES;
    }
    unsigned first = can->order[0];
    for (unsigned i = 1; is_queue(chip) && i < can->order_count; i++) {
        if (chip_can_arbitration(chip_can_mailbox(chip, can->order[i]).identifier) <
            chip_can_arbitration(chip_can_mailbox(chip, first).identifier)) {
            first = can->order[i];
        }
    }
    return first;
}

void chip_can_sent(chip_t *chip, unsigned element)
{
    const uint32_t first = chip_get(chip, ram_address(TRANSMIT + element * ELEMENT_BYTES));
    if ((first & 5U << 29) != 0) {
        chip_note(chip, "CAN: a remote frame, or an error state");
    }
    finish(chip, element, CHIP_FDCAN1_TXBTO);
}
