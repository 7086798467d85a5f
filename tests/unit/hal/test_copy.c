/* SPDX-License-Identifier: Apache-2.0 */
#include "copy.h"

#include <stdint.h>

#include "unity.h"

enum { SPAN = 40, BEFORE = 8, MOST = 24, UNTOUCHED = 0xA5 };

static union {
    uint32_t words[SPAN / 4];
    uint8_t bytes[SPAN];
} source, destination;

void setUp(void)
{
    for (unsigned i = 0; i < SPAN; i++) {
        source.bytes[i] = (uint8_t)(17U * i + 3U);
        destination.bytes[i] = UNTOUCHED;
    }
}

void tearDown(void) {}

void test_copies_every_length_from_every_place_to_every_place(void)
{
    for (unsigned to = 0; to < 4; to++) {
        for (unsigned from = 0; from < 4; from++) {
            for (unsigned size = 0; size <= MOST; size++) {
                setUp();
                uint8_t *begin = &destination.bytes[BEFORE + to];
                TEST_ASSERT_EQUAL_PTR(begin, copy_bytes(begin, &source.bytes[from], size));
                for (unsigned i = 0; i < SPAN; i++) {
                    const int inside = i >= BEFORE + to && i < BEFORE + to + size;
                    const uint8_t copied = source.bytes[inside ? i - BEFORE - to + from : 0U];
                    TEST_ASSERT_EQUAL_HEX8(inside ? copied : UNTOUCHED, destination.bytes[i]);
                }
            }
        }
    }
}

void test_fills_every_length_at_every_place_with_eight_bits(void)
{
    for (unsigned to = 0; to < 4; to++) {
        for (unsigned size = 0; size <= MOST; size++) {
            setUp();
            uint8_t *begin = &destination.bytes[BEFORE + to];
            TEST_ASSERT_EQUAL_PTR(begin, fill_bytes(begin, 0x1C3, size));
            for (unsigned i = 0; i < SPAN; i++) {
                const int inside = i >= BEFORE + to && i < BEFORE + to + size;
                TEST_ASSERT_EQUAL_HEX8(inside ? 0xC3 : UNTOUCHED, destination.bytes[i]);
            }
        }
    }
}
