/* SPDX-License-Identifier: Apache-2.0 */
/* The EMF observer's constants, its start, the octant it begins with and its acquisition. */
#include <math.h>

#include "config/bases.h"
#include "emf_observer.c" /* its functions are private */
#include "unity.h"

extern const config_t CONFIG_LU2013;

static config_t config;
static emf_observer_t observer;

/* L_q I_base = 8 mWb; 2 psi + 5/4 of that are 32 768 uWb: 1 LSB of Q15 is 1 uWb. 2^24 periods are
 * 1 024 s. */
void setUp(void)
{
    config = CONFIG_LU2013;
    config.motor.q_inductance_nH = 80000;
    config.drive.current_full_scale_mA = 100000;
    config.motor.flux_linkage_nWb = 11384000;
    config.drive.pwm_frequency_Hz = 16384;
    config.motor.pole_pairs = 10;
    config.rotor.observer_speed_mrad_s = 20000;
    emf_observer_init(&observer, &config);
}

void tearDown(void) {}

void test_full_scale_is_twice_the_magnets_flux_and_more_than_that_of_the_current(void)
{
    TEST_ASSERT_EQUAL_INT64(32768000, full_scale_nWb(&config));
}

void test_share_of_the_full_scale_is_rounded_to_nearest_and_limited(void)
{
    TEST_ASSERT_EQUAL_INT32(0, share_q15(&config, 499, INT16_MAX));
    TEST_ASSERT_EQUAL_INT32(1, share_q15(&config, 500, INT16_MAX));
    TEST_ASSERT_EQUAL_INT32(32767, share_q15(&config, 32767000, 40000));
    TEST_ASSERT_EQUAL_INT32(4095, share_q15(&config, 4095000, 4095));
    TEST_ASSERT_EQUAL_INT32(4095, share_q15(&config, 4096000, 4095));
    TEST_ASSERT_EQUAL_INT32(4095, share_q15(&config, 4294967296000, 4095)); /* 2^32 times it */
}

void test_flux_linkage_is_a_share_in_q14(void)
{
    TEST_ASSERT_EQUAL_INT32(5692, foc_observer_flux_q14(&config));
}

/* Four times 200 rad/s; 1 rad/s is 1 024 in Q24 a period. */
void test_leak_is_four_times_the_lowest_speed_in_use(void)
{
    TEST_ASSERT_EQUAL_INT32(800 * 1024, foc_observer_leak_q24(&config));
    config.rotor.observer_speed_mrad_s = 10001;
    TEST_ASSERT_EQUAL_INT32(409640, foc_observer_leak_q24(&config)); /* 409 640.96 */
}

void test_leak_is_at_least_400_a_second_and_at_most_an_eighth_of_a_period(void)
{
    config.rotor.observer_speed_mrad_s = 9999;
    TEST_ASSERT_EQUAL_INT32(400 * 1024, foc_observer_leak_q24(&config));
    config.rotor.observer_speed_mrad_s = 60000;
    TEST_ASSERT_EQUAL_INT32(1 << 21, foc_observer_leak_q24(&config));
    config.rotor.observer_speed_mrad_s = 2980000; /* 3.0e9, beyond 31 bits */
    config.motor.pole_pairs = 60;
    config.drive.pwm_frequency_Hz = 4000;
    TEST_ASSERT_EQUAL_INT32(1 << 21, foc_observer_leak_q24(&config));
}

/* 1 Ohm and 100 A for 1/16 384 s: 6.1 mWb. */
void test_resistance_is_that_of_winding_and_switch_and_at_most_an_eighth(void)
{
    config.motor.phase_resistance_uOhm = 16384 * 5;
    config.drive.loss_resistance_uOhm = 16384 * 2;
    TEST_ASSERT_EQUAL_INT32(700, foc_observer_resistance_q15(&config));
    config.motor.phase_resistance_uOhm = 16384 * 50;
    TEST_ASSERT_EQUAL_INT32(4095, foc_observer_resistance_q15(&config));
}

/* Whole nanowebers of a period, of the circle and of a phase. */
static double volt_q15(int32_t full_scale_mV)
{
    const double limit = foc_modulation_limit_q15(&config, BASES_MODEL_TIMER_Hz) / 32768.0;
    const double period_nWb = floor(full_scale_mV * 1e6 / 16384.0);
    const double inverse = round(32768.0 / sqrt(3.0)) / 32768.0;
    return floor(floor(floor(period_nWb * limit) * inverse) / 1000.0 + 0.5);
}

void test_flux_of_a_period_is_the_circle_of_the_bus_voltage_base(void)
{
    for (int32_t mV = 200000; mV < 202000; mV++) {
        config.drive.voltage_full_scale_mV = mV;
        TEST_ASSERT_EQUAL_INT32((int32_t)volt_q15(mV),
                                foc_observer_volt_q15(&config, BASES_MODEL_TIMER_Hz));
    }
    config.drive.voltage_full_scale_mV = 300000;
    TEST_ASSERT_EQUAL_INT32(8191, foc_observer_volt_q15(&config, BASES_MODEL_TIMER_Hz));
}

/* Two equal poles p: gains 2 p and p^2, times 29 800. p in Q24, p^2 rounded down to Q24. */
static void assert_gains(int32_t pole_q24, int32_t proportional, int32_t integral)
{
    const observer_gains_t gains = tracking_gains(pole_q24);
    TEST_ASSERT_EQUAL_INT32(proportional, gains.proportional);
    TEST_ASSERT_EQUAL_INT32(integral, gains.integral);
}

void test_gains_of_the_tracking_loop_place_both_poles(void)
{
    assert_gains(1 << 22, 14900, 1862); /* 1/4: 29 800/2 and 29 800/16 */
    assert_gains((5 << 20) - 1, 18624, 2910);
    assert_gains(4968000, 17648, 2613); /* 2 613.000 */
    assert_gains(5078000, 18039, 2729); /* 2 729.994 */
}

void test_integral_gain_is_at_least_one(void)
{
    assert_gains(1000, 3, 1);
}

void test_poles_are_at_most_five_sixteenths_of_a_period(void)
{
    assert_gains(5 << 20, 18625, 2910);
    assert_gains(6 << 20, 18625, 2910);
}

static void assert_gains_of_leak(int32_t times, observer_gains_t gains)
{
    const observer_gains_t wanted = tracking_gains(800 * 1024 * times);
    TEST_ASSERT_EQUAL_INT32(wanted.proportional, gains.proportional);
    TEST_ASSERT_EQUAL_INT32(wanted.integral, gains.integral);
}

void test_first_state_has_its_constants_and_the_gains_of_the_acquisition(void)
{
    TEST_ASSERT_EQUAL_INT32(-8000, q_pair_x(observer.minus_inductance));
    TEST_ASSERT_EQUAL_INT32(-8000, q_pair_y(observer.minus_inductance));
    assert_gains_of_leak(6, observer.acquisition);
    assert_gains_of_leak(6, observer.gains);
    assert_gains_of_leak(2, observer.tracking);
    TEST_ASSERT_EQUAL_UINT32(54, observer.acquisition_periods); /* 16 384/300 */
    config.drive.pwm_frequency_Hz = 18000;
    emf_observer_init(&observer, &config);
    TEST_ASSERT_EQUAL_UINT32(60, observer.acquisition_periods);
    config.drive.pwm_frequency_Hz = 17999;
    emf_observer_init(&observer, &config);
    TEST_ASSERT_EQUAL_UINT32(59, observer.acquisition_periods);
    /* The smallest leak, so that neither pole is at its limit. */
    config.drive.pwm_frequency_Hz = 16384;
    config.rotor.observer_speed_mrad_s = 1;
    emf_observer_init(&observer, &config);
    TEST_ASSERT_EQUAL_INT32(8730, observer.acquisition.proportional); /* 6 * 400 * 1 024 */
    TEST_ASSERT_EQUAL_INT32(2910, observer.tracking.proportional);
}

static void fill(uint32_t periods)
{
    observer.theta_q32 = 1;
    observer.speed_q32 = 2;
    observer.start_speed_q32 = 3;
    observer.alpha_q30 = 4;
    observer.beta_q30 = 5;
    observer.u.v = q_pair(6, 7);
    observer.x.v = q_pair(8, 9);
    observer.gains = observer.tracking;
    observer.periods = periods;
}

void test_reset_keeps_the_speed_of_a_complete_acquisition_only(void)
{
    for (uint32_t short_of = 0; short_of <= 1; short_of++) {
        fill(observer.acquisition_periods - short_of);
        emf_observer_reset(&observer);
        TEST_ASSERT_EQUAL_INT32(short_of != 0 ? 3 : 2, observer.start_speed_q32);
        TEST_ASSERT_EQUAL_UINT32(0, observer.theta_q32);
        TEST_ASSERT_EQUAL_INT32(0, observer.speed_q32);
        TEST_ASSERT_EQUAL_INT32(0, observer.alpha_q30);
        TEST_ASSERT_EQUAL_INT32(0, observer.beta_q30);
        TEST_ASSERT_EQUAL_INT32(0, q_pair_x(observer.u.v));
        TEST_ASSERT_EQUAL_INT32(0, q_pair_y(observer.u.v));
        TEST_ASSERT_EQUAL_INT32(0, q_pair_x(observer.x.v));
        TEST_ASSERT_EQUAL_INT32(0, q_pair_y(observer.x.v));
        TEST_ASSERT_EQUAL_UINT32(0, observer.periods);
        TEST_ASSERT_EQUAL_INT32(observer.acquisition.proportional, observer.gains.proportional);
    }
}

void test_vector_has_the_middle_of_its_octant(void)
{
    /* Alpha, beta, sixteenths of a turn. An axis belongs to the octant that follows it in the
     * right half plane and the upper one, a diagonal to the one beside the alpha axis. */
    static const int32_t VECTORS[][3] = {
        {5, 2, 1},    {2, 5, 3},   {-2, 5, 5},  {-5, 2, 7},  {-5, -2, 9}, {-2, -5, 11},
        {2, -5, 13},  {5, -2, 15}, {1, 5, 3},   {0, 5, 3},   {-1, 5, 5},  {0, -5, 13},
        {-1, -5, 11}, {5, 1, 1},   {5, 0, 1},   {5, -1, 15}, {-5, 0, 7},  {-5, -1, 9},
        {3, 3, 1},    {-3, 3, 7},  {-3, -3, 9}, {3, -3, 15}, {0, 0, 1}};
    for (unsigned k = 0; k < sizeof VECTORS / sizeof VECTORS[0]; k++) {
        TEST_ASSERT_EQUAL_HEX32((uint32_t)VECTORS[k][2] << 28,
                                octant_q32(q_pair(VECTORS[k][0], VECTORS[k][1])));
    }
}

void test_eighth_period_of_a_start_sets_angle_and_speed_once(void)
{
    observer.acquisition_periods = 16;
    fill(0);
    observer.x.v = q_pair(-5, 2);
    emf_observer_acquire(&observer);
    TEST_ASSERT_EQUAL_UINT32(4, observer.periods);
    TEST_ASSERT_EQUAL_UINT32(1, observer.theta_q32);
    emf_observer_acquire(&observer);
    TEST_ASSERT_EQUAL_UINT32(8, observer.periods);
    TEST_ASSERT_EQUAL_HEX32(7U << 28, observer.theta_q32);
    TEST_ASSERT_EQUAL_INT32(3, observer.speed_q32);
    observer.theta_q32 = 1;
    emf_observer_acquire(&observer);
    TEST_ASSERT_EQUAL_UINT32(12, observer.periods);
    TEST_ASSERT_EQUAL_UINT32(1, observer.theta_q32);
}

void test_gains_are_those_of_tracking_from_the_end_of_the_acquisition_on(void)
{
    observer.acquisition_periods = 12;
    observer.periods = 8;
    emf_observer_acquire(&observer);
    TEST_ASSERT_EQUAL_INT32(observer.tracking.proportional, observer.gains.proportional);
    observer.gains.proportional = 1;
    emf_observer_acquire(&observer); /* complete: no change any more */
    TEST_ASSERT_EQUAL_UINT32(12, observer.periods);
    TEST_ASSERT_EQUAL_INT32(1, observer.gains.proportional);
    observer.acquisition_periods = 13;
    emf_observer_reset(&observer);
    observer.periods = 8;
    emf_observer_acquire(&observer);
    TEST_ASSERT_EQUAL_INT32(observer.acquisition.proportional, observer.gains.proportional);
}

/* x along a point of the table: the error is the angle from that point, 2 LSB for 1/65 536 turn. */
void test_angle_from_the_nearest_direction_is_taken_from_the_error(void)
{
    static const observer_tuning_t NO_TUNING = {.used = false};
    const ab16_t zero = {.v = q_pair(0, 0)};
    const q_pair_t axis = ANGLE_TABLE[40];
    for (uint32_t at = 0; at < 256U; at++) {
        emf_observer_reset(&observer);
        observer.alpha_q30 = q_pair_x(axis) * 65536;
        observer.beta_q30 = q_pair_y(axis) * 65536;
        observer.theta_q32 = (40U * 256U + at) << 16;
        observer.speed_q32 = 1000;
        observer.gains.proportional = 1 << 14;
        observer.gains.integral = 100;
        emf_observer_step(&observer, zero, zero, &NO_TUNING);
        const int32_t error = -2 * ((int32_t)at - 128);
        TEST_ASSERT_EQUAL_HEX32(((40U * 256U + at) << 16) + 1000U + (uint32_t)(error * 16384),
                                observer.theta_q32);
        TEST_ASSERT_EQUAL_INT32(1000 + 100 * error, observer.speed_q32);
    }
}
