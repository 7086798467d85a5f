/* SPDX-License-Identifier: Apache-2.0 */
/* Fold-back of the current near an end of the battery's voltage: the steady-state line, and its
 * stability with any pack resistance. */
#include "torque/foldback.h"

#include <math.h>

#include "core/scaled.h"
#include "unity.h"

/* The paper's vehicle, one motor of four: 62.5 A times four wheels in 12 milliohm are 3 V. */
static const foldback_t LOW = {
    .most_mA = 62500, .width_mV = 1168, .span_mV = 18400, .rise_mV = 3000};

void setUp(void) {}

void tearDown(void) {}

/* The current after one step at this voltage, from a state that allows now_mA. */
static int32_t next(int32_t inside_mV, int32_t now_mA)
{
    foldback_state_t state = {.allowed_q24 = (int32_t)(16777216.0 * now_mA / 62500.0)};
    return foldback_step(&state, &LOW, inside_mV, now_mA);
}

void test_limit_opens_in_half_a_second_and_is_zero_one_width_outside(void)
{
    foldback_state_t state = {.allowed_q24 = 0};
    int32_t allowed_mA = 0;
    for (int n = 0; n < 500; n++) {
        allowed_mA = foldback_step(&state, &LOW, 9000, 0);
    }
    TEST_ASSERT_EQUAL_INT32(62500, allowed_mA);
    TEST_ASSERT_EQUAL_INT32(0, foldback_step(&state, &LOW, -1168, 62500));
}

void test_limit_is_constant_on_the_steady_state_line(void)
{
    for (int32_t now_mA = 0; now_mA <= 62500; now_mA += 625) {
        const int32_t inside_mV = (int32_t)((int64_t)1168 * now_mA / 62500);
        TEST_ASSERT_INT32_WITHIN(6, now_mA, next(inside_mV, now_mA));
    }
}

void test_limit_approaches_the_steady_state_line_without_overshoot(void)
{
    for (int32_t inside_mV = -1000; inside_mV < 2336; inside_mV += 13) {
        for (int32_t now_mA = 0; now_mA <= 62500; now_mA += 1250) {
            const double on_line_mA = fmin(fmax(62500.0 * inside_mV / 1168.0, 0.0), 62500.0);
            TEST_ASSERT_TRUE(fabs(next(inside_mV, now_mA) - on_line_mA) <=
                             fabs(now_mA - on_line_mA) + 6.0);
        }
    }
}

/* Steady-state limit with a pack of r times the resistance that is counted, open-circuit voltage
 * open_mV inside the end, at a constant current of this motor. */
static int32_t settled_mA(double r, int32_t open_mV, int32_t flowing_mA)
{
    foldback_state_t state = {.allowed_q24 = 1 << 24};
    const double moved_mV = r * 3000.0 * flowing_mA / 62500.0;
    int32_t allowed_mA = 0;
    for (int n = 0; n < 20000; n++) {
        allowed_mA = foldback_step(&state, &LOW, open_mV - (int32_t)lround(moved_mV), flowing_mA);
    }
    return allowed_mA;
}

/* 62.5 A of 1.168 V and 3 V: whatever the motor draws, returns or leaves. */
void test_steady_state_limit_is_independent_of_the_motor_current(void)
{
    const int32_t expected_mA = (int32_t)(62500.0 * 2000.0 / 4168.0);
    for (int32_t flowing_mA = -60000; flowing_mA <= expected_mA; flowing_mA += 5000) {
        TEST_ASSERT_INT32_WITHIN(300, expected_mA, settled_mA(1.0, 2000, flowing_mA));
    }
    TEST_ASSERT_EQUAL_INT32(62500, settled_mA(1.0, 4300, 0));
    TEST_ASSERT_INT32_WITHIN(60, 0, settled_mA(1.0, 0, 0));
}

/* A demand rises to more than the pack takes: lowest limit before it is reached, and how far the
 * voltage goes beyond its place on the line. The pack has r times the resistance that is counted.
 */
typedef struct {
    double lowest_mA, settled_mA, beyond_mV;
} onset_t;

static onset_t onset(double r, double open_mV, double per_step_mA)
{
    foldback_state_t state = {.allowed_q24 = 1 << 24};
    for (int n = 0; n < 3000; n++) { /* the vehicle rolls */
        foldback_step(&state, &LOW, (int32_t)lround(open_mV), 0);
    }
    onset_t out = {.lowest_mA = 1e9};
    const double at_end_mA = open_mV / (1168.0 + r * 3000.0) * 62500.0;
    double delayed_mA[3] = {0.0, 0.0, 0.0};
    for (int n = 0; n < 4000; n++) {
        const double inside_mV = open_mV - r * 3000.0 * delayed_mA[0] / 62500.0;
        const double limit_mA =
            foldback_step(&state, &LOW, (int32_t)lround(inside_mV), (int32_t)lround(delayed_mA[0]));
        out.lowest_mA = n < 1000 ? fmin(out.lowest_mA, limit_mA) : out.lowest_mA;
        out.beyond_mV = fmax(out.beyond_mV, 1168.0 * at_end_mA / 62500.0 - inside_mV);
        delayed_mA[0] = delayed_mA[1];
        delayed_mA[1] = delayed_mA[2];
        delayed_mA[2] = fmin(fmin(delayed_mA[2] + per_step_mA, limit_mA), 62500.0);
        out.settled_mA = delayed_mA[0];
    }
    return out;
}

void test_limit_is_where_the_current_settles_before_any_flows(void)
{
    for (double open_mV = 200.0; open_mV < 4000.0; open_mV += 200.0) {
        const double expected_mA = 62500.0 * open_mV / 4168.0;
        for (double per_step_mA = 50.0; per_step_mA < 1e5; per_step_mA *= 10.0) {
            const onset_t found = onset(1.0, open_mV, per_step_mA);
            TEST_ASSERT_DOUBLE_WITHIN(0.02 * expected_mA + 100.0, expected_mA, found.lowest_mA);
            TEST_ASSERT_DOUBLE_WITHIN(0.02 * expected_mA + 100.0, expected_mA, found.settled_mA);
            TEST_ASSERT_TRUE(found.beyond_mV < 40.0);
        }
    }
}

/* A vehicle that rolls near the end: before the next stop begins the limit is where its current
 * will settle, however little that is. Half a second is from the whole limit down. */
void test_limit_that_is_not_in_use_settles_in_half_a_second(void)
{
    for (int32_t open_mV = 0; open_mV < 4000; open_mV += 50) {
        foldback_state_t state = {.allowed_q24 = 1 << 24};
        int32_t allowed_mA = 0;
        for (int n = 0; n < 500; n++) {
            allowed_mA = foldback_step(&state, &LOW, open_mV, 0);
        }
        TEST_ASSERT_INT32_WITHIN(100, (int32_t)(62500.0 * open_mV / 4168.0), allowed_mA);
    }
}

/* Cold or aged, or warm: the limit is wrong for a moment, and a third of a volt in fifty beyond the
 * line at most; it settles on the same line. */
void test_a_wrong_resistance_costs_a_moment(void)
{
    for (double r = 0.3; r < 2.1; r *= 1.2) {
        for (double open_mV = 200.0; open_mV < 4000.0; open_mV += 200.0) {
            const double expected_mA = fmin(62500.0 * open_mV / (1168.0 + r * 3000.0), 62500.0);
            const onset_t found = onset(r, open_mV, 500.0);
            TEST_ASSERT_DOUBLE_WITHIN(0.02 * expected_mA + 150.0, expected_mA, found.settled_mA);
            TEST_ASSERT_TRUE(found.lowest_mA > 0.4 * expected_mA);
            TEST_ASSERT_TRUE(found.beyond_mV < 0.5 * open_mV + 40.0);
        }
    }
}

/* Driving lowers the voltage; the moment it ends there is the whole open-circuit voltage again. */
void test_a_current_the_other_way_opens_no_limit(void)
{
    foldback_state_t state = {.allowed_q24 = 0};
    int32_t allowed_mA = 0;
    for (int n = 0; n < 5000; n++) {
        allowed_mA = foldback_step(&state, &LOW, 1000 + 6000, -125000);
    }
    TEST_ASSERT_INT32_WITHIN(300, (int32_t)(62500.0 * 1000.0 / 4168.0), allowed_mA);
}

/* A pack of any resistance, a current that follows two steps later and by at most 0.6 A a step, a
 * demand above the limit. No limit cycle: after two seconds the current is constant and on the
 * line.
 */
void test_current_settles_on_the_line_for_any_pack_resistance(void)
{
    for (double r_ohm = 0.02; r_ohm < 3.0; r_ohm *= 1.5) {
        double delayed_mA[3] = {0.0, 0.0, 0.0};
        int32_t command_mA = 0;
        foldback_state_t state = {.allowed_q24 = 0};
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
        /* 53 V - 4 R i = 40 V + 1.168 V i / 62.5 A, at most 62.5 A. */
        const double on_line_mA = fmin(13e3 / (4.0 * r_ohm + 1.168 / 62.5), 62500.0);
        TEST_ASSERT_TRUE(highest_mA - lowest_mA <= 5.0);
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * on_line_mA + 40.0, on_line_mA, highest_mA);
    }
}

void test_limit_is_zero_for_a_largest_current_of_zero(void)
{
    const foldback_t none = {.most_mA = 0, .width_mV = 1168, .span_mV = 18400, .rise_mV = 0};
    const int32_t inside_mV[] = {1000, INT32_MAX, INT32_MIN};
    for (int k = 0; k < 3; k++) {
        foldback_state_t state = {.allowed_q24 = 1 << 20};
        TEST_ASSERT_EQUAL_INT32(0, foldback_step(&state, &none, inside_mV[k], 1000));
    }
}

/* ---- one step ---- */

enum { STEPS = 8 };
static const double ONE = 16777216.0;

/* Eight widths of 40 mV times 0.2997 and a 64th are 100.9 mV, the span in whole millivolts. The
 * line is at 11 mV. */
void test_from_the_span_on_the_gain_is_that_of_a_limit_in_use(void)
{
    const foldback_t f = {.most_mA = 64000, .width_mV = 40, .span_mV = 100, .rise_mV = 0};
    foldback_state_t state = {.allowed_q24 = (int32_t)(0.2997 * ONE)};
    foldback_step(&state, &f, 0, 0);
    const double expected = 0.2997 - (0.2997 + 1.0 / 64.0) * 11.0 / 100.0 / STEPS;
    TEST_ASSERT_DOUBLE_WITHIN(4.0 / ONE, expected, state.allowed_q24 / ONE);
}

/* A current the other way is none: exactly a 64th is left to fall from. Error 3 of 32 V. */
void test_the_limit_drops_to_a_64th_where_the_current_flows_the_other_way(void)
{
    const foldback_t f = {.most_mA = 64000, .width_mV = 4096, .span_mV = 65536, .rise_mV = 0};
    for (int32_t flowing_mA = -64000; flowing_mA <= 0; flowing_mA += 32000) {
        foldback_state_t state = {.allowed_q24 = SCALED_ONE / 2};
        foldback_step(&state, &f, -1024, flowing_mA);
        TEST_ASSERT_EQUAL_INT32((SCALED_ONE / 64) - 3 * (SCALED_ONE / 32) / 8, state.allowed_q24);
    }
}

void test_a_line_without_width_lets_no_current_outside_the_end(void)
{
    const foldback_t f = {.most_mA = 64000, .width_mV = 0, .span_mV = 60000, .rise_mV = 0};
    foldback_state_t state = {.allowed_q24 = SCALED_ONE};
    TEST_ASSERT_EQUAL_INT32(64000, foldback_step(&state, &f, 1, 0));
    TEST_ASSERT_EQUAL_INT32(0, foldback_step(&state, &f, -1, 0));
    TEST_ASSERT_EQUAL_INT32(0, state.allowed_q24);
}
