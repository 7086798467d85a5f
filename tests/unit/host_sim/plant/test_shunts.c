/* SPDX-License-Identifier: Apache-2.0 */
/* Low-side shunts: zero while the high side conducts, settling after it. */
#include "plant/shunts.h"

#include <math.h>

#include "unity.h"

static const double PERIOD_S = 50e-6;
static const double TAU_S = 0.5e-6;
static const plant_abc_t CURRENT_A = {.a = 40.0, .b = -30.0, .c = -10.0};

void setUp(void) {}

void tearDown(void) {}

static shunts_period_t steady(plant_abc_t duty, double dead_s)
{
    const shunts_period_t out = {.duty = duty,
                                 .begin_a = CURRENT_A,
                                 .end_a = CURRENT_A,
                                 .period_s = PERIOD_S,
                                 .dead_s = dead_s};
    return out;
}

/* Amplifier outputs at the counter top after ten equal periods. */
static shunts_t settled(plant_abc_t duty, double dead_s, double tau_s)
{
    shunts_t out = {.output_a = {0.0, 0.0, 0.0}};
    const shunts_period_t period = steady(duty, dead_s);
    for (int k = 0; k < 10; k++) {
        shunts_pwm(&out, &period, PERIOD_S, tau_s);
    }
    return out;
}

/* Steady state of a lag driven for t and off for the rest of the period, sampled in the middle of
 * the on time: i (1 - e^(-t/tau)) plus the remainder of the period before. */
static double window(double current_a, double low_before_s, double high_s, double tau_s)
{
    const double low_after_s = PERIOD_S - high_s - low_before_s;
    const double e_after = exp(-low_after_s / tau_s); /* from the top to the rise */
    const double e_high = exp(-high_s / tau_s);
    const double e_before = exp(-low_before_s / tau_s);
    /* x = (x e_after + i (1 - e_after)) e_high e_before + i (1 - e_before) */
    const double gain = ((1.0 - e_after) * e_high * e_before + 1.0 - e_before) /
                        (1.0 - e_after * e_high * e_before);
    return current_a * gain;
}

void test_a_leg_with_a_long_window_is_measured_without_error(void)
{
    const plant_abc_t half = {.a = 0.5, .b = 0.5, .c = 0.5};
    const shunts_t s = settled(half, 0.0, TAU_S);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 40.0, s.output_a[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, -30.0, s.output_a[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, -10.0, shunts_output(&s).c);
}

void test_a_short_window_gives_the_share_of_an_exponential_settling(void)
{
    const double duties[] = {0.9, 0.97, 0.99, 0.999};
    for (int k = 0; k < 4; k++) {
        const plant_abc_t duty = {.a = duties[k], .b = duties[k], .c = 0.2};
        const shunts_t s = settled(duty, 0.0, TAU_S);
        const double half_low_s = 0.5 * PERIOD_S * (1.0 - duties[k]);
        const double high_s = PERIOD_S * duties[k];
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, window(40.0, half_low_s, high_s, TAU_S), s.output_a[0]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, window(-30.0, half_low_s, high_s, TAU_S), s.output_a[1]);
    }
    /* Two and a half time constants: 8 % missing. */
    const plant_abc_t duty = {.a = 0.95, .b = 0.1, .c = 0.1};
    const shunts_t s = settled(duty, 0.0, TAU_S);
    TEST_ASSERT_DOUBLE_WITHIN(0.001, 40.0 * (1.0 - exp(-2.5)), s.output_a[0]);
}

void test_during_the_dead_time_the_conducting_diode_decides_the_shunt_current(void)
{
    const double dead_s = 1e-6;
    const plant_abc_t duty = {.a = 0.95, .b = 0.95, .c = 0.1};
    const shunts_t s = settled(duty, dead_s, TAU_S);
    const double half_low_s = 0.5 * PERIOD_S * 0.05;
    /* Current into the motor: the low diode conducts during the dead times as well. Current out of
     * the motor: only the switch conducts. */
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, window(40.0, half_low_s, PERIOD_S * 0.95 - dead_s, TAU_S),
                              s.output_a[0]);
    TEST_ASSERT_DOUBLE_WITHIN(
        1e-9, window(-30.0, half_low_s - dead_s, PERIOD_S * 0.95 + dead_s, TAU_S), s.output_a[1]);
}

void test_shunt_reads_zero_at_full_duty_and_the_whole_current_at_zero_duty(void)
{
    const plant_abc_t duty = {.a = 1.0, .b = 0.0, .c = 0.5};
    const shunts_t s = settled(duty, 1e-6, TAU_S);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, s.output_a[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -30.0, s.output_a[1]);
}

void test_a_later_sample_has_a_smaller_settling_error(void)
{
    const plant_abc_t duty = {.a = 0.95, .b = 0.1, .c = 0.1};
    const shunts_t top = settled(duty, 0.0, TAU_S);
    shunts_t late = top;
    const shunts_period_t period = steady(duty, 0.0);
    shunts_pwm(&late, &period, 1e-6, TAU_S);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 40.0 - (40.0 - top.output_a[0]) * exp(-2.0), late.output_a[0]);
    shunts_t too_late = top; /* the leg has risen at 1.25 us */
    shunts_pwm(&too_late, &period, 3e-6, TAU_S);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, (40.0 - (40.0 - top.output_a[0]) * exp(-2.5)) * exp(-3.5),
                              too_late.output_a[0]);
}

void test_shunts_measure_low_diode_currents_with_open_and_all_with_closed_switches(void)
{
    const plant_abc_t none = {.a = 0.0, .b = 0.0, .c = 0.0};
    const shunts_period_t period = steady(none, 1e-6);
    shunts_t s = {.output_a = {0.0, 0.0, 0.0}};
    shunts_off(&s, &period, PERIOD_S, TAU_S);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 40.0, s.output_a[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, s.output_a[1]);
    shunts_short(&s, &period, PERIOD_S, TAU_S);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -30.0, s.output_a[1]);
}
