/* SPDX-License-Identifier: Apache-2.0 */
/* The current regulator: feed-forward terms, priority of d, tuning for bus voltage and speed. */
#include <math.h>
#include <stdlib.h>

#include "foc/current_loop.h"
#include "unity.h"

extern const config_t CONFIG_LU2013;

static const double PI = 3.14159265358979323846;
static config_t config;
static current_loop_state_t state;

void setUp(void)
{
    config = CONFIG_LU2013;
    current_loop_reset(&state);
}

void tearDown(void) {}

/* Volts that one modulation unit stands for. */
static double unit_V(int32_t limit_q15, int32_t v_dc_pu)
{
    return limit_q15 / 32768.0 * v_dc_pu / 32768.0 * config.drive.voltage_full_scale_mV * 1e-3 /
           sqrt(3.0);
}

static double current_base_A(void)
{
    return config.drive.current_full_scale_mA * 1e-3;
}

static double speed_rad_s(int32_t speed_q32)
{
    return speed_q32 / 4294967296.0 * config.drive.pwm_frequency_Hz * 2.0 * PI;
}

static const int32_t BUS_PU[] = {19000, 23859, 28102, 32000};
static const int32_t LIMIT_Q15[] = {20000, 27493, 31000};

void test_gains_in_modulation_units_are_the_configured_volts_over_the_unit(void)
{
    for (int v = 0; v < 4; v++) {
        for (int l = 0; l < 3; l++) {
            const current_loop_tuning_t tuning = current_loop_tuning(
                &config, LIMIT_Q15[l], BUS_PU[v], 0, config.motor.reference_temperature_cC);
            /* per-unit volts per per-unit ampere, times V_base, over the unit */
            const double factor =
                config.drive.voltage_full_scale_mV * 1e-3 / unit_V(LIMIT_Q15[l], BUS_PU[v]);
            const double proportional =
                config.current_loop.proportional_q_pu_q16 / 65536.0 * factor;
            const double integral = config.current_loop.integral_q_pu_q24 / 16777216.0 * factor;
            TEST_ASSERT_DOUBLE_WITHIN(1.0 / 2048.0 + proportional * 1e-3, proportional,
                                      tuning.q.proportional_q10 / 1024.0);
            TEST_ASSERT_DOUBLE_WITHIN(1.0 / 32768.0 + integral * 1e-3, integral,
                                      tuning.q.integral_q15 / 32768.0);
            TEST_ASSERT_DOUBLE_WITHIN(1.5 / 32768.0, integral / proportional,
                                      tuning.q.anti_windup_q15 / 32768.0);
        }
    }
}

void test_the_integral_gain_follows_the_winding_as_copper_does_and_the_proportional_does_not(void)
{
    const int32_t reference_cC = config.motor.reference_temperature_cC;
    const current_loop_tuning_t before =
        current_loop_tuning(&config, 27493, 28102, 0, reference_cC);
    static const int32_t RISE_cK[] = {-4500, 9500, 12500};
    for (int t = 0; t < 3; t++) {
        const current_loop_tuning_t tuning =
            current_loop_tuning(&config, 27493, 28102, 0, reference_cC + RISE_cK[t]);
        const double factor = 1.0 + 0.00393 * RISE_cK[t] / 100.0;
        TEST_ASSERT_DOUBLE_WITHIN(2.0, factor * before.d.integral_q15, tuning.d.integral_q15);
        TEST_ASSERT_DOUBLE_WITHIN(2.0, factor * before.q.integral_q15, tuning.q.integral_q15);
        TEST_ASSERT_DOUBLE_WITHIN(2.0, factor * before.q.anti_windup_q15, tuning.q.anti_windup_q15);
        TEST_ASSERT_EQUAL_INT32(before.q.proportional_q10, tuning.q.proportional_q10);
    }
    /* A broken thermistor moves it within a tenth and 1000 K up. */
    const current_loop_tuning_t lowest = current_loop_tuning(&config, 27493, 28102, 0, INT32_MIN);
    const current_loop_tuning_t highest = current_loop_tuning(&config, 27493, 28102, 0, INT32_MAX);
    TEST_ASSERT_DOUBLE_WITHIN(1.5, 0.1 * before.q.integral_q15, lowest.q.integral_q15);
    TEST_ASSERT_DOUBLE_WITHIN(6.0, 4.93 * before.q.integral_q15, highest.q.integral_q15);
}

void test_feed_forward_is_speed_times_flux_and_inductance(void)
{
    static const int32_t SPEEDS_Q32[] = {-52000000, -5000000, 1000, 5000000,
                                         52000000}; /* to 640 r/min of 23 pole pairs */
    for (int v = 0; v < 4; v++) {
        for (int s = 0; s < 5; s++) {
            const current_loop_tuning_t tuning = current_loop_tuning(
                &config, 27493, BUS_PU[v], SPEEDS_Q32[s], config.motor.reference_temperature_cC);
            const double w = speed_rad_s(SPEEDS_Q32[s]);
            const double unit = unit_V(27493, BUS_PU[v]);
            const double emf = w * config.motor.flux_linkage_nWb * 1e-9 / unit;
            const double w_l = w * config.motor.q_inductance_nH * 1e-9 * current_base_A() / unit;
            TEST_ASSERT_DOUBLE_WITHIN(fabs(emf) * 1e-3 + 1.0 / 32768.0, emf,
                                      tuning.forward_q_q25 / 33554432.0);
            TEST_ASSERT_DOUBLE_WITHIN(fabs(w_l) * 1e-3 + 1.0 / 2048.0, w_l,
                                      tuning.w_l_q_q10 / 1024.0);
            TEST_ASSERT_DOUBLE_WITHIN(fabs(w_l) * 1e-3 + 1.0 / 2048.0, w_l,
                                      tuning.w_l_d_q10 / 1024.0);
        }
    }
}

void test_the_angle_is_advanced_by_one_and_a_half_periods(void)
{
    static const int32_t SPEEDS_Q32[] = {-100000000, -52000000, 0, 131072, 52000000, 100000000};
    for (int s = 0; s < 6; s++) {
        const current_loop_tuning_t tuning = current_loop_tuning(
            &config, 27493, 28102, SPEEDS_Q32[s], config.motor.reference_temperature_cC);
        const double angle = 1.5 * SPEEDS_Q32[s] / 4294967296.0 * 2.0 * PI;
        /* The advance is rounded down to three 65 536ths of a turn, 2.9e-4 rad or 9.4 LSB, and sine
         * has its own 1. */
        TEST_ASSERT_DOUBLE_WITHIN(11.0, 32768.0 * sin(angle), tuning.advance.sin);
        TEST_ASSERT_DOUBLE_WITHIN(11.0, 32768.0 * cos(angle), tuning.advance.cos);
    }
}

void test_a_bus_voltage_below_a_sixteenth_counts_as_a_sixteenth(void)
{
    const current_loop_tuning_t lowest =
        current_loop_tuning(&config, 27493, 2048, 1000000, config.motor.reference_temperature_cC);
    static const int32_t BELOW[] = {2047, 1, 0, -1, -32768};
    for (int i = 0; i < 5; i++) {
        const current_loop_tuning_t tuning = current_loop_tuning(
            &config, 27493, BELOW[i], 1000000, config.motor.reference_temperature_cC);
        TEST_ASSERT_EQUAL_INT32(lowest.q.proportional_q10, tuning.q.proportional_q10);
        TEST_ASSERT_EQUAL_INT32(lowest.forward_q_q25, tuning.forward_q_q25);
    }
}

void test_gains_beyond_their_formats_are_clamped_and_never_zero(void)
{
    config.current_loop.proportional_d_pu_q16 = 1048576;
    config.current_loop.integral_d_pu_q24 = 16777216;
    config.current_loop.proportional_q_pu_q16 = 1;
    config.current_loop.integral_q_pu_q24 = 1;
    const current_loop_tuning_t tuning =
        current_loop_tuning(&config, 8192, 1, INT32_MAX, config.motor.reference_temperature_cC);
    TEST_ASSERT_TRUE(tuning.d.proportional_q10 <= PI_LARGEST_PROPORTIONAL_Q10 &&
                     tuning.d.integral_q15 <= PI_LARGEST_INTEGRAL_Q15);
    TEST_ASSERT_TRUE(tuning.d.anti_windup_q15 <= PI_LARGEST_ANTI_WINDUP_Q15);
    TEST_ASSERT_TRUE(tuning.q.proportional_q10 >= 1 && tuning.q.integral_q15 >= 1 &&
                     tuning.q.anti_windup_q15 >= 1);
}

static current_loop_tuning_t plain_tuning(void)
{
    return current_loop_tuning(&config, 27493, 28102, 0, config.motor.reference_temperature_cC);
}

static current_loop_out_t step(const current_loop_tuning_t *tuning, int32_t d, int32_t q,
                               int32_t i_d, int32_t i_q)
{
    const dq_t reference = {.d = d, .q = q};
    const dq_t i = {.d = i_d, .q = i_q};
    current_loop_out_t out;
    current_loop_step(&state, tuning, reference, i, &out);
    return out;
}

void test_without_error_and_speed_there_is_no_voltage(void)
{
    const current_loop_tuning_t tuning = plain_tuning();
    for (int n = 0; n < 100; n++) {
        const current_loop_out_t out = step(&tuning, 700, -900, 700, -900);
        TEST_ASSERT_EQUAL_INT32(0, out.realised.d);
        TEST_ASSERT_EQUAL_INT32(0, out.realised.q);
    }
}

void test_at_speed_without_current_the_voltage_is_the_back_emf(void)
{
    const current_loop_tuning_t tuning =
        current_loop_tuning(&config, 27493, 28102, 20000000, config.motor.reference_temperature_cC);
    const current_loop_out_t out = step(&tuning, 0, 0, 0, 0);
    TEST_ASSERT_EQUAL_INT32(0, out.realised.d);
    TEST_ASSERT_INT32_WITHIN(1, tuning.forward_q_q25 >> 10, out.realised.q);
}

void test_cross_coupling_has_the_sign_of_the_motor_equations(void)
{
    /* u_d holds -w L_q i_q, u_q holds +w L_d i_d. */
    const current_loop_tuning_t still = plain_tuning();
    current_loop_tuning_t tuning = still;
    tuning.w_l_q_q10 = 512; /* 0.5 */
    tuning.w_l_d_q10 = 256; /* 0.25 */
    const current_loop_out_t out = step(&tuning, 6000, 8000, 6000, 8000);
    TEST_ASSERT_INT32_WITHIN(1, -4000, out.realised.d);
    TEST_ASSERT_INT32_WITHIN(1, 1500, out.realised.q);
}

void test_the_d_axis_takes_its_voltage_first_and_q_gets_what_the_circle_leaves(void)
{
    current_loop_tuning_t tuning = plain_tuning();
    tuning.d.proportional_q10 = 1024;
    tuning.q.proportional_q10 = 1024;
    for (int32_t d = 0; d <= 32767; d += 111) {
        current_loop_reset(&state);
        const current_loop_out_t out = step(&tuning, d, -32768, 0, 0);
        TEST_ASSERT_INT32_WITHIN(1, d, out.realised.d);
        TEST_ASSERT_TRUE(out.realised.q <= 0);
        TEST_ASSERT_TRUE(hypot(out.realised.d, out.realised.q) <= 32769.0);
        /* The interpolated root falls short by 0.8 % at most where the circle is not steep. */
        if (d < 31700) {
            TEST_ASSERT_TRUE(out.realised.q <=
                             -0.992 * sqrt(32768.0 * 32768.0 - (double)d * d) + 2.0);
        }
    }
}

void test_what_is_wanted_is_reported_before_the_circle(void)
{
    current_loop_tuning_t tuning = plain_tuning();
    tuning.d.proportional_q10 = 2048;
    tuning.q.proportional_q10 = 4096;
    const current_loop_out_t out = step(&tuning, 20000, -20000, 0, 0);
    TEST_ASSERT_EQUAL_INT32(40000, out.wanted_d);
    TEST_ASSERT_EQUAL_INT32(-80000, out.wanted_q);
    TEST_ASSERT_EQUAL_INT32(32767, out.realised.d);
}

void test_each_axis_is_told_what_it_realised_and_has_its_own_gains(void)
{
    /* In one step an integrator advances by k_i e + k_i/k_p (1 - k_p e) where k_p e is too much by
     * a half, by k_i e where not. */
    current_loop_tuning_t tuning = plain_tuning();
    tuning.d.proportional_q10 = 3 * 1024;
    tuning.d.integral_q15 = 300;
    tuning.d.anti_windup_q15 = 100;
    tuning.q.proportional_q10 = 2 * 1024;
    tuning.q.integral_q15 = 400;
    tuning.q.anti_windup_q15 = 200;
    step(&tuning, 16384, 0, 0, 0);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 300.0 * 0.5 + 100.0 * (1.0 - 1.5),
                              state.d.integrator_q30 / 32768.0);
    current_loop_reset(&state);
    step(&tuning, 0, -24576, 0, 0);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 400.0 * -0.75 + 200.0 * (1.5 - 1.0),
                              state.q.integrator_q30 / 32768.0);
    current_loop_reset(&state);
    step(&tuning, 100, 100, 0, 0);
    TEST_ASSERT_EQUAL_INT32(300 * 100, state.d.integrator_q30);
    TEST_ASSERT_EQUAL_INT32(400 * 100, state.q.integrator_q30);
}

void test_each_axis_is_decoupled_with_the_inductance_of_the_other_current(void)
{
    config.current_loop.inductance_d_pu_q16 *= 2;
    const current_loop_tuning_t salient =
        current_loop_tuning(&config, 27493, 28102, 30000000, config.motor.reference_temperature_cC);
    TEST_ASSERT_INT_WITHIN(1, 2 * salient.w_l_q_q10, salient.w_l_d_q10);
    TEST_ASSERT_TRUE(salient.w_l_q_q10 > 10);
}

void test_a_back_emf_of_more_than_eight_units_counts_as_eight(void)
{
    config.current_loop.flux_pu_q16 = 1048576;
    for (int sign = -1; sign <= 1; sign += 2) {
        const current_loop_tuning_t tuning = current_loop_tuning(
            &config, 27493, 28102, sign * 1000000000, config.motor.reference_temperature_cC);
        TEST_ASSERT_EQUAL_INT32(sign * 8 * (1 << 25), tuning.forward_q_q25);
    }
}

void test_a_reset_forgets_the_integrators(void)
{
    const current_loop_tuning_t tuning = plain_tuning();
    for (int n = 0; n < 50; n++) {
        step(&tuning, 3000, 3000, 0, 0);
    }
    TEST_ASSERT_NOT_EQUAL(0, state.q.integrator_q30);
    current_loop_reset(&state);
    TEST_ASSERT_EQUAL_INT32(0, state.d.integrator_q30);
    TEST_ASSERT_EQUAL_INT32(0, state.q.integrator_q30);
}

void test_currents_at_the_ends_of_their_formats_do_not_overflow(void)
{
    /* Measured vectors may be 1.53 long (frames.h), references 1.0, cross coupling 16. */
    static const int32_t ENDS[] = {-50200, -32768, 0, 32767, 50200};
    current_loop_tuning_t tuning = plain_tuning();
    tuning.d.proportional_q10 = PI_LARGEST_PROPORTIONAL_Q10;
    tuning.q.proportional_q10 = PI_LARGEST_PROPORTIONAL_Q10;
    for (int sign = -1; sign <= 1; sign += 2) {
        tuning.w_l_d_q10 = sign * 16383;
        tuning.w_l_q_q10 = sign * 16383;
        tuning.forward_q_q25 = sign * (1 << 28);
        for (int d = 0; d < 5; d++) {
            for (int q = 0; q < 5; q++) {
                for (int r = -1; r <= 1; r += 2) {
                    const current_loop_out_t out =
                        step(&tuning, r * 32767, -r * 32767, ENDS[d], ENDS[q]);
                    TEST_ASSERT_TRUE(hypot(out.realised.d, out.realised.q) <= 32769.0);
                }
            }
        }
    }
}

/* ---- what d gives back ---- */

void test_d_gives_back_what_it_wants_beyond_98_per_cent_of_the_circle_and_nothing_else(void)
{
    static const int32_t WANTED[] = {-40000, -33000, -32257, -32256, -1000, 0,
                                     5000,   32256,  32257,  33000,  60000};
    static const int32_t BEYOND[] = {-7744, -744, -1, 0, 0, 0, 0, 0, 1, 744, 27744};
    for (int n = 0; n < 11; n++) {
        const current_loop_out_t last = {
            .wanted_d = WANTED[n], .wanted_q = 0, .realised = {.d = 0, .q = 0}};
        state.d.integrator_q30 = 12345;
        state.q.integrator_q30 = -777;
        current_loop_give_back_d(&state, &last);
        TEST_ASSERT_EQUAL_INT32(12345 - BEYOND[n] * 32768, state.d.integrator_q30);
        TEST_ASSERT_EQUAL_INT32(-777, state.q.integrator_q30);
    }
}

void test_the_next_voltage_leaves_q_at_least_17_per_cent(void)
{
    const current_loop_tuning_t tuning = plain_tuning();
    state.d.integrator_q30 = 1 << 29;
    current_loop_out_t out = step(&tuning, 30000, 20000, 0, 0); /* far more than there is */
    TEST_ASSERT_EQUAL_INT32(32767, out.realised.d);
    TEST_ASSERT_LESS_THAN_INT32(300, out.realised.q);
    for (int n = 0; n < 10 && out.wanted_d > CURRENT_LOOP_MOST_D_Q15; n++) {
        current_loop_give_back_d(&state, &out);
        out = step(&tuning, 1000, 20000, 0, 0);
    }
    TEST_ASSERT_GREATER_OR_EQUAL_INT32((int32_t)(0.17 * 32768), out.realised.q);
}
