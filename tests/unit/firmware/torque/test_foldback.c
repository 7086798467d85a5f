/* SPDX-License-Identifier: Apache-2.0 */
/* Near the ends of the battery's voltage: the line in the steady state, and a calm way to it with
 * any pack. */
#include "torque/foldback.h"

#include <math.h>

#include "unity.h"

/* The paper's vehicle, one motor of four. */
static const foldback_t LOW = {.most_mA = 62500, .width_mV = 1168, .span_mV = 18400};

void setUp(void) {}

void tearDown(void) {}

void test_two_widths_inside_there_is_no_limit_and_one_width_beyond_there_is_nothing(void)
{
    TEST_ASSERT_EQUAL_INT32(62500, foldback_current_mA(&LOW, false, 2336, 0));
    TEST_ASSERT_EQUAL_INT32(0, foldback_current_mA(&LOW, true, -1168, 62500));
}

void test_on_the_line_the_current_stays(void)
{
    for (int32_t now_mA = 0; now_mA <= 62500; now_mA += 625) {
        const int32_t inside_mV = (int32_t)((int64_t)1168 * now_mA / 62500);
        TEST_ASSERT_INT32_WITHIN(1, now_mA, foldback_current_mA(&LOW, true, inside_mV, now_mA));
    }
}

void test_beside_the_line_it_moves_towards_it_without_crossing(void)
{
    for (int32_t inside_mV = -1000; inside_mV < 2336; inside_mV += 13) {
        for (int32_t now_mA = 0; now_mA <= 62500; now_mA += 1250) {
            const double on_line_mA = fmin(fmax(62500.0 * inside_mV / 1168.0, 0.0), 62500.0);
            const int32_t next_mA = foldback_current_mA(&LOW, true, inside_mV, now_mA);
            TEST_ASSERT_TRUE(fabs(next_mA - on_line_mA) <= fabs(now_mA - on_line_mA) + 1.0);
        }
    }
}

/* A pack of any resistance behind it, torque that takes effect two steps later and no faster than
 * 0.6 A a step, a driver who wants all there is. No cycle: after a second and a half the current
 * stands still, on the line. */
void test_with_any_pack_the_current_comes_to_rest_on_the_line(void)
{
    for (double r_ohm = 0.02; r_ohm < 3.0; r_ohm *= 1.5) {
        double delayed_mA[3] = {0.0, 0.0, 0.0};
        int32_t command_mA = 0;
        uint16_t near_steps = 0;
        double lowest_mA = 1e9;
        double highest_mA = 0.0;
        double volts = 53.0;
        for (int n = 0; n < 3000; n++) {
            volts = 53.0 - r_ohm * 4.0 * delayed_mA[0] * 1e-3;
            delayed_mA[0] = delayed_mA[1];
            delayed_mA[1] = delayed_mA[2];
            delayed_mA[2] = command_mA;
            const int32_t inside_mV = (int32_t)lround(1e3 * (volts - 40.0));
            const bool near = foldback_near(&near_steps, inside_mV, LOW.width_mV);
            const int32_t allowed_mA = foldback_current_mA(&LOW, near, inside_mV, command_mA);
            command_mA += allowed_mA > command_mA + 600
                              ? 600
                              : (allowed_mA < command_mA - 600 ? -600 : allowed_mA - command_mA);
            if (n >= 2000) {
                lowest_mA = fmin(lowest_mA, command_mA);
                highest_mA = fmax(highest_mA, command_mA);
            }
        }
        /* 53 V - 4 R i = 40 V + 1.168 V i / 62.5 A, if that is less than all. */
        const double on_line_mA = fmin(13e3 / (4.0 * r_ohm + 1.168 / 62.5), 62500.0);
        TEST_ASSERT_TRUE(highest_mA - lowest_mA <= 5.0);
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * on_line_mA + 40.0, on_line_mA, highest_mA);
    }
}

void test_near_lasts_half_a_second(void)
{
    uint16_t steps = 0;
    TEST_ASSERT_FALSE(foldback_near(&steps, 2336, 1168));
    TEST_ASSERT_TRUE(foldback_near(&steps, 2335, 1168));
    for (int n = 1; n < FOLDBACK_NEAR_STEPS; n++) {
        TEST_ASSERT_TRUE(foldback_near(&steps, 10000, 1168));
    }
    TEST_ASSERT_FALSE(foldback_near(&steps, 10000, 1168));
}

void test_without_a_current_to_share_there_is_none(void)
{
    const foldback_t none = {.most_mA = 0, .width_mV = 1168, .span_mV = 18400};
    TEST_ASSERT_EQUAL_INT32(0, foldback_current_mA(&none, true, 1000, 1000));
    TEST_ASSERT_EQUAL_INT32(0, foldback_current_mA(&none, true, INT32_MAX, INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(0, foldback_current_mA(&none, true, INT32_MIN, INT32_MIN));
}
