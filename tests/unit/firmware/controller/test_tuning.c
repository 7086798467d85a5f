/* SPDX-License-Identifier: Apache-2.0 */
/* Coefficients for bus voltage, speed and winding temperature. */
#include <math.h>

#include "tuning.h"
#include "unity.h"
#include "winding.h"

extern const config_t CONFIG_LU2013;

static const double PI = 3.14159265358979323846;
static config_t config;

void setUp(void)
{
    config = CONFIG_LU2013;
}

void tearDown(void) {}

static current_tuning_t tuned(int32_t limit_q15, int32_t v_dc_pu, int32_t speed_q32,
                              int32_t winding_temperature_cC)
{
    const winding_t winding = winding_constants(&config);
    return current_tuning(&config, &winding, limit_q15, v_dc_pu, speed_q32, winding_temperature_cC);
}

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
            const current_tuning_t tuning =
                tuned(LIMIT_Q15[l], BUS_PU[v], 0, config.motor.reference_temperature_cC);
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

void test_integral_gain_follows_the_winding_resistance_and_proportional_gain_does_not(void)
{
    const int32_t reference_cC = config.motor.reference_temperature_cC;
    const current_tuning_t before = tuned(27493, 28102, 0, reference_cC);
    static const int32_t RISE_cK[] = {-4500, 9500, 12500};
    for (int t = 0; t < 3; t++) {
        const current_tuning_t tuning = tuned(27493, 28102, 0, reference_cC + RISE_cK[t]);
        const double factor = 1.0 + 0.00393 * RISE_cK[t] / 100.0;
        TEST_ASSERT_DOUBLE_WITHIN(2.0, factor * before.d.integral_q15, tuning.d.integral_q15);
        TEST_ASSERT_DOUBLE_WITHIN(2.0, factor * before.q.integral_q15, tuning.q.integral_q15);
        TEST_ASSERT_DOUBLE_WITHIN(2.0, factor * before.q.anti_windup_q15, tuning.q.anti_windup_q15);
        TEST_ASSERT_EQUAL_INT32(before.q.proportional_q10, tuning.q.proportional_q10);
    }
    /* A broken thermistor moves it within a tenth and 1000 K up. */
    const current_tuning_t lowest = tuned(27493, 28102, 0, INT32_MIN);
    const current_tuning_t highest = tuned(27493, 28102, 0, INT32_MAX);
    TEST_ASSERT_DOUBLE_WITHIN(1.5, 0.1 * before.q.integral_q15, lowest.q.integral_q15);
    TEST_ASSERT_DOUBLE_WITHIN(6.0, 4.93 * before.q.integral_q15, highest.q.integral_q15);
}

void test_feed_forward_is_speed_times_flux_and_inductance(void)
{
    static const int32_t SPEEDS_Q32[] = {-52000000, -5000000, 1000, 5000000,
                                         52000000}; /* to 640 r/min of 23 pole pairs */
    for (int v = 0; v < 4; v++) {
        for (int s = 0; s < 5; s++) {
            const current_tuning_t tuning =
                tuned(27493, BUS_PU[v], SPEEDS_Q32[s], config.motor.reference_temperature_cC);
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
        const current_tuning_t tuning =
            tuned(27493, 28102, SPEEDS_Q32[s], config.motor.reference_temperature_cC);
        const double angle = 1.5 * SPEEDS_Q32[s] / 4294967296.0 * 2.0 * PI;
        /* The advance is rounded down to three 65 536ths of a turn, 2.9e-4 rad or 9.4 LSB, and sine
         * has its own 1. */
        TEST_ASSERT_DOUBLE_WITHIN(11.0, 32768.0 * sin(angle), q_pair_y(tuning.advance.v));
        TEST_ASSERT_DOUBLE_WITHIN(11.0, 32768.0 * cos(angle), q_pair_x(tuning.advance.v));
    }
}

void test_bus_voltage_is_clamped_to_at_least_a_sixteenth(void)
{
    const current_tuning_t lowest =
        tuned(27493, 2048, 1000000, config.motor.reference_temperature_cC);
    static const int32_t BELOW[] = {2047, 1, 0, -1, -32768};
    for (int i = 0; i < 5; i++) {
        const current_tuning_t tuning =
            tuned(27493, BELOW[i], 1000000, config.motor.reference_temperature_cC);
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
    const current_tuning_t tuning =
        tuned(8192, 1, INT32_MAX, config.motor.reference_temperature_cC);
    TEST_ASSERT_TRUE(tuning.d.proportional_q10 <= PI_LARGEST_PROPORTIONAL_Q10 &&
                     tuning.d.integral_q15 <= PI_LARGEST_INTEGRAL_Q15);
    TEST_ASSERT_TRUE(tuning.d.anti_windup_q15 <= PI_LARGEST_ANTI_WINDUP_Q15);
    TEST_ASSERT_TRUE(tuning.q.proportional_q10 >= 1 && tuning.q.integral_q15 >= 1 &&
                     tuning.q.anti_windup_q15 >= 1);
}

void test_each_axis_is_decoupled_with_the_inductance_of_the_other_current(void)
{
    config.current_loop.inductance_d_pu_q16 *= 2;
    const current_tuning_t salient =
        tuned(27493, 28102, 30000000, config.motor.reference_temperature_cC);
    TEST_ASSERT_INT_WITHIN(1, 2 * salient.w_l_q_q10, salient.w_l_d_q10);
    TEST_ASSERT_TRUE(salient.w_l_q_q10 > 10);
}

/* Equal inductances do not make equal gains: each axis has its own three figures. */
void test_an_axis_with_an_integral_gain_of_its_own_keeps_it(void)
{
    config.current_loop.inductance_d_pu_q16 = config.current_loop.inductance_q_pu_q16;
    config.current_loop.proportional_d_pu_q16 = config.current_loop.proportional_q_pu_q16;
    config.current_loop.integral_d_pu_q24 = config.current_loop.integral_q_pu_q24 / 2;
    const current_tuning_t tuning = tuned(27493, 28102, 0, config.motor.reference_temperature_cC);
    TEST_ASSERT_INT_WITHIN(1, tuning.q.integral_q15 / 2, tuning.d.integral_q15);
    TEST_ASSERT_EQUAL_INT32(tuning.q.proportional_q10, tuning.d.proportional_q10);
}

void test_a_back_emf_of_more_than_eight_units_counts_as_eight(void)
{
    config.current_loop.flux_pu_q16 = 1048576;
    for (int sign = -1; sign <= 1; sign += 2) {
        const current_tuning_t tuning =
            tuned(27493, 28102, sign * 1000000000, config.motor.reference_temperature_cC);
        TEST_ASSERT_EQUAL_INT32(sign * 8 * (1 << 25), tuning.forward_q_q25);
    }
}
