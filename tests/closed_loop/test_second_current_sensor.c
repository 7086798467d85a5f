/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A current sensor glitches, and some time later another one fails while the vehicle brakes: no
 * driving torque, and no more current than that fault makes as the first one. firmware/foc/
 * DERIVATIONS.md, A sensor that is out. In the time that the fault lasts the speed stays.
 *
 * HUBFOC_SECOND_SENSOR=whole in the environment: every phase, glitch and delay.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "unity.h"
#include "vehicle_fixture.h"

void setUp(void) {}

void tearDown(void) {}

static const double TURN = 6.283185307179586;
static const double HEAVY_KG = 1e6;
static const double GLITCH_S = 0.2;    /* when it begins */
static const double RELEASED_S = 0.45; /* the driver lets go */
static const double BRAKES_S = 0.8;
static const double WATCHED_S = 0.3;   /* of braking with the fault */
static const double WRONG_S = 5e-3;    /* of driving torque, at most */
static const double OVER_FIRST = 1.02; /* current over that of the fault as the first one */
static const double OVER_TRIP = 1.3;   /* current, at most, but for what is so as a first fault */
static const double NOISE_PEAK = 0.35; /* of the full scale, evenly distributed */
enum { EXAMINED_PERIODS = 2 };         /* of the fault, in which the current is not judged */

typedef struct {
    const char *name;
    double stuck, shown, offset, gain_error;
    bool noisy;
} failure_t;

static const failure_t RAIL = {.name = "rail", .stuck = 1.0, .shown = 1.0};
static const failure_t DEAD = {.name = "dead", .stuck = 1.0};
static const failure_t FAILURES[] = {
    {.name = "offset of a tenth", .offset = 0.1},
    {.name = "offset of three tenths", .offset = -0.3},
    {.name = "gain 0.1", .gain_error = -0.9},
    {.name = "gain 0.5", .gain_error = -0.5},
    {.name = "gain 2", .gain_error = 1.0},
    {.name = "dead", .stuck = 1.0},
    {.name = "stuck", .stuck = 1.0, .shown = 0.3},
    {.name = "at full scale", .stuck = 1.0, .shown = 1.0},
    {.name = "at the negative end", .stuck = 1.0, .shown = -1.0},
    {.name = "noise", .noisy = true},
};
enum { FAILURES_COUNT = sizeof FAILURES / sizeof FAILURES[0] };

/* What the driver does: brakes all the time; or drives, lets go and brakes. */
typedef enum { BRAKING, THEN_BRAKING } manoeuvre_t;

static bench_t trunk, healthy, broken;
static manoeuvre_t manoeuvre;
static double demand_nm, trip_a, limit_nm;

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

static uint8_t named(const bench_t *bench)
{
    fast_report_t report;
    foc_report_copy(&bench->wheel[0].controller.fast.foc, &report);
    return report.wrong_current_sensor;
}

/* failure: NULL, the sensor reads right again. */
static void fail(bench_t *bench, const failure_t *failure, int phase)
{
    static const failure_t NONE;
    const failure_t *shown = failure != NULL ? failure : &NONE;
    fault_params_t *fault = &bench->params.fault;
    fault->current_sensors = failure != NULL ? 1 << phase : 0;
    fault->current_stuck = shown->stuck;
    fault->current_shown = shown->shown;
    fault->current_offset = shown->noisy ? NOISE_PEAK : shown->offset;
    fault->current_gain_error = shown->gain_error;
    bench_refresh(bench);
}

static void drive_on(bench_t *bench)
{
    driver_params_t *driver = &bench->params.driver;
    const double t = bench->time_s;
    const bool brakes = manoeuvre == BRAKING || t >= BRAKES_S;
    const double brake_nm = brakes ? demand_nm : 0.0;
    const double drive_nm = !brakes && t < RELEASED_S ? demand_nm / 2.0 : 0.0;
    if (driver->brake_demand_nm != brake_nm || driver->drive_demand_nm != drive_nm) {
        driver->brake_demand_nm = brake_nm;
        driver->drive_demand_nm = drive_nm;
        bench_refresh(bench);
    }
    bench_period(bench);
}

static void run_until(bench_t *bench, double until_s)
{
    while (bench->time_s < until_s - 1e-9) {
        drive_on(bench);
    }
}

static void copy(bench_t *to, const bench_t *from)
{
    *to = *from;
    bench_refresh(to);
}

typedef struct {
    double wrong_s;   /* longest driving torque above the limit while braking */
    double over_trip; /* current over the trip; but for a short circuit's */
} outcome_t;

/* Another sensor fails, from the state of `healthy` on. */
static outcome_t second(const failure_t *failure, int phase)
{
    outcome_t out = {.wrong_s = 0.0};
    copy(&broken, &healthy);
    fail(&broken, failure, phase);
    const double end_s = fmax(broken.time_s, manoeuvre == BRAKING ? 0.0 : BRAKES_S) + WATCHED_S;
    uint32_t random = 1;
    double wrong_s = 0.0;
    for (int n = 0; broken.time_s < end_s; n++) {
        if (failure->noisy) {
            random = random * 1664525U + 1013904223U;
            broken.params.fault.current_offset =
                NOISE_PEAK * (2.0 * (double)random / 4294967296.0 - 1.0);
        }
        const double before_s = broken.time_s;
        drive_on(&broken);
        const bool wrong =
            broken.params.driver.brake_demand_nm > 0.0 && torque_nm(&broken) > limit_nm;
        wrong_s = wrong ? wrong_s + broken.time_s - before_s : 0.0;
        out.wrong_s = fmax(out.wrong_s, wrong_s);
        if (n >= EXAMINED_PERIODS &&
            !bridge_is_short(broken.wheel[0].controller.fast.output.bridge)) {
            out.over_trip = fmax(out.over_trip, current_a(&broken) / trip_a);
        }
    }
    return out;
}

typedef struct {
    int runs, healed;
    double wrong_s, over_trip, over_first;
} summary_t;

/* The same fault of one of two sensors after a glitch of the third, and as the first one. */
static void check_failure(const failure_t *failure, const bench_t *after_glitch,
                          const bench_t *without, int phase, const char *text, summary_t *all)
{
    for (int other = 1; other < 3; other++) {
        const int failing = (phase + other) % 3;
        copy(&healthy, without);
        const outcome_t first = second(failure, failing);
        const bool first_ends = broken.wheel[0].first_fault != REASON_NONE;
        copy(&healthy, after_glitch);
        const outcome_t out = second(failure, failing);
        char where[256];
        snprintf(where, sizeof where,
                 "%s, then %s of %d: %.1f ms of driving torque, current %.2f of the trip, %.2f as "
                 "the first fault",
                 text, failure->name, failing, 1e3 * out.wrong_s, out.over_trip, first.over_trip);
        TEST_ASSERT_TRUE_MESSAGE(out.wrong_s <= WRONG_S, where);
        TEST_ASSERT_TRUE_MESSAGE(out.over_trip <= fmax(OVER_TRIP, OVER_FIRST * first.over_trip),
                                 where);
        all->runs++;
        all->wrong_s = fmax(all->wrong_s, out.wrong_s);
        all->over_trip = fmax(all->over_trip, out.over_trip);
        if (!first_ends) {
            all->over_first = fmax(all->over_first, out.over_trip - first.over_trip);
        }
    }
}

typedef struct {
    int phases, glitches, delays;
    const double *glitch_s, *delay_s;
} extent_t;

static bool is_whole(void)
{
    return getenv("HUBFOC_SECOND_SENSOR") != NULL;
}

static extent_t extent(void)
{
    static const double GLITCHES_S[] = {0.001, 0.02, 0.2}, FEW_GLITCHES_S[] = {0.001, 0.2};
    static const double DELAYS_S[] = {0.1, 0.3, 1.0, 3.0, 10.0, 60.0}, FEW_DELAYS_S[] = {0.3};
    const bool whole = is_whole();
    const extent_t out = {
        .phases = whole ? 3 : 1,
        .glitches = whole ? 3 : 2,
        .delays = whole ? 6 : 1,
        .glitch_s = whole ? GLITCHES_S : FEW_GLITCHES_S,
        .delay_s = whole ? DELAYS_S : FEW_DELAYS_S,
    };
    return out;
}

/* One vehicle whose sensor glitches and one whose does not, with every delay. */
static void check_glitch(const extent_t *many, double glitch_s, const failure_t *glitch, int phase,
                         const char *text, summary_t *all)
{
    static bench_t glitched, plain;
    copy(&glitched, &trunk);
    copy(&plain, &trunk);
    fail(&glitched, glitch, phase);
    run_until(&glitched, GLITCH_S + glitch_s);
    if (glitch == &RAIL) { /* one that is dead makes no implausible sum of a small current */
        TEST_ASSERT_EQUAL_INT_MESSAGE(phase + 1, named(&glitched), text);
    }
    fail(&glitched, NULL, phase);
    for (int d = 0; d < many->delays; d++) {
        const double at_s = GLITCH_S + glitch_s + many->delay_s[d];
        run_until(&glitched, at_s);
        run_until(&plain, at_s);
        all->healed += named(&glitched) == 0;
        char where[120];
        snprintf(where, sizeof where, "%s, %g s later", text, many->delay_s[d]);
        for (int f = 0; f < FAILURES_COUNT; f++) {
            check_failure(&FAILURES[f], &glitched, &plain, phase, where, all);
        }
    }
}

/* At a share of the largest speed, a share of the rated torque demanded. */
static void check_drive(const char *name, double speed_share, double demand_share,
                        manoeuvre_t driver)
{
    bench_params_t params = fixture_one_wheel(fixture_drive(name));
    const config_t config = fixture_drive_config(name);
    const double rated_nm = 1e-3 * config.motor.rated_torque_mNm;
    params.vehicle.mass_kg = HEAVY_KG;
    params.run.initial_speed_m_per_s =
        speed_share * 1e-3 * config.motor.max_speed_mrad_s * params.vehicle.wheel_radius_m;
    manoeuvre = driver;
    demand_nm = demand_share * rated_nm;
    limit_nm = fmax(2.0, 0.05 * rated_nm);
    trip_a = config.monitor.overcurrent_pu_q15 / 32768.0 * params.sensors.current_full_scale_a;
    copy(&trunk, fixture_start(&params, &config));
    run_until(&trunk, GLITCH_S);
    const extent_t many = extent();
    summary_t all = {.runs = 0};
    for (int phase = 0; phase < many.phases; phase++) {
        for (int g = 0; g < many.glitches; g++) {
            const failure_t *glitch = g % 2 == 0 ? &RAIL : &DEAD;
            char text[80];
            snprintf(text, sizeof text, "%s at %g, %g of rated, %g ms %s of %d", name, speed_share,
                     demand_share, 1e3 * many.glitch_s[g], glitch->name, phase);
            check_glitch(&many, many.glitch_s[g], glitch, phase, text, &all);
        }
    }
    printf("%s at %g of its speed, %g of rated torque, %s: %d second faults, the first sensor used "
           "again before %d of %d; driving torque for at most %.1f ms, current at most %.2f of the "
           "trip, at most %.2f more than as the first fault\n",
           name, speed_share, demand_share,
           driver == BRAKING ? "braking" : "driving, coasting, braking", all.runs, all.healed,
           many.phases * many.glitches * many.delays, 1e3 * all.wrong_s, all.over_trip,
           all.over_first);
}

static void check_all(const char *name)
{
    check_drive(name, 0.5, 1.0, BRAKING);
    check_drive(name, 0.15, 1.0, THEN_BRAKING);
    if (is_whole()) {
        check_drive(name, 0.5, 1.0, THEN_BRAKING);
        check_drive(name, 0.5, 0.2, BRAKING);
    }
}

void test_lu2013_survives_a_second_current_sensor_after_a_glitch(void)
{
    check_all("lu2013");
}

void test_ebike36v_survives_a_second_current_sensor_after_a_glitch(void)
{
    check_all("ebike36v");
}

void test_scooter48v_survives_a_second_current_sensor_after_a_glitch(void)
{
    check_all("scooter48v");
}

void test_ipm400v_survives_a_second_current_sensor_after_a_glitch(void)
{
    check_all("ipm400v");
}

/* With full torque a glitch is over after 20 ms with current and a turn: the warning ends. */
void test_vehicle_brakes_on_with_all_three_sensors_after_a_glitch(void)
{
    static const char *const NAMES[] = {"lu2013", "ebike36v", "scooter48v", "ipm400v"};
    for (int k = 0; k < 4; k++) {
        bench_params_t params = fixture_one_wheel(fixture_drive(NAMES[k]));
        const config_t config = fixture_drive_config(NAMES[k]);
        params.vehicle.mass_kg = HEAVY_KG;
        params.run.initial_speed_m_per_s =
            0.5e-3 * config.motor.max_speed_mrad_s * params.vehicle.wheel_radius_m;
        manoeuvre = BRAKING;
        demand_nm = 1e-3 * config.motor.rated_torque_mNm;
        copy(&trunk, fixture_start(&params, &config));
        run_until(&trunk, GLITCH_S);
        fail(&trunk, &RAIL, 1);
        run_until(&trunk, GLITCH_S + 0.002);
        TEST_ASSERT_EQUAL_INT(MODE_LIMP, trunk.wheel[0].slow.mode);
        TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SENSOR_B, trunk.wheel[0].slow.warning_reason);
        fail(&trunk, NULL, 1);
        run_until(&trunk, GLITCH_S + 0.02);
        TEST_ASSERT_EQUAL_INT(MODE_LIMP, trunk.wheel[0].slow.mode);
        run_until(&trunk, GLITCH_S + 0.25);
        TEST_ASSERT_EQUAL_INT(MODE_RUN, trunk.wheel[0].slow.mode);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, trunk.wheel[0].slow.warning_reason);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, trunk.wheel[0].first_fault);
    }
}

/* One that stays wrong stays out, with and without torque: no fault, and LIMP all the time. */
void test_sensor_that_stays_wrong_stays_out_while_the_vehicle_drives_coasts_and_brakes(void)
{
    static const char *const NAMES[] = {"lu2013", "ebike36v", "scooter48v", "ipm400v"};
    static const double SPEEDS[] = {0.03, 0.5};
    static const int KINDS[] = {0, 2, 5, 6, 9};
    for (int k = 0; k < 8; k++) {
        bench_params_t params = fixture_one_wheel(fixture_drive(NAMES[k / 2]));
        const config_t config = fixture_drive_config(NAMES[k / 2]);
        params.vehicle.mass_kg = HEAVY_KG;
        params.run.initial_speed_m_per_s =
            SPEEDS[k % 2] * 1e-3 * config.motor.max_speed_mrad_s * params.vehicle.wheel_radius_m;
        manoeuvre = THEN_BRAKING;
        demand_nm = 2e-3 * config.motor.rated_torque_mNm;
        copy(&trunk, fixture_start(&params, &config));
        run_until(&trunk, RELEASED_S - 0.35);
        for (int f = is_whole() ? 0 : k % 2; f < 5; f += is_whole() ? 1 : 2) {
            copy(&broken, &trunk);
            fail(&broken, &FAILURES[KINDS[f]], f % 3);
            run_until(&broken, BRAKES_S + 1.0);
            char text[80];
            snprintf(text, sizeof text, "%s at %g, %s", NAMES[k / 2], SPEEDS[k % 2],
                     FAILURES[KINDS[f]].name);
            TEST_ASSERT_EQUAL_INT_MESSAGE(REASON_NONE, broken.wheel[0].first_fault, text);
            TEST_ASSERT_EQUAL_INT_MESSAGE(f % 3 + 1, named(&broken), text);
            TEST_ASSERT_EQUAL_INT_MESSAGE(MODE_LIMP, broken.wheel[0].slow.mode, text);
        }
    }
}
