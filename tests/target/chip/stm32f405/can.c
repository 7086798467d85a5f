/* SPDX-License-Identifier: Apache-2.0 */
/* bxCAN on a bus of 500 kbit/s (RM0090 section 32): three mailboxes that leave by their identifiers
 * or in the order of their requests, aborts, a FIFO of three frames, filter banks in 16-bit list
 * mode. */
#include <string.h>

#include "parts.h"

enum { JOIN_BITS = 11, FIFO_FRAMES = 3, BANKS = 28 };
static const uint32_t FULL_TSR = CHIP_CAN1_TSR_TME0 | CHIP_CAN1_TSR_TME1 | CHIP_CAN1_TSR_TME2;
static const uint32_t EMPTY[CHIP_MAILBOXES] = {CHIP_CAN1_TSR_TME0, CHIP_CAN1_TSR_TME1,
                                               CHIP_CAN1_TSR_TME2};
static const uint32_t OUTCOME[CHIP_MAILBOXES] = {
    CHIP_CAN1_TSR_RQCP0 | CHIP_CAN1_TSR_TXOK0 | CHIP_CAN1_TSR_ALST0 | CHIP_CAN1_TSR_TERR0,
    CHIP_CAN1_TSR_RQCP1 | CHIP_CAN1_TSR_TXOK1 | CHIP_CAN1_TSR_ALST1 | CHIP_CAN1_TSR_TERR1,
    CHIP_CAN1_TSR_RQCP2 | CHIP_CAN1_TSR_TXOK2 | CHIP_CAN1_TSR_ALST2 | CHIP_CAN1_TSR_TERR2};
static const uint32_t DONE[CHIP_MAILBOXES] = {CHIP_CAN1_TSR_RQCP0, CHIP_CAN1_TSR_RQCP1,
                                              CHIP_CAN1_TSR_RQCP2};
static const uint32_t SENT[CHIP_MAILBOXES] = {CHIP_CAN1_TSR_TXOK0, CHIP_CAN1_TSR_TXOK1,
                                              CHIP_CAN1_TSR_TXOK2};
static const uint32_t ABORT[CHIP_MAILBOXES] = {CHIP_CAN1_TSR_ABRQ0, CHIP_CAN1_TSR_ABRQ1,
                                               CHIP_CAN1_TSR_ABRQ2};
static const uint32_t MAILBOX[CHIP_MAILBOXES] = {CHIP_CAN1_TI0R, CHIP_CAN1_TI1R, CHIP_CAN1_TI2R};

void chip_can_reset(chip_t *chip)
{
    chip_can_t *can = &chip->can;
    can->fifo_count = 0;
    can->order_count = 0;
    can->sender = can->sender == CHIP_ITSELF ? CHIP_IDLE : can->sender;
    can->joined = CHIP_NEVER;
    *chip_at(chip, CHIP_CAN1_TSR) = FULL_TSR;
}

static bool timing_is_right(chip_t *chip)
{
    const uint32_t timing = chip_get(chip, CHIP_CAN1_BTR);
    const uint32_t quanta = 3U + (timing >> 16 & 0xFU) + (timing >> 20 & 7U);
    const uint32_t quantum = ((timing & 0x3FFU) + 1U) * chip_bus_ticks(chip, CHIP_RCC_CFGR_PPRE1);
    if (quanta * quantum != CHIP_CAN_BIT_TICKS) {
        chip_note(chip, "CAN: a bit of %u ns on a bus of 2000", quanta * quantum * 1000U / 336U);
        return false;
    }
    return chip_pin_function(chip, 'B', 8, 9) && chip_pin_function(chip, 'B', 9, 9);
}

static bool is_on_bus(const chip_t *chip)
{
    return chip->now >= chip->can.joined && !chip->fault.can_silent;
}

/* As a 16-bit filter sees it: identifier, RTR, IDE, and of a 29-bit one the next three bits. */
static uint32_t filtered(uint32_t identifier)
{
    return identifier < CHIP_EXTENDED
               ? identifier << 5
               : (identifier >> 18 & 0x7FFU) << 5 | 1U << 3 | (identifier >> 15 & 7U);
}

/* 32.7.4. */
static bool is_accepted(chip_t *chip, uint32_t identifier)
{
    const uint32_t active = chip_get(chip, CHIP_CAN1_FA1R);
    for (uint32_t bank = 0; bank < BANKS; bank++) {
        if ((active >> bank & 1U) == 0) {
            continue;
        }
        if ((chip_get(chip, CHIP_CAN1_FM1R) >> bank & 1U) == 0 ||
            (chip_get(chip, CHIP_CAN1_FS1R) >> bank & 1U) != 0 ||
            (chip_get(chip, CHIP_CAN1_FFA1R) >> bank & 1U) != 0) {
            chip_note(chip, "CAN: filter bank %u is of a kind that is not modelled", bank);
            continue;
        }
        for (uint32_t entry = 0; entry < 4; entry++) {
            const uint32_t at = CHIP_CAN1_F0R1 + 8U * bank + 4U * (entry / 2U);
            const uint32_t wanted = chip_get(chip, at) >> 16U * (entry & 1U) & 0xFFFFU;
            if (wanted == filtered(identifier)) {
                return true;
            }
        }
    }
    return false;
}

void chip_can_received(chip_t *chip, const chip_frame_t *frame)
{
    chip_can_t *can = &chip->can;
    if (!is_on_bus(chip) || !is_accepted(chip, frame->identifier)) {
        return;
    }
    if (can->fifo_count == FIFO_FRAMES) {
        *chip_at(chip, CHIP_CAN1_RF0R) |= CHIP_CAN1_RF0R_FOVR0;
        can->fifo[FIFO_FRAMES - 1] = *frame; /* not locked: the newest replaces the last */
        return;
    }
    can->fifo[can->fifo_count] = *frame;
    can->fifo_count++;
}

static uint32_t fifo_word(const chip_t *chip, uint32_t address)
{
    if (chip->can.fifo_count == 0) {
        return 0;
    }
    const chip_frame_t *frame = &chip->can.fifo[0];
    uint32_t words[2];
    memcpy(words, frame->data, sizeof words);
    switch (address) {
    case CHIP_CAN1_RI0R:
        return frame->identifier < CHIP_EXTENDED ? frame->identifier << 21
                                                 : frame->identifier << 3 | CHIP_CAN1_RI0R_IDE;
    case CHIP_CAN1_RDT0R:
        return frame->length;
    case CHIP_CAN1_RDL0R:
        return words[0];
    default:
        return words[1];
    }
}

uint32_t chip_can_read(chip_t *chip, uint32_t address)
{
    const uint32_t value = chip_get(chip, address);
    const uint32_t control = chip_get(chip, CHIP_CAN1_MCR);
    switch (address) {
    case CHIP_CAN1_MSR:
        if ((control & CHIP_CAN1_MCR_INRQ) != 0) {
            return CHIP_CAN1_MSR_INAK;
        }
        if ((control & CHIP_CAN1_MCR_SLEEP) != 0) {
            return CHIP_CAN1_MSR_SLAK;
        }
        return is_on_bus(chip) ? 0 : CHIP_CAN1_MSR_INAK;
    case CHIP_CAN1_RF0R:
        return (value & CHIP_CAN1_RF0R_FOVR0) | chip->can.fifo_count;
    case CHIP_CAN1_RI0R:
    case CHIP_CAN1_RDT0R:
    case CHIP_CAN1_RDL0R:
    case CHIP_CAN1_RDH0R:
        return fifo_word(chip, address);
    default:
        return value;
    }
}

static void write_master_control(chip_t *chip, uint32_t value)
{
    const uint32_t before = chip_get(chip, CHIP_CAN1_MCR);
    *chip_at(chip, CHIP_CAN1_MCR) = value;
    if ((value & (CHIP_CAN1_MCR_INRQ | CHIP_CAN1_MCR_SLEEP)) != 0) {
        chip->can.joined = CHIP_NEVER;
    } else if ((before & CHIP_CAN1_MCR_INRQ) != 0) {
        chip->can.joined =
            timing_is_right(chip) ? chip->now + JOIN_BITS * CHIP_CAN_BIT_TICKS : CHIP_NEVER;
    }
}

static void request(chip_t *chip, unsigned mailbox)
{
    if ((chip_get(chip, CHIP_CAN1_TSR) & EMPTY[mailbox]) == 0) {
        chip_note(chip, "CAN: mailbox %u written while it is full", mailbox);
        return;
    }
    *chip_at(chip, CHIP_CAN1_TSR) &= ~(EMPTY[mailbox] | OUTCOME[mailbox]);
    chip_can_request(chip, mailbox);
}

/* A mailbox is empty again; 32.9.2, TSR. */
static void finish(chip_t *chip, unsigned mailbox, bool sent)
{
    chip_can_forget(chip, mailbox);
    *chip_at(chip, CHIP_CAN1_TSR) |= EMPTY[mailbox] | DONE[mailbox] | (sent ? SENT[mailbox] : 0);
}

/* RQCP is cleared by writing 1, and the outcome with it. An abort takes a pending mailbox at once;
 * one on the bus comes to its end (32.7.1). */
static void write_transmit_status(chip_t *chip, uint32_t value)
{
    for (unsigned mailbox = 0; mailbox < CHIP_MAILBOXES; mailbox++) {
        if ((value & DONE[mailbox]) != 0) {
            *chip_at(chip, CHIP_CAN1_TSR) &= ~OUTCOME[mailbox];
        }
        const bool pending = (chip_get(chip, CHIP_CAN1_TSR) & EMPTY[mailbox]) == 0;
        if ((value & ABORT[mailbox]) != 0 && pending && !chip_can_sends(chip, mailbox)) {
            finish(chip, mailbox, false);
        }
    }
}

bool chip_can_write(chip_t *chip, uint32_t address, uint32_t value)
{
    chip_can_t *can = &chip->can;
    const bool in_initialisation = (chip_get(chip, CHIP_CAN1_MCR) & CHIP_CAN1_MCR_INRQ) != 0;
    switch (address) {
    case CHIP_CAN1_MCR:
        write_master_control(chip, value);
        return true;
    case CHIP_CAN1_BTR:
        if (!in_initialisation) {
            chip_note(chip, "CAN: bit timing written outside of initialisation");
            return true;
        }
        return false;
    case CHIP_CAN1_TSR:
        write_transmit_status(chip, value);
        return true;
    case CHIP_CAN1_RF0R:
        *chip_at(chip, address) &= ~(value & CHIP_CAN1_RF0R_FOVR0);
        if ((value & CHIP_CAN1_RF0R_RFOM0) != 0 && can->fifo_count > 0) {
            can->fifo_count--;
            memmove(&can->fifo[0], &can->fifo[1], can->fifo_count * sizeof can->fifo[0]);
        }
        return true;
    case CHIP_CAN1_TI0R:
    case CHIP_CAN1_TI1R:
    case CHIP_CAN1_TI2R:
        *chip_at(chip, address) = value & ~1U;
        if ((value & 1U) != 0) {
            request(chip, (address - CHIP_CAN1_TI0R) / (CHIP_CAN1_TI1R - CHIP_CAN1_TI0R));
        }
        return true;
    default:
        if (address >= CHIP_CAN1_F0R1 && address <= CHIP_CAN1_F27R2) {
            const uint32_t bank = (address - CHIP_CAN1_F0R1) / 8U;
            if ((chip_get(chip, CHIP_CAN1_FA1R) >> bank & 1U) != 0) {
                chip_note(chip, "CAN: filter bank %u written while it is active", bank);
            }
        }
        return false;
    }
}

chip_frame_t chip_can_mailbox(const chip_t *chip, unsigned mailbox)
{
    const uint32_t at = MAILBOX[mailbox];
    const uint32_t word = chip_get(chip, at);
    const bool extended = (word & CHIP_CAN1_TI0R_IDE) != 0;
    chip_frame_t frame = {.identifier = extended ? word >> 3 | CHIP_EXTENDED : word >> 21,
                          .length = (uint8_t)(chip_get(chip, at + 4U) & 0xFU)};
    const uint32_t words[2] = {chip_get(chip, at + 8U), chip_get(chip, at + 12U)};
    memcpy(frame.data, words, sizeof words);
    return frame;
}

/* 32.7.1: in the order of the requests with TXFP, else the lowest identifier, of equal ones the
 * lowest mailbox. */
unsigned chip_can_offered(chip_t *chip)
{
    const chip_can_t *can = &chip->can;
    if (can->order_count == 0 || chip->fault.can_silent) {
        return CHIP_MAILBOXES;
    }
    unsigned first = can->order[0];
    for (unsigned i = 1;
         (chip_get(chip, CHIP_CAN1_MCR) & CHIP_CAN1_MCR_TXFP) == 0 && i < can->order_count; i++) {
        const unsigned mailbox = can->order[i];
        const uint32_t least = chip_can_arbitration(chip_can_mailbox(chip, first).identifier);
        const uint32_t own = chip_can_arbitration(chip_can_mailbox(chip, mailbox).identifier);
        if (own < least || (own == least && mailbox < first)) {
            first = mailbox;
        }
    }
    return first;
}

void chip_can_sent(chip_t *chip, unsigned mailbox)
{
    finish(chip, mailbox, true);
}
