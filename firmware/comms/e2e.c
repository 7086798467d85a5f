/* SPDX-License-Identifier: Apache-2.0 */
#include "comms/e2e.h"

enum { POLYNOMIAL = 0x2F, CRC_INITIAL = 0xFF, CRC_FINAL = 0xFF };

/*
 * The list of data ids. It is linear over exclusive-or (entry [a ^ b] = entry [a] ^ entry [b]) and
 * every entry has an even number of bits, so the code stays a linear one in which, as in the CRC
 * alone, words differ in an even number of places; 0x90, 0xAA, 0xC0 and 0x60 at 1, 2, 4 and 8 were
 * found by search to leave no two equal syndromes (distance 4) and no burst of eight or fewer
 * undetected.
 */
static const uint8_t DATA_ID[E2E_COUNTER_MASK + 1] = {
    0x00, 0x90, 0xAA, 0x3A, 0xC0, 0x50, 0x6A, 0xFA, 0x60, 0xF0, 0xCA, 0x5A, 0xA0, 0x30, 0x0A, 0x9A};

static uint8_t crc8_add(uint8_t crc, uint8_t byte)
{
    uint32_t value = (uint32_t)crc ^ byte;
    for (int bit = 0; bit < 8; bit++) {
        value = (value << 1) ^ ((value & 0x80U) != 0 ? (uint32_t)POLYNOMIAL : 0U);
    }
    return (uint8_t)(value & 0xFFU);
}

static uint8_t crc_of(const uint8_t data[E2E_FRAME_BYTES], uint16_t identifier)
{
    uint8_t crc = CRC_INITIAL;
    for (uint32_t i = 1; i < E2E_FRAME_BYTES; i++) {
        crc = crc8_add(crc, data[i]);
    }
    const uint32_t data_id = DATA_ID[data[1] & E2E_COUNTER_MASK] ^ (identifier & 0xFFU);
    return (uint8_t)(crc8_add(crc, (uint8_t)data_id) ^ CRC_FINAL);
}

void e2e_protect(uint8_t data[E2E_FRAME_BYTES], uint16_t identifier, uint8_t counter)
{
    data[1] =
        (uint8_t)((data[1] & ~(uint32_t)E2E_COUNTER_MASK) | (counter & (uint32_t)E2E_COUNTER_MASK));
    data[0] = crc_of(data, identifier);
}

bool e2e_intact(const uint8_t data[E2E_FRAME_BYTES], uint16_t identifier)
{
    return data[0] == crc_of(data, identifier);
}

void e2e_receiver_init(e2e_receiver_t *receiver, uint32_t timeout_ms)
{
    const e2e_receiver_t zero = {.link = E2E_NO_DATA};
    *receiver = zero;
    receiver->timeout_ms = timeout_ms;
}

static bool started(const e2e_receiver_t *receiver)
{
    return receiver->link == E2E_QUALIFYING || receiver->link == E2E_VALID;
}

bool e2e_timed_out(e2e_receiver_t *receiver, uint32_t now_ms)
{
    if (!started(receiver) || now_ms - receiver->refreshed_ms < receiver->timeout_ms) {
        return false;
    }
    receiver->link = E2E_TIMED_OUT;
    receiver->counts.timeouts++;
    return true;
}

static void begin(e2e_receiver_t *receiver, uint8_t counter)
{
    receiver->link = E2E_QUALIFYING;
    receiver->counter = counter;
    receiver->in_order = 1;
}

static e2e_status_t continues(e2e_receiver_t *receiver, uint32_t step, uint32_t now_ms)
{
    receiver->counter = (uint8_t)((receiver->counter + step) & E2E_COUNTER_MASK);
    receiver->counts.lost += step - 1U;
    if (receiver->link == E2E_QUALIFYING) {
        receiver->in_order++;
        if (receiver->in_order < E2E_QUALIFYING_FRAMES) {
            return E2E_NOT_QUALIFIED;
        }
        receiver->link = E2E_VALID;
    }
    receiver->refreshed_ms = now_ms;
    receiver->counts.used++;
    return step == 1U ? E2E_OK : E2E_SOME_LOST;
}

e2e_status_t e2e_receive(e2e_receiver_t *receiver, const uint8_t data[E2E_FRAME_BYTES],
                         uint16_t identifier, bool plausible, uint32_t now_ms)
{
    (void)e2e_timed_out(receiver, now_ms);
    if (!e2e_intact(data, identifier)) {
        receiver->counts.damaged++;
        return E2E_DAMAGED;
    }
    if (!plausible) {
        receiver->counts.implausible++;
        return E2E_IMPLAUSIBLE;
    }
    const uint8_t counter = data[1] & E2E_COUNTER_MASK;
    if (!started(receiver)) {
        begin(receiver, counter);
        receiver->refreshed_ms = now_ms;
        return E2E_NOT_QUALIFIED;
    }
    const uint32_t step = ((uint32_t)counter - receiver->counter) & E2E_COUNTER_MASK;
    if (step == 0) {
        receiver->counts.repeated++;
        return E2E_REPEATED;
    }
    if (step > E2E_STEP_MAX) {
        /* refreshed_ms is not changed, so a sender whose counter always jumps times out. */
        begin(receiver, counter);
        receiver->counts.wrong_sequence++;
        return E2E_WRONG_SEQUENCE;
    }
    return continues(receiver, step, now_ms);
}

uint32_t e2e_errors(const e2e_counts_t *counts)
{
    return counts->repeated + counts->wrong_sequence + counts->implausible + counts->damaged +
           counts->timeouts;
}

const char *e2e_link_text(e2e_link_t link)
{
    switch (link) {
    case E2E_NO_DATA:
        return "NO_DATA";
    case E2E_QUALIFYING:
        return "QUALIFYING";
    case E2E_VALID:
        return "VALID";
    case E2E_TIMED_OUT:
        return "TIMED_OUT";
    }
    return "unknown";
}
