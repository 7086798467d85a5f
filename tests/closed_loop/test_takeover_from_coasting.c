/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A coasting bridge closes because a torque is wanted: with its rotor sensor, and without any,
 * where the observer has to find the angle first (controller/DERIVATIONS.md, Takeover from
 * coasting). Torques are those of the shaft, positive in the sense of the demand.
 */
#include <math.h>
#include <stdio.h>

#include "unity.h"
#include "vehicle_fixture.h"

void setUp(void) {}

void tearDown(void) {}

static const double KMH = 1.0 / 3.6;
enum {
    INSTANTS = 16,
    INSTANT_PERIODS = 7,
    WATCHED_PERIODS = 600,
    MEAN_PERIODS = 20,    /* a millisecond */
    UNKNOWN_PERIODS = 60, /* of closing, in which the EMF drives the current */
    CONFIRMED_PERIODS = 5 * MEAN_PERIODS,
    /* Two milliseconds of a plausible flux, and eleven after its direction has changed. */
    FOUND_PERIODS = (2 + 11) * MEAN_PERIODS
};

/* When the hall plug comes off. */
typedef enum { NEVER, DRIVING, COASTING } plug_t;

static bench_t moving, closing;

static void demand(bench_t *bench, double drive_nm, double brake_nm)
{
    bench->params.driver.drive_demand_nm = drive_nm;
    bench->params.driver.brake_demand_nm = brake_nm;
    bench_refresh(bench);
}

static void unplug(bench_t *bench)
{
    bench->params.sensors.hall_stuck_high = 7.0;
    bench_refresh(bench);
    fixture_run(bench, 0.2);
}

/* `moving` with its bridge open. */
static void coast_at(double kmh, plug_t off)
{
    bench_params_t params = fixture_quarter_vehicle();
    params.run.initial_speed_m_per_s = kmh * KMH;
    const config_t config =
        fixture_config_with_sensor(CONFIG_STRATEGY_SERIES_OPTIMAL, CONFIG_ROTOR_HALL);
    bench_t *bench = fixture_start(&params, &config);
    demand(bench, 10.0, 0.0);
    fixture_run(bench, 0.3);
    if (off == DRIVING) {
        unplug(bench);
    }
    demand(bench, 0.0, 0.0);
    fixture_run(bench, 0.5);
    if (off == COASTING) {
        unplug(bench);
    }
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, bench->wheel[0].active.bridge);
    moving = *bench;
    bench_refresh(&moving);
}

/* EMF over the proportional share of the current controller, as a torque. */
static double emf_nm(const bench_t *bench)
{
    const pmsm_params_t *motor = &bench->params.motor;
    const double omega = motor->pole_pairs * bench->wheel[0].motion.speed_rad_s;
    const double emf_v = omega * motor->flux_linkage_wb;
    const double controller_ohm =
        motor->q_inductance_h * PLANT_TWO_PI * bench->config.current_loop.bandwidth_Hz;
    return 1.5 * motor->pole_pairs * motor->flux_linkage_wb * emf_v / controller_ohm;
}

typedef struct {
    double emf_nm;
    double mean_nm;  /* largest mean of a millisecond, either sign */
    double first_nm; /* largest torque of the demand's sense in the first half millisecond */
    double wrong_nm; /* largest of the wrong sign, from UNKNOWN_PERIODS on */
    double wrong_ms; /* longest time with more than 2 N m of it */
    int confirmed;   /* periods from closing; WATCHED_PERIODS: never */
} outcome_t;

/* Adds one period, `at` after closing, to an outcome. */
static void add(outcome_t *out, double nm, int at, double window_nm[MEAN_PERIODS], int *wrong)
{
    window_nm[at % MEAN_PERIODS] = nm;
    double mean_nm = 0.0;
    for (int n = 0; n < MEAN_PERIODS; n++) {
        mean_nm += window_nm[n] / MEAN_PERIODS;
    }
    if (at < UNKNOWN_PERIODS) {
        out->mean_nm = fmax(out->mean_nm, fabs(mean_nm));
    } else {
        out->wrong_nm = fmax(out->wrong_nm, -nm);
    }
    if (at < MEAN_PERIODS / 2) {
        out->first_nm = fmax(out->first_nm, nm);
    }
    *wrong = nm < -2.0 ? *wrong + 1 : 0;
    out->wrong_ms = fmax(out->wrong_ms, (double)*wrong / MEAN_PERIODS);
}

/* From `moving`, some periods later: sign +1 to drive, -1 to brake. */
static outcome_t close_bridge(int instant, double sign)
{
    closing = moving;
    bench_refresh(&closing);
    for (int n = 0; n < instant * INSTANT_PERIODS; n++) {
        bench_period(&closing);
    }
    demand(&closing, sign > 0.0 ? 30.0 : 0.0, sign > 0.0 ? 0.0 : 40.0);
    wheel_t *wheel = &closing.wheel[0];
    for (int n = 0; n < 2 * MEAN_PERIODS && wheel->active.bridge != BRIDGE_PWM; n++) {
        bench_period(&closing);
    }
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, wheel->active.bridge);
    outcome_t out = {.emf_nm = emf_nm(&closing), .confirmed = WATCHED_PERIODS};
    double window_nm[MEAN_PERIODS] = {0.0};
    int wrong = 0;
    for (int n = 0; n < WATCHED_PERIODS; n++) {
        if (wheel->controller.slow.measure.angle.confirmed && out.confirmed == WATCHED_PERIODS) {
            out.confirmed = n;
        }
        const double before_nms = wheel->totals.torque_impulse_nms;
        bench_period(&closing);
        const double shaft_nm =
            (wheel->totals.torque_impulse_nms - before_nms) / closing.world.step_s;
        add(&out, sign * shaft_nm, n, window_nm, &wrong);
    }
    TEST_ASSERT_EQUAL_INT(REASON_NONE, wheel->first_fault);
    return out;
}

/* The worst of all instants. */
static outcome_t worst_of(double sign)
{
    outcome_t all = {.emf_nm = 0.0};
    for (int instant = 0; instant < INSTANTS; instant++) {
        const outcome_t out = close_bridge(instant, sign);
        all.emf_nm = fmax(all.emf_nm, out.emf_nm);
        all.mean_nm = fmax(all.mean_nm, out.mean_nm);
        all.first_nm = fmax(all.first_nm, out.first_nm);
        all.wrong_nm = fmax(all.wrong_nm, out.wrong_nm);
        all.wrong_ms = fmax(all.wrong_ms, out.wrong_ms);
        all.confirmed = out.confirmed > all.confirmed ? out.confirmed : all.confirmed;
    }
    return all;
}

/* Speeds at which the bridge opens. */
static const double SPEEDS_KMH[] = {7.0, 10.0, 20.0, 30.0, 40.0, 47.0};
enum { SPEEDS_COUNT = sizeof SPEEDS_KMH / sizeof SPEEDS_KMH[0] };

void test_with_its_sensor_the_observer_is_confirmed_within_5_ms_of_closing(void)
{
    for (int k = 0; k < SPEEDS_COUNT; k++) {
        coast_at(SPEEDS_KMH[k], NEVER);
        for (int drive = 0; drive < 2; drive++) {
            const outcome_t out = worst_of(drive == 1 ? 1.0 : -1.0);
            TEST_ASSERT_TRUE(out.confirmed < CONFIRMED_PERIODS);
            TEST_ASSERT_TRUE(out.wrong_nm < 2.0);
            TEST_ASSERT_TRUE(out.wrong_ms == 0.0);
        }
    }
}

/*
 * The law, a quarter more for the delay of the loop, and the iron's current w psi/R_i, whose drag
 * is 1 to 2 N m here. What the integrators have gathered is at most a third of it; the dead time's
 * 1 V adds 1.6 N m. Of the wrong sign for at most twice the time of UNKNOWN_PERIODS.
 */
static void assert_without_sensor(double kmh, plug_t off)
{
    coast_at(kmh, off);
    for (int drive = 0; drive < 2; drive++) {
        const outcome_t out = worst_of(drive == 1 ? 1.0 : -1.0);
        char text[160];
        snprintf(text, sizeof text,
                 "%.0f km/h, %s: law %.1f, mean %.1f N m, wrong %.1f N m, %.2f ms; confirmed after "
                 "%.2f ms",
                 kmh, drive == 1 ? "drive" : "brake", out.emf_nm, out.mean_nm, out.wrong_nm,
                 out.wrong_ms, (double)out.confirmed / MEAN_PERIODS);
        puts(text);
        TEST_ASSERT_TRUE_MESSAGE(out.mean_nm < 1.25 * out.emf_nm + 2.0, text);
        TEST_ASSERT_TRUE_MESSAGE(out.mean_nm > 0.75 * out.emf_nm, text);
        TEST_ASSERT_TRUE_MESSAGE(out.wrong_nm < out.emf_nm / 3.0 + 3.6, text);
        TEST_ASSERT_TRUE_MESSAGE(out.wrong_ms < 6.0, text);
        TEST_ASSERT_TRUE_MESSAGE(out.confirmed <= FOUND_PERIODS, text);
        if (drive == 1) {
            /* The EMF brakes whatever the demand is. */
            TEST_ASSERT_TRUE_MESSAGE(out.first_nm < 0.5, text);
        }
    }
}

void test_without_a_sensor_the_torque_of_closing_is_that_of_the_emf(void)
{
    for (int k = 0; k < SPEEDS_COUNT; k++) {
        assert_without_sensor(SPEEDS_KMH[k], DRIVING);
        assert_without_sensor(SPEEDS_KMH[k], COASTING);
    }
}
