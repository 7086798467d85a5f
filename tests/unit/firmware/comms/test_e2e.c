/* SPDX-License-Identifier: Apache-2.0 */
/* End-to-end protection: errors that the CRC of profile 2 detects, and the receiver's states. Those
 * of profile 5: test_e2e_profile_5.c. test_frames.py compares both with another implementation. */
#include <string.h>

#include "comms/e2e.h"
#include "unity.h"

enum { BITS = 64, IDENTIFIER = 0x123, TIMEOUT_ms = 50 };

static e2e_receiver_t receiver;

void setUp(void)
{
    memset(&receiver, 0xA5, sizeof receiver); /* uninitialised fields are visible */
    e2e_receiver_init(&receiver, E2E_PROFILE_2, TIMEOUT_ms);
}

void tearDown(void) {}

/* ---- errors that the CRC detects ---- */

/* Bits in the order in which CAN sends them: byte 0 first, the highest bit of a byte first. */
static void flip(uint8_t *data, uint32_t bit)
{
    data[bit / 8U] = (uint8_t)(data[bit / 8U] ^ (0x80U >> bit % 8U));
}

static void assert_found(const uint8_t *data)
{
    TEST_ASSERT_FALSE(e2e_intact(E2E_PROFILE_2, data, IDENTIFIER));
}

static void begin(uint8_t *data, uint8_t counter)
{
    static const uint8_t CONTENT[E2E_FRAME_BYTES] = {0, 0x50, 0x39, 0x30, 0xFF, 0x00, 0xA5, 0x01};
    memcpy(data, CONTENT, sizeof CONTENT);
    e2e_protect(E2E_PROFILE_2, data, IDENTIFIER, counter);
}

void test_protected_frame_passes_the_check_with_its_content(void)
{
    for (uint8_t counter = 0; counter < 16; counter++) {
        uint8_t data[E2E_FRAME_BYTES];
        begin(data, counter);
        TEST_ASSERT_TRUE(e2e_intact(E2E_PROFILE_2, data, IDENTIFIER));
        TEST_ASSERT_EQUAL_HEX8(0x50 | counter, data[1]);
        TEST_ASSERT_EQUAL_HEX8(0x39, data[2]);
        TEST_ASSERT_EQUAL_HEX8(0x01, data[7]);
    }
}

void test_low_four_bits_of_the_counter_are_sent(void)
{
    uint8_t data[E2E_FRAME_BYTES];
    begin(data, 0xF3);
    TEST_ASSERT_EQUAL_HEX8(0x53, data[1]);
}

/* 64 + 2 016 + 41 664 patterns, including those that change the counter and so the data id. */
void test_crc_detects_every_one_two_or_three_bit_errors(void)
{
    uint8_t data[E2E_FRAME_BYTES];
    begin(data, 6);
    for (uint32_t a = 0; a < BITS; a++) {
        flip(data, a);
        assert_found(data);
        for (uint32_t b = a + 1; b < BITS; b++) {
            flip(data, b);
            assert_found(data);
            for (uint32_t c = b + 1; c < BITS; c++) {
                flip(data, c);
                assert_found(data);
                flip(data, c);
            }
            flip(data, b);
        }
        flip(data, a);
    }
    TEST_ASSERT_TRUE(e2e_intact(E2E_PROFILE_2, data, IDENTIFIER));
}

void test_crc_detects_every_odd_number_of_bit_errors(void)
{
    uint32_t random = 1;
    for (int i = 0; i < 100000; i++) {
        uint8_t data[E2E_FRAME_BYTES];
        begin(data, (uint8_t)(i & 15));
        uint8_t wrong[E2E_FRAME_BYTES];
        uint32_t ones = 0;
        for (uint32_t k = 0; k < E2E_FRAME_BYTES; k++) {
            random = random * 1664525U + 1013904223U; /* Numerical Recipes' generator */
            wrong[k] = (uint8_t)(random >> 24);
            ones += (uint32_t)__builtin_popcount(wrong[k]);
        }
        wrong[0] = (uint8_t)(wrong[0] ^ (ones % 2U == 0 ? 1U : 0U));
        for (uint32_t k = 0; k < E2E_FRAME_BYTES; k++) {
            data[k] ^= wrong[k];
        }
        assert_found(data);
    }
}

void test_crc_detects_every_burst_of_up_to_eight_bits(void)
{
    for (uint32_t first = 0; first < BITS; first++) {
        for (uint32_t pattern = 1; pattern < 256; pattern += 2) {
            uint8_t data[E2E_FRAME_BYTES];
            begin(data, 9);
            for (uint32_t i = 0; i < 8 && first + i < BITS; i++) {
                if (((pattern >> i) & 1U) != 0) {
                    flip(data, first + i);
                }
            }
            assert_found(data);
        }
    }
}

void test_frame_with_another_low_byte_of_the_identifier_is_refused(void)
{
    for (uint8_t counter = 0; counter < 16; counter++) {
        uint8_t data[E2E_FRAME_BYTES];
        begin(data, counter);
        for (uint16_t other = 0; other < 0x800; other++) {
            TEST_ASSERT_EQUAL((other & 0xFF) == (IDENTIFIER & 0xFF),
                              e2e_intact(E2E_PROFILE_2, data, other));
        }
    }
}

void test_frames_of_only_zeros_or_ones_are_refused(void)
{
    uint8_t data[E2E_FRAME_BYTES];
    memset(data, 0, sizeof data);
    assert_found(data);
    memset(data, 0xFF, sizeof data);
    assert_found(data);
}

/* ---- the receiver ---- */

static e2e_status_t receive(uint8_t counter, uint32_t now_ms)
{
    uint8_t data[E2E_FRAME_BYTES];
    begin(data, counter);
    return e2e_receive(&receiver, data, IDENTIFIER, true, now_ms);
}

/* Counters 0, 1, 2 at 0, 10, 20 ms: the last one qualifies the sender. */
static void qualify(void)
{
    (void)receive(0, 0);
    (void)receive(1, 10);
    TEST_ASSERT_EQUAL_INT(E2E_OK, receive(2, 20));
}

void test_sender_is_qualified_by_its_third_frame_in_order(void)
{
    TEST_ASSERT_EQUAL_INT(E2E_NO_DATA, receiver.link);
    TEST_ASSERT_EQUAL_INT(E2E_NOT_QUALIFIED, receive(9, 0));
    TEST_ASSERT_EQUAL_INT(E2E_QUALIFYING, receiver.link);
    TEST_ASSERT_EQUAL_INT(E2E_NOT_QUALIFIED, receive(10, 10));
    TEST_ASSERT_EQUAL_INT(E2E_OK, receive(11, 20));
    TEST_ASSERT_EQUAL_INT(E2E_VALID, receiver.link);
    TEST_ASSERT_EQUAL_UINT32(1, receiver.counts.used);
}

void test_counter_wraps_from_fifteen_to_zero(void)
{
    qualify();
    for (uint32_t i = 3; i < 100; i++) {
        TEST_ASSERT_EQUAL_INT(E2E_OK, receive((uint8_t)(i & 15U), 10 * i));
    }
    TEST_ASSERT_EQUAL_UINT32(0, e2e_errors(&receiver.counts));
    TEST_ASSERT_EQUAL_UINT32(0, receiver.counts.lost);
}

/* Each of the sixteen counter steps (e2e.h): 0 repeated, 1 in order, 2 and 3 lost, others wrong
 * sequence. */
void test_every_step_of_the_counter_has_its_status(void)
{
    for (uint32_t step = 0; step < 16; step++) {
        setUp();
        qualify();
        const e2e_status_t status = receive((uint8_t)((2U + step) & 15U), 30);
        const e2e_status_t expected = step == 0   ? E2E_REPEATED
                                      : step == 1 ? E2E_OK
                                      : step <= 3 ? E2E_SOME_LOST
                                                  : E2E_WRONG_SEQUENCE;
        TEST_ASSERT_EQUAL_INT(expected, status);
        TEST_ASSERT_EQUAL_UINT32(expected == E2E_SOME_LOST ? step - 1U : 0U, receiver.counts.lost);
        TEST_ASSERT_EQUAL_INT(expected == E2E_WRONG_SEQUENCE ? E2E_QUALIFYING : E2E_VALID,
                              receiver.link);
    }
}

void test_sender_requalifies_after_a_jump_with_two_frames_in_order(void)
{
    qualify();
    TEST_ASSERT_EQUAL_INT(E2E_WRONG_SEQUENCE, receive(8, 30));
    TEST_ASSERT_EQUAL_INT(E2E_NOT_QUALIFIED, receive(9, 40));
    TEST_ASSERT_EQUAL_INT(E2E_OK, receive(10, 50));
    TEST_ASSERT_EQUAL_UINT32(1, receiver.counts.wrong_sequence);
}

void test_repeated_frame_does_not_break_the_sequence(void)
{
    qualify();
    TEST_ASSERT_EQUAL_INT(E2E_REPEATED, receive(2, 30));
    TEST_ASSERT_EQUAL_INT(E2E_REPEATED, receive(2, 35));
    TEST_ASSERT_EQUAL_UINT32(20, receiver.refreshed_ms);
    TEST_ASSERT_EQUAL_INT(E2E_OK, receive(3, 40));
    TEST_ASSERT_EQUAL_UINT32(2, receiver.counts.repeated);
}

void test_damaged_frame_counts_as_damaged_and_as_lost(void)
{
    qualify();
    uint8_t data[E2E_FRAME_BYTES];
    begin(data, 3);
    data[5] ^= 0x10;
    TEST_ASSERT_EQUAL_INT(E2E_DAMAGED, e2e_receive(&receiver, data, IDENTIFIER, true, 30));
    TEST_ASSERT_EQUAL_UINT32(20, receiver.refreshed_ms);
    TEST_ASSERT_EQUAL_INT(E2E_SOME_LOST, receive(4, 40));
    TEST_ASSERT_EQUAL_UINT32(1, receiver.counts.damaged);
    TEST_ASSERT_EQUAL_UINT32(1, receiver.counts.lost);
}

void test_implausible_frame_counts_as_lost_and_the_crc_is_checked_first(void)
{
    qualify();
    uint8_t data[E2E_FRAME_BYTES];
    begin(data, 3);
    TEST_ASSERT_EQUAL_INT(E2E_IMPLAUSIBLE, e2e_receive(&receiver, data, IDENTIFIER, false, 30));
    TEST_ASSERT_EQUAL_UINT8(2, receiver.counter);
    data[0] ^= 1;
    TEST_ASSERT_EQUAL_INT(E2E_DAMAGED, e2e_receive(&receiver, data, IDENTIFIER, false, 30));
    TEST_ASSERT_EQUAL_UINT32(1, receiver.counts.implausible);
    TEST_ASSERT_EQUAL_UINT32(1, receiver.counts.damaged);
}

void test_missing_frames_time_out_once_at_the_timeout(void)
{
    TEST_ASSERT_FALSE(e2e_timed_out(&receiver, 1000)); /* who has never spoken cannot fall silent */
    qualify();
    TEST_ASSERT_FALSE(e2e_timed_out(&receiver, 20 + TIMEOUT_ms - 1));
    TEST_ASSERT_TRUE(e2e_timed_out(&receiver, 20 + TIMEOUT_ms));
    TEST_ASSERT_FALSE(e2e_timed_out(&receiver, 20 + TIMEOUT_ms + 1));
    TEST_ASSERT_EQUAL_INT(E2E_TIMED_OUT, receiver.link);
    TEST_ASSERT_EQUAL_UINT32(1, receiver.counts.timeouts);
}

void test_frame_after_the_timeout_is_not_used(void)
{
    qualify();
    TEST_ASSERT_EQUAL_INT(E2E_NOT_QUALIFIED, receive(3, 20 + TIMEOUT_ms));
    TEST_ASSERT_EQUAL_INT(E2E_QUALIFYING, receiver.link);
    TEST_ASSERT_EQUAL_INT(E2E_NOT_QUALIFIED, receive(4, 30 + TIMEOUT_ms));
    TEST_ASSERT_EQUAL_INT(E2E_OK, receive(5, 40 + TIMEOUT_ms));
}

void test_sender_with_a_stuck_counter_times_out_and_does_not_requalify(void)
{
    qualify();
    bool timed_out = false;
    for (uint32_t ms = 30; ms < 2000; ms += 10) {
        timed_out = e2e_timed_out(&receiver, ms) || timed_out;
        const e2e_status_t status = receive(2, ms);
        TEST_ASSERT_TRUE(status == E2E_REPEATED || status == E2E_NOT_QUALIFIED);
    }
    TEST_ASSERT_TRUE(timed_out);
    TEST_ASSERT_EQUAL_UINT32(1, receiver.counts.used);
}

/* Two frames in order and a jump, repeated: never three in order, so no frame is used and the
 * timeout is reported. */
void test_sender_with_repeated_jumps_times_out(void)
{
    qualify();
    bool timed_out = false;
    uint8_t counter = 2;
    for (uint32_t ms = 30; ms < 2000; ms += 10) {
        counter = (uint8_t)(counter + (ms % 20U == 10U ? 5U : 1U));
        timed_out = e2e_timed_out(&receiver, ms) || timed_out;
        (void)receive(counter & 15U, ms);
    }
    TEST_ASSERT_TRUE(timed_out);
    TEST_ASSERT_EQUAL_UINT32(1, receiver.counts.used);
}

void test_timeout_is_correct_over_a_wrap_of_the_clock(void)
{
    const uint32_t start_ms = UINT32_MAX - 14U;
    (void)receive(0, start_ms);
    (void)receive(1, start_ms + 10U);
    TEST_ASSERT_EQUAL_INT(E2E_OK, receive(2, start_ms + 20U));
    TEST_ASSERT_FALSE(e2e_timed_out(&receiver, start_ms + 20U + TIMEOUT_ms - 1U));
    TEST_ASSERT_TRUE(e2e_timed_out(&receiver, start_ms + 20U + TIMEOUT_ms));
}

void test_error_count_is_the_sum_of_all_errors(void)
{
    const e2e_counts_t counts = {.used = 1000,
                                 .lost = 500,
                                 .repeated = 1,
                                 .wrong_sequence = 20,
                                 .implausible = 300,
                                 .damaged = 4000,
                                 .timeouts = 50000};
    TEST_ASSERT_EQUAL_UINT32(54321, e2e_errors(&counts));
}

void test_every_state_has_a_name(void)
{
    TEST_ASSERT_EQUAL_STRING("NO_DATA", e2e_link_text(E2E_NO_DATA));
    TEST_ASSERT_EQUAL_STRING("QUALIFYING", e2e_link_text(E2E_QUALIFYING));
    TEST_ASSERT_EQUAL_STRING("VALID", e2e_link_text(E2E_VALID));
    TEST_ASSERT_EQUAL_STRING("TIMED_OUT", e2e_link_text(E2E_TIMED_OUT));
    TEST_ASSERT_EQUAL_STRING("unknown", e2e_link_text((e2e_link_t)4));
}
