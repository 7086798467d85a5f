/* SPDX-License-Identifier: Apache-2.0 */
/* A motor's share of the pack's currents, and the pack's current of a share. */
#include "config/pack_share.h"

#include "unity.h"

static config_battery_t battery;

void setUp(void)
{
    battery = (config_battery_t){.driven_wheels = 4};
}

void tearDown(void) {}

void test_alike_motors_have_equal_shares(void)
{
    TEST_ASSERT_EQUAL_INT32(50000, pack_share_mA(&battery, 200000));
    TEST_ASSERT_EQUAL_INT32(200000, pack_share_whole_mA(&battery, 50000));
    battery.driven_wheels = 3;
    TEST_ASSERT_EQUAL_INT32(66666, pack_share_mA(&battery, 200000));
}

/* 3/8 of 200 A are 75 A, exactly; the largest current does not overflow. */
void test_a_share_of_its_own_counts_instead(void)
{
    battery.pack_share_q15 = 12288;
    TEST_ASSERT_EQUAL_INT32(75000, pack_share_mA(&battery, 200000));
    TEST_ASSERT_EQUAL_INT32(200000, pack_share_whole_mA(&battery, 75000));
    TEST_ASSERT_EQUAL_INT32(805306367, pack_share_mA(&battery, INT32_MAX));
    battery.pack_share_q15 = 32768;
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, pack_share_mA(&battery, INT32_MAX));
    battery.pack_share_q15 = 1;
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, pack_share_whole_mA(&battery, 2000000));
}

/* Two thirds of a pack for two motors in front, a third for two at the rear, each share rounded
 * down. */
void test_motors_whose_shares_make_one_never_take_more_than_the_pack_allows(void)
{
    const config_battery_t front = {.driven_wheels = 4, .pack_share_q15 = 10922};
    const config_battery_t rear = {.driven_wheels = 4, .pack_share_q15 = 5461};
    for (int32_t pack_mA = 0; pack_mA <= 2000000; pack_mA += 777) {
        const int32_t all_mA =
            2 * pack_share_mA(&front, pack_mA) + 2 * pack_share_mA(&rear, pack_mA);
        TEST_ASSERT_TRUE(all_mA <= pack_mA);
        TEST_ASSERT_INT32_WITHIN(4 + pack_mA / 10000, pack_mA, all_mA);
    }
}
