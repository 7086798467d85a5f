/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A motor whose L_q is 0.5 to 1.5 times the configured one, as iron that saturates or a data sheet
 * make it: a healthy rotor sensor keeps its name and all of the torque, and where the EMF observer
 * replaces it the current leaves its angle within 20 degrees (motor/DERIVATIONS.md, Uncertain L_q).
 */
#include <math.h>
#include <stdio.h>

#include "unity.h"
#include "vehicle_fixture.h"

void setUp(void) {}

void tearDown(void) {}

static const double KMH = 1.0 / 3.6;
static const char *const DRIVES[] = {"lu2013", "ebike36v", "scooter48v", "ipm400v"};
static const double SHARES[] = {0.5, 0.7, 1.4, 1.5};

enum {
    DRIVE_COUNT = (int)(sizeof(DRIVES) / sizeof(DRIVES[0])),
    SHARE_COUNT = (int)(sizeof(SHARES) / sizeof(SHARES[0]))
};

static bool names_rotor(reason_t reason)
{
    return reason == REASON_ROTOR_UNCERTAIN || reason == REASON_ROTOR_LOST ||
           reason == REASON_ROTOR_IMPLAUSIBLE || reason == REASON_ROTOR_SLIPPED ||
           reason == REASON_ROTOR_FROZEN || reason == REASON_ROTOR_REVERSED;
}

/* Electrical degrees by which the observer is ahead of the rotor. */
static double error_deg(const bench_t *bench)
{
    const wheel_t *wheel = &bench->wheel[0];
    const double theta_turn = wheel->controller.fast.foc.observer.theta_q32 / 4294967296.0 -
                              wheel->to_fast.observer.lead_turn / 65536.0;
    return 360.0 * remainder(theta_turn - wheel->rotor.theta_turn, 1.0);
}

static bench_t *rolling(const char *name, double share, double kmh)
{
    bench_params_t params = fixture_one_wheel(fixture_drive(name));
    params.motor.q_inductance_h *= share;
    params.run.initial_speed_m_per_s = kmh * KMH;
    const config_t config = fixture_drive_config(name);
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.05);
    return bench;
}

static void demand(bench_t *bench, double nm)
{
    bench->params.driver.drive_demand_nm = fmax(nm, 0.0);
    bench->params.driver.brake_demand_nm = fmax(-nm, 0.0);
    bench_refresh(bench);
}

/* Runs a millisecond; false if a finding or a limit names the rotor. */
static bool is_quiet(bench_t *bench)
{
    const slow_output_t *out = &bench->wheel[0].slow;
    fixture_run(bench, 1e-3);
    return !names_rotor(out->warning_reason) && !names_rotor(out->fault_reason) &&
           !names_rotor(out->torque_reason) && !names_rotor(out->available_reason);
}

static double most_nm(const char *name)
{
    return 1e-3 * fixture_drive_config(name).motor.max_torque_mNm;
}

static void break_sensor(bench_t *bench)
{
    bench->params.fault.rotor_frozen = 1.0;
    bench->params.sensors.hall_stuck_high = 7.0;
    bench_refresh(bench);
}

/* ---- a healthy sensor ---- */

void test_a_healthy_sensor_is_never_named_and_loses_no_torque(void)
{
    static const double SPEEDS_KMH[] = {6.0, 12.0, 40.0};
    for (int k = 0; k < DRIVE_COUNT * SHARE_COUNT * 3 * 2; k++) {
        const char *name = DRIVES[k % DRIVE_COUNT];
        const double share = SHARES[k / DRIVE_COUNT % SHARE_COUNT];
        const double kmh = SPEEDS_KMH[k / DRIVE_COUNT / SHARE_COUNT % 3];
        const double sign = k < DRIVE_COUNT * SHARE_COUNT * 3 ? -1.0 : 1.0;
        bench_t *bench = rolling(name, share, kmh);
        demand(bench, sign * most_nm(name));
        for (int ms = 0; ms < 450 && bench->vehicle.speed_m_per_s > 2.0 * KMH; ms++) {
            char text[96];
            snprintf(text, sizeof(text), "%s, L_q %.1f, %.0f km/h, %+.0f, after %d ms", name, share,
                     kmh, sign, ms);
            TEST_ASSERT_TRUE_MESSAGE(is_quiet(bench), text);
        }
    }
}

/* ---- the observer in its place ---- */

typedef struct {
    double error_deg; /* largest */
    double braking_nm;
} observed_t;

/* The largest demand once the sensor has been lost: 0.3 s for the torque to rise, then 0.3 s. */
static observed_t observed(const char *name, double share, double kmh, double sign)
{
    bench_t *bench = rolling(name, share, kmh);
    demand(bench, sign * 0.05 * most_nm(name));
    fixture_run(bench, 0.1);
    break_sensor(bench);
    fixture_run(bench, 0.3);
    demand(bench, sign * most_nm(name));
    fixture_run(bench, 0.3);
    observed_t out = {.error_deg = 0.0};
    for (int ms = 0; ms < 300 && bench->vehicle.speed_m_per_s > 8.0 * KMH; ms++) {
        fixture_run(bench, 1e-3);
        out.error_deg = fmax(out.error_deg, fabs(error_deg(bench)));
    }
    out.braking_nm = -1e-3 * bench->wheel[0].slow.motor_torque_command_mNm;
    return out;
}

void test_the_observers_angle_stays_within_20_degrees(void)
{
    for (int k = 0; k < DRIVE_COUNT * SHARE_COUNT * 2; k++) {
        const char *name = DRIVES[k % DRIVE_COUNT];
        const double share = SHARES[k / DRIVE_COUNT % SHARE_COUNT];
        for (double kmh = 15.0; kmh <= 30.0; kmh += 15.0) {
            const double sign = k < DRIVE_COUNT * SHARE_COUNT ? -1.0 : 1.0;
            const observed_t out = observed(name, share, kmh, sign);
            char text[96];
            snprintf(text, sizeof(text), "%s, L_q %.1f, %.0f km/h, %+.0f: %.1f degrees", name,
                     share, kmh, sign, out.error_deg);
            TEST_ASSERT_TRUE_MESSAGE(out.error_deg < 20.0, text);
        }
    }
}

/* 0.5 L_q |i_q| + sin^2(15) (L_q/2 - L_d) |i_q| = sin(15) [psi + cos(15) (L_q/2 - L_d) |i_d|]: with
 * its least-loss i_d of -8 to -16 A the motor of 400 V may have 28 to 30 A and 9 to 11.5 N m of its
 * 115. L_q i_q is small beside psi in hub motors, which keep all of their torque. */
void test_only_a_motor_whose_l_q_i_q_exceeds_its_flux_gives_up_torque(void)
{
    const double salient_nm = observed("ipm400v", 1.0, 30.0, -1.0).braking_nm;
    TEST_ASSERT_TRUE(salient_nm > 8.0 && salient_nm < 12.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.4, 40.0, observed("lu2013", 1.0, 20.0, -1.0).braking_nm);
    TEST_ASSERT_TRUE(observed("ipm400v", 0.5, 30.0, -1.0).error_deg > 10.0);
}

/* On a ramp from there down the observer of half the L_q would lose the rotor. */
void test_a_sensor_that_freezes_in_full_braking_leaves_the_observer_an_angle(void)
{
    for (int s = 0; s < SHARE_COUNT; s++) {
        bench_t *bench = rolling("ipm400v", SHARES[s], 30.0);
        demand(bench, -most_nm("ipm400v"));
        fixture_run(bench, 0.4);
        break_sensor(bench);
        fixture_run(bench, 0.2);
        for (int ms = 0; ms < 300; ms++) {
            fixture_run(bench, 1e-3);
            TEST_ASSERT_TRUE(fabs(error_deg(bench)) < 20.0);
        }
        TEST_ASSERT_EQUAL_INT(REASON_NONE, bench->wheel[0].first_fault);
        TEST_ASSERT_TRUE(bench->wheel[0].slow.motor_torque_command_mNm < -7000);
    }
}
