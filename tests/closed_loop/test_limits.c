/* SPDX-License-Identifier: Apache-2.0 */
/* Limits in closed loop: full battery, weak battery, hot winding, speeds above base speed, a fault
 * at speed. */
#include <math.h>

#include "unity.h"
#include "vehicle_fixture.h"

void setUp(void) {}

void tearDown(void) {}

void test_with_a_full_battery_the_hydraulic_brake_takes_over_with_its_reason(void)
{
    bench_params_t params = fixture_quarter_vehicle();
    params.run.initial_speed_m_per_s = 9.0;
    params.battery.initial_soc = 1.0;
    params.driver.brake_demand_nm = 40.0;
    config_t config = fixture_config(CONFIG_STRATEGY_SERIES_OPTIMAL);
    config.brake.loss_braking = 0;
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.5);
    TEST_ASSERT_EQUAL_INT(REASON_CHARGE_CURRENT, bench->wheel[0].slow.available_reason);
    fixture_run_to_standstill(bench, 30.0);
    const ledger_t ledger = bench_ledger(bench);
    /* Iron loss brakes in any case. The hydraulic brake has the rest, and the cells are not
     * charged.
     */
    TEST_ASSERT_TRUE(ledger.hydraulic_j + ledger.iron_j > 0.99 * bench->kinetic_before_j);
    TEST_ASSERT_TRUE(ledger.hydraulic_j > 0.9 * bench->kinetic_before_j);
    TEST_ASSERT_TRUE(-ledger.chemical_j < 0.001 * bench->kinetic_before_j);
    /* As quick a stop as with an empty battery: v^2/2a and 0.15 s for the brakes to come. */
    const double ideal_m = 81.0 / (2.0 * 4.0 * 40.0 / 0.25 / 660.0);
    TEST_ASSERT_TRUE(bench->vehicle.distance_m < ideal_m + 0.15 * 9.0);
}

void test_weak_battery_stays_above_min_voltage(void)
{
    bench_params_t params = fixture_vehicle();
    params.run.initial_speed_m_per_s = 3.0;
    params.driver.drive_demand_nm = 40.0;
    params.battery.series_resistance_ohm = 0.5; /* 40 N m a wheel would take it below 35 V */
    const config_t config = fixture_config(CONFIG_STRATEGY_SERIES_OPTIMAL);
    bench_t *bench = fixture_start(&params, &config);
    double lowest_v = 1e9;
    for (int k = 0; k < 300; k++) {
        fixture_run(bench, 0.01);
        lowest_v = fmin(lowest_v, bench->battery.terminal_v);
    }
    TEST_ASSERT_TRUE(lowest_v < 42.0); /* it was asked for more than the pack has */
    TEST_ASSERT_TRUE(lowest_v > 0.97 * 1e-3 * config.battery.min_voltage_mV);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, bench->wheel[0].first_fault);
    TEST_ASSERT_FALSE(bench->battery.collapsed);
}

/* A pack of 1 ohm at 40 to 41 V: without an integrator the fold-back's gain of 214 A/V and a delay
 * of 1 ms would give a limit cycle of one step of the torque rate, 0.4 Nm. */
void test_weak_battery_current_has_no_limit_cycle(void)
{
    bench_params_t params = fixture_vehicle();
    params.run.initial_speed_m_per_s = 3.0;
    params.driver.drive_demand_nm = 40.0;
    params.battery.series_resistance_ohm = 1.0;
    const config_t config = fixture_config(CONFIG_STRATEGY_SERIES_OPTIMAL);
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 1.0);
    double largest_nm = 0.0;
    for (int k = 0; k < 500; k++) {
        const int32_t before_mNm = bench->wheel[0].slow.motor_torque_command_mNm;
        fixture_run(bench, 1e-3);
        largest_nm = fmax(largest_nm, 1e-3 * fabs(bench->wheel[0].slow.motor_torque_command_mNm -
                                                  (double)before_mNm));
    }
    TEST_ASSERT_EQUAL_INT(REASON_BUS_VOLTAGE_LOW, bench->wheel[0].slow.torque_reason);
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 40.3, bench->battery.terminal_v);
    TEST_ASSERT_TRUE(largest_nm <
                     0.04); /* a tenth of what the rate allows; the rising speed takes some of it */
    TEST_ASSERT_EQUAL_INT(REASON_NONE, bench->wheel[0].first_fault);
}

void test_at_the_winding_limit_the_motor_has_no_current_and_the_hydraulic_brake_acts(void)
{
    bench_params_t params = fixture_quarter_vehicle();
    params.run.initial_speed_m_per_s = 8.0;
    params.thermal.winding_temperature_c = 150.0;
    params.driver.brake_demand_nm = 40.0;
    const config_t config = fixture_config(CONFIG_STRATEGY_SERIES_OPTIMAL);
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.5);
    TEST_ASSERT_EQUAL_INT(REASON_WINDING_TEMPERATURE, bench->wheel[0].slow.available_reason);
    TEST_ASSERT_INT32_WITHIN(500, 0, bench->wheel[0].slow.i_q_mA);
    const double motor_nm = -1e-3 * bench->wheel[0].slow.motor_torque_command_mNm; /* iron loss */
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 40.0 - motor_nm, bench->wheel[0].brake_capacity_nm);
}

/* 60 km/h is 636 r/min: 54.1 V of EMF between lines, more than the battery has. */
void test_braking_above_base_speed_follows_the_demand(void)
{
    bench_params_t params = fixture_quarter_vehicle();
    params.run.initial_speed_m_per_s = 60.0 / 3.6;
    params.driver.brake_demand_nm = 20.0;
    const config_t config = fixture_config(CONFIG_STRATEGY_SERIES_OPTIMAL);
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.5);
    const double before_nms = bench->wheel[0].totals.torque_impulse_nms;
    fixture_run(bench, 0.5);
    TEST_ASSERT_DOUBLE_WITHIN(0.6, -20.0,
                              (bench->wheel[0].totals.torque_impulse_nms - before_nms) / 0.5);
    fixture_run_to_standstill(bench, 60.0);
    const ledger_t ledger = bench_ledger(bench);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, bench->wheel[0].first_fault);
    TEST_ASSERT_TRUE(-ledger.chemical_j > 0.7 * bench->kinetic_before_j);
    TEST_ASSERT_TRUE(fabs(ledger.residual_j) < 1e-4 * ledger.turned_over_j);
}

void test_freewheel_below_base_speed_leaves_only_the_iron_drag(void)
{
    bench_params_t params = fixture_quarter_vehicle();
    params.run.initial_speed_m_per_s = 10.0;
    params.driver.drive_demand_nm = 20.0;
    const config_t config = fixture_config(CONFIG_STRATEGY_SERIES_OPTIMAL);
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.3);
    bench->wheel[0].winding.temperature_c = 290.0; /* a fault: the bridge freewheels */
    fixture_run(bench, 0.2);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, bench->wheel[0].active.bridge);
    const ledger_t before = bench_ledger(bench);
    fixture_run(bench, 0.5);
    const ledger_t after = bench_ledger(bench);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, after.copper_j - before.copper_j);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, after.chemical_j - before.chemical_j);
    /* Only iron loss brakes: 1.5 (w psi)^2 / R_i, reduced by the iron branch's inductance drop. */
    const double w = bench_wheel_speed_rad_s(bench) * 23.0;
    const double r_i = 1.5 + 0.006 * w;
    const double iron_w = 1.5 * w * w * 0.0204 * 0.0204 / r_i;
    TEST_ASSERT_DOUBLE_WITHIN(0.05 * iron_w, iron_w, (after.iron_j - before.iron_j) / 0.5);
    TEST_ASSERT_TRUE(fabs(after.residual_j) < 1e-4 * after.turned_over_j);
}
