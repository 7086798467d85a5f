/* SPDX-License-Identifier: Apache-2.0 */
#include "ring.h"
#include "unity.h"

static ring_t ring;

void setUp(void)
{
    const ring_t empty = {.written = 0};
    ring = empty;
}

void tearDown(void) {}

void test_ring_keeps_byte_order_over_many_wraps(void)
{
    uint8_t next_in = 0;
    uint8_t next_out = 0;
    for (int i = 0; i < 10000; i++) {
        for (int k = 0; k < 1 + i % 7; k++) {
            if (ring_put(&ring, next_in)) {
                next_in++;
            }
        }
        for (int k = 0; k < 1 + i % 5; k++) {
            uint8_t byte;
            if (ring_get(&ring, &byte)) {
                TEST_ASSERT_EQUAL_UINT8(next_out, byte);
                next_out++;
            }
        }
    }
}

void test_full_ring_refuses_and_empty_ring_returns_false(void)
{
    uint8_t byte = 0x77;
    TEST_ASSERT_FALSE(ring_get(&ring, &byte));
    for (int i = 0; i < RING_SIZE - 1; i++) {
        TEST_ASSERT_TRUE(ring_put(&ring, (uint8_t)i));
    }
    TEST_ASSERT_FALSE(ring_put(&ring, 0xEE));
    TEST_ASSERT_TRUE(ring_get(&ring, &byte));
    TEST_ASSERT_EQUAL_UINT8(0, byte);
    TEST_ASSERT_TRUE(ring_put(&ring, 0xEE));
}
