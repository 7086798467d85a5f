/* SPDX-License-Identifier: Apache-2.0 */
/*
 * bxCAN 1 at 500 kbit/s (RM0090 section 32): 42 MHz / 6 = 7 MHz, 14 quanta a bit = 1 + 11 + 2,
 * sample point 86 %.
 */
#include "hal/can.h"

#include "board.h"
#include "can_places.h"
#include "clock.h"
#include "registers/can.h"
#include "registers/rcc.h"
#include "wait.h"

enum {
    BIT_RATE = 500000,
    QUANTA_BEFORE_SAMPLE = 11, /* beside the one of synchronisation */
    QUANTA_AFTER_SAMPLE = 2,
    QUANTA = 1 + QUANTA_BEFORE_SAMPLE + QUANTA_AFTER_SAMPLE,
    PRESCALER = CLOCK_CORE_Hz / CLOCK_APB1_DIVIDER / QUANTA / BIT_RATE,
    LOOKS = 20000, /* 0.6 .. 2.4 ms: entering and leaving initialisation takes a frame and eleven
                      bits, 0.3 ms */
    START_MOST_ms = 3,
    ABORT_LOOKS = 20, /* a pending mailbox is empty in a few cycles, one on the bus later */
    IDENTIFIERS_PER_BANK = 4,
    BANKS_USED = 4,
    IDENTIFIERS_MAX = 14
};
_Static_assert(PRESCALER *QUANTA *BIT_RATE == CLOCK_CORE_Hz / CLOCK_APB1_DIVIDER,
               "the bit rate must be exact");
_Static_assert(IDENTIFIERS_MAX <= BANKS_USED * IDENTIFIERS_PER_BANK, "filter banks");

/* On a bus that is held dominant the last wait runs out, and the watchdog, which resets after 17 ms
 * at the earliest, has been started before and is not fed until the control steps have run for 5
 * ms. */
_Static_assert(LOOKS *WAIT_POLL_CYCLES_MOST <= CLOCK_CORE_Hz / 1000 * START_MOST_ms,
               "no restart because of the bus");

static bool configured; /* filters and bit timing are in place */
static can_places_t places;

/* The controller joins by itself when it has seen the bus free for eleven bits, however late that
 * is (32.4.2). */
static bool is_on_bus(void)
{
    return configured && (CAN1->MSR & CAN_MSR_INAK) == 0;
}

/* One entry of a bank in 16-bit list mode (32.7.4): identifier in bits 5 .. 15, data frame,
 * standard identifier. */
static uint32_t filter_entry(const uint16_t *identifiers, uint32_t count, uint32_t index)
{
    return (uint32_t)identifiers[index < count ? index : count - 1U]
           << 5; /* spare entries repeat the last one */
}

static void accept_only(const uint16_t *identifiers, uint32_t count)
{
    const uint32_t banks = (1U << BANKS_USED) - 1U;
    CAN1->FMR |= CAN_FMR_FINIT;
    CAN1->FA1R = 0;
    CAN1->FM1R |= banks;             /* list of identifiers */
    CAN1->FS1R &= ~(uint32_t)banks;  /* 16 bits each */
    CAN1->FFA1R &= ~(uint32_t)banks; /* into FIFO 0 */
    for (uint32_t bank = 0; bank < BANKS_USED; bank++) {
        const uint32_t first = bank * IDENTIFIERS_PER_BANK;
        CAN1->filter[bank].FR1 = filter_entry(identifiers, count, first) |
                                 filter_entry(identifiers, count, first + 1U) << 16;
        CAN1->filter[bank].FR2 = filter_entry(identifiers, count, first + 2U) |
                                 filter_entry(identifiers, count, first + 3U) << 16;
    }
    CAN1->FA1R = banks;
    CAN1->FMR &= ~(uint32_t)CAN_FMR_FINIT;
}

bool can_init(const uint16_t *accepted_identifiers, uint32_t count)
{
    configured = false;
    if (count == 0 || count > IDENTIFIERS_MAX) {
        return false;
    }
    gpio_init();
    gpio_make_alternate(BOARD_CAN_RECEIVE, BOARD_AF_CAN1, GPIO_PULL_UP);
    gpio_make_alternate(BOARD_CAN_TRANSMIT, BOARD_AF_CAN1, GPIO_PULL_UP);
    RCC->APB1ENR |= RCC_APB1ENR_CAN1EN;
    (void)RCC->APB1ENR;
    CAN1->MCR = CAN_MCR_INRQ; /* and out of sleep */
    if (!wait_for(&CAN1->MSR, CAN_MSR_INAK | CAN_MSR_SLAK, CAN_MSR_INAK, LOOKS)) {
        return false;
    }
    /* Back on the bus by itself after bus-off; without TXFP frames leave by their identifiers. */
    CAN1->MCR = CAN_MCR_INRQ | CAN_MCR_ABOM;
    const can_places_t empty = {.taken = {false}};
    places = empty;
    CAN1->BTR = ((uint32_t)(PRESCALER - 1) << CAN_BTR_BRP_Pos) |
                ((uint32_t)(QUANTA_BEFORE_SAMPLE - 1) << CAN_BTR_TS1_Pos) |
                ((uint32_t)(QUANTA_AFTER_SAMPLE - 1)
                 << CAN_BTR_TS2_Pos); /* resynchronisation by one quantum */
    accept_only(accepted_identifiers, count);
    CAN1->MCR &= ~(uint32_t)CAN_MCR_INRQ;
    configured = true;
    return wait_for(&CAN1->MSR, CAN_MSR_INAK, 0, LOOKS);
}

static uint8_t byte_of(uint32_t low, uint32_t high, uint32_t index)
{
    return (uint8_t)((index < 4U ? low : high) >> 8U * (index & 3U));
}

bool can_receive(can_frame_t *frame)
{
    if (!is_on_bus() || (CAN1->RF0R & CAN_RF0R_FMP0) == 0) {
        return false;
    }
    const can_receive_mailbox_t *mailbox = &CAN1->receive[0];
    const uint32_t low = mailbox->RDLR;
    const uint32_t high = mailbox->RDHR;
    const uint32_t length = mailbox->RDTR & CAN_RDTR_DLC;
    frame->identifier = mailbox->RIR >> CAN_RIR_STID_Pos;
    frame->length =
        (uint8_t)(length > 8U ? 8U : length); /* 9 .. 15 on the wire also mean eight bytes */
    for (uint32_t i = 0; i < 8U; i++) {
        frame->data[i] = i < frame->length ? byte_of(low, high, i) : 0;
    }
    CAN1->RF0R = CAN_RF0R_RFOM0;
    (void)wait_for(&CAN1->RF0R, CAN_RF0R_RFOM0, 0,
                   LOOKS); /* a few cycles, until the next frame is in the mailbox */
    return true;
}

/* The flags of mailbox i (32.9.2). */
static bool is_empty(uint32_t i)
{
    return (CAN1->TSR & CAN_TSR_TME0 << i) != 0;
}

static bool has_left(uint32_t i)
{
    return (CAN1->TSR & CAN_TSR_TXOK0 << 8U * i) != 0;
}

/* True if the frame in this mailbox is aborted. One that has left, or is leaving, is not. */
static bool is_given_up(uint32_t i)
{
    if (is_empty(i)) {
        return false;
    }
    CAN1->TSR = CAN_TSR_ABRQ0 << 8U * i;
    const uint32_t empty = CAN_TSR_TME0 << i;
    return wait_for(&CAN1->TSR, empty, empty, ABORT_LOOKS) && !has_left(i);
}

bool can_transmit(const can_frame_t *frame)
{
    const uint32_t i = can_places_for(&places, frame->identifier);
    if (!is_on_bus() || i == CAN_PLACES || (places.taken[i] && !is_given_up(i))) {
        return false;
    }
    const uint8_t *d = frame->data;
    can_transmit_mailbox_t *const mailbox = &CAN1->transmit[i];
    mailbox->TDTR = frame->length;
    mailbox->TDLR = d[0] | (uint32_t)d[1] << 8 | (uint32_t)d[2] << 16 | (uint32_t)d[3] << 24;
    mailbox->TDHR = d[4] | (uint32_t)d[5] << 8 | (uint32_t)d[6] << 16 | (uint32_t)d[7] << 24;
    mailbox->TIR =
        (frame->identifier < CAN_EXTENDED ? frame->identifier << CAN_TIR_STID_Pos
                                          : frame->identifier << CAN_TIR_EXID_Pos | CAN_TIR_IDE) |
        CAN_TIR_TXRQ;
    can_places_take(&places, i, frame->identifier);
    return true;
}

can_progress_t can_progress(uint32_t identifier)
{
    const uint32_t i = can_places_of(&places, identifier);
    if (i == CAN_PLACES) {
        return CAN_ABORTED;
    }
    if (!is_empty(i)) {
        return CAN_PENDING;
    }
    places.taken[i] = false;
    return has_left(i) ? CAN_SENT : CAN_ABORTED;
}

bool can_bus_off(void)
{
    return configured && (CAN1->ESR & CAN_ESR_BOFF) != 0;
}
