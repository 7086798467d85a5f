/* SPDX-License-Identifier: Apache-2.0 */
/* The wheel's torque follows the demand: both directions, all speeds, ideal angle and hall sensors.
 */
#include <math.h>
#include <stdio.h>

#include "unity.h"
#include "vehicle_fixture.h"

void setUp(void) {}

void tearDown(void) {}

/* Mean airgap torque over a time at constant speed, as on a test bench. */
static double torque_at_speed_nm(bench_t *bench, double time_s)
{
    const double before_nms = bench->wheel[0].totals.torque_impulse_nms;
    const double speed = bench->vehicle.speed_m_per_s;
    const double until_s = bench->time_s + time_s - 1e-9;
    while (bench->time_s < until_s) {
        bench_period(bench);
        bench->vehicle.speed_m_per_s = speed;
        bench->vehicle.acceleration_m_per_s2 = 0.0;
    }
    return (bench->wheel[0].totals.torque_impulse_nms - before_nms) / time_s;
}

static bench_t *at_speed(double rpm, int32_t sensor)
{
    bench_params_t params = fixture_quarter_vehicle();
    params.run.initial_speed_m_per_s = rpm * PLANT_TWO_PI / 60.0 * params.vehicle.wheel_radius_m;
    const config_t config = fixture_config_with_sensor(CONFIG_STRATEGY_SERIES_OPTIMAL, sensor);
    return fixture_start(&params, &config);
}

static void follows(int32_t sensor, double tolerance_nm)
{
    const double speeds_rpm[] = {60.0, 200.0, 400.0};
    const double torques_nm[] = {8.0, 20.0, 35.0, -20.0};
    for (int s = 0; s < 3; s++) {
        for (int t = 0; t < 4; t++) {
            bench_t *bench = at_speed(speeds_rpm[s], sensor);
            bench->params.driver.drive_demand_nm = torques_nm[t];
            torque_at_speed_nm(bench, 0.3);
            const double torque_nm = torque_at_speed_nm(bench, 0.2);
            char text[96];
            snprintf(text, sizeof(text), "%g N m at %g r/min", torques_nm[t], speeds_rpm[s]);
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(tolerance_nm, torques_nm[t], torque_nm, text);
            /* The controller's torque estimate against the plant's torque. */
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(tolerance_nm, torque_nm,
                                              1e-3 * bench->wheel[0].slow.motor_torque_estimate_mNm,
                                              text);
        }
    }
}

void test_torque_follows_the_demand_with_an_ideal_angle(void)
{
    follows(CONFIG_ROTOR_ANGLE, 0.3); /* one per cent of the rated 30 N m */
}

void test_torque_follows_the_demand_with_hall_sensors(void)
{
    follows(CONFIG_ROTOR_HALL, 0.3);
}

void test_torque_rises_no_faster_than_the_configured_rate(void)
{
    bench_t *bench = at_speed(200.0, CONFIG_ROTOR_ANGLE);
    bench->params.driver.drive_demand_nm = 36.0;
    const double rate_nm_per_s = 1e-3 * bench->config.brake.torque_rate_mNm_s;
    const double after_half_nm = torque_at_speed_nm(bench, 0.5 * 36.0 / rate_nm_per_s) * 2.0;
    TEST_ASSERT_DOUBLE_WITHIN(3.0, 18.0, after_half_nm); /* a ramp's mean is half its end */
    torque_at_speed_nm(bench, 0.1);
    TEST_ASSERT_DOUBLE_WITHIN(0.4, 36.0, torque_at_speed_nm(bench, 0.1));
}

void test_the_bus_current_estimate_is_the_battery_current(void)
{
    const double torques_nm[] = {30.0, -30.0};
    for (int t = 0; t < 2; t++) {
        bench_t *bench = at_speed(350.0, CONFIG_ROTOR_ANGLE);
        bench->params.driver.drive_demand_nm = torques_nm[t];
        torque_at_speed_nm(bench, 0.3);
        /* The estimate is of the motor's terminals, without the bridge's losses (40 W at 53 V).
         */
        TEST_ASSERT_DOUBLE_WITHIN(1.5, bench->battery.current_a,
                                  1e-3 * bench->wheel[0].slow.bus_current_mA);
    }
}

void test_vehicle_starts_from_standstill_with_hall_sensors_at_any_rotor_position(void)
{
    for (int k = 0; k < 12; k++) {
        bench_params_t params = fixture_quarter_vehicle();
        params.driver.drive_demand_nm = 15.0;
        params.run.rotor_turn = k / 12.0;
        const config_t config =
            fixture_config_with_sensor(CONFIG_STRATEGY_SERIES_OPTIMAL, CONFIG_ROTOR_HALL);
        bench_t *bench = fixture_start(&params, &config);
        fixture_run(bench, 1.5);
        /* 15 N m on a quarter of 660 kg at 0.25 m: 0.364 m/s^2, less what the sectors' middle costs
         * at first */
        TEST_ASSERT_TRUE(bench->vehicle.speed_m_per_s > 0.45);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, bench->wheel[0].first_fault);
    }
}

void test_noise_and_misplaced_halls_cause_no_fault_and_little_energy_loss(void)
{
    double stored_j[2];
    for (int n = 0; n < 2; n++) {
        bench_params_t params = fixture_quarter_vehicle();
        params.run.initial_speed_m_per_s = 8.0;
        params.driver.brake_demand_nm = 30.0;
        if (n == 1) {
            params.sensors.current_noise_a = 0.8;
            params.sensors.bus_voltage_noise_v = 0.1;
            params.sensors.hall_edge_error_deg = 3.0;
        }
        const config_t config =
            fixture_config_with_sensor(CONFIG_STRATEGY_SERIES_OPTIMAL, CONFIG_ROTOR_HALL);
        bench_t *bench = fixture_start(&params, &config);
        fixture_run_to_standstill(bench, 30.0);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, bench->wheel[0].first_fault);
        stored_j[n] = -bench_ledger(bench).chemical_j;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * stored_j[0], stored_j[0], stored_j[1]);
}
