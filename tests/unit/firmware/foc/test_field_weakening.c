/* SPDX-License-Identifier: Apache-2.0 */
/* Field weakening: i_d falls above the voltage limit, returns to zero below it, and stays within
 * its limit. */
#include "field_weakening.h"
#include "paper_vehicle.h"
#include "unity.h"

static config_t config;

void setUp(void)
{
    config = paper_vehicle();
}

void tearDown(void) {}

/* With the voltage before its limit. */
static void step(field_weakening_t *state, int32_t d, int32_t q, int32_t gain, int32_t most)
{
    const dq_t unsaturated = {.d = d, .q = q};
    field_weakening_step(state, field_weakening_margin_q15(state, unsaturated), gain, most);
}

static int32_t after(field_weakening_t *state, int steps, int32_t d, int32_t q, int32_t gain,
                     int32_t most)
{
    for (int n = 0; n < steps; n++) {
        step(state, d, q, gain, most);
    }
    return field_weakening_current_pu(state);
}

void test_field_weakening_current_is_zero_below_the_voltage_limit(void)
{
    field_weakening_t state;
    field_weakening_init(&state, &config);
    TEST_ASSERT_EQUAL_INT32(0, after(&state, 1000, 0, 20000, 500, 8000));
}

void test_field_weakening_current_grows_above_the_voltage_limit_up_to_its_own(void)
{
    field_weakening_t state;
    field_weakening_init(&state, &config);
    int32_t before = 0;
    for (int n = 0; n < 200; n++) {
        const int32_t now = after(&state, 1, 0, 40000, 5000, 8000);
        TEST_ASSERT_TRUE(now <= before && now >= -8000);
        before = now;
    }
    TEST_ASSERT_EQUAL_INT32(-8000, before);
}

void test_field_weakening_current_returns_to_exactly_zero(void)
{
    field_weakening_t state;
    field_weakening_init(&state, &config);
    after(&state, 1000, 0, 40000, 5000, 8000);
    TEST_ASSERT_EQUAL_INT32(0, after(&state, 1000, 0, 0, 5000, 8000));
}

void test_one_step_is_four_periods_of_gain_times_the_missing_squared_voltage(void)
{
    /* |u|^2 = 1 in either axis is the circle; the target as generated is 0.96887 of the voltage. */
    field_weakening_t state;
    field_weakening_init(&state, &config);
    step(&state, 32767, 0, 1000, 32767);
    const double missing = 32767.0 * 32767.0 / 32768.0 - 0.96887 * 0.96887 * 32768.0;
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * 2.0 * 1000.0, 4.0 * -missing * 1000.0,
                              4.0 * state.current_q28); /* Q30 */
}

void test_field_weakening_is_symmetric_in_the_sign_of_the_voltage(void)
{
    field_weakening_t forward;
    field_weakening_init(&forward, &config);
    field_weakening_t backward = forward;
    for (int n = 0; n < 50; n++) {
        step(&forward, -9000, 31000, 700, 8000);
        step(&backward, -9000, -31000, 700, 8000);
        /* Each square is rounded down on its own, which sees no sign. */
        TEST_ASSERT_EQUAL_INT32(forward.current_q28, backward.current_q28);
    }
    TEST_ASSERT_TRUE(forward.current_q28 < 0);
}

void test_limit_or_gain_of_zero_switches_field_weakening_off(void)
{
    field_weakening_t state;
    field_weakening_init(&state, &config);
    TEST_ASSERT_EQUAL_INT32(0, after(&state, 100, 0, 100000, 32767, 0));
    TEST_ASSERT_EQUAL_INT32(0, after(&state, 100, 0, 100000, 0, 32767));
}

void test_the_largest_voltages_and_gains_do_not_overflow(void)
{
    static const int32_t VOLTAGES[] = {INT32_MIN, -600000, -32769, 32768, 600000, INT32_MAX};
    field_weakening_t state;
    field_weakening_init(&state, &config);
    for (int d = 0; d < 6; d++) {
        for (int q = 0; q < 6; q++) {
            for (int n = 0; n < 4; n++) {
                step(&state, VOLTAGES[d], VOLTAGES[q], 32767, 32767);
                TEST_ASSERT_TRUE(field_weakening_current_pu(&state) >= -32767);
                TEST_ASSERT_TRUE(field_weakening_current_pu(&state) <= 0);
            }
        }
    }
}

/* At a target of 0.8 a voltage of 0.81 of the circle demands a current, one of 0.79 does not. */
void test_voltage_is_regulated_to_the_configured_target(void)
{
    config.current_loop.modulation_target_pu_q15 = 26214;
    field_weakening_t state;
    field_weakening_init(&state, &config);
    TEST_ASSERT_EQUAL_INT32(0, after(&state, 10, 0, 25887, 500, 8000));
    TEST_ASSERT_TRUE(after(&state, 10, 0, 26542, 500, 8000) < 0);
    const dq_t at_target = {.d = 26214, .q = 0};
    TEST_ASSERT_INT32_WITHIN(1, 0, field_weakening_margin_q15(&state, at_target));
}

void test_square_of_the_target_is_rounded_to_nearest(void)
{
    for (int32_t target = 30000; target < 30300; target++) {
        field_weakening_t state;
        config.current_loop.modulation_target_pu_q15 = target;
        field_weakening_init(&state, &config);
        TEST_ASSERT_EQUAL_INT32((target * (int64_t)target * 2 / 32768 + 1) / 2,
                                state.target_square_q15);
    }
}

void test_current_is_limited_to_exactly_its_limit_and_to_zero(void)
{
    field_weakening_t state;
    field_weakening_init(&state, &config);
    state.current_q28 = -8000 * 8192 + 1;
    field_weakening_step(&state, -1, 2, 8000);
    TEST_ASSERT_EQUAL_INT32(-8000 * 8192, state.current_q28);
    state.current_q28 = -1;
    field_weakening_step(&state, 1, 2, 8000);
    TEST_ASSERT_EQUAL_INT32(0, state.current_q28);
}
