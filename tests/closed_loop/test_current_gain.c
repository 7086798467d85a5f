/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The battery's charge beside the current sensors' in whole rides. A management that filters its
 * current, with the errors of an ordinary one, costs no braking: both brakes make the demand, as
 * without its message. A gain of 0.7 of all current sensors has its name within two windows.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "unity.h"
#include "vehicle_fixture.h"

void setUp(void) {}

void tearDown(void) {}

static const double MESSAGE_S = 0.1;
static const double WINDOW_S = 17.024;    /* 8 (2 + 0.128) */
static const double SETTLES_S = 0.5;      /* of both brakes after the pedal moves */
static const double MEAN_S = 0.1;         /* over which the sum of the brakes is averaged */
static const double MISSING_SHARE = 0.03; /* of rated torque, of that sum */

static const char *const DRIVES[] = {"scooter48v", "lu2013", "ebike36v", "ipm400v"};
enum { DRIVES_COUNT = sizeof DRIVES / sizeof DRIVES[0] };

/* One drive and one ride in an ordinary run, all of them with HUBFOC_FOR_LONG. */
static int drives(void)
{
    return getenv("HUBFOC_FOR_LONG") == NULL ? 1 : DRIVES_COUNT;
}

/* One wheel with its share of vehicle and battery, that knows it drives alone. */
typedef struct {
    bench_params_t params;
    config_t config;
    double rated_nm, up_s; /* with rated torque to the largest speed, without losses */
} drive_t;

static drive_t drive_of(const char *name)
{
    drive_t out = {.params = fixture_one_wheel(fixture_drive(name)),
                   .config = fixture_drive_config(name)};
    const vehicle_params_t *vehicle = &out.params.vehicle;
    out.config.battery.driven_wheels = 1;
    out.rated_nm = 1e-3 * out.config.motor.rated_torque_mNm;
    out.up_s = 1e-3 * out.config.motor.max_speed_mrad_s * vehicle->mass_kg *
               vehicle->wheel_radius_m * vehicle->wheel_radius_m / out.rated_nm;
    out.params.bms.period_s = MESSAGE_S;
    out.params.bms.current_silent = 0.0;
    return out;
}

typedef struct {
    double missing_nm; /* largest, of the sum of both brakes below the demand */
    double found_s;    /* first wrong gain; below zero: none */
    bool fault;
} outcome_t;

static outcome_t outcome;
static double braking_since_s, mean_missing_nm;

static double sum_nm(const bench_t *bench)
{
    const wheel_t *wheel = &bench->wheel[0];
    return wheel->brake_capacity_nm - 1e-3 * wheel->slow.motor_torque_estimate_mNm;
}

/* A millisecond. */
static void watch(bench_t *bench)
{
    fixture_run(bench, 1e-3);
    const slow_output_t *slow = &bench->wheel[0].slow;
    const double demand_nm = bench->params.driver.brake_demand_nm;
    const bool brakes = demand_nm > 0.0 && slow->speed_mrad_s > 2000;
    braking_since_s = brakes ? braking_since_s + 1e-3 : 0.0;
    const double missing_nm = braking_since_s > SETTLES_S ? demand_nm - sum_nm(bench) : 0.0;
    mean_missing_nm += (missing_nm - mean_missing_nm) * 1e-3 / MEAN_S;
    outcome.missing_nm = fmax(outcome.missing_nm, mean_missing_nm);
    outcome.fault = outcome.fault || slow->fault_reason != REASON_NONE;
    if (outcome.found_s < 0.0 &&
        findings_present(&bench->wheel[0].controller.slow.findings, FINDING_GAIN)) {
        outcome.found_s = bench->time_s;
    }
}

static void demand(bench_t *bench, double drive_nm, double brake_nm, double duration_s)
{
    bench->params.driver.drive_demand_nm = drive_nm;
    bench->params.driver.brake_demand_nm = brake_nm;
    bench_refresh(bench);
    const double until_s = bench->time_s + duration_s - 1e-9;
    while (bench->time_s < until_s) {
        watch(bench);
    }
}

static void begin(void)
{
    const outcome_t none = {.found_s = -1.0};
    outcome = none;
    braking_since_s = 0.0;
    mean_missing_nm = 0.0;
}

/* Stops from nine tenths of the largest speed. */
static outcome_t stops(drive_t drive)
{
    drive.params.run.initial_speed_m_per_s =
        0.9e-3 * drive.config.motor.max_speed_mrad_s * drive.params.vehicle.wheel_radius_m;
    bench_t *bench = fixture_start(&drive.params, &drive.config);
    begin();
    for (int n = 0; n < 3; n++) {
        demand(bench, 0.0, (n + 1) / 1.5 * drive.rated_nm, drive.up_s);
        demand(bench, 1.2 * drive.rated_nm, 0.0, drive.up_s);
    }
    return outcome;
}

/* From standstill to half of the largest speed, coasting, and a stop with a pause. */
static outcome_t urban(drive_t drive)
{
    bench_t *bench = fixture_start(&drive.params, &drive.config);
    begin();
    for (int n = 0; n < 4; n++) {
        demand(bench, drive.rated_nm, 0.0, 0.55 * drive.up_s);
        demand(bench, 0.0, 0.0, 2.0);
        demand(bench, 0.0, (n % 2 + 1) / 1.5 * drive.rated_nm, 0.6 * drive.up_s);
        demand(bench, 0.0, 0.0, 2.0);
    }
    return outcome;
}

typedef outcome_t (*ride_t)(drive_t drive);
static const ride_t RIDES[] = {stops, urban};

static int rides(void)
{
    return getenv("HUBFOC_FOR_LONG") == NULL ? 1 : (int)(sizeof RIDES / sizeof RIDES[0]);
}

typedef struct {
    double filter_s, offset_a, gain_error;
} management_t;

static outcome_t run_with(ride_t ride, drive_t drive, management_t management)
{
    drive.params.bms.current_filter_s = management.filter_s;
    drive.params.bms.current_offset_a = management.offset_a;
    drive.params.bms.current_error = management.gain_error;
    return ride(drive);
}

void test_a_good_management_is_believed_whatever_it_filters(void)
{
    static const management_t GOOD[] = {{.filter_s = 0.15, .gain_error = -0.02},
                                        {.filter_s = 2.0, .gain_error = 0.02}};
    for (int k = 0; k < drives(); k++) {
        const drive_t drive = drive_of(DRIVES[k]);
        for (int n = 0; n < 2; n++) {
            for (int r = 0; r < rides(); r++) {
                const outcome_t out = run_with(RIDES[r], drive, GOOD[n]);
                TEST_ASSERT_FALSE_MESSAGE(out.fault, DRIVES[k]);
                TEST_ASSERT_TRUE_MESSAGE(out.found_s < 0.0, DRIVES[k]);
            }
        }
    }
}

/* The alarm is false: the torque of both brakes together is as if there were no message. */
void test_a_management_that_is_wrong_costs_no_braking(void)
{
    static const management_t WRONG[] = {{.filter_s = 2.0, .offset_a = 5.0, .gain_error = 0.25},
                                         {.filter_s = 0.0, .offset_a = -5.0, .gain_error = -0.2}};
    int found = 0;
    for (int k = 0; k < drives(); k++) {
        const drive_t drive = drive_of(DRIVES[k]);
        for (int r = 0; r < rides(); r++) {
            drive_t silent = drive;
            silent.params.bms.current_silent = 1.0;
            const double as_without_nm = RIDES[r](silent).missing_nm;
            for (int n = 0; n < 2; n++) {
                const outcome_t out = run_with(RIDES[r], drive, WRONG[n]);
                TEST_ASSERT_FALSE_MESSAGE(out.fault, DRIVES[k]);
                TEST_ASSERT_TRUE_MESSAGE(
                    out.missing_nm <= as_without_nm + MISSING_SHARE * drive.rated_nm, DRIVES[k]);
                found += out.found_s >= 0.0 ? 1 : 0;
            }
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(drives() * rides(), found); /* more than half of the runs */
}

/* Driving at two fifths of the largest speed, from the first torque on. The name of the rotor
 * sensor, which a salient motor's observer contradicts as well, comes first. */
void test_a_gain_of_seven_tenths_is_found_within_two_windows(void)
{
    for (int k = 0; k < drives(); k++) {
        drive_t drive = drive_of(DRIVES[k]);
        drive.params.run.initial_speed_m_per_s =
            0.4e-3 * drive.config.motor.max_speed_mrad_s * drive.params.vehicle.wheel_radius_m;
        drive.params.fault.current_sensors = 7.0;
        drive.params.fault.current_gain_error = -0.3;
        drive.params.bms.current_filter_s = 0.3;
        bench_t *bench = fixture_start(&drive.params, &drive.config);
        begin();
        demand(bench, 0.5 * drive.rated_nm, 0.0, 2.0 * WINDOW_S);
        printf("%s: found after %.1f s\n", DRIVES[k], outcome.found_s);
        TEST_ASSERT_TRUE_MESSAGE(outcome.found_s >= 0.0, DRIVES[k]);
        const double missing = bench->wheel[0].controller.slow.last.current_missing_q15 / 32768.0;
        TEST_ASSERT_DOUBLE_WITHIN(0.06, 0.3, missing);
    }
}
