/* SPDX-License-Identifier: Apache-2.0 */
/* Dead-time compensation: size from the configuration, sign from the current, proportional near
 * zero. */
#include <math.h>
#include <stdlib.h>

#include "modulation.h"
#include "random_values.h"
#include "tuning.h"
#include "unity.h"

extern const config_t CONFIG_LU2013;
static config_t config;
static int32_t timer_Hz;

void setUp(void)
{
    config = CONFIG_LU2013;
    config.drive.pwm_frequency_Hz = 20000;
    timer_Hz = 168000000; /* 4200 counts */
    config.drive.dead_time_ns = 1000;
    config.drive.diode_drop_mV = 0;
    config.current_loop.dead_time_zone_pu_q15 = 655;
}

void tearDown(void) {}

/* At the middle of the battery's voltage range. */
static dead_time_slope_t middle_slope(void)
{
    const int32_t middle_mV = (config.battery.min_voltage_mV + config.battery.max_voltage_mV) / 2;
    return dead_time_slope_at(&config,
                              q_scale(middle_mV, 32768, config.drive.voltage_full_scale_mV));
}

/* Phase a is the alpha axis. */
static double trim_counts(dead_time_slope_t slope, int32_t current_pu)
{
    const ab_t i = {.alpha = current_pu, .beta = 0};
    return modulation_dead_time(slope, i).a / 32768.0 *
           modulation_dead_time_counts(&config, timer_Hz);
}

void test_full_correction_is_the_dead_time_as_a_share_of_the_period(void)
{
    /* 1 us * 20 kHz = 2 % of 4200 counts. */
    TEST_ASSERT_EQUAL_INT32(84, modulation_dead_time_counts(&config, timer_Hz));
    config.drive.dead_time_ns = 500;
    config.drive.pwm_frequency_Hz = 16000;                                       /* 5250 counts */
    TEST_ASSERT_EQUAL_INT32(42, modulation_dead_time_counts(&config, timer_Hz)); /* 0.8 % of 5250 */
    config.drive.dead_time_ns = 495;
    TEST_ASSERT_EQUAL_INT32(
        42, modulation_dead_time_counts(&config, timer_Hz)); /* 41.58, to the nearest */
    config.drive.dead_time_ns = 493;
    TEST_ASSERT_EQUAL_INT32(41, modulation_dead_time_counts(&config, timer_Hz)); /* 41.41 */
}

void test_diode_drop_is_corrected_as_a_share_of_the_battery_s_middle_voltage(void)
{
    /* The leg misses 2 % of v_dc + 2 V_f. At 40 V that is 0.8 V + 4 % of V_f; a count is worth 40 V
     * / 4200. */
    config.battery.min_voltage_mV = 30000;
    config.battery.max_voltage_mV = 50000;
    config.drive.diode_drop_mV = 1000;
    TEST_ASSERT_EQUAL_INT32(88,
                            modulation_dead_time_counts(&config, timer_Hz)); /* 84 * 42/40 = 88.2 */
    config.drive.diode_drop_mV = 5000;
    TEST_ASSERT_EQUAL_INT32(105, modulation_dead_time_counts(&config, timer_Hz)); /* 84 * 50/40 */
    config.battery.max_voltage_mV = 90000;                                        /* 60 V */
    TEST_ASSERT_EQUAL_INT32(98, modulation_dead_time_counts(&config, timer_Hz));  /* 84 * 70/60 */
    for (int32_t drop_mV = 0; drop_mV <= 5000; drop_mV += 7) {
        config.drive.diode_drop_mV = drop_mV;
        const double lost_V = 1e-6 * 20000.0 * (60.0 + 2e-3 * drop_mV);
        TEST_ASSERT_DOUBLE_WITHIN(0.5001, lost_V / 60.0 * 4200.0,
                                  modulation_dead_time_counts(&config, timer_Hz));
    }
}

void test_largest_valid_dead_time_and_drop_give_an_eighth_of_the_longest_period(void)
{
    config.battery.min_voltage_mV = 1000;
    config.battery.max_voltage_mV = 3000;
    config.drive.diode_drop_mV = 4000; /* 1 + 2 * 4 V / 2 V = 5 */
    config.drive.pwm_frequency_Hz = 50000;
    config.drive.dead_time_ns = 500; /* 2.5 % */
    timer_Hz = 2 * 16384 * 50000;
    TEST_ASSERT_EQUAL_INT32(2048, modulation_dead_time_counts(&config, timer_Hz));
}

void test_positive_current_lengthens_the_high_side_pulse(void)
{
    const dead_time_slope_t slope = middle_slope();
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 84.0, trim_counts(slope, 20000));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, -84.0, trim_counts(slope, -20000));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, trim_counts(slope, 0));
}

void test_correction_is_proportional_inside_the_zone(void)
{
    const dead_time_slope_t slope = middle_slope();
    for (int32_t i = -655; i <= 655; i++) {
        /* The slope 1/zone is kept to 1/2^16 of one unit per LSB: 0.3 % here, and one LSB of Q15 is
         * rounded away. */
        TEST_ASSERT_DOUBLE_WITHIN(84.0 * 0.004, 84.0 * i / 655.0, trim_counts(slope, i));
    }
}

void test_correction_is_bounded_and_monotonic_for_every_current_and_zone(void)
{
    static const int32_t ZONES[] = {128, 129, 655, 5000, 32767};
    for (int z = 0; z < 5; z++) {
        config.current_loop.dead_time_zone_pu_q15 = ZONES[z];
        const dead_time_slope_t slope = middle_slope();
        double before = -85.0;
        for (int32_t i = -32768; i <= 32767; i++) {
            const double trim = trim_counts(slope, i);
            TEST_ASSERT_TRUE(trim >= before && fabs(trim) <= 84.0);
            before = trim;
        }
        TEST_ASSERT_DOUBLE_WITHIN(0.5, 84.0, before); /* the zone ends inside the range */
    }
}

void test_each_phase_is_trimmed_by_the_sign_of_its_own_current(void)
{
    const dead_time_slope_t slope = middle_slope();
    for (int k = 0; k < 3600; k++) {
        const double angle = k * 3.14159265358979323846 / 1800.0;
        const ab_t i = {(int32_t)lround(20000.0 * cos(angle)),
                        (int32_t)lround(20000.0 * sin(angle))};
        const abc_t trim = modulation_dead_time(slope, i);
        const int32_t got[3] = {trim.a, trim.b, trim.c};
        for (int x = 0; x < 3; x++) {
            const double phase = 20000.0 * cos(angle - x * 2.0 * 3.14159265358979323846 / 3.0);
            if (fabs(phase) > 660.0) {
                TEST_ASSERT_DOUBLE_WITHIN(0.01, phase > 0.0 ? 84.0 : -84.0,
                                          84.0 * got[x] / 32768.0);
            } else {
                TEST_ASSERT_DOUBLE_WITHIN(84.0 * 0.01, 84.0 * phase / 655.0,
                                          84.0 * got[x] / 32768.0);
            }
        }
    }
}

void test_the_longest_current_vector_does_not_overflow_in_any_direction(void)
{
    config.current_loop.dead_time_zone_pu_q15 = 128;
    const dead_time_slope_t slope = middle_slope();
    for (int k = 0; k < 36000; k++) {
        const double angle = k * 3.14159265358979323846 / 18000.0;
        const ab_t i = {(int32_t)lround(32768.0 * cos(angle)),
                        (int32_t)lround(32768.0 * sin(angle))};
        const abc_t trim = modulation_dead_time(slope, i);
        TEST_ASSERT_TRUE(abs(trim.a) <= 32768 && abs(trim.b) <= 32768 && abs(trim.c) <= 32768);
        /* With a zone this narrow only a wrap could turn a sign round. */
        const double beta_part = i.beta * sqrt(0.75);
        const double phase[3] = {i.alpha, beta_part - 0.5 * i.alpha, -beta_part - 0.5 * i.alpha};
        const int32_t got[3] = {trim.a, trim.b, trim.c};
        for (int x = 0; x < 3; x++) {
            TEST_ASSERT_TRUE(fabs(phase[x]) < 4.0 || got[x] * phase[x] > 0.0);
        }
    }
}

void test_correction_is_zero_without_dead_time(void)
{
    config.drive.dead_time_ns = 0;
    const dead_time_slope_t slope = middle_slope();
    for (int32_t i = -32768; i <= 32767; i += 5) {
        TEST_ASSERT_EQUAL_DOUBLE(0.0, trim_counts(slope, i));
    }
}

/* 500 ns * 20 kHz of 8450 counts are 84.5; 793 ns * 27 471 Hz of 3833 counts 83.4999 99999. */
void test_the_correction_is_rounded_to_the_nearest_count(void)
{
    config.drive.dead_time_ns = 500;
    TEST_ASSERT_EQUAL_INT32(85, modulation_dead_time_counts(&config, 2 * 20000 * 8450));
    config.drive.dead_time_ns = 793;
    config.drive.pwm_frequency_Hz = 27471;
    TEST_ASSERT_EQUAL_INT32(83, modulation_dead_time_counts(&config, 2 * 27471 * 3833));
}
