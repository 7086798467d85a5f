/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Low-side shunts whose amplifiers need time to settle, and one of them dies: two remain, and the
 * one with the shortest window can no longer be left out. The voltage circle leaves every leg
 * drive.min_pulse before and after the sample, so the windows of any two suffice:
 * firmware/foc/DERIVATIONS.md, Current sensors.
 */
#include <math.h>
#include <stdio.h>

#include "unity.h"
#include "vehicle_fixture.h"

void setUp(void) {}

void tearDown(void) {}

static const double SETTLING_s = 0.3e-6;
static const double WINDOW_s = 2.5e-6; /* dead time of 1 us, then five time constants: 0.7 % */
enum { WATCHED_PERIODS = 4000 };

static bench_t moving, broken;

typedef struct {
    double current_a;   /* largest */
    double window_s;    /* shortest low side before a sample, of the shunts that are not dead */
    double error_share; /* of their readings, over the current: largest */
    double torque_nm;   /* mean */
} outcome_t;

/* `moving` at a speed, sign +1 driving, -1 braking. */
static void start(double speed_m_per_s, double sign)
{
    bench_params_t params = fixture_quarter_vehicle();
    params.run.initial_speed_m_per_s = speed_m_per_s;
    params.driver.drive_demand_nm = sign > 0.0 ? 20.0 : 0.0;
    params.driver.brake_demand_nm = sign > 0.0 ? 0.0 : 20.0;
    params.sensors.shunt_settling_s = SETTLING_s;
    params.sensors.current_noise_a = 0.0;
    config_t config =
        fixture_config_with_sensor(CONFIG_STRATEGY_SERIES_OPTIMAL, CONFIG_ROTOR_ANGLE);
    config.drive.min_pulse_ns = (int32_t)lround(1e9 * WINDOW_s);
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.4);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, bench->wheel[0].first_fault);
    moving = *bench;
    bench_refresh(&moving);
}

/* Of a leg, before the sample at the end of a period. */
static double window_s(const bench_t *bench, int leg)
{
    const double on = bench->wheel[0].active.compare_counts[leg] * bench->world.duty_per_count;
    return (1.0 - on) / 2.0 * bench->world.step_s;
}

/* From `moving`, with the shunt of a phase dead; -1: none. */
static outcome_t run_with_dead(int phase)
{
    broken = moving;
    broken.params.fault.current_sensors = phase < 0 ? 0.0 : (double)(1 << phase);
    broken.params.fault.current_stuck = 1.0;
    bench_refresh(&broken);
    const wheel_t *wheel = &broken.wheel[0];
    outcome_t out = {.window_s = 1.0};
    const double before_nms = wheel->totals.torque_impulse_nms;
    for (int n = 0; n < WATCHED_PERIODS; n++) {
        bench_period(&broken);
        const double current_a = hypot(wheel->rotor.terminal.alpha, wheel->rotor.terminal.beta);
        const plant_abc_t top = plant_inverse_clarke(wheel->at_top);
        const plant_abc_t seen = wheel->sampled_a;
        const double error_a[3] = {seen.a - top.a, seen.b - top.b, seen.c - top.c};
        out.current_a = fmax(out.current_a, current_a);
        for (int leg = 0; leg < 3; leg++) {
            if (leg != phase) {
                out.window_s = fmin(out.window_s, window_s(&broken, leg));
                out.error_share = fmax(out.error_share, fabs(error_a[leg]) / fmax(current_a, 5.0));
            }
        }
    }
    out.torque_nm =
        (wheel->totals.torque_impulse_nms - before_nms) / (WATCHED_PERIODS * broken.world.step_s);
    return out;
}

static void assert_goes_on(int phase, const outcome_t *with_all, double sign)
{
    const outcome_t out = run_with_dead(phase);
    const wheel_t *wheel = &broken.wheel[0];
    char text[160];
    snprintf(text, sizeof text,
             "shunt %d dead, sign %.0f: %.1f A of %.1f, window %.2f us, error %.2f %%, %.2f N m of "
             "%.2f",
             phase, sign, out.current_a, with_all->current_a, 1e6 * out.window_s,
             100.0 * out.error_share, out.torque_nm, with_all->torque_nm);
    puts(text);
    TEST_ASSERT_EQUAL_INT_MESSAGE(REASON_NONE, wheel->first_fault, text);
    TEST_ASSERT_EQUAL_INT_MESSAGE(MODE_LIMP, wheel->slow.mode, text);
    TEST_ASSERT_EQUAL_INT_MESSAGE(REASON_CURRENT_SENSOR_A + phase, wheel->slow.warning_reason,
                                  text);
    /* A count of the timer, and of the dead-time correction. */
    TEST_ASSERT_TRUE_MESSAGE(
        out.window_s > WINDOW_s - 2.0 * broken.world.step_s * broken.world.duty_per_count, text);
    /* As with the two longer windows of three: tests/unit/host_sim/bench/test_feed.c. */
    TEST_ASSERT_TRUE_MESSAGE(out.error_share < 0.02, text);
    TEST_ASSERT_TRUE_MESSAGE(out.current_a < 1.1 * with_all->current_a + 2.0, text);
    if (sign < 0.0) {
        TEST_ASSERT_TRUE_MESSAGE(fabs(out.torque_nm - with_all->torque_nm) < 0.5, text);
    } else {
        TEST_ASSERT_TRUE_MESSAGE(out.torque_nm > 0.25 * with_all->torque_nm, text); /* LIMP */
        TEST_ASSERT_TRUE_MESSAGE(out.torque_nm < with_all->torque_nm + 0.5, text);
    }
}

/* 12 to 16 m/s: from half of the voltage to its end. */
static void assert_two_shunts_suffice(double sign)
{
    double shortest_s = 1.0;
    for (double speed_m_per_s = 12.0; speed_m_per_s < 17.0; speed_m_per_s += 2.0) {
        start(speed_m_per_s, sign);
        const outcome_t with_all = run_with_dead(-1);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, broken.wheel[0].first_fault);
        shortest_s = fmin(shortest_s, with_all.window_s);
        for (int phase = 0; phase < 3; phase++) {
            assert_goes_on(phase, &with_all, sign);
        }
    }
    TEST_ASSERT_TRUE(sign < 0.0 || shortest_s < 1.25 * WINDOW_s); /* the end of the voltage */
}

void test_a_braking_drive_goes_on_with_two_shunts(void)
{
    assert_two_shunts_suffice(-1.0);
}

void test_a_driving_motor_goes_on_with_two_shunts_at_the_end_of_the_voltage(void)
{
    assert_two_shunts_suffice(1.0);
}
