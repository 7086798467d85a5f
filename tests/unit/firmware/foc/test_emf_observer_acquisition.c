/* SPDX-License-Identifier: Apache-2.0 */
/* The EMF observer's gains, its start, the octant it begins with and its acquisition. */
#include "emf_observer.h"

#include <math.h>

#include "observer_config.h"
#include "unity.h"

enum { CAPTURES = 2, ACQUISITIONS = 14 /* of four periods: 16 384/300 are 54 */ };

static config_t config;
static emf_observer_t observer;

void setUp(void)
{
    config = observer_config();
    emf_observer_init(&observer, &config);
}

void tearDown(void) {}

/* Two equal poles p of a period: gains 2 p and p^2, times 29 800; p in Q24, p^2 rounded down to
 * Q24. */
static void assert_poles(double p, observer_gains_t gains)
{
    TEST_ASSERT_EQUAL_INT32((int32_t)floor(2.0 * p * 29800.0), gains.proportional);
    const double square = floor(p * p * 16777216.0) / 16777216.0;
    TEST_ASSERT_EQUAL_INT32((int32_t)fmax(floor(square * 29800.0), 1.0), gains.integral);
}

/* lambda T is four times the lowest speed, 1/8 at most and 400 1/s at least; six of it at a start,
 * two afterwards, up to 5/16. */
void test_gains_of_the_tracking_loop_place_both_poles(void)
{
    for (int32_t speed_mrad_s = 5000; speed_mrad_s < 60000; speed_mrad_s += 100) {
        config.rotor.observer_speed_mrad_s = speed_mrad_s;
        emf_observer_init(&observer, &config);
        const double leak = fmin(floor(fmax(4e-2 * speed_mrad_s, 400.0) * 1024.0), 2097152.0);
        assert_poles(fmin(6.0 * leak / 16777216.0, 5.0 / 16.0), observer.acquisition);
        assert_poles(fmin(2.0 * leak / 16777216.0, 5.0 / 16.0), observer.tracking);
    }
}

void test_integral_gain_is_at_least_one(void)
{
    config.rotor.observer_speed_mrad_s = 1;
    config.drive.pwm_frequency_Hz = 200000;
    emf_observer_init(&observer, &config);
    TEST_ASSERT_EQUAL_INT32(1, observer.tracking.integral);
}

void test_the_acquisition_takes_3_3_ms(void)
{
    TEST_ASSERT_EQUAL_UINT32(54, observer.acquisition_periods); /* 16 384/300 */
    config.drive.pwm_frequency_Hz = 18000;
    emf_observer_init(&observer, &config);
    TEST_ASSERT_EQUAL_UINT32(60, observer.acquisition_periods);
    config.drive.pwm_frequency_Hz = 17999;
    emf_observer_init(&observer, &config);
    TEST_ASSERT_EQUAL_UINT32(59, observer.acquisition_periods);
}

/* Two periods with the voltage of a direction and no current: the flux x has its direction. */
static void make_flux(int32_t alpha, int32_t beta)
{
    const observer_tuning_t tuning = {.volt = q_pair(8000, 8000)};
    const ab16_t u = {.v = q_pair(6000 * alpha, 6000 * beta)};
    const ab16_t no_current = {.v = q_pair(0, 0)};
    emf_observer_step(&observer, u, no_current, &tuning);
    emf_observer_step(&observer, u, no_current, &tuning);
}

static void acquire(int times)
{
    for (int n = 0; n < times; n++) {
        emf_observer_acquire(&observer);
    }
}

void test_eighth_period_of_a_start_sets_the_middle_of_the_flux_s_octant_once(void)
{
    /* Alpha, beta, sixteenths of a turn. An axis belongs to the octant that follows it in the right
     * half plane and the upper one, a diagonal to the one beside the alpha axis. */
    static const int32_t VECTORS[][3] = {
        {5, 2, 1},   {2, 5, 3}, {-2, 5, 5},  {-5, 2, 7}, {-5, -2, 9}, {-2, -5, 11}, {2, -5, 13},
        {5, -2, 15}, {0, 5, 3}, {0, -5, 13}, {5, 0, 1},  {-5, 0, 7},  {3, 3, 1},    {0, 0, 1}};
    for (unsigned k = 0; k < sizeof VECTORS / sizeof VECTORS[0]; k++) {
        emf_observer_reset(&observer);
        make_flux(VECTORS[k][0], VECTORS[k][1]);
        const uint32_t before_q32 = observer.theta_q32;
        acquire(CAPTURES - 1);
        TEST_ASSERT_EQUAL_HEX32(before_q32, observer.theta_q32);
        acquire(1);
        TEST_ASSERT_EQUAL_HEX32((uint32_t)VECTORS[k][2] << 28, observer.theta_q32);
        make_flux(-VECTORS[k][0], -VECTORS[k][1]);
        const uint32_t after_q32 = observer.theta_q32;
        acquire(1);
        TEST_ASSERT_EQUAL_HEX32(after_q32, observer.theta_q32);
    }
}

static void assert_same_gains(observer_gains_t expected)
{
    TEST_ASSERT_EQUAL_INT32(expected.proportional, observer.gains.proportional);
    TEST_ASSERT_EQUAL_INT32(expected.integral, observer.gains.integral);
}

void test_gains_are_those_of_tracking_from_the_end_of_the_acquisition_on(void)
{
    for (int start = 0; start < 2; start++) {
        assert_same_gains(observer.acquisition);
        acquire(ACQUISITIONS - 1);
        assert_same_gains(observer.acquisition);
        TEST_ASSERT_FALSE(emf_observer_acquired(&observer));
        acquire(1);
        assert_same_gains(observer.tracking);
        TEST_ASSERT_TRUE(emf_observer_acquired(&observer));
        acquire(1); /* complete: counts no further */
        TEST_ASSERT_EQUAL_UINT32(4 * ACQUISITIONS, observer.periods);
        emf_observer_reset(&observer);
    }
}

void test_a_start_has_the_speed_of_the_last_complete_acquisition(void)
{
    int32_t complete_q32 = 0;
    for (int times = ACQUISITIONS; times >= ACQUISITIONS - 1; times--) {
        acquire(times);
        make_flux(2 * times - 25, 2);
        TEST_ASSERT_NOT_EQUAL(complete_q32, observer.speed_q32);
        complete_q32 = times == ACQUISITIONS ? observer.speed_q32 : complete_q32;
        emf_observer_reset(&observer);
        TEST_ASSERT_EQUAL_UINT32(0, observer.theta_q32);
        TEST_ASSERT_EQUAL_INT32(0, observer.speed_q32);
        TEST_ASSERT_EQUAL_INT32(0, observer.alpha_q30);
        TEST_ASSERT_EQUAL_INT32(0, observer.beta_q30);
        TEST_ASSERT_EQUAL_INT32(0, q_pair_x(observer.x.v));
        TEST_ASSERT_EQUAL_INT32(0, q_pair_y(observer.x.v));
        acquire(CAPTURES);
        TEST_ASSERT_EQUAL_INT32(complete_q32, observer.speed_q32);
        emf_observer_reset(&observer);
    }
}
