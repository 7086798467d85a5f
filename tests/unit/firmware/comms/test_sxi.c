/* SPDX-License-Identifier: Apache-2.0 */
/* SxI frames: length, counter, packet, sum of the bytes before. */
#include <string.h>

#include "comms/sxi.h"
#include "unity.h"

static sxi_t sxi;

void setUp(void)
{
    memset(&sxi, 0xA5, sizeof sxi);
    sxi_init(&sxi, 0);
}

void tearDown(void) {}

/* All bytes at a time; the length of the last packet that was complete. */
static uint32_t receive(const uint8_t *bytes, uint32_t count, uint32_t now_ms)
{
    uint32_t length = 0;
    for (uint32_t i = 0; i < count; i++) {
        length = sxi_receive(&sxi, bytes[i], now_ms);
    }
    return length;
}

/* CONNECT in mode 0: 2 + 7 + 0xFF + 0 = 0x108. */
static const uint8_t CONNECT[] = {2, 7, 0xFF, 0, 0x08};

void test_a_frame_is_its_packet(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, receive(CONNECT, sizeof CONNECT - 1U, 10));
    TEST_ASSERT_EQUAL_UINT32(2, receive(&CONNECT[4], 1, 10));
    TEST_ASSERT_EQUAL_HEX8_ARRAY(&CONNECT[2], &sxi.frame[SXI_HEADER_BYTES], 2);
    TEST_ASSERT_EQUAL_UINT32(2, receive(CONNECT, sizeof CONNECT, 11)); /* the next at once */
}

void test_the_longest_packet_fits_and_a_longer_one_is_none(void)
{
    static const uint8_t LONGEST[] = {8, 0, 1, 2, 3, 4, 5, 6, 7, 8, 44};
    static const uint8_t LONGER[] = {9, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 54};
    TEST_ASSERT_EQUAL_UINT32(8, receive(LONGEST, sizeof LONGEST, 1));
    for (uint32_t i = 0; i < sizeof LONGER; i++) {
        TEST_ASSERT_EQUAL_UINT32(0, sxi_receive(&sxi, LONGER[i], 2));
    }
}

/* Nothing in the middle of a broken frame is taken for one; after a gap it begins anew. */
void test_after_a_broken_frame_all_is_left_out_until_the_line_was_silent(void)
{
    for (uint32_t at = 0; at < sizeof CONNECT; at++) {
        uint8_t broken[sizeof CONNECT];
        memcpy(broken, CONNECT, sizeof broken);
        broken[at] ^= 0x40;
        setUp();
        TEST_ASSERT_EQUAL_UINT32(0, receive(broken, sizeof broken, 1000));
        if (at > 0) { /* a wrong length waits for its bytes, or skips */
            TEST_ASSERT_EQUAL_UINT32(0, receive(CONNECT, sizeof CONNECT, 1000));
        }
        TEST_ASSERT_EQUAL_UINT32(0, receive(CONNECT, sizeof CONNECT, 1000 + SXI_GAP_ms - 1));
        TEST_ASSERT_EQUAL_UINT32(2, receive(CONNECT, sizeof CONNECT, 1000 + 2 * SXI_GAP_ms));
    }
}

void test_a_frame_that_stops_is_forgotten(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, receive(CONNECT, 3, 50));
    TEST_ASSERT_EQUAL_UINT32(2, receive(CONNECT, sizeof CONNECT, 50 + SXI_GAP_ms));
}

void test_answers_are_numbered_and_summed(void)
{
    static const uint8_t ANSWER[] = {0xFF, 0x80, 0x01};
    uint8_t frame[SXI_FRAME_BYTES];
    for (uint32_t k = 0; k < 300; k++) {
        TEST_ASSERT_EQUAL_UINT32(6, sxi_frame(&sxi, ANSWER, sizeof ANSWER, frame));
        const uint8_t expected[] = {3, (uint8_t)k, 0xFF, 0x80, 0x01, (uint8_t)(0x183 + k)};
        TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, frame, sizeof expected);
        TEST_ASSERT_EQUAL_UINT32(3, receive(frame, 6, k));
    }
}

void test_silence_is_two_seconds_without_a_byte(void)
{
    const uint32_t begun_ms = UINT32_MAX - 700U;
    sxi_init(&sxi, begun_ms);
    TEST_ASSERT_FALSE(sxi_is_silent(&sxi, begun_ms + 1999U));
    TEST_ASSERT_TRUE(sxi_is_silent(&sxi, begun_ms + 2000U));
    (void)sxi_receive(&sxi, 0, begun_ms + 1999U);
    TEST_ASSERT_FALSE(sxi_is_silent(&sxi, begun_ms + 3998U));
    TEST_ASSERT_TRUE(sxi_is_silent(&sxi, begun_ms + 3999U));
}

/* Any bytes: a packet only where its sum is right. */
void test_random_bytes_make_no_packet_without_its_sum(void)
{
    uint32_t state = 1;
    uint8_t last[SXI_FRAME_BYTES] = {0};
    uint32_t packets = 0, now_ms = 0;
    for (uint32_t k = 0; k < 1000000; k++) {
        state = state * 1664525U + 1013904223U;
        const uint8_t byte = (uint8_t)(state >> 27);
        memmove(last, &last[1], sizeof last - 1U);
        last[sizeof last - 1U] = byte;
        now_ms += (state >> 20 & 15U) == 0 ? SXI_GAP_ms : 0U;
        const uint32_t length = sxi_receive(&sxi, byte, now_ms);
        if (length > 0) {
            const uint8_t *frame = &last[sizeof last - length - SXI_HEADER_BYTES - 1U];
            uint32_t sum = 0;
            for (uint32_t i = 0; i < length + SXI_HEADER_BYTES; i++) {
                sum += frame[i];
            }
            TEST_ASSERT_EQUAL_UINT32(length, frame[0]);
            TEST_ASSERT_EQUAL_UINT8(sum, byte);
            packets++;
        }
    }
    TEST_ASSERT_GREATER_THAN_UINT32(20, packets);
}
