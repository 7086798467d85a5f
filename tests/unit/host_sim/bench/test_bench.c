/* SPDX-License-Identifier: Apache-2.0 */
/* The whole vehicle: start of a run, energy balance, reproducibility. */
#include "bench/bench.h"

#include <math.h>

#include "unity.h"
#include "vehicle_fixture.h"

static bench_params_t params;
static config_t config;

void setUp(void)
{
    params = fixture_vehicle();
    config = fixture_config(CONFIG_STRATEGY_SERIES_OPTIMAL);
}

void tearDown(void) {}

void test_run_begins_at_speed_with_running_controllers_and_zero_accounts(void)
{
    params.run.initial_speed_m_per_s = 11.0;
    const bench_t *bench = fixture_start(&params, &config);
    TEST_ASSERT_EQUAL_DOUBLE(11.0, bench->vehicle.speed_m_per_s);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, bench->time_s);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, bench->vehicle.distance_m);
    TEST_ASSERT_EQUAL_DOUBLE(params.battery.initial_soc, bench->battery.soc);
    const ledger_t ledger = bench_ledger(bench);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, ledger.chemical_j);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, ledger.kinetic_j);
    TEST_ASSERT_TRUE(pmsm_magnetic_energy_j(&bench->wheel[0].machine, &bench->wheel[0].rotor) >
                     1e-5);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, ledger.magnetic_j);
    for (int k = 0; k < 4; k++) {
        TEST_ASSERT_EQUAL_INT(MODE_RUN, bench->wheel[k].slow.mode);
        TEST_ASSERT_DOUBLE_WITHIN(0.05 * 44.0, 44.0,
                                  1e-3 * bench->wheel[k].slow.speed_mrad_s); /* 11 m/s on 0.25 m */
    }
}

void test_driving_in_reverse_is_symmetric_to_driving_forward(void)
{
    params.run.initial_speed_m_per_s = -5.0;
    params.driver.brake_demand_nm = 30.0;
    bench_t *bench = fixture_start(&params, &config);
    fixture_run_to_standstill(bench, 10.0);
    /* v^2/2a, a = 4 * 30 / 0.25 / 660, and the time the brakes need to act */
    TEST_ASSERT_DOUBLE_WITHIN(1.0, -25.0 / (2.0 * 0.7273), bench->vehicle.distance_m);
    const ledger_t now = bench_ledger(bench);
    TEST_ASSERT_TRUE(bench_braking_ledger(bench, &now).chemical_j < 0.0);
}

void test_energy_balance_closes_while_driving_braking_and_climbing(void)
{
    params.road.slope = 0.02;
    params.road.air_density_kg_per_m3 = 1.2;
    params.vehicle.rolling_resistance = 0.014;
    params.motor.friction_torque_nm = 0.4;
    params.motor.viscous_friction_nm_s = 0.01;
    params.run.initial_speed_m_per_s = 5.0;
    params.driver.drive_demand_nm = 35.0;
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 1.0);
    bench->params.driver.brake_demand_nm = 60.0;
    fixture_run(bench, 1.0);
    bench->params.driver.brake_demand_nm = 0.0;
    fixture_run(bench, 0.5);
    const ledger_t ledger = bench_ledger(bench);
    TEST_ASSERT_TRUE(ledger.turned_over_j > 5000.0);
    TEST_ASSERT_TRUE(ledger.bearing_j > 10.0 && ledger.hydraulic_j > 100.0 &&
                     ledger.climbed_j > 100.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.0, ledger.residual_j / ledger.turned_over_j);
    /* What the motors did at the wheels, bearings taken off, is what became of it there. */
    const double at_wheels_j =
        ledger.hydraulic_j + ledger.drag_j + ledger.rolling_j + ledger.climbed_j + ledger.kinetic_j;
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * ledger.turned_over_j, at_wheels_j, ledger.shaft_j);
}

/* 5 m/s down 10 % for a second: m g h = 660 * 9.81 * 5 * 0.0995 = 3221 J, and more as it gains
 * speed. */
void test_energy_balance_of_a_descent_contains_the_potential_energy(void)
{
    params.road.slope = -0.1;
    params.run.initial_speed_m_per_s = 5.0;
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 1.0);
    const ledger_t ledger = bench_ledger(bench);
    TEST_ASSERT_TRUE(-ledger.climbed_j > 3221.0);
    TEST_ASSERT_TRUE(ledger.turned_over_j >= -ledger.climbed_j);
    TEST_ASSERT_TRUE(ledger.turned_over_j < -1.1 * ledger.climbed_j);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.0, ledger.residual_j / ledger.turned_over_j);
}

void test_braking_accounts_cover_the_time_with_the_brake_pedal_pressed(void)
{
    params.run.initial_speed_m_per_s = 8.0;
    bench_t *bench = fixture_start(&params, &config);
    bench->params.driver.drive_demand_nm = 20.0;
    fixture_run(bench, 0.3);
    const ledger_t before = bench_ledger(bench);
    bench->params.driver.brake_demand_nm = 30.0;
    fixture_run(bench, 0.7);
    const ledger_t after = bench_ledger(bench);
    bench->params.driver.brake_demand_nm = 0.0;
    fixture_run(bench, 0.4);
    const ledger_t now = bench_ledger(bench);
    const ledger_t braking = bench_braking_ledger(bench, &now);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, after.copper_j - before.copper_j, braking.copper_j);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, after.chemical_j - before.chemical_j, braking.chemical_j);
    TEST_ASSERT_TRUE(bench_ledger(bench).chemical_j > after.chemical_j);
}

void test_the_same_parameters_give_the_same_bytes_and_another_seed_others(void)
{
    params.run.initial_speed_m_per_s = 6.0;
    params.sensors.current_noise_a = 0.5;
    params.driver.brake_demand_nm = 25.0;
    ledger_t end[3];
    const double seeds[3] = {5.0, 5.0, 6.0};
    for (int k = 0; k < 3; k++) {
        params.run.seed = seeds[k];
        bench_t *bench = fixture_start(&params, &config);
        fixture_run(bench, 0.5);
        end[k] = bench_ledger(bench);
    }
    TEST_ASSERT_EQUAL_MEMORY(&end[0], &end[1], sizeof(ledger_t));
    TEST_ASSERT_TRUE(end[0].chemical_j != end[2].chemical_j);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * fabs(end[0].chemical_j), end[0].chemical_j, end[2].chemical_j);
}

void test_a_change_of_parameters_during_the_run_takes_effect_after_a_refresh(void)
{
    params.run.initial_speed_m_per_s = 10.0;
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.1);
    const double flat = bench->vehicle.acceleration_m_per_s2;
    bench->params.road.slope = 0.10;
    bench_refresh(bench);
    fixture_run(bench, 0.1);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, flat - 9.81 * 0.10 / sqrt(1.01),
                              bench->vehicle.acceleration_m_per_s2);
}

void test_controller_that_does_not_reach_ready_is_reported_and_not_run(void)
{
    params.sensors.current_offset_a = 60.0; /* more than any healthy sensor has */
    const driver_trace_t none = {.points = 0};
    static bench_t bench;
    bench_init(&bench, &params, &config, &none);
    TEST_ASSERT_EQUAL_INT(BENCH_NOT_RUN, bench_start(&bench));
}

void test_a_winding_time_constant_below_the_resolution_of_the_period_is_refused(void)
{
    params.motor.phase_resistance_ohm = 2.0; /* 2 ohm * 50 us against 76 uH */
    const driver_trace_t none = {.points = 0};
    static bench_t bench;
    bench_init(&bench, &params, &config, &none);
    TEST_ASSERT_EQUAL_INT(BENCH_UNRESOLVED, bench_start(&bench));
}
