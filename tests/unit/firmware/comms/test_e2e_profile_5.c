/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Profile 5 of eight bytes: which errors its CRC detects, and which the counter. The code is
 * linear, so one content stands for all: an error is undetected by the CRC if and only if its own
 * syndrome is zero. test_the_code_is_linear shows that for random contents.
 */
#include <string.h>

#include "comms/e2e.h"
#include "random_values.h"
#include "unity.h"

enum { BITS = 64, IDENTIFIER = 0x123, COUNTERS = 256, BURST = 16 };

void setUp(void) {}

void tearDown(void) {}

/* Bits in the order in which CAN sends them: byte 0 first, the highest bit of a byte first. */
static void flip(uint8_t *data, uint32_t bit)
{
    data[bit / 8U] = (uint8_t)(data[bit / 8U] ^ (0x80U >> bit % 8U));
}

/* What an error does to the check: the difference between the CRC it carries and the one it needs.
 * From the function under test alone: the one 16-bit change of bytes 0 and 1 that mends it. */
static uint32_t syndrome(const uint8_t error[E2E_FRAME_BYTES])
{
    uint8_t sound[E2E_FRAME_BYTES] = {0, 0, 0, 0x50, 0x39, 0x30, 0xFF, 0xA5};
    e2e_protect(E2E_PROFILE_5, sound, IDENTIFIER, 77);
    uint8_t changed[E2E_FRAME_BYTES];
    for (int k = 0; k < E2E_FRAME_BYTES; k++) {
        changed[k] = sound[k] ^ error[k];
    }
    const uint32_t carried = changed[0] | (uint32_t)changed[1] << 8;
    e2e_protect(E2E_PROFILE_5, changed, IDENTIFIER, changed[2]);
    return carried ^ (changed[0] | (uint32_t)changed[1] << 8);
}

static uint32_t syndromes[BITS];

static void find_syndromes(void)
{
    for (uint32_t bit = 0; bit < BITS; bit++) {
        uint8_t error[E2E_FRAME_BYTES] = {0};
        flip(error, bit);
        syndromes[bit] = syndrome(error);
    }
}

void test_the_code_is_linear(void)
{
    find_syndromes();
    random_t random = random_seeded(5);
    for (int k = 0; k < 20000; k++) {
        uint8_t error[E2E_FRAME_BYTES];
        uint8_t data[E2E_FRAME_BYTES];
        uint32_t sum = 0;
        for (uint32_t i = 0; i < E2E_FRAME_BYTES; i++) {
            error[i] = (uint8_t)random_u64(&random);
            data[i] = (uint8_t)random_u64(&random);
        }
        for (uint32_t bit = 0; bit < BITS; bit++) {
            sum ^= (error[bit / 8] & (0x80U >> bit % 8)) != 0 ? syndromes[bit] : 0U;
        }
        const uint16_t identifier = (uint16_t)(random_u64(&random) % 0x800U);
        e2e_protect(E2E_PROFILE_5, data, identifier, data[2]);
        TEST_ASSERT_TRUE(e2e_intact(E2E_PROFILE_5, data, identifier));
        for (uint32_t i = 0; i < E2E_FRAME_BYTES; i++) {
            data[i] ^= error[i];
        }
        TEST_ASSERT_EQUAL(sum == 0, e2e_intact(E2E_PROFILE_5, data, identifier));
    }
}

void test_every_one_two_or_three_bit_errors_are_detected(void)
{
    find_syndromes();
    for (uint32_t a = 0; a < BITS; a++) {
        TEST_ASSERT_TRUE(syndromes[a] != 0);
        for (uint32_t b = a + 1; b < BITS; b++) {
            TEST_ASSERT_TRUE(syndromes[a] != syndromes[b]);
            for (uint32_t c = b + 1; c < BITS; c++) {
                TEST_ASSERT_TRUE((syndromes[a] ^ syndromes[b]) != syndromes[c]);
            }
        }
    }
}

/* Steps of the counter that a qualified receiver accepts, for each counter before and an error. */
static int accepted_counters(uint8_t error)
{
    int accepted = 0;
    for (uint32_t sent = 0; sent < COUNTERS; sent++) {
        e2e_receiver_t receiver;
        e2e_receiver_init(&receiver, E2E_PROFILE_5, 50);
        uint8_t data[E2E_FRAME_BYTES] = {0};
        e2e_status_t status = E2E_DAMAGED;
        for (uint32_t k = 0; k <= 3; k++) {
            const uint32_t own = sent + k - 3U;
            e2e_protect(E2E_PROFILE_5, data, IDENTIFIER,
                        (uint8_t)(k == 3 ? (own & 0xFFU) ^ error : own));
            status = e2e_receive(&receiver, data, IDENTIFIER, true, 10U * k);
        }
        accepted += status == E2E_OK || status == E2E_SOME_LOST ? 1 : 0;
    }
    return accepted;
}

/* All 49 * 32 768 of 16 bits and all shorter ones. The CRC misses six, all of 16 bits and across
 * the border of CRC and counter; the counter after them is one that no receiver accepts. */
void test_every_burst_of_up_to_sixteen_bits_is_detected_by_crc_or_counter(void)
{
    find_syndromes();
    int missed = 0;
    for (uint32_t first = 0; first < BITS; first++) {
        for (uint32_t pattern = 1; pattern < 1U << BURST; pattern += 2) {
            uint32_t sum = 0;
            uint8_t error[E2E_FRAME_BYTES] = {0};
            bool inside = true;
            for (uint32_t i = 0; i < BURST && inside; i++) {
                if ((pattern >> i & 1U) != 0) {
                    inside = first + i < BITS;
                    sum ^= inside ? syndromes[first + i] : 0U;
                }
            }
            if (!inside || sum != 0) {
                continue;
            }
            for (uint32_t i = 0; i < BURST; i++) {
                if ((pattern >> i & 1U) != 0) {
                    flip(error, first + i);
                }
            }
            TEST_ASSERT_TRUE_MESSAGE(pattern >> (BURST - 1) == 1, "of fewer than 16 bits");
            TEST_ASSERT_EQUAL_INT(0, accepted_counters(error[2]));
            missed++;
        }
    }
    TEST_ASSERT_EQUAL_INT(6, missed);
    TEST_ASSERT_EQUAL_INT(256, accepted_counters(0)); /* without an error every one is accepted */
}

void test_every_other_identifier_is_refused(void)
{
    uint8_t data[E2E_FRAME_BYTES] = {0, 0, 0, 1, 2, 3, 4, 5};
    e2e_protect(E2E_PROFILE_5, data, IDENTIFIER, 200);
    TEST_ASSERT_EQUAL_UINT8(200, e2e_counter(E2E_PROFILE_5, data));
    for (uint32_t other = 0; other < 0x10000; other++) {
        TEST_ASSERT_EQUAL(other == IDENTIFIER, e2e_intact(E2E_PROFILE_5, data, (uint16_t)other));
    }
}

void test_frames_of_only_zeros_or_ones_are_refused(void)
{
    uint8_t data[E2E_FRAME_BYTES];
    memset(data, 0, sizeof data);
    TEST_ASSERT_FALSE(e2e_intact(E2E_PROFILE_5, data, IDENTIFIER));
    memset(data, 0xFF, sizeof data);
    TEST_ASSERT_FALSE(e2e_intact(E2E_PROFILE_5, data, IDENTIFIER));
}

void test_counter_wraps_after_255_and_a_frame_of_256_cycles_ago_is_not_seen_as_new(void)
{
    e2e_receiver_t receiver;
    e2e_receiver_init(&receiver, E2E_PROFILE_5, 50);
    uint8_t data[E2E_FRAME_BYTES] = {0};
    for (uint32_t k = 0; k < 1000; k++) {
        e2e_protect(E2E_PROFILE_5, data, IDENTIFIER, (uint8_t)k);
        const e2e_status_t status = e2e_receive(&receiver, data, IDENTIFIER, true, 10U * k);
        TEST_ASSERT_EQUAL_INT(k < 2 ? E2E_NOT_QUALIFIED : E2E_OK, status);
    }
    for (uint32_t back = 1; back < COUNTERS; back++) { /* a single frame, replayed */
        e2e_receiver_t copy = receiver;
        e2e_protect(E2E_PROFILE_5, data, IDENTIFIER, (uint8_t)(999U - back));
        const e2e_status_t status = e2e_receive(&copy, data, IDENTIFIER, true, 10000);
        TEST_ASSERT_EQUAL(back >= COUNTERS - E2E_STEP_MAX,
                          status == E2E_OK || status == E2E_SOME_LOST);
    }
}
