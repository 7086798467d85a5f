/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Effect of dead time on the phase currents at 50 r/min and the torque of 10 A (11.1 A with iron
 * current and i_d). The bridge model switches every edge: dead intervals, diodes and PWM ripple are
 * simulated, not their means over the period.
 */
#include <complex.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>

#include "config/validate.h"
#include "unity.h"
#include "vehicle_fixture.h"

static const double TURN = 6.283185307179586;
static const double SPEED_RAD_S = 5.235987755982989; /* 50 r/min */
static const double TORQUE_NM = 7.038;               /* 3/2 * 23 * 0.0204 Wb * 10 A */

typedef struct {
    double first_a, fifth_a, seventh_a;
    double torque_nm;
} harmonics_t;

void setUp(void) {}

void tearDown(void) {}

/* Amplitudes in phase a and the mean airgap torque, over one mechanical turn: 23 electrical ones.
 */
static harmonics_t harmonics(bool compensated)
{
    bench_params_t params = fixture_quarter_vehicle();
    params.vehicle.mass_kg = 1e5; /* keeps the speed to a hundredth of a per cent */
    params.run.initial_speed_m_per_s = SPEED_RAD_S * 0.25;
    params.inverter.switching = 1.0;
    params.driver.drive_demand_nm = TORQUE_NM;
    config_t config =
        fixture_config_with_sensor(CONFIG_STRATEGY_SERIES_OPTIMAL, CONFIG_ROTOR_ANGLE);
    if (!compensated) {
        config.drive.dead_time_ns = 0;
        config.crc32 = config_crc32(&config, (uint32_t)offsetof(config_t, crc32));
    }
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.3);
    const wheel_t *wheel = &bench->wheel[0];
    const double period_s = 1.0 / params.inverter.pwm_frequency_hz;
    const int periods = (int)lround(TURN / SPEED_RAD_S / period_s);
    const double impulse_nms = wheel->totals.torque_impulse_nms;
    static const double ORDER[3] = {1.0, 5.0, 7.0};
    double complex sum[3] = {0.0};
    for (int n = 0; n < periods; n++) {
        for (int k = 0; k < 3; k++) {
            sum[k] += 2.0 / periods * wheel->rotor.terminal.alpha *
                      cexp(-I * TURN * ORDER[k] * wheel->rotor.theta_turn);
        }
        bench_period(bench);
    }
    TEST_ASSERT_EQUAL_INT(REASON_NONE, wheel->first_fault);
    const harmonics_t out = {
        .first_a = cabs(sum[0]),
        .fifth_a = cabs(sum[1]),
        .seventh_a = cabs(sum[2]),
        .torque_nm = (wheel->totals.torque_impulse_nms - impulse_nms) / (periods * period_s),
    };
    return out;
}

void test_dead_time_compensation_halves_the_fifth_and_seventh_harmonic_at_the_same_torque(void)
{
    const harmonics_t without = harmonics(false);
    const harmonics_t with = harmonics(true);
    char text[160];
    snprintf(text, sizeof(text),
             "first %.3f %.3f A, fifth %.4f %.4f A, seventh %.4f %.4f A, torque %.3f %.3f N m",
             without.first_a, with.first_a, without.fifth_a, with.fifth_a, without.seventh_a,
             with.seventh_a, without.torque_nm, with.torque_nm);
    /* 4/pi of 1.09 V over the order against 0.35 Ohm of winding and regulator: 0.79 A and 0.57 A
     * for a square wave. */
    TEST_ASSERT_TRUE_MESSAGE(without.fifth_a > 0.4 && without.fifth_a < 0.8, text);
    TEST_ASSERT_TRUE_MESSAGE(without.seventh_a > 0.25 && without.seventh_a < 0.6, text);
    TEST_ASSERT_TRUE_MESSAGE(with.fifth_a <= 0.5 * without.fifth_a, text);
    TEST_ASSERT_TRUE_MESSAGE(with.seventh_a <= 0.5 * without.seventh_a, text);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.3, TORQUE_NM, with.torque_nm, text); /* 1 % of rated */
}
