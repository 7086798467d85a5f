/* SPDX-License-Identifier: Apache-2.0 */
#include "comms/e2e.h"

#include "comms/generated/protection.h"

static const uint8_t DATA_ID[PROTECTION_P2_COUNTER_MASK + 1] = PROTECTION_P2_DATA_IDS;

/* One byte more of a CRC of 8 or 16 bits, the highest bit first. */
static uint32_t crc_add(uint32_t crc, uint32_t byte, uint32_t polynomial, uint32_t bits)
{
    uint32_t value = crc ^ (byte << (bits - 8U));
    for (int bit = 0; bit < 8; bit++) {
        const bool leaves = (value >> (bits - 1U) & 1U) != 0;
        value = (value << 1) ^ (leaves ? polynomial : 0U);
    }
    return value & ((UINT32_C(1) << bits) - 1U);
}

static uint32_t crc8_of(const uint8_t data[E2E_FRAME_BYTES], uint32_t identifier)
{
    uint32_t crc = PROTECTION_P2_INITIAL;
    for (uint32_t i = 1; i < E2E_FRAME_BYTES; i++) {
        crc = crc_add(crc, data[i], PROTECTION_P2_POLYNOMIAL, 8);
    }
    const uint32_t data_id = DATA_ID[data[1] & PROTECTION_P2_COUNTER_MASK] ^ (identifier & 0xFFU);
    return crc_add(crc, data_id, PROTECTION_P2_POLYNOMIAL, 8) ^ PROTECTION_P2_FINAL;
}

static uint32_t crc16_of(const uint8_t data[E2E_FRAME_BYTES], uint32_t identifier)
{
    uint32_t crc = PROTECTION_P5_INITIAL;
    for (uint32_t i = 2; i < E2E_FRAME_BYTES; i++) {
        crc = crc_add(crc, data[i], PROTECTION_P5_POLYNOMIAL, 16);
    }
    const uint32_t data_id = PROTECTION_P5_DATA_ID ^ identifier;
    crc = crc_add(crc, data_id & 0xFFU, PROTECTION_P5_POLYNOMIAL, 16);
    return crc_add(crc, data_id >> 8 & 0xFFU, PROTECTION_P5_POLYNOMIAL, 16);
}

void e2e_protect(e2e_profile_t profile, uint8_t data[E2E_FRAME_BYTES], uint16_t identifier,
                 uint8_t counter)
{
    if (profile == E2E_PROFILE_5) {
        data[2] = counter;
        const uint32_t crc = crc16_of(data, identifier);
        data[0] = (uint8_t)(crc & 0xFFU);
        data[1] = (uint8_t)(crc >> 8);
        return;
    }
    const uint32_t mask = PROTECTION_P2_COUNTER_MASK;
    data[1] = (uint8_t)((data[1] & ~mask) | (counter & mask));
    data[0] = (uint8_t)crc8_of(data, identifier);
}

bool e2e_intact(e2e_profile_t profile, const uint8_t data[E2E_FRAME_BYTES], uint16_t identifier)
{
    if (profile == E2E_PROFILE_5) {
        return ((uint32_t)data[0] | (uint32_t)data[1] << 8) == crc16_of(data, identifier);
    }
    return data[0] == crc8_of(data, identifier);
}

uint8_t e2e_counter(e2e_profile_t profile, const uint8_t data[E2E_FRAME_BYTES])
{
    return profile == E2E_PROFILE_5 ? data[2] : (uint8_t)(data[1] & PROTECTION_P2_COUNTER_MASK);
}

static uint32_t counter_mask(e2e_profile_t profile)
{
    return profile == E2E_PROFILE_5 ? PROTECTION_P5_COUNTER_MASK : PROTECTION_P2_COUNTER_MASK;
}

void e2e_receiver_init(e2e_receiver_t *receiver, e2e_profile_t profile, uint32_t timeout_ms)
{
    const e2e_receiver_t zero = {.link = E2E_NO_DATA};
    *receiver = zero;
    receiver->profile = profile;
    receiver->timeout_ms = timeout_ms;
    receiver->step_max = E2E_STEP_MAX;
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
    receiver->counter = (uint8_t)((receiver->counter + step) & counter_mask(receiver->profile));
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
    if (!e2e_intact(receiver->profile, data, identifier)) {
        receiver->counts.damaged++;
        return E2E_DAMAGED;
    }
    if (!plausible) {
        receiver->counts.implausible++;
        return E2E_IMPLAUSIBLE;
    }
    const uint8_t counter = e2e_counter(receiver->profile, data);
    if (!started(receiver)) {
        begin(receiver, counter);
        receiver->refreshed_ms = now_ms;
        return E2E_NOT_QUALIFIED;
    }
    const uint32_t step = ((uint32_t)counter - receiver->counter) & counter_mask(receiver->profile);
    if (step == 0) {
        receiver->counts.repeated++;
        return E2E_REPEATED;
    }
    if (step > receiver->step_max) {
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
