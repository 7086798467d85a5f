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

static int32_t next(int32_t inside_mV, int32_t now_mA)
{
    foldback_state_t state = {.allowed_q6_mA = now_mA * 64};
    return foldback_step(&state, &LOW, inside_mV, now_mA);
}

void test_far_inside_all_is_allowed_within_half_a_second_and_one_width_beyond_nothing(void)
{
    foldback_state_t state = {.allowed_q6_mA = 0};
    for (int n = 0; n < 500; n++) {
        (void)foldback_step(&state, &LOW, 9000, 0);
    }
    TEST_ASSERT_EQUAL_INT32(62500, state.allowed_q6_mA / 64);
    TEST_ASSERT_EQUAL_INT32(0, foldback_step(&state, &LOW, -1168, 62500));
}

void test_on_the_line_the_current_stays(void)
{
    for (int32_t now_mA = 0; now_mA <= 62500; now_mA += 625) {
        const int32_t inside_mV = (int32_t)((int64_t)1168 * now_mA / 62500);
        TEST_ASSERT_INT32_WITHIN(6, now_mA, next(inside_mV, now_mA));
    }
}

void test_beside_the_line_it_moves_towards_it_without_crossing(void)
{
    for (int32_t inside_mV = -1000; inside_mV < 2336; inside_mV += 13) {
        for (int32_t now_mA = 0; now_mA <= 62500; now_mA += 1250) {
            const double on_line_mA = fmin(fmax(62500.0 * inside_mV / 1168.0, 0.0), 62500.0);
            TEST_ASSERT_TRUE(fabs(next(inside_mV, now_mA) - on_line_mA) <=
                             fabs(now_mA - on_line_mA) + 6.0);
        }
    }
}

void test_what_the_motor_is_asked_for_does_not_move_it(void)
{
    /* A bus that stays where it is, whatever is drawn from it: the line's current. */
    foldback_state_t state = {.allowed_q6_mA = 62500 * 64};
    for (int n = 0; n < 20000; n++) {
        (void)foldback_step(&state, &LOW, 584, 0);
    }
    TEST_ASSERT_INT32_WITHIN(200, 31250, state.allowed_q6_mA / 64);
}

/* A pack of any resistance behind it, torque that takes effect two steps later and no faster than
 * 0.6 A a step, a driver who wants all there is. No cycle: after a second and a half the current
 * stands still, on the line. */
void test_with_any_pack_the_current_comes_to_rest_on_the_line(void)
{
    for (double r_ohm = 0.02; r_ohm < 3.0; r_ohm *= 1.5) {
        double delayed_mA[3] = {0.0, 0.0, 0.0};
        int32_t command_mA = 0;
        foldback_state_t state = {.allowed_q6_mA = 0};
        double lowest_mA = 1e9;
        double highest_mA = 0.0;
        double volts = 53.0;
        for (int n = 0; n < 3000; n++) {
            volts = 53.0 - r_ohm * 4.0 * delayed_mA[0] * 1e-3;
            delayed_mA[0] = delayed_mA[1];
            delayed_mA[1] = delayed_mA[2];
            delayed_mA[2] = command_mA;
            const int32_t inside_mV = (int32_t)lround(1e3 * (volts - 40.0));
            const int32_t allowed_mA =
                foldback_step(&state, &LOW, inside_mV, (int32_t)delayed_mA[0]);
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

void test_without_a_current_to_share_there_is_none(void)
{
    const foldback_t none = {.most_mA = 0, .width_mV = 1168, .span_mV = 18400};
    const int32_t inside_mV[] = {1000, INT32_MAX, INT32_MIN};
    for (int k = 0; k < 3; k++) {
        foldback_state_t state = {.allowed_q6_mA = 64000};
        TEST_ASSERT_EQUAL_INT32(0, foldback_step(&state, &none, inside_mV[k], 1000));
    }
}
