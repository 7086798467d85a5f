/* SPDX-License-Identifier: Apache-2.0 */
/* Sensor failures and the anti-lock system, on the vehicle with its controllers. */
#include "bench/abs_unit.h"

#include <math.h>

#include "bench/bench.h"
#include "unity.h"
#include "vehicle_fixture.h"

static bench_params_t params;
static config_t config;

void setUp(void)
{
    params = fixture_vehicle();
    params.run.initial_speed_m_per_s = 10.0;
    params.driver.brake_demand_nm = 40.0;
    config = fixture_config(CONFIG_STRATEGY_SERIES_OPTIMAL);
}

void tearDown(void) {}

static double residual(const bench_t *bench)
{
    const ledger_t ledger = bench_ledger(bench);
    return fabs(ledger.residual_j) / ledger.turned_over_j;
}

static double mean_brake_nm(const bench_t *bench)
{
    double out = 0.0;
    for (int k = 0; k < 4; k++) {
        out += 0.25 * (bench->wheel[k].brake_capacity_nm -
                       1e-3 * bench->wheel[k].slow.motor_torque_estimate_mNm);
    }
    return out;
}

void test_a_motor_with_a_broken_winding_sensor_goes_on_braking(void)
{
    for (int k = 0; k < 2; k++) {
        bench_t *bench = fixture_start(&params, &config);
        fixture_run(bench, 0.5);
        TEST_ASSERT_DOUBLE_WITHIN(1.0, 40.0, mean_brake_nm(bench));
        bench->params.wheel[1].winding_sensor_open = k == 0 ? 1.0 : 0.0;
        bench->params.wheel[1].winding_sensor_shorted = k == 0 ? 0.0 : 1.0;
        bench_refresh(bench);
        fixture_run(bench, 0.6);
        TEST_ASSERT_EQUAL_INT(REASON_WINDING_SENSOR, bench->wheel[1].slow.warning_reason);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, bench->wheel[1].first_fault);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, bench->wheel[0].slow.warning_reason);
        TEST_ASSERT_TRUE(bench->wheel[1].active.bridge == BRIDGE_PWM);
        TEST_ASSERT_DOUBLE_WITHIN(1.0, 40.0, mean_brake_nm(bench));
        TEST_ASSERT_DOUBLE_WITHIN(0.5, -40.0,
                                  1e-3 * bench->wheel[1].slow.motor_torque_estimate_mNm);
    }
}

void test_sensor_that_reads_too_hot_derates_the_motor_at_the_same_total_torque(void)
{
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.5);
    const double middle_cC = 0.5 * (config.motor.derate_winding_temperature_cC +
                                    config.motor.max_winding_temperature_cC);
    bench->params.winding_sensor.offset_k = 0.01 * middle_cC - 25.0;
    fixture_run(bench, 0.6);
    for (int k = 0; k < 4; k++) {
        const wheel_t *wheel = &bench->wheel[k];
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 25.0, wheel->winding.temperature_c);
        TEST_ASSERT_EQUAL_INT(REASON_WINDING_TEMPERATURE, wheel->slow.available_reason);
        TEST_ASSERT_TRUE(wheel->slow.motor_torque_command_mNm > -25000);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, wheel->first_fault);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 40.0, mean_brake_nm(bench));
}

void test_winding_overshoots_its_limit_by_the_lag_of_the_sensor(void)
{
    params.thermal.active = 1.0;
    params.thermal.winding_heat_capacity_j_per_k = 20.0;
    params.thermal.winding_thermal_resistance_k_per_w = 0.0;
    params.winding_sensor.lag_s = 0.5;
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 2.0);
    const wheel_t *wheel = &bench->wheel[0];
    /* Constant power: the temperature is a ramp of P / C, and the sensor's error is its lag times
     * P / C. */
    const double slope_k_per_s = wheel->totals.copper_j / bench->time_s / 20.0;
    TEST_ASSERT_TRUE(slope_k_per_s > 3.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.3 * slope_k_per_s, 0.5 * slope_k_per_s,
                              wheel->winding.temperature_c - wheel->winding_sensor.reported_c);
}

/* A stop from 10 m/s on ice with twice the torque that it takes. */
static void brake_on_ice(double active)
{
    params.road.friction = 0.1;
    params.driver.brake_demand_nm = 80.0;
    params.wheel_speed.teeth = 96.0;
    params.wheel_speed.clock_s = 1e-5;
    params.wheel_speed.lowest_rad_per_s = 2.0;
    params.anti_lock.active = active;
}

void test_anti_lock_on_ice_keeps_wheels_turning_and_shortens_the_stop(void)
{
    double way_m[2];
    for (int active = 0; active < 2; active++) {
        brake_on_ice(active);
        bench_t *bench = fixture_start(&params, &config);
        double slowest_share = 1.0;
        double torque_nm = 0.0;
        int steps = 0;
        bench->params.run.stop_at_standstill = 1.0;
        while (!bench_has_ended(bench) && steps < 600000) {
            bench_period(bench);
            steps++;
            for (int k = 0; k < 4 && bench->vehicle.speed_m_per_s > 2.5; k++) {
                slowest_share = fmin(slowest_share, bench->wheel[k].motion.speed_rad_s * 0.25 /
                                                        bench->vehicle.speed_m_per_s);
            }
            if (bench->time_s > 0.5 && bench->vehicle.speed_m_per_s > 2.0) {
                torque_nm =
                    fmax(torque_nm, fabs(1e-3 * bench->wheel[0].slow.motor_torque_estimate_mNm));
            }
        }
        way_m[active] = bench->vehicle.distance_m;
        TEST_ASSERT_TRUE(active == 1 ? slowest_share > 0.6 : slowest_share <= 0.0);
        TEST_ASSERT_TRUE(active == 0 ||
                         torque_nm < 1.0); /* the flag sets the motor torque to zero */
        TEST_ASSERT_TRUE(residual(bench) < 1e-6);
    }
    TEST_ASSERT_TRUE(way_m[1] < 0.97 * way_m[0]);
}

void test_anti_lock_is_never_active_on_dry_road(void)
{
    brake_on_ice(1.0);
    params.road.friction = 1.0;
    bench_t *bench = fixture_start(&params, &config);
    for (int k = 0; k < 40000; k++) {
        bench_period(bench);
        TEST_ASSERT_FALSE(bench->abs_unit.anti_lock.at_work);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 80.0, mean_brake_nm(bench));
}

void test_dead_wheel_sensor_switches_anti_lock_off_and_all_brakes_act(void)
{
    brake_on_ice(1.0);
    params.road.friction = 1.0;
    params.driver.brake_demand_nm = 50.0;
    params.run.initial_speed_m_per_s = 14.0;
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.5);
    bench->params.wheel[2].speed_sensor_dead = 1.0;
    bench_refresh(bench);
    fixture_run(bench, 0.5);
    TEST_ASSERT_TRUE(bench->abs_unit.anti_lock.at_work); /* the wheel counts as locked */
    TEST_ASSERT_TRUE(bench->wheel[2].brake_capacity_nm < 1.0);
    fixture_run(bench, 2.7);
    TEST_ASSERT_TRUE(bench->abs_unit.anti_lock.failed);
    TEST_ASSERT_FALSE(bench->abs_unit.anti_lock.at_work);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 50.0, mean_brake_nm(bench));
}
