/* SPDX-License-Identifier: Apache-2.0 */
/* Wheels with slip: momentum, energy, locking, split friction, and the limit of high friction. */
#include "bench/bench.h"

#include <math.h>

#include "unity.h"
#include "vehicle_fixture.h"

static bench_params_t params;
static config_t config;

void setUp(void)
{
    params = fixture_vehicle();
    params.run.initial_speed_m_per_s = 10.0;
    params.driver.brake_demand_nm = 100.0;
    params.road.friction = 1.0;
    config = fixture_config(CONFIG_STRATEGY_SERIES_OPTIMAL);
}

void tearDown(void) {}

static double residual(const bench_t *bench)
{
    const ledger_t ledger = bench_ledger(bench);
    return fabs(ledger.residual_j) / ledger.turned_over_j;
}

void test_momentum_change_equals_the_impulse_of_motors_brakes_and_road(void)
{
    params.road.air_density_kg_per_m3 = 1.2;
    params.road.slope = 0.03;
    bench_t *bench = fixture_start(&params, &config);
    const double radius_m = params.vehicle.wheel_radius_m;
    const double inertia = params.chassis.wheel_inertia_kg_m2;
    const double body_kg = params.vehicle.mass_kg - 4.0 * inertia / (radius_m * radius_m);
    const double before = bench->vehicle.speed_m_per_s;
    double rims = 0.0;
    double torque_before_nms = 0.0;
    for (int k = 0; k < 4; k++) {
        rims -= inertia * bench->wheel[k].motion.speed_rad_s / radius_m;
        torque_before_nms += bench->wheel[k].totals.torque_impulse_nms -
                             bench->wheel[k].totals.hydraulic_impulse_nms;
    }
    /* Air and slope: independent of the bench's own accounts, from the speed alone (trapezoids). */
    double road_ns = 0.0;
    for (int n = 0; n < 20000; n++) {
        const double v0 = bench->vehicle.speed_m_per_s;
        bench_period(bench);
        const double v1 = bench->vehicle.speed_m_per_s;
        road_ns += 50e-6 * (0.5 * 1.2 * 0.4 * 1.4 * 0.5 * (v0 * v0 + v1 * v1) +
                            660.0 * 9.81 * 0.03 / sqrt(1.0009));
    }
    double torque_nms = -torque_before_nms;
    for (int k = 0; k < 4; k++) {
        rims += inertia * bench->wheel[k].motion.speed_rad_s / radius_m;
        torque_nms += bench->wheel[k].totals.torque_impulse_nms -
                      bench->wheel[k].totals.hydraulic_impulse_nms;
    }
    const double change_ns = body_kg * (bench->vehicle.speed_m_per_s - before) + rims;
    TEST_ASSERT_TRUE(change_ns < -1000.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * fabs(change_ns), torque_nms / radius_m - road_ns, change_ns);
}

void test_momentum_balance_closes_for_rolling_wheels(void)
{
    params.road.friction = 0.0;
    bench_t *bench = fixture_start(&params, &config);
    const double before = bench->vehicle.speed_m_per_s;
    fixture_run(bench, 1.0);
    double torque_nms = 0.0;
    for (int k = 0; k < 4; k++) {
        torque_nms += bench->wheel[k].totals.torque_impulse_nms -
                      bench->wheel[k].totals.hydraulic_impulse_nms;
    }
    const double change_ns = 660.0 * (bench->vehicle.speed_m_per_s - before);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * fabs(change_ns), torque_nms / 0.25, change_ns);
}

void test_energy_balance_closes_for_slipping_wheels(void)
{
    params.wheel[0].road_friction = 0.15;
    params.driver.brake_demand_nm = 250.0;
    params.bus.capacitance_f = 4e-3;
    params.bus.cable_resistance_ohm = 0.002;
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.5);
    bench->params.driver.brake_demand_nm = 0.0;
    bench->params.driver.drive_demand_nm = 40.0;
    fixture_run(bench, 0.5);
    const ledger_t ledger = bench_ledger(bench);
    TEST_ASSERT_TRUE(ledger.tyre_j > 1000.0);
    TEST_ASSERT_TRUE(residual(bench) < 1e-5);
}

void test_high_friction_gives_the_result_of_rolling_wheels(void)
{
    params.road.friction = 3.0;
    params.tyre.bristle_stiffness_per_m = 2000.0;
    bench_t *bench = fixture_start(&params, &config);
    fixture_run_to_standstill(bench, 10.0);
    const double slipping_m = bench->vehicle.distance_m;
    const double returned_j = bench_ledger(bench).chemical_j;
    params.road.friction = 0.0;
    bench = fixture_start(&params, &config);
    fixture_run_to_standstill(bench, 10.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * slipping_m, bench->vehicle.distance_m, slipping_m);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * fabs(returned_j), bench_ledger(bench).chemical_j, returned_j);
}

void test_on_split_friction_the_wheels_on_ice_lock_and_the_others_roll(void)
{
    params.wheel[0].road_friction = 0.1;
    params.wheel[2].road_friction = 0.1;
    params.driver.brake_demand_nm = 200.0;
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 1.0);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, bench->wheel[0].motion.speed_rad_s);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, bench->wheel[2].motion.speed_rad_s);
    const double rolling = bench->vehicle.speed_m_per_s / 0.25;
    TEST_ASSERT_TRUE(rolling > 10.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.1 * rolling, rolling, bench->wheel[1].motion.speed_rad_s);
    TEST_ASSERT_TRUE(bench->wheel[0].motion.force_n > -0.1 * bench->wheel[0].motion.load_n);
    TEST_ASSERT_TRUE(residual(bench) < 1e-5);
}

void test_change_to_ice_acts_on_the_tyre_force_at_once(void)
{
    params.driver.brake_demand_nm = 200.0;
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.4);
    const double before = bench->vehicle.acceleration_m_per_s2;
    TEST_ASSERT_TRUE(before < -3.0);
    bench->params.road.friction = 0.1;
    bench_refresh(bench);
    fixture_run(bench, 0.3);
    TEST_ASSERT_TRUE(bench->vehicle.acceleration_m_per_s2 > -0.1 * 9.81);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, bench->wheel[1].motion.speed_rad_s);
}

void test_braked_wheels_stand_still_on_a_slope(void)
{
    params.run.initial_speed_m_per_s = 0.0;
    params.road.slope = 0.1; /* 160 N a wheel, 40 N m */
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 2.0);
    const double settled_m = bench->vehicle.distance_m;
    fixture_run(bench, 2.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, settled_m, bench->vehicle.distance_m);
}

void test_wheel_slip_is_selected_before_the_run_and_requires_tyre_data(void)
{
    bench_t *bench = fixture_start(&params, &config);
    bench_params_t changed = bench->params;
    changed.road.friction = 0.3;
    TEST_ASSERT_NULL(bench_objection(bench, &changed));
    changed.road.friction = 0.0;
    TEST_ASSERT_NOT_NULL(bench_objection(bench, &changed));
    params.tyre.bristle_stiffness_per_m = 0.0;
    TEST_ASSERT_NOT_NULL(motion_objection(&params));
    params.road.friction = 0.0;
    TEST_ASSERT_NULL(motion_objection(&params));
}

void test_energy_residual_is_below_1e_4_with_every_effect_on(void)
{
    params.road.friction = 0.9;
    params.wheel[0].road_friction = 0.3;
    params.road.slope = -0.03;
    params.road.wind_m_per_s = 5.0;
    params.road.air_density_kg_per_m3 = 1.2;
    params.vehicle.rolling_resistance = 0.014;
    params.bus.capacitance_f = 4e-3;
    params.bus.cable_resistance_ohm = 0.002;
    params.bms.period_s = 0.1;
    params.thermal.active = 1.0;
    params.inverter.switch_resistance_temperature_coefficient_per_k = 0.005;
    params.brake.knee_torque_nm = 10.0;
    params.brake.knee_rate_nm_per_s = 200.0;
    params.motor.friction_torque_nm = 0.3;
    params.motor.viscous_friction_nm_s = 0.005;
    params.sensors.current_drift_a_per_s = 0.2;
    params.motor.d_saturation_current_a = 120.0;
    params.motor.q_saturation_current_a = 100.0;
    params.motor.cross_saturation = 0.5;
    params.motor.magnet_bias_current_a = 20.0;
    params.motor.cogging_torque_nm = 0.6;
    params.motor.cogging_per_turn = 276.0;
    params.sensors.sampling_delay_s = 0.5e-6;
    params.sensors.shunt_settling_s = 0.3e-6;
    params.winding_sensor.lag_s = 2.0;
    params.wheel_speed.teeth = 96.0;
    params.anti_lock.active = 1.0;
    params.driver.brake_demand_nm = 80.0;
    for (int k = 0; k < 2; k++) {
        params.inverter.switching = k;
        bench_t *bench = fixture_start(&params, &config);
        fixture_run(bench, 0.5);
        bench->params.bus.contactor_open = 1.0; /* and the bridge goes off on its diodes */
        bench_refresh(bench);
        fixture_run(bench, 0.2);
        const ledger_t ledger = bench_ledger(bench);
        TEST_ASSERT_TRUE(ledger.turned_over_j > 5000.0);
        TEST_ASSERT_TRUE(ledger.tyre_j > 50.0 && ledger.cable_j > 5.0 && ledger.bearing_j > 5.0);
        TEST_ASSERT_TRUE(residual(bench) < 1e-4);
    }
}
