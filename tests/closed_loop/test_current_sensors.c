/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A current sensor that fails in a braking vehicle: every kind of failure, in every phase, at eight
 * instants of the electrical turn, at several speeds and torques of two drives. The wrong sensor is
 * replaced before the current leaves its limits, the right one is named, and the stop continues
 * with the same torque. Today's trip alone let 690 A and 529 N m pass.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "unity.h"
#include "vehicle_fixture.h"

void setUp(void) {}

void tearDown(void) {}

static const double TURN = 6.283185307179586;
static const double CURRENT_OVER_TRIP = 1.3; /* at most */

typedef struct {
    const char *name;
    double stuck, shown, frozen, offset, gain_error;
} failure_t;

static const failure_t FAILURES[] = {
    {.name = "dead", .stuck = 1.0},
    {.name = "at full scale", .stuck = 1.0, .shown = 1.0},
    {.name = "at the negative end", .stuck = 1.0, .shown = -1.0},
    {.name = "stuck", .stuck = 1.0, .shown = 0.3},
    {.name = "frozen", .frozen = 1.0},
    {.name = "offset of a tenth", .offset = 0.1},
    {.name = "offset of three tenths", .offset = -0.3},
    {.name = "gain 0.5", .gain_error = -0.5},
    {.name = "gain 0.7", .gain_error = -0.3},
    {.name = "gain 1.3", .gain_error = 0.3},
    {.name = "gain 2", .gain_error = 1.0},
};
enum {
    FAILURES_COUNT = sizeof FAILURES / sizeof FAILURES[0],
    INSTANTS = 8,
    INSTANT_PERIODS = 7,
    WATCHED_PERIODS = 600,
    NAMED_PERIODS = 3 /* with an implausible sum, until the sensor is named */
};

static bench_t moving, broken;

/* Of the first wheel, at the airgap. */
static double torque_nm(const bench_t *bench)
{
    const pmsm_params_t *motor = &bench->params.motor;
    const pmsm_state_t *rotor = &bench->wheel[0].rotor;
    const double cosine = cos(TURN * rotor->theta_turn);
    const double sine = sin(TURN * rotor->theta_turn);
    const double d = cosine * rotor->terminal.alpha + sine * rotor->terminal.beta;
    const double q = cosine * rotor->terminal.beta - sine * rotor->terminal.alpha;
    return 1.5 * motor->pole_pairs * q *
           (motor->flux_linkage_wb + (motor->d_inductance_h - motor->q_inductance_h) * d);
}

static double current_a(const bench_t *bench)
{
    const pmsm_state_t *rotor = &bench->wheel[0].rotor;
    return hypot(rotor->terminal.alpha, rotor->terminal.beta);
}

static void break_sensors(bench_t *bench, const failure_t *failure, int phases)
{
    fault_params_t *fault = &bench->params.fault;
    fault->current_sensors = phases;
    fault->current_stuck = failure->stuck;
    fault->current_shown = failure->shown;
    fault->current_frozen = failure->frozen;
    fault->current_offset = failure->offset;
    fault->current_gain_error = failure->gain_error;
    bench_refresh(bench);
}

typedef struct {
    double most_a;
    double most_change_nm, mean_change_nm; /* of the torque */
    int implausible_periods;               /* until the sensor was named, or all */
    int named;                             /* 1 .. 3, 0: none */
} outcome_t;

/* From the present state of `moving`, some periods later. */
static outcome_t fail(const failure_t *failure, int phases, int instant)
{
    outcome_t out = {.named = 0};
    broken = moving;
    bench_refresh(&broken);
    for (int n = 0; n < instant * INSTANT_PERIODS; n++) {
        bench_period(&broken);
    }
    const double before_nm = torque_nm(&broken);
    break_sensors(&broken, failure, phases);
    const foc_state_t *foc = &broken.wheel[0].controller.fast.foc;
    for (int n = 0; n < WATCHED_PERIODS; n++) {
        bench_period(&broken);
        const double change_nm = torque_nm(&broken) - before_nm;
        out.most_a = fmax(out.most_a, current_a(&broken));
        out.most_change_nm = fmax(out.most_change_nm, fabs(change_nm));
        out.mean_change_nm += change_nm / WATCHED_PERIODS;
        const bool implausible =
            abs(foc->period.current_sum_pu) > broken.config.monitor.current_sum_pu_q15;
        if (out.named == 0 && implausible) {
            out.implausible_periods++;
            fast_report_t report;
            foc_report_copy(foc, &report);
            foc_report_complete(&report);
            out.named = report.wrong_current_sensor;
        }
    }
    return out;
}

/* `moving` at a share of the largest speed, the demand in force. Returns the trip. */
static double brake_at(const char *name, double share_of_speed, double demand_nm)
{
    bench_params_t params = fixture_one_wheel(fixture_drive(name));
    const config_t config = fixture_drive_config(name);
    params.run.initial_speed_m_per_s =
        share_of_speed * 1e-3 * config.motor.max_speed_mrad_s * params.vehicle.wheel_radius_m;
    params.driver.brake_demand_nm = demand_nm;
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.3);
    moving = *bench;
    bench_refresh(&moving);
    return config.monitor.overcurrent_pu_q15 / 32768.0 * params.sensors.current_full_scale_a;
}

typedef struct {
    double current_over_trip, change, mean_change; /* largest; of the torque over the rated one */
    int seen, undetermined;
} summary_t;

/* most_periods: until the sensor is named. */
static void check_failure(const failure_t *failure, double trip_a, int most_periods, summary_t *all)
{
    const double rated_nm = moving.config.motor.max_torque_mNm * 1e-3;
    for (int phase = 0; phase < 3; phase++) {
        for (int instant = 0; instant < INSTANTS; instant++) {
            const outcome_t out = fail(failure, 1 << phase, instant);
            char text[96];
            snprintf(text, sizeof text, "%s, phase %d, instant %d", failure->name, phase, instant);
            all->current_over_trip = fmax(all->current_over_trip, out.most_a / trip_a);
            all->change = fmax(all->change, out.most_change_nm / rated_nm);
            if (out.implausible_periods == 0) {
                continue; /* a gain error that makes no implausible sum at this torque */
            }
            all->seen++;
            if (out.named == 0 && most_periods > NAMED_PERIODS) {
                all->undetermined++;
                TEST_ASSERT_EQUAL_INT_MESSAGE(REASON_CURRENT_SUM, broken.wheel[0].first_fault,
                                              text);
                continue;
            }
            all->mean_change = fmax(all->mean_change, fabs(out.mean_change_nm) / rated_nm);
            TEST_ASSERT_EQUAL_INT_MESSAGE(phase + 1, out.named, text);
            TEST_ASSERT_TRUE_MESSAGE(out.implausible_periods <= most_periods, text);
            TEST_ASSERT_EQUAL_INT_MESSAGE(REASON_NONE, broken.wheel[0].first_fault, text);
            TEST_ASSERT_EQUAL_INT_MESSAGE(MODE_LIMP, broken.wheel[0].slow.mode, text);
            TEST_ASSERT_EQUAL_INT_MESSAGE(REASON_CURRENT_SENSOR_A + phase,
                                          broken.wheel[0].slow.warning_reason, text);
        }
    }
}

static void check_drive(const char *name, double share_of_speed, double demand_nm, int most_periods)
{
    const double trip_a = brake_at(name, share_of_speed, demand_nm);
    summary_t all = {.seen = 0};
    for (int f = 0; f < FAILURES_COUNT; f++) {
        check_failure(&FAILURES[f], trip_a, most_periods, &all);
    }
    printf("%s at %.0f %% of its speed, %g N m: %d failures seen, %d undetermined, current at most "
           "%.2f of the trip, "
           "torque within %.1f %%, mean within %.2f %%\n",
           name, 100.0 * share_of_speed, demand_nm, all.seen, all.undetermined,
           all.current_over_trip, 100.0 * all.change, 100.0 * all.mean_change);
    TEST_ASSERT_TRUE(all.seen >= 8 * 3 * INSTANTS);
    TEST_ASSERT_TRUE(all.current_over_trip < CURRENT_OVER_TRIP);
    TEST_ASSERT_TRUE(all.mean_change < 0.05);
    TEST_ASSERT_TRUE(20 * all.undetermined < all.seen);
}

void test_wrong_sensor_is_named_and_the_papers_vehicle_brakes_on(void)
{
    check_drive("lu2013", 0.66, 40.0, NAMED_PERIODS);
    check_drive("lu2013", 0.66, 10.0, NAMED_PERIODS);
    check_drive("lu2013", 0.2, 40.0, NAMED_PERIODS);
    /* The voltage is limited now and then, and the prediction less exact: a gain error of 30 % may
     * end the torque instead, and in 3 of 264 failures it is named after 4, 8 and 12 periods. */
    check_drive("lu2013", 0.98, 30.0, 12);
}

void test_wrong_sensor_is_named_and_the_400_v_drive_brakes_on(void)
{
    check_drive("ipm400v", 0.3, 100.0, NAMED_PERIODS);
    check_drive("ipm400v", 0.9, 60.0, NAMED_PERIODS);
}

/* Two at a time by the same: no single sensor explains the sum, and the motor's torque ends. What
 * two sensors show that one alone could show as well is not covered. */
void test_two_wrong_sensors_end_the_torque_before_the_current_leaves_its_limits(void)
{
    const double trip_a = brake_at("lu2013", 0.66, 40.0);
    const failure_t offset = {.name = "two offsets", .offset = 0.1};
    for (int instant = 0; instant < INSTANTS; instant++) {
        const outcome_t out = fail(&offset, 3, instant);
        TEST_ASSERT_TRUE(out.most_a < CURRENT_OVER_TRIP * trip_a);
        TEST_ASSERT_EQUAL_INT(0, out.named);
        TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SUM, broken.wheel[0].first_fault);
    }
}

/* What moves too slowly for a residual: firmware/foc/DERIVATIONS.md, Current sensors. */
void test_slow_drift_ends_in_a_fault_with_the_current_inside_its_limits(void)
{
    const double trip_a = brake_at("lu2013", 0.66, 40.0);
    broken = moving;
    broken.params.fault.current_sensors = 2.0;
    broken.params.fault.current_drift_per_s = 0.2;
    bench_refresh(&broken);
    double most_a = 0.0;
    for (int n = 0; n < 10000; n++) {
        bench_period(&broken);
        most_a = fmax(most_a, current_a(&broken));
    }
    TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SUM, broken.wheel[0].first_fault);
    TEST_ASSERT_TRUE(most_a < trip_a);
}

/* All of them dead: no sum shows it, and the loop adds a share of the reference every period. The
 * jump to zero is seen in two periods. */
static void check_all_dead(const char *name, double share_of_speed, double demand_nm)
{
    const failure_t dead = {.name = "all dead", .stuck = 1.0};
    const double trip_a = brake_at(name, share_of_speed, demand_nm);
    double most_a = 0.0;
    for (int instant = 0; instant < INSTANTS; instant++) {
        const outcome_t out = fail(&dead, 7, instant);
        most_a = fmax(most_a, out.most_a);
        TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SENSOR, broken.wheel[0].first_fault);
        TEST_ASSERT_EQUAL_INT(MODE_FAULT, broken.wheel[0].slow.mode);
    }
    printf("%s at %.0f %% of its speed, %g N m, all dead: current at most %.2f of the trip\n", name,
           100.0 * share_of_speed, demand_nm, most_a / trip_a);
    TEST_ASSERT_TRUE(most_a < CURRENT_OVER_TRIP * trip_a);
}

void test_all_dead_sensors_end_the_torque_before_the_current_leaves_its_limits(void)
{
    check_all_dead("lu2013", 0.66, 75.0);
    check_all_dead("lu2013", 0.2, 40.0);
    check_all_dead("ebike36v", 0.5, 20.0);
    check_all_dead("scooter48v", 0.5, 25.0);
    check_all_dead("ipm400v", 0.3, 175.0);
    check_all_dead("ipm400v", 0.7, 175.0);
}

/* Dead before there is a current: the reference rises and none is seen. */
void test_sensors_that_die_while_coasting_are_named_with_the_next_torque(void)
{
    static const char *const NAMES[] = {"lu2013", "ebike36v", "scooter48v", "ipm400v"};
    for (int n = 0; n < 4; n++) {
        const double trip_a = brake_at(NAMES[n], 0.4, 0.0);
        const failure_t dead = {.name = "all dead", .stuck = 1.0};
        broken = moving;
        break_sensors(&broken, &dead, 7);
        broken.params.driver.brake_demand_nm = 2.5e-3 * broken.config.motor.rated_torque_mNm;
        bench_refresh(&broken);
        double most_a = 0.0;
        for (int k = 0; k < 4 * WATCHED_PERIODS; k++) {
            bench_period(&broken);
            most_a = fmax(most_a, current_a(&broken));
        }
        printf("%s, dead while coasting: current at most %.2f of the trip\n", NAMES[n],
               most_a / trip_a);
        TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SENSOR, broken.wheel[0].first_fault);
        TEST_ASSERT_TRUE(most_a < CURRENT_OVER_TRIP * trip_a);
    }
}
