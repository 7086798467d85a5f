/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Loss of the rotor sensor where the EMF exceeds the bus voltage: the bridge must stay in active
 * short circuit until the speed is below the freewheel limit, and must freewheel then, because the
 * braking torque of the short circuit rises with falling speed. Without the EMF observer, which
 * would take over.
 */
#include <math.h>
#include <stdio.h>

#include "unity.h"
#include "vehicle_fixture.h"

void setUp(void) {}

void tearDown(void) {}

static const double G_M_PER_S2 = 9.81;
static const double LEFT_AT_SHARE = 0.9; /* of the limit */

/* Faults of the encoder. */
typedef enum {
    JUMPS,      /* once, by more than a quarter of its counts, and counts on */
    FALLS_QUIET /* and counts no more */
} loss_t;

static bench_t *with_encoder(const char *name, double rad_s)
{
    bench_params_t params = fixture_one_wheel(fixture_drive(name));
    params.encoder.counts = 4096.0;
    params.encoder.index_deg = 77.0;
    params.encoder.index_width_counts = 1.0;
    params.run.initial_speed_m_per_s = rad_s * params.vehicle.wheel_radius_m;
    config_t config = fixture_drive_config(name);
    config.rotor.sensor = CONFIG_ROTOR_ENCODER;
    config.rotor.encoder_counts = 4096;
    config.rotor.encoder_index_turn = (int32_t)lround(77.0 / 360.0 * 65536.0);
    config.rotor.observer_takeover = 0;
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.2);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, bench->wheel[0].first_fault);
    return bench;
}

static void lose_encoder(bench_t *bench, loss_t loss)
{
    bench->wheel[0].shaft.lost_counts +=
        1100.0; /* more than half an electrical turn of 3 pole pairs, 683 */
    if (loss == FALLS_QUIET) {
        bench->params.encoder.counts = 0.0;
        bench_refresh(bench);
    }
}

/* The speed at which the rectified EMF is the open-circuit voltage of the battery. */
static double limit_rad_s(const char *name)
{
    const bench_t *bench = with_encoder(name, 30.0);
    const pmsm_params_t *motor = &bench->params.motor;
    return bench->battery.terminal_v / (sqrt(3.0) * motor->flux_linkage_wb * motor->pole_pairs);
}

/* Energy that the diodes return of the short-circuit current psi / L_d when the bridge opens:
 * 3/4 L_d i^2, and half of that again from the EMF while the current falls. */
static double field_j(const bench_t *bench)
{
    const pmsm_params_t *motor = &bench->params.motor;
    return 1.5 * 0.75 * motor->flux_linkage_wb * motor->flux_linkage_wb / motor->d_inductance_h;
}

typedef struct {
    double limit_rad_s;
    double charged_j;       /* through the diodes of the open bridge into the battery */
    double opened_at_share; /* of the limit; the first time */
    double shorted_at_share;
    int times_opened, times_shorted;
    bridge_mode_t bridge;
} outcome_t;

static outcome_t start_at(const bench_t *bench, double limit)
{
    const outcome_t out = {
        .limit_rad_s = limit,
        .opened_at_share = -1.0,
        .shorted_at_share = -1.0,
        .bridge = bench->wheel[0].active.bridge,
    };
    return out;
}

/* One period at a speed. */
static void watch_period(bench_t *bench, double rad_s, outcome_t *out)
{
    const wheel_t *wheel = &bench->wheel[0];
    const double dc_j = wheel->totals.dc_j;
    bench->vehicle.speed_m_per_s = rad_s * bench->params.vehicle.wheel_radius_m;
    bench->vehicle.acceleration_m_per_s2 = 0.0;
    bench_period(bench);
    const bridge_mode_t now = wheel->active.bridge;
    if (now == BRIDGE_OFF) {
        out->charged_j += fmax(dc_j - wheel->totals.dc_j, 0.0);
    }
    if (now != out->bridge && now == BRIDGE_OFF && out->times_opened++ == 0) {
        out->opened_at_share = rad_s / out->limit_rad_s;
    }
    if (now != out->bridge && now == BRIDGE_SHORT && out->times_shorted++ == 0) {
        out->shorted_at_share = rad_s / out->limit_rad_s;
    }
    out->bridge = now;
}

/* From one speed to another one at a constant rate. */
static void change_speed(bench_t *bench, double from_rad_s, double to_rad_s, double m_per_s2,
                         outcome_t *out)
{
    const double rate_rad_s2 = m_per_s2 / bench->params.vehicle.wheel_radius_m;
    const int periods = (int)(fabs(to_rad_s - from_rad_s) / (rate_rad_s2 * bench->world.step_s));
    for (int n = 0; n < periods; n++) {
        watch_period(bench, from_rad_s + (to_rad_s - from_rad_s) * n / periods, out);
    }
}

static void print_result(const char *name, const outcome_t *out, char text[static 200])
{
    snprintf(text, 200,
             "%s: %.3f J charged; opened %d times, first at %.3f; shorted %d times, first at %.3f "
             "of the limit",
             name, out->charged_j, out->times_opened, out->opened_at_share, out->times_shorted,
             out->shorted_at_share);
}

/* ---- a sensor is lost above the limit ---- */

/*
 * The bridge opens at 0.9 of the limit. The speed is measured over four turns to a PWM period at
 * each end; and it grows old: half a window when it ends, as much as the next one takes, and two
 * milliseconds for exchange and rounding. lu2013 turns 215 times a second there: 30 ms, in which 1
 * g takes 0.29 m/s of the limit's 16.3, 1.8 %, and 0.3 % of rounding. ipm400v turns 464 times: 15
 * ms, 0.15 m/s of 62, 0.2 %, and 1.2 %.
 */
static void assert_freewheel_below_the_limit(const char *name)
{
    const double limit = limit_rad_s(name);
    bench_t *bench = with_encoder(name, 1.05 * limit);
    const double four_turns_s =
        4.0 * PLANT_TWO_PI / (LEFT_AT_SHARE * limit * bench->params.motor.pole_pairs);
    const double rounding = bench->world.step_s / four_turns_s;
    const double ageing =
        (1.5 * four_turns_s + 2e-3) * G_M_PER_S2 / (limit * bench->params.vehicle.wheel_radius_m);
    lose_encoder(bench, FALLS_QUIET);
    outcome_t out = start_at(bench, limit);
    change_speed(bench, 1.05 * limit, 0.1 * limit, G_M_PER_S2, &out);
    char text[200];
    print_result(name, &out, text);
    TEST_ASSERT_NOT_EQUAL(REASON_NONE, bench->wheel[0].slow.fault_reason);
    TEST_ASSERT_EQUAL_INT_MESSAGE(1, out.times_shorted, text);
    TEST_ASSERT_EQUAL_INT_MESSAGE(1, out.times_opened, text);
    TEST_ASSERT_TRUE_MESSAGE(out.charged_j < field_j(bench), text);
    TEST_ASSERT_TRUE_MESSAGE(out.opened_at_share < LEFT_AT_SHARE * (1.0 + rounding), text);
    TEST_ASSERT_TRUE_MESSAGE(out.opened_at_share > LEFT_AT_SHARE * (1.0 - rounding) - ageing, text);
}

/* A short circuit of 268 A is not admissible for a motor of 75 A: it freewheels above the limit
 * too, and returns no more than its share of the pack's charge current. */
void test_bridge_of_the_paper_s_motor_freewheels_after_a_lost_sensor(void)
{
    const double limit = limit_rad_s("lu2013");
    bench_t *bench = with_encoder("lu2013", 1.05 * limit);
    lose_encoder(bench, FALLS_QUIET);
    outcome_t out = start_at(bench, limit);
    change_speed(bench, 1.05 * limit, 0.1 * limit, G_M_PER_S2, &out);
    TEST_ASSERT_NOT_EQUAL(REASON_NONE, bench->wheel[0].slow.fault_reason);
    TEST_ASSERT_EQUAL_INT(0, out.times_shorted);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, out.bridge);
}

void test_bridge_of_the_interior_magnet_motor_freewheels_in_time_below_the_limit(void)
{
    assert_freewheel_below_the_limit("ipm400v");
}

void test_restarted_encoder_does_not_cause_freewheel_above_the_limit(void)
{
    const char *const names[] = {"ipm400v"};
    for (int k = 0; k < 1; k++) {
        const double limit = limit_rad_s(names[k]);
        bench_t *bench = with_encoder(names[k], 1.05 * limit);
        lose_encoder(bench, JUMPS);
        outcome_t out = start_at(bench, limit);
        change_speed(bench, 1.05 * limit, 1.05 * limit + 0.01,
                     0.01 * bench->params.vehicle.wheel_radius_m, &out);
        char text[200];
        print_result(names[k], &out, text);
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, out.times_opened, text);
    }
}

/* ---- a wheel without a sensor exceeds the limit, driven by the other wheels or downhill ---- */

/*
 * Its last speed is half the limit, so the bridge is open, and nothing but the diodes' current
 * tells. It becomes 8 A (5 % of the converter's range) a few per cent beyond the limit, and has to
 * show in most looks of 20 ms.
 */
static void assert_shorts_when_the_diodes_conduct(const char *name)
{
    const double limit = limit_rad_s(name);
    bench_t *bench = with_encoder(name, 0.5 * limit);
    lose_encoder(bench, FALLS_QUIET);
    outcome_t out = start_at(bench, limit);
    bench->params.driver.brake_demand_nm = 5.0;
    bench_refresh(bench);
    change_speed(bench, 0.5 * limit, 0.7 * limit, 0.2 * G_M_PER_S2, &out);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, out.bridge);
    change_speed(bench, 0.7 * limit, 1.3 * limit, 0.2 * G_M_PER_S2, &out);
    char text[200];
    print_result(name, &out, text);
    TEST_ASSERT_EQUAL_INT_MESSAGE(BRIDGE_SHORT, out.bridge, text);
    TEST_ASSERT_EQUAL_INT_MESSAGE(1, out.times_shorted, text);
    TEST_ASSERT_TRUE_MESSAGE(out.shorted_at_share > 1.0 && out.shorted_at_share < 1.1, text);
    change_speed(bench, 1.3 * limit, 0.7 * limit, G_M_PER_S2, &out);
    TEST_ASSERT_EQUAL_INT_MESSAGE(BRIDGE_OFF, out.bridge, text);
    TEST_ASSERT_EQUAL_INT_MESSAGE(1, out.times_shorted, text);
}

void test_diode_current_in_freewheel_selects_the_active_short_circuit(void)
{
    assert_shorts_when_the_diodes_conduct("ipm400v");
}
