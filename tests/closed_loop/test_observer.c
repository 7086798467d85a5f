/* SPDX-License-Identifier: Apache-2.0 */
/* The EMF observer in closed loop: its angle against the rotor of the plant. */
#include <math.h>
#include <stdio.h>

#include "unity.h"
#include "vehicle_fixture.h"

void setUp(void) {}

void tearDown(void) {}

static const double KMH = 1.0 / 3.6;

/* Electrical degrees by which the observer's angle is ahead of the rotor; both at the next sample.
 */
static double error_deg(const bench_t *bench)
{
    const wheel_t *wheel = &bench->wheel[0];
    const double theta_turn = wheel->controller.fast.foc.observer.theta_q32 / 4294967296.0 -
                              wheel->to_fast.observer.lead_turn / 65536.0;
    return 360.0 * remainder(theta_turn - wheel->rotor.theta_turn, 1.0);
}

typedef struct {
    double above_10_deg, at_5_deg; /* largest angle errors by speed in km/h */
} errors_t;

/* A stop from 40 km/h, with a motor that has these multiples of what the controller has configured.
 */
static errors_t stop_with(const char *name, double r, double l, double psi, double demand_nm)
{
    bench_params_t params = fixture_one_wheel(fixture_drive(name));
    params.motor.phase_resistance_ohm *= r;
    params.motor.d_inductance_h *= l;
    params.motor.q_inductance_h *= l;
    params.motor.flux_linkage_wb *= psi;
    params.run.initial_speed_m_per_s = 40.0 * KMH;
    params.driver.brake_demand_nm = demand_nm;
    const config_t config = fixture_drive_config(name);
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.02);
    errors_t out = {0.0, 0.0};
    while (bench->vehicle.speed_m_per_s > 5.0 * KMH) {
        bench_period(bench);
        const double size_deg = fabs(error_deg(bench));
        double *worst =
            bench->vehicle.speed_m_per_s > 10.0 * KMH ? &out.above_10_deg : &out.at_5_deg;
        *worst = fmax(*worst, size_deg);
    }
    return out;
}

/* All corners of the three errors. ipm400v: 20 % of L_q would turn its flux by 12 degrees. */
static void assert_angle_error(const char *name, double inductance_error, double demand_nm)
{
    for (int corner = 0; corner < 8; corner++) {
        const double r = (corner & 1) != 0 ? 1.2 : 0.8;
        const double l = 1.0 + ((corner & 2) != 0 ? inductance_error : -inductance_error);
        const double psi = (corner & 4) != 0 ? 1.2 : 0.8;
        const errors_t error = stop_with(name, r, l, psi, demand_nm);
        char text[96];
        snprintf(text, sizeof(text), "R %.1f, L %.2f, psi %.1f: %.2f and %.2f degrees", r, l, psi,
                 error.above_10_deg, error.at_5_deg);
        TEST_ASSERT_TRUE_MESSAGE(error.above_10_deg < 5.0, text);
        TEST_ASSERT_TRUE_MESSAGE(error.at_5_deg < 10.0, text);
    }
}

void test_angle_of_the_papers_motor_with_all_parameters_20_percent_wrong(void)
{
    assert_angle_error("lu2013", 0.2, 40.0);
}

void test_angle_of_a_salient_motor_with_l_q_5_percent_wrong(void)
{
    assert_angle_error("ipm400v", 0.05, 70.0);
}

/* ---- without the sensor ---- */

typedef struct {
    double stored_j, lowest_nm, highest_nm; /* torque: means of a millisecond, braking positive */
    reason_t fault;
} stop_t;

/* From 40 to 5 km/h; the hall plug comes off at the beginning. */
static stop_t stop_from_40(double demand_nm, bool plug_off)
{
    bench_params_t params = fixture_quarter_vehicle();
    params.run.initial_speed_m_per_s = 42.0 * KMH;
    params.driver.brake_demand_nm = demand_nm;
    const config_t config =
        fixture_config_with_sensor(CONFIG_STRATEGY_SERIES_OPTIMAL, CONFIG_ROTOR_HALL);
    bench_t *bench = fixture_start(&params, &config);
    while (bench->vehicle.speed_m_per_s > 40.0 * KMH) {
        bench_period(bench);
    }
    const double before_j = bench_ledger(bench).chemical_j;
    bench->params.sensors.hall_stuck_high = plug_off ? 7.0 : 0.0;
    bench_refresh(bench);
    stop_t out = {.lowest_nm = 1e9, .highest_nm = -1e9};
    while (bench->vehicle.speed_m_per_s > 5.0 * KMH && bench->time_s < 60.0) {
        const double before_nms = bench->wheel[0].totals.torque_impulse_nms;
        fixture_run(bench, 1e-3);
        const double nm = -(bench->wheel[0].totals.torque_impulse_nms - before_nms) / 1e-3;
        if (bench->vehicle.speed_m_per_s > 12.0 * KMH) {
            out.lowest_nm = fmin(out.lowest_nm, nm);
            out.highest_nm = fmax(out.highest_nm, nm);
        }
    }
    out.stored_j = before_j - bench_ledger(bench).chemical_j;
    out.fault = bench->wheel[0].first_fault;
    return out;
}

void test_stop_without_any_rotor_sensor_stores_97_percent(void)
{
    const double demands_nm[] = {15.0, 40.0};
    for (int d = 0; d < 2; d++) {
        const stop_t with = stop_from_40(demands_nm[d], false);
        const stop_t without = stop_from_40(demands_nm[d], true);
        char text[128];
        snprintf(text, sizeof(text),
                 "%.0f of %.0f J, torque %.2f .. %.2f (%.2f .. %.2f) N m, fault %d",
                 without.stored_j, with.stored_j, without.lowest_nm, without.highest_nm,
                 with.lowest_nm, with.highest_nm, without.fault);
        TEST_ASSERT_TRUE_MESSAGE(without.stored_j > 0.97 * with.stored_j, text);
        TEST_ASSERT_EQUAL_INT_MESSAGE(REASON_NONE, without.fault, text);
        TEST_ASSERT_TRUE_MESSAGE(without.lowest_nm > 0.95 * with.lowest_nm, text);
        TEST_ASSERT_TRUE_MESSAGE(without.highest_nm < 1.05 * with.highest_nm, text);
    }
}
