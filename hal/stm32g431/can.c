/* SPDX-License-Identifier: Apache-2.0 */
/*
 * FDCAN 1 as classic CAN at 500 kbit/s (RM0440 section 46) on the crystal's 8 MHz: 16 quanta a bit
 * = 1 + 13 + 2, sample point 88 %.
 */
#include "hal/can.h"

#include "board.h"
#include "can_places.h"
#include "registers/can.h"
#include "registers/rcc.h"
#include "wait.h"

enum {
    BIT_RATE = 500000,
    QUANTA_BEFORE_SAMPLE = 13, /* beside the one of synchronisation */
    QUANTA_AFTER_SAMPLE = 2,
    QUANTA = 1 + QUANTA_BEFORE_SAMPLE + QUANTA_AFTER_SAMPLE,
    PRESCALER = BOARD_CRYSTAL_Hz / QUANTA / BIT_RATE,
    LOOKS = 20000,    /* 1 ms: eleven bits are 22 us */
    ABORT_LOOKS = 20, /* a pending element is free in a few cycles, one on the bus later */
    IDENTIFIERS_MAX = 14,
    FILTER_TWO_IDENTIFIERS = 1, /* SFT (46.3.7) */
    FILTER_INTO_FIFO_0 = 1,     /* SFEC */
    REJECT = 2,                 /* ANFE, ANFS: what no filter takes */
    IDENTIFIER_Pos = 18,        /* in an element: bits 18 .. 28 are those of a standard frame */
    LENGTH_Pos = 16
};
_Static_assert(PRESCALER *QUANTA *BIT_RATE == BOARD_CRYSTAL_Hz, "the bit rate must be exact");
#define ELEMENT_EXTENDED (1U << 30)

static bool configured; /* filters and bit timing are in place */
static can_places_t places;

/* Off after too many errors the controller goes back into initialisation; left again, it waits for
 * the bus to be free for 129 times eleven bits (46.3.4). */
static bool is_on_bus(void)
{
    if (configured && (FDCAN1->CCCR & FDCAN1_CCCR_INIT) != 0) {
        FDCAN1->CCCR &= ~(uint32_t)FDCAN1_CCCR_INIT;
    }
    return configured && (FDCAN1->PSR & FDCAN1_PSR_ACT) != 0;
}

static void accept_only(const uint16_t *identifiers, uint32_t count)
{
    const uint32_t filters = (count + 1U) / 2U;
    for (uint32_t i = 0; i < filters; i++) {
        const uint32_t first = identifiers[2U * i];
        const uint32_t second = 2U * i + 1U < count ? identifiers[2U * i + 1U] : first;
        FDCAN1_MEMORY->standard_filter[i] = (uint32_t)FILTER_TWO_IDENTIFIERS << 30 |
                                            (uint32_t)FILTER_INTO_FIFO_0 << 27 | first << 16 |
                                            second;
    }
    FDCAN1->RXGFC = filters << FDCAN1_RXGFC_LSS_Pos | FDCAN1_RXGFC_RRFE | FDCAN1_RXGFC_RRFS |
                    (uint32_t)REJECT << FDCAN1_RXGFC_ANFE_Pos |
                    (uint32_t)REJECT << FDCAN1_RXGFC_ANFS_Pos;
}

bool can_init(const uint16_t *accepted_identifiers, uint32_t count)
{
    configured = false;
    if (count == 0 || count > IDENTIFIERS_MAX) {
        return false;
    }
    gpio_init();
    gpio_make_alternate(BOARD_CAN_RECEIVE, BOARD_AF_CAN, GPIO_PULL_UP);
    gpio_make_alternate(BOARD_CAN_TRANSMIT, BOARD_AF_CAN, GPIO_PULL_UP);
    RCC->CCIPR &= ~(uint32_t)RCC_CCIPR_FDCANSEL; /* the crystal */
    RCC->APB1ENR1 |= RCC_APB1ENR1_FDCANEN;
    (void)RCC->APB1ENR1;
    FDCAN1->CCCR = FDCAN1_CCCR_INIT;
    if (!wait_for(&FDCAN1->CCCR, FDCAN1_CCCR_INIT, FDCAN1_CCCR_INIT, LOOKS)) {
        return false;
    }
    FDCAN1->CCCR = FDCAN1_CCCR_INIT | FDCAN1_CCCR_CCE; /* classic frames: FDOE is 0 */
    FDCAN1->NBTP = (uint32_t)(PRESCALER - 1) << FDCAN1_NBTP_NBRP_Pos |
                   (uint32_t)(QUANTA_BEFORE_SAMPLE - 1) << FDCAN1_NBTP_NTSEG1_Pos |
                   (uint32_t)(QUANTA_AFTER_SAMPLE - 1) << FDCAN1_NBTP_NTSEG2_Pos |
                   (uint32_t)(QUANTA_AFTER_SAMPLE - 1) << FDCAN1_NBTP_NSJW_Pos;
    FDCAN1->TXBC = FDCAN1_TXBC_TFQM; /* three transmit elements, sent by their identifiers */
    const can_places_t empty = {.taken = {false}};
    places = empty;
    accept_only(accepted_identifiers, count);
    FDCAN1->CCCR &= ~(uint32_t)FDCAN1_CCCR_INIT; /* clears CCE as well */
    configured = true;
    bool joined = false;
    for (uint32_t looks = 0; looks < LOOKS && !joined; looks++) {
        joined = (FDCAN1->PSR & FDCAN1_PSR_ACT) != 0;
    }
    return joined;
}

bool can_receive(can_frame_t *frame)
{
    if (!is_on_bus() || (FDCAN1->RXF0S & FDCAN1_RXF0S_F0FL) == 0) {
        return false;
    }
    const uint32_t index = (FDCAN1->RXF0S & FDCAN1_RXF0S_F0GI) >> FDCAN1_RXF0S_F0GI_Pos;
    const fdcan_element_t *element = &FDCAN1_MEMORY->receive_0[index];
    const uint32_t length = element->length >> LENGTH_Pos & 0xFU;
    frame->identifier = element->identifier >> IDENTIFIER_Pos & 0x7FFU;
    frame->length =
        (uint8_t)(length > 8U ? 8U : length); /* 9 .. 15 on the wire also mean eight bytes */
    for (uint32_t i = 0; i < 8U; i++) {
        frame->data[i] =
            i < frame->length ? (uint8_t)(element->data[i / 4U] >> 8U * (i % 4U)) : (uint8_t)0;
    }
    FDCAN1->RXF0A = index;
    return true;
}

/* True if the frame in this element is cancelled. One that has left, or is leaving, is not. */
static bool is_given_up(uint32_t i)
{
    const uint32_t bit = 1U << i;
    if ((FDCAN1->TXBRP & bit) == 0) {
        return false;
    }
    FDCAN1->TXBCR = bit;
    return wait_for(&FDCAN1->TXBRP, bit, 0, ABORT_LOOKS) && (FDCAN1->TXBTO & bit) == 0;
}

/* The queue takes a frame at its put index only, the lowest free element (46.3.5). */
static bool is_next(uint32_t i)
{
    const uint32_t status = FDCAN1->TXFQS;
    return (status & FDCAN1_TXFQS_TFQF) == 0 &&
           (status & FDCAN1_TXFQS_TFQPI) >> FDCAN1_TXFQS_TFQPI_Pos == i;
}

bool can_transmit(const can_frame_t *frame)
{
    const uint32_t i = can_places_for(&places, frame->identifier);
    if (!is_on_bus() || i == CAN_PLACES || (places.taken[i] && !is_given_up(i)) || !is_next(i)) {
        return false;
    }
    fdcan_element_t *const element = &FDCAN1_MEMORY->transmit[i];
    element->identifier = frame->identifier < CAN_EXTENDED
                              ? frame->identifier << IDENTIFIER_Pos
                              : (frame->identifier & ~CAN_EXTENDED) | ELEMENT_EXTENDED;
    element->length = (uint32_t)frame->length << LENGTH_Pos;
    for (uint32_t k = 0; k < 2U; k++) {
        const uint8_t *d = &frame->data[4U * k];
        element->data[k] = d[0] | (uint32_t)d[1] << 8 | (uint32_t)d[2] << 16 | (uint32_t)d[3] << 24;
    }
    FDCAN1->TXBAR = 1U << i;
    can_places_take(&places, i, frame->identifier);
    return true;
}

can_progress_t can_progress(uint32_t identifier)
{
    const uint32_t i = can_places_of(&places, identifier);
    if (i == CAN_PLACES) {
        return CAN_ABORTED;
    }
    if ((FDCAN1->TXBRP >> i & 1U) != 0) {
        return CAN_PENDING;
    }
    places.taken[i] = false;
    return (FDCAN1->TXBTO >> i & 1U) != 0 ? CAN_SENT : CAN_ABORTED;
}

bool can_bus_off(void)
{
    (void)is_on_bus();
    return configured && (FDCAN1->PSR & FDCAN1_PSR_BO) != 0;
}
