/* SPDX-License-Identifier: Apache-2.0 */
/* The EMF observer's gains, its start, the octant it begins with and its acquisition. */
#include "emf_observer.c" /* its functions are private */
#include "observer_config.h"
#include "unity.h"

static config_t config;
static emf_observer_t observer;

void setUp(void)
{
    config = observer_config();
    emf_observer_init(&observer, &config);
}

void tearDown(void) {}

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
