/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Sum of both brakes while braking torque is transferred between them. The hydraulic brake has dead
 * time and lag; the controller estimates its torque. The sum is braking airgap torque plus the
 * hydraulic brake's capacity, means over 5 ms.
 */
#include <math.h>
#include <stdio.h>

#include "unity.h"
#include "vehicle_fixture.h"

static const double DEMAND_NM = 80.0; /* the motor gives 40 */
static const double MOTOR_NM = 40.0;
static const double MEAN_s = 0.005;
static const double FRICTION_NM =
    0.5; /* and ripple: what the airgap torque is more or less than the shaft's */

typedef struct {
    double most_nm, least_nm;
} range_t;

void setUp(void) {}

void tearDown(void) {}

static double total_nm(bench_t *bench)
{
    const wheel_t *wheel = &bench->wheel[0];
    const double before_nms = wheel->totals.torque_impulse_nms;
    fixture_run(bench, MEAN_s);
    return wheel->brake_capacity_nm - (wheel->totals.torque_impulse_nms - before_nms) / MEAN_s;
}

static range_t sum_range(bench_t *bench, double duration_s)
{
    range_t out = {.most_nm = -INFINITY, .least_nm = INFINITY};
    const double until_s = bench->time_s + duration_s;
    while (bench->time_s < until_s) {
        const double now_nm = total_nm(bench);
        out.most_nm = fmax(out.most_nm, now_nm);
        out.least_nm = fmin(out.least_nm, now_nm);
    }
    return out;
}

static void anti_lock(bench_t *bench, bool at_work)
{
    bench->params.driver.abs_active = at_work ? 1.0 : 0.0;
    bench_refresh(bench);
}

/* A vehicle whose hydraulic brake has `gain` times the torque and `delay` times the dead time and
 * lag of the configuration. */
static bench_params_t vehicle(double gain, double delay)
{
    bench_params_t params = fixture_quarter_vehicle();
    params.brake.torque_loss = 1.0 - gain;
    params.brake.hydraulic_dead_time_s *= delay;
    params.brake.hydraulic_time_constant_s *= delay;
    return params;
}

/* Braking at 30 km/h, then an intervention of 0.3 s, then the motor's return. */
static range_t after_anti_lock(double gain, double delay)
{
    bench_params_t params = vehicle(gain, delay);
    params.vehicle.mass_kg = 1e6;
    params.run.initial_speed_m_per_s = 30.0 / 3.6;
    params.driver.brake_demand_nm = DEMAND_NM;
    const config_t config = fixture_config(CONFIG_STRATEGY_SERIES_OPTIMAL);
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.6);
    TEST_ASSERT_DOUBLE_WITHIN(FRICTION_NM, MOTOR_NM + gain * (DEMAND_NM - MOTOR_NM),
                              total_nm(bench));
    anti_lock(bench, true);
    fixture_run(bench, 0.3);
    anti_lock(bench, false);
    const range_t out = sum_range(bench, 1.2);
    TEST_ASSERT_TRUE(bench->wheel[0].slow.motor_torque_command_mNm <
                     -0.98e3 * MOTOR_NM); /* the motor brakes again */
    return out;
}

void test_sum_of_both_brakes_never_exceeds_the_demand_after_anti_lock(void)
{
    const range_t range = after_anti_lock(1.0, 1.0);
    TEST_ASSERT_TRUE(range.most_nm <= DEMAND_NM + FRICTION_NM);
    /* The motor's torque rises at 400 N m/s. The hydraulic torque falls at first with 40 N m/60 ms
     * = 667 N m/s, and at 400 N m/s after 60 ms ln(667/400) = 31 ms. By then the sum has lost 40 (1
     * - 400/667) - 400 * 0.031 = 3.7 N m, and one slow step of the motor. */
    TEST_ASSERT_TRUE(range.least_nm >= DEMAND_NM - 3.7 - 0.7 - FRICTION_NM);
}

/* The excess is the error of the estimate: 30 % of 80 N m hydraulic torque. */
void test_hydraulic_brake_30_percent_stronger_adds_only_its_own_error(void)
{
    TEST_ASSERT_TRUE(after_anti_lock(1.3, 1.0).most_nm <= 1.3 * DEMAND_NM + FRICTION_NM);
}

/* The excess is at most the difference of two step responses of 40 N m: dead time 40 and 52 ms, lag
 * 60 and 78 ms. */
void test_hydraulic_brake_30_percent_slower_adds_only_the_difference_of_the_lags(void)
{
    double difference_nm = 0.0;
    for (double t = 0.0; t < 0.5; t += 1e-4) {
        const double actual = t < 0.052 ? 1.0 : exp(-(t - 0.052) / 0.078);
        const double estimated = t < 0.040 ? 1.0 : exp(-(t - 0.040) / 0.060);
        difference_nm = fmax(difference_nm, MOTOR_NM * (actual - estimated));
    }
    TEST_ASSERT_TRUE(after_anti_lock(1.0, 1.3).most_nm <= DEMAND_NM + difference_nm + FRICTION_NM);
    TEST_ASSERT_TRUE(after_anti_lock(1.0, 0.7).most_nm <= DEMAND_NM + FRICTION_NM);
}

/* From 4 m/s to 0.5 m/s the loss optimum falls from 75 N m to 8 N m, below the demand from 1.6 m/s
 * on. Without the lead of the hydraulic command the delay of 0.1 s would leave 14 N m/s * 0.1 s =
 * 1.4 N m missing. */
static range_t sum_below_the_optimum(double gain, double delay)
{
    bench_params_t params = vehicle(gain, delay);
    params.run.initial_speed_m_per_s = 4.0;
    params.driver.brake_demand_nm = 30.0;
    const config_t config = fixture_config(CONFIG_STRATEGY_SERIES_OPTIMAL);
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.4); /* until the brakes have settled */
    range_t out = {.most_nm = -INFINITY, .least_nm = INFINITY};
    while (bench->vehicle.speed_m_per_s > 0.5) {
        const double now_nm = total_nm(bench);
        out.most_nm = fmax(out.most_nm, now_nm);
        out.least_nm = fmin(out.least_nm, now_nm);
    }
    TEST_ASSERT_TRUE(bench->wheel[0].brake_capacity_nm >
                     15.0 * gain); /* the hydraulic brake has most of the demand */
    return out;
}

void test_demand_is_met_while_the_loss_optimum_falls_with_speed(void)
{
    const range_t range = sum_below_the_optimum(1.0, 1.0);
    TEST_ASSERT_TRUE(range.least_nm >= 30.0 - FRICTION_NM);
    TEST_ASSERT_TRUE(range.most_nm <= 30.0 + FRICTION_NM);
}

void test_hydraulic_brake_30_percent_faster_or_slower_misses_a_ramp_by_30_percent_of_the_delay(void)
{
    const double missed_nm = 14.5 * 0.3 * 0.1;
    TEST_ASSERT_TRUE(sum_below_the_optimum(1.0, 1.3).least_nm >= 30.0 - missed_nm - FRICTION_NM);
    TEST_ASSERT_TRUE(sum_below_the_optimum(1.0, 0.7).most_nm <= 30.0 + missed_nm + FRICTION_NM);
}
