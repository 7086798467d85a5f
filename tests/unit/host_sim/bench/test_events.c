/* SPDX-License-Identifier: Apache-2.0 */
/* Events during a run, each set by a parameter, and the reaction of the firmware. */
#include "bench/bench.h"

#include <math.h>

#include "unity.h"
#include "vehicle_fixture.h"

static bench_params_t params;
static config_t config;

void setUp(void)
{
    params = fixture_quarter_vehicle();
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

void test_contactor_opening_at_full_regeneration_raises_the_bus_until_the_bridge_opens(void)
{
    params.bus.capacitance_f = 1e-3;
    params.bus.cable_resistance_ohm = 0.002;
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.5);
    TEST_ASSERT_TRUE(bench->battery.current_a < -20.0);
    const double power_w = -bench->battery.current_a * bench->bus.voltage_v;
    const double before_v = bench->bus.voltage_v;
    bench->params.bus.contactor_open = 1.0;
    bench_refresh(bench);
    bench_period(bench);
    /* C (v^2 - v0^2) / 2 = P t */
    TEST_ASSERT_DOUBLE_WITHIN(0.1, sqrt(before_v * before_v + 2.0 * power_w * 50e-6 / 1e-3),
                              bench->bus.voltage_v);
    double highest_v = 0.0;
    for (int k = 0; k < 2000; k++) {
        bench_period(bench);
        highest_v = fmax(highest_v, bench->bus.voltage_v);
    }
    TEST_ASSERT_EQUAL_INT(REASON_NONE, bench->wheel[0].first_fault);
    TEST_ASSERT_EQUAL_INT(MODE_LIMP, bench->wheel[0].slow.mode);
    TEST_ASSERT_TRUE(bench->wheel[0].active.bridge != BRIDGE_PWM);
    /* The battery's message, a millisecond later, or the trip, and the field's energy: below what
     * 75 V switches stand. */
    TEST_ASSERT_TRUE(highest_v > before_v + 2.0 && highest_v < 70.0);
    /* The driver still brakes: the hydraulic brake has taken over. */
    fixture_run(bench, 0.5);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 40.0, bench->wheel[0].brake_capacity_nm);
    TEST_ASSERT_TRUE(residual(bench) < 1e-5);
}

void test_a_contactor_cannot_open_where_there_is_no_capacitor(void)
{
    bench_t *bench = fixture_start(&params, &config);
    bench_params_t changed = bench->params;
    changed.bus.contactor_open = 1.0;
    TEST_ASSERT_NOT_NULL(bench_objection(bench, &changed));
    changed.bus.contactor_open = 0.0;
    TEST_ASSERT_NULL(bench_objection(bench, &changed));
    changed.bus.capacitance_f = 1e-3;
    TEST_ASSERT_NOT_NULL(bench_objection(bench, &changed));
}

void test_demand_age_grows_without_can_frames(void)
{
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.3);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, bench->demand_age_s);
    bench->params.driver.silent = 1.0;
    bench->params.driver.brake_demand_nm = 10.0; /* not received */
    fixture_run(bench, 0.05);
    TEST_ASSERT_DOUBLE_WITHIN(1.1e-3, 0.05, bench->demand_age_s);
    TEST_ASSERT_EQUAL_DOUBLE(40.0, bench->demand.brake_nm);
    bench->params.driver.silent = 0.0;
    fixture_run(bench, 0.002);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, bench->demand_age_s);
    TEST_ASSERT_EQUAL_DOUBLE(10.0, bench->demand.brake_nm);
}

/* How often, in how many milliseconds, a new demand comes; the driver wants another one in each. */
static int demands_in(bench_t *bench, int milliseconds, double *oldest_s)
{
    int out = 0;
    *oldest_s = 0.0;
    for (int ms = 0; ms < milliseconds; ms++) {
        const double before_nm = bench->demand.brake_nm;
        bench->params.driver.brake_demand_nm += 0.01;
        fixture_run(bench, 0.001);
        out += bench->demand.brake_nm != before_nm ? 1 : 0;
        *oldest_s = fmax(*oldest_s, bench->demand_age_s);
    }
    return out;
}

void test_demands_come_once_a_period_and_grow_old_between(void)
{
    params.driver.demand_period_s = 0.02;
    bench_t *bench = fixture_start(&params, &config);
    double oldest_s;
    TEST_ASSERT_INT_WITHIN(1, 20, demands_in(bench, 400, &oldest_s));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.019, oldest_s);
}

void test_jitter_makes_each_period_longer_by_up_to_its_size(void)
{
    params.driver.demand_period_s = 0.01;
    params.driver.demand_jitter_s = 0.01;
    bench_t *bench = fixture_start(&params, &config);
    double oldest_s;
    /* 15 ms and the rest of a millisecond in the mean; four standard errors of a uniform one. */
    const double periods = 1500.0 / 15.5;
    const double deviation = 10.0 / sqrt(12.0) * sqrt(periods) / 15.5;
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * deviation, periods, demands_in(bench, 1500, &oldest_s));
    TEST_ASSERT_TRUE(oldest_s > 0.017 && oldest_s < 0.02 + 1e-9);
}

void test_failed_brake_of_one_wheel_does_not_affect_the_others(void)
{
    params = fixture_vehicle();
    params.run.initial_speed_m_per_s = 10.0;
    params.driver.brake_demand_nm = 100.0;
    bench_t *bench = fixture_start(&params, &config);
    bench->params.wheel[2].brake_torque_loss = 1.0;
    bench_refresh(bench);
    fixture_run(bench, 0.5);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, bench->wheel[2].brake_capacity_nm);
    TEST_ASSERT_TRUE(bench->wheel[1].brake_capacity_nm > 50.0);
    TEST_ASSERT_TRUE(residual(bench) < 1e-5);
}

void test_a_current_sensor_that_drifts_after_calibration_is_off_by_rate_times_time(void)
{
    params.driver.brake_demand_nm = 0.0;
    params.sensors.current_drift_a_per_s = 2.0;
    bench_t *bench = fixture_start(&params, &config);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, bench->wheel[0].fault.offset_a);
    fixture_run(bench, 0.5);
    TEST_ASSERT_DOUBLE_WITHIN(2.1e-3, 1.0, bench->wheel[0].fault.offset_a);
    bench->params.wheel[0].current_offset_a = 3.0;
    fixture_run(bench, 0.01);
    TEST_ASSERT_DOUBLE_WITHIN(2.1e-3, 4.02, bench->wheel[0].fault.offset_a);
}

void test_broken_hall_connector_is_detected_by_that_wheel_only(void)
{
    params = fixture_vehicle();
    params.run.initial_speed_m_per_s = 3.0;
    params.driver.drive_demand_nm = 20.0;
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.2);
    bench->params.wheel[1].hall_stuck_high = 7.0;
    bench_refresh(bench);
    fixture_run(bench, 0.5);
    /* The observer has taken over: a warning, no fault. */
    TEST_ASSERT_EQUAL_INT(MODE_LIMP, bench->wheel[1].slow.mode);
    TEST_ASSERT_TRUE(bench->wheel[1].slow.warning_reason != REASON_NONE);
    TEST_ASSERT_EQUAL_INT(MODE_RUN, bench->wheel[0].slow.mode);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, bench->wheel[0].slow.warning_reason);
}

void test_fixed_temperature_follows_its_parameter_during_the_run(void)
{
    bench_t *bench = fixture_start(&params, &config);
    const double cold_ohm = bench->wheel[0].machine.resistance_ohm;
    bench->params.thermal.winding_temperature_c = 100.0;
    bench->params.wheel[0].winding_rise_k = 20.0;
    bench_refresh(bench);
    TEST_ASSERT_EQUAL_DOUBLE(120.0, bench->wheel[0].winding.temperature_c);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0 + 0.00393 * 95.0,
                              bench->wheel[0].machine.resistance_ohm / cold_ohm);
}

/* ---- temperature sensors by kind, converted by the configuration's curve: an NTC, 10 kOhm ---- */

static const winding_sensor_params_t NTC = {
    .kind = 1.0, .ohm_25c = 10e3, .beta_k = 3380.0, .divider_ohm = 10e3};
/* As IEC 60751 within 0.1 K from 0 to 200 degC. */
static const winding_sensor_params_t PT1000 = {.kind = 2.0,
                                               .ohm_25c = 1097.35,
                                               .linear_per_k = 3.5353e-3,
                                               .square_per_k2 = -5.263e-7,
                                               .divider_ohm = 10e3};

static bench_t *ride_with(winding_sensor_params_t sensor, double winding_c)
{
    params.driver.brake_demand_nm = 5.0;
    params.thermal.winding_temperature_c = winding_c;
    params.winding_sensor = sensor;
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.3);
    return bench;
}

void test_a_sensor_of_the_configured_kind_is_read_within_the_error_of_its_curve(void)
{
    const double windings_c[] = {-20.0, 25.0, 80.0, 120.0};
    for (int k = 0; k < 4; k++) {
        const bench_t *bench = ride_with(NTC, windings_c[k]);
        TEST_ASSERT_DOUBLE_WITHIN(1.5, bench->wheel[0].winding.temperature_c,
                                  bench->wheel[0].winding_sensor.reported_c);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, bench->wheel[0].slow.warning_reason);
    }
}

/* PT1000 at 25 degC: 1097 Ohm, which a thermistor has at
 * 1/(1/298.15 + ln(0.1097)/3380) - 273.15 = 97.2 degC. */
void test_a_sensor_of_another_kind_shows_what_its_resistance_means_to_the_configured_one(void)
{
    const bench_t *bench = ride_with(PT1000, 25.0);
    TEST_ASSERT_DOUBLE_WITHIN(1.5, 97.2, bench->wheel[0].winding_sensor.reported_c);
}

void test_open_and_shorted_lines_of_a_sensor_are_named_in_either_divider(void)
{
    for (int to_supply = 0; to_supply < 2; to_supply++) {
        for (int open = 0; open < 2; open++) {
            winding_sensor_params_t sensor = NTC;
            sensor.to_supply = to_supply;
            bench_t *bench = ride_with(NTC, 40.0);
            sensor.open = open;
            sensor.shorted = 1 - open;
            bench->params.winding_sensor = sensor;
            bench_refresh(bench);
            fixture_run(bench, 0.2);
            TEST_ASSERT_EQUAL_DOUBLE(299.99, bench->wheel[0].winding_sensor.reported_c);
            TEST_ASSERT_TRUE(bench->wheel[0].slow.warning_reason == REASON_WINDING_SENSOR ||
                             bench->wheel[0].first_fault != REASON_NONE);
        }
    }
}

void test_a_gain_error_of_a_sensor_is_read_as_such(void)
{
    winding_sensor_params_t sensor = NTC;
    sensor.gain_error = 0.1;
    const bench_t *bench = ride_with(sensor, 80.0);
    TEST_ASSERT_DOUBLE_WITHIN(1.5, 88.0, bench->wheel[0].winding_sensor.reported_c);
}
