/* SPDX-License-Identifier: Apache-2.0 */
/* Inputs of the converters: late samples, shunts with too short a window, and a firmware that
 * chooses two of three shunts. */
#include "bench/feed.h"

#include <math.h>

#include "bench/bench.h"
#include "unity.h"
#include "vehicle_fixture.h"

static bench_params_t params;
static config_t config;

void setUp(void)
{
    params = fixture_quarter_vehicle();
    params.run.initial_speed_m_per_s =
        15.0; /* 573 r/min: 28 V of back-EMF, a peak phase voltage of 30.6 V at most */
    params.driver.drive_demand_nm = 15.0;
    params.sensors.current_noise_a = 0.0;
    params.sensors.bus_voltage_noise_v = 0.0;
    config = fixture_config_with_sensor(CONFIG_STRATEGY_SERIES_OPTIMAL, CONFIG_ROTOR_ANGLE);
}

void tearDown(void) {}

static double length_a(plant_abc_t i)
{
    const plant_ab_t ab = plant_clarke(i);
    return hypot(ab.alpha, ab.beta);
}

static double apart_a(plant_abc_t one, plant_abc_t other)
{
    const plant_abc_t difference = {
        .a = one.a - other.a, .b = one.b - other.b, .c = one.c - other.c};
    return length_a(difference);
}

/* Two readings, and the third phase as minus their sum. */
static plant_abc_t without(plant_abc_t seen, int phase)
{
    plant_abc_t out = seen;
    double *const third = phase == 0 ? &out.a : (phase == 1 ? &out.b : &out.c);
    *third -= seen.a + seen.b + seen.c;
    return out;
}

static int longest(const uint16_t counts[3])
{
    return counts[0] >= counts[1] && counts[0] >= counts[2] ? 0 : (counts[1] >= counts[2] ? 1 : 2);
}

typedef struct {
    double chosen_a, fixed_a, all_a, firmware_a; /* largest errors of the current vector */
    double current_a;                            /* largest */
    double torque_nm;
    reason_t fault;
} seen_t;

static seen_t drive(void)
{
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.3);
    wheel_t *wheel = &bench->wheel[0];
    seen_t out = {.chosen_a = 0.0};
    const double before_nms = wheel->totals.torque_impulse_nms;
    const double base_a = 1e-3 * config.drive.current_full_scale_mA;
    for (int k = 0; k < 4000; k++) {
        bench_period(bench);
        const plant_abc_t truth = plant_inverse_clarke(wheel->at_top);
        out.chosen_a =
            fmax(out.chosen_a,
                 apart_a(without(wheel->sampled_a, longest(wheel->active.compare_counts)), truth));
        out.fixed_a = fmax(out.fixed_a, apart_a(without(wheel->sampled_a, 2), truth));
        out.all_a = fmax(out.all_a, apart_a(wheel->sampled_a, truth));
        const dq_t measured = dq_of(foc_latest(&wheel->controller.fast.foc)->i_pu);
        const double measured_a = hypot(measured.d, measured.q) / 32768.0 * base_a;
        out.firmware_a = fmax(out.firmware_a, fabs(measured_a - length_a(truth)));
        out.current_a = fmax(out.current_a, length_a(truth));
    }
    out.torque_nm = (wheel->totals.torque_impulse_nms - before_nms) / 0.2;
    out.fault = wheel->first_fault;
    return out;
}

void test_ideal_shunts_measure_the_current_with_any_choice_of_phases(void)
{
    const seen_t seen = drive();
    TEST_ASSERT_TRUE(seen.current_a > 15.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, seen.chosen_a);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, seen.fixed_a);
}

void test_near_full_voltage_only_the_chosen_shunts_measure_without_error(void)
{
    /* The torque limits keep no voltage back: the drive runs at its full modulation. */
    config.current_loop.modulation_reserve_pu_q15 = 0;
    params.sensors.shunt_settling_s = 0.3e-6;
    const seen_t seen = drive();
    TEST_ASSERT_EQUAL_INT(REASON_NONE, seen.fault);
    /* At the full modulation of 0.919 the leg that is up longest is so for 0.96 of 50 us: 1 us at
     * the bottom before the sample, and a dead time of 1 us off that where its current comes out of
     * the motor. Its sample contains almost nothing of its current. The second longest, on a tie,
     * is up for (1 + 0.919 sqrt(3)/2) / 2 = 0.898: 2.5 us less 1 us, 5 time constants, 1 %. */
    TEST_ASSERT_TRUE(seen.chosen_a < 0.02 * seen.current_a);
    TEST_ASSERT_TRUE(seen.fixed_a > 0.06 * seen.current_a);
    TEST_ASSERT_TRUE(seen.fixed_a > 4.0 * seen.chosen_a);
    TEST_ASSERT_TRUE(seen.all_a > 2.0 * seen.chosen_a);
    /* The firmware itself, converter's steps of 0.08 A included. */
    TEST_ASSERT_TRUE(seen.firmware_a < 0.02 * seen.current_a + 0.2);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 15.0, seen.torque_nm);
}

void test_with_the_switching_bridge_the_chosen_shunts_have_the_least_error(void)
{
    params.sensors.shunt_settling_s = 0.3e-6;
    params.inverter.switching = 1.0;
    const seen_t seen = drive();
    TEST_ASSERT_EQUAL_INT(REASON_NONE, seen.fault);
    TEST_ASSERT_TRUE(seen.chosen_a < 0.02 * seen.current_a);
    TEST_ASSERT_TRUE(seen.fixed_a > 4.0 * seen.chosen_a);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 15.0, seen.torque_nm);
}

void test_a_late_sample_is_the_current_of_that_instant(void)
{
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.3);
    bench->params.sensors.sampling_delay_s = 10e-6;
    bench_refresh(bench);
    wheel_world_t first_part = bench->world;
    first_part.step_s = 10e-6;
    int same = 0;
    for (int k = 0; k < 200; k++) {
        wheel_t *wheel = &bench->wheel[0];
        wheel_sample(wheel, &bench->world, bench->bus.voltage_v);
        wheel_t copy = *wheel;
        wheel_step(&copy, &first_part, wheel->motion.speed_rad_s, bench->bus.voltage_v);
        const plant_abc_t then = plant_inverse_clarke(copy.rotor.terminal);
        same += apart_a(wheel->sampled_a, then) < 1e-9 ? 1 : 0;
        /* Where a current changes its sign the dead time's voltage, 0.02 * 54 V of a leg, is
         * decided in the middle of the step. It drives the inductance for 10 us, and at once the
         * iron branch, 1.5 + 0.006 * 1380 Ohm. */
        const double amperes_per_volt = 10e-6 / 76e-6 + 1.0 / (1.5 + 0.006 * 1380.0);
        TEST_ASSERT_TRUE(apart_a(wheel->sampled_a, then) <
                         4.0 / 3.0 * 0.02 * 54.0 * amperes_per_volt);
        bench_period(bench);
    }
    TEST_ASSERT_TRUE(same > 150);
}

/* How far the sample is from the top's current, at most; over the current. */
static double late_share(double switching)
{
    params.inverter.switching = switching;
    params.sensors.sampling_delay_s = 8e-6;
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.2);
    wheel_t *wheel = &bench->wheel[0];
    double out = 0.0;
    for (int k = 0; k < 400; k++) {
        bench_period(bench);
        const plant_abc_t top = plant_inverse_clarke(wheel->at_top);
        out = fmax(out, apart_a(wheel->sampled_a, top) / length_a(top));
    }
    TEST_ASSERT_EQUAL_INT(REASON_NONE, wheel->first_fault);
    return out;
}

void test_a_late_sample_contains_ripple_only_with_the_switching_bridge(void)
{
    params.driver.drive_demand_nm = 30.0;
    const double averaged = late_share(0.0);
    const double ripple = late_share(1.0);
    /* Eight microseconds turn the vector by 8e-6 * 1380 rad/s = 1.1 %; on the switching bridge the
     * zero vector lets the back-EMF of 28 V at 76 uH have it for up to so long: 3 A of 41. */
    TEST_ASSERT_TRUE(averaged < 0.03);
    TEST_ASSERT_TRUE(ripple > 0.04 && ripple < 0.15);
}

void test_a_sample_beyond_the_middle_of_the_period_is_refused(void)
{
    TEST_ASSERT_NULL(bench_world_objection(&params));
    params.sensors.sampling_delay_s = 26e-6;
    TEST_ASSERT_NOT_NULL(bench_world_objection(&params));
    params.inverter.pwm_frequency_hz = 10e3;
    TEST_ASSERT_NULL(bench_world_objection(&params));
}
