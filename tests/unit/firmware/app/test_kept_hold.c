/* SPDX-License-Identifier: Apache-2.0 */
#include "app/kept_hold.h"

#include <string.h>

#include "random_values.h"
#include "unity.h"

static kept_hold_t kept;

void setUp(void)
{
    memset(&kept, 0xA5, sizeof kept);
}

void tearDown(void) {}

static void assert_read(drive_direction_t direction, bool leaves)
{
    const hill_hold_kept_t hold = kept_hold_read(&kept);
    TEST_ASSERT_EQUAL_INT(direction, hold.direction);
    TEST_ASSERT_EQUAL(leaves, hold.leaves);
}

static hill_hold_kept_t hold_of(drive_direction_t direction, bool leaves)
{
    const hill_hold_kept_t out = {.direction = direction, .leaves = leaves};
    return out;
}

void test_what_was_written_is_read_in_both_directions(void)
{
    for (int leaves = 0; leaves <= 1; leaves++) {
        kept_hold_write(&kept, hold_of(DRIVE_DIRECTION_FORWARD, leaves == 1));
        assert_read(DRIVE_DIRECTION_FORWARD, leaves == 1);
        kept_hold_follow(&kept, hold_of(DRIVE_DIRECTION_REVERSE, leaves == 1));
        assert_read(DRIVE_DIRECTION_REVERSE, leaves == 1);
    }
    kept_hold_follow(&kept, hold_of(DRIVE_DIRECTION_NEUTRAL, false));
    assert_read(DRIVE_DIRECTION_NEUTRAL, false);
}

/* The published check value of CRC-32 proves config_crc32() elsewhere; 96 bits at random pass it
 * with 2^-32 each. */
void test_memory_after_a_power_up_is_no_hold(void)
{
    assert_read(DRIVE_DIRECTION_NEUTRAL, false);
    memset(&kept, 0, sizeof kept);
    assert_read(DRIVE_DIRECTION_NEUTRAL, false);
    memset(&kept, 0xFF, sizeof kept);
    assert_read(DRIVE_DIRECTION_NEUTRAL, false);
    random_t random = random_seeded(1);
    for (int i = 0; i < 100000; i++) {
        kept.direction = (uint32_t)random_between(&random, 0, 2);
        kept.leaves = (uint32_t)random_between(&random, 0, 1);
        kept.crc32 = (uint32_t)random_between(&random, INT32_MIN, INT32_MAX);
        assert_read(DRIVE_DIRECTION_NEUTRAL, false);
    }
}

void test_a_flipped_bit_is_no_hold(void)
{
    for (size_t bit = 0; bit < 8U * sizeof kept; bit++) {
        kept_hold_write(&kept, hold_of(DRIVE_DIRECTION_FORWARD, false));
        unsigned char *bytes = (unsigned char *)&kept;
        bytes[bit / 8U] = (unsigned char)(bytes[bit / 8U] ^ 1U << bit % 8U);
        assert_read(DRIVE_DIRECTION_NEUTRAL, false);
    }
}
