/* SPDX-License-Identifier: Apache-2.0 */
/* The energy of the winding's inductance beside a current loop in double precision, of the paper's
 * motor: 31 mohm, 76 uH, 20 kHz, bandwidth 1 kHz. W = 3/2 L i^2 (1/g - 1). */
#include <math.h>

#include "config/bases.h"
#include "monitor/monitor_jump.h"
#include "paper_vehicle.h"
#include "unity.h"

enum { PERIODS = 20, DISTURBED_ms = 30, RUN_ms = 120 };

static const double PI = 3.14159265358979323846;
static const double BUS_V = 53.0;

/* What happens to the loop from DISTURBED_ms on. */
typedef struct {
    double reference_a, emf_v;
    double gain;          /* of all sensors */
    double gain_drift_ms; /* the gain takes this long to change; 0: at once */
    double reading;       /* of the bus sensor */
    double emf_step_v;
    double emf_wave_v, wave_hz;
    double ramp_a_per_ms; /* of the reference, from DISTURBED_ms on for 10 ms */
    double glitch;        /* of one sample, as a share of the current */
    int period;           /* of the millisecond, in which it begins */
} run_t;

static const run_t QUIET = {.reference_a = -50.0, .emf_v = 10.0, .gain = 1.0, .reading = 1.0};

static monitor_jump_state_t state;
static config_t config;

void setUp(void)
{
    const monitor_jump_state_t fresh = {.filled = 0};
    state = fresh;
    config = paper_vehicle();
}

void tearDown(void) {}

static double progress(double ms, double drift_ms)
{
    return ms < 0.0 ? 0.0 : drift_ms <= 0.0 || ms >= drift_ms ? 1.0 : ms / drift_ms;
}

static bool step(double q_a, double bus_a, bool watched)
{
    const monitor_jump_input_t in = {
        .i_pu = {.q = (int32_t)lround(32768e3 * q_a / config.drive.current_full_scale_mA)},
        .bus_current_mA = (int32_t)lround(1e3 * bus_a),
        .bus_voltage_mV = (int32_t)lround(1e3 * BUS_V),
        .watched = watched,
    };
    return monitor_jump_step(&state, &config, &in);
}

/* The millisecond after DISTURBED_ms in which a jump is named; -1: in none. The voltage of a period
 * acts in the next one. */
static int named_after(const run_t *run)
{
    const double r = 1e-6 * config.motor.phase_resistance_uOhm;
    const double l = 1e-9 * config.motor.q_inductance_nH;
    const double period_s = 1e-3 / PERIODS;
    const double bandwidth = 2.0 * PI * 1000.0;
    double true_a = run->reference_a;
    double integral_v = r * run->reference_a + run->emf_v;
    double next_v = integral_v;
    setUp();
    for (int ms = 0; ms < RUN_ms; ms++) {
        double sum_a = 0.0;
        double sum_w = 0.0;
        for (int k = 0; k < PERIODS; k++) {
            const double since_ms = ms - DISTURBED_ms + (k - run->period) / (double)PERIODS;
            const bool disturbed = since_ms > -1e-9;
            const bool glitch = disturbed && since_ms < 0.5 / PERIODS;
            const double gain = 1.0 + (run->gain - 1.0) *
                                          progress(since_ms + 1e-9, run->gain_drift_ms) *
                                          (disturbed ? 1.0 : 0.0);
            const double shown_a = gain * true_a * (glitch ? 1.0 + run->glitch : 1.0);
            const double wanted_a =
                run->reference_a + (disturbed ? run->ramp_a_per_ms * fmin(since_ms, 10.0) : 0.0);
            const double reading = disturbed ? run->reading : 1.0;
            const double emf_v = run->emf_v + (disturbed ? run->emf_step_v : 0.0) +
                                 run->emf_wave_v * sin(2.0 * PI * run->wave_hz * 1e-3 * since_ms);
            const double set_v = next_v;
            integral_v += bandwidth * r * period_s * (wanted_a - shown_a);
            next_v = integral_v + bandwidth * l * (wanted_a - shown_a);
            sum_a += shown_a;
            sum_w += 1.5 * set_v * shown_a;
            /* As little as the sensor reads too much the bridge makes too little. */
            const double end_a = (set_v / reading - emf_v) / r;
            true_a = end_a + (true_a - end_a) * exp(-r / l * period_s);
        }
        if (step(sum_a / PERIODS, sum_w / PERIODS / BUS_V, true)) {
            return ms - DISTURBED_ms;
        }
    }
    return -1;
}

/* By braking and by driving motors; the jump is two milliseconds at most. */
void test_gain_that_steps_is_named_whatever_the_power(void)
{
    const double gains[] = {0.4, 0.5, 1.4, 1.6, 2.0};
    for (int g = 0; g < 5; g++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            for (double emf_v = -20.0; emf_v <= 20.0; emf_v += 5.0) {
                run_t run = QUIET;
                run.reference_a = 30.0 * sign;
                run.gain = gains[g];
                run.emf_v = emf_v;
                const int at_ms = named_after(&run);
                TEST_ASSERT_GREATER_OR_EQUAL_INT(MONITOR_JUMP_NAME_STEPS, at_ms);
                TEST_ASSERT_LESS_OR_EQUAL_INT(MONITOR_JUMP_NAME_STEPS + 4, at_ms);
            }
        }
    }
}

/* 0.37 L i^2 is W at 0.8 and 1.33. */
void test_smaller_steps_and_drifts_are_not_named(void)
{
    const double gains[] = {0.85, 0.9, 1.0, 1.1, 1.2};
    for (int g = 0; g < 5; g++) {
        for (int period = 0; period < PERIODS; period++) {
            run_t run = QUIET;
            run.gain = gains[g];
            run.period = period;
            TEST_ASSERT_EQUAL_INT(-1, named_after(&run));
        }
    }
    run_t drift = QUIET;
    drift.gain_drift_ms = 50.0;
    for (double gain = 0.65; gain < 1.5; gain += 0.7) {
        drift.gain = gain;
        TEST_ASSERT_EQUAL_INT(-1, named_after(&drift));
    }
}

/* What a healthy drive meets: the inductance then takes up what its current shows. An EMF that
 * steps by 2 V (44 rad/s of the wheel), or swings as a road that shakes a wheel of 0.7 kg m^2 with
 * 300 N m makes it, 32 V Hz; a bus reading that steps
 * by a tenth; a reference at the torque rate, 400 N m/s, begins and ends; one sample of all sensors
 * half as large or by a half larger. */
void test_other_disturbances_are_not_named(void)
{
    for (int period = 0; period < PERIODS; period++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            for (double current_a = 10.0; current_a <= 55.0; current_a += 22.5) {
                run_t run = QUIET;
                run.period = period;
                run.reference_a = -current_a;
                run.emf_v = 15.0 * sign;
                run_t other = run;
                other.emf_step_v = 2.0 * sign;
                TEST_ASSERT_EQUAL_INT(-1, named_after(&other));
                other = run;
                for (double hz = 20.0; hz <= 200.0; hz += 60.0) {
                    other.wave_hz = hz;
                    other.emf_wave_v = 32.0 / hz;
                    TEST_ASSERT_EQUAL_INT(-1, named_after(&other));
                }
                other = run;
                other.reading = 1.0 + 0.1 * sign;
                TEST_ASSERT_EQUAL_INT(-1, named_after(&other));
                other = run;
                other.ramp_a_per_ms = 0.57 * sign;
                TEST_ASSERT_EQUAL_INT(-1, named_after(&other));
                other = run;
                other.glitch = 0.5 * sign;
                TEST_ASSERT_EQUAL_INT(-1, named_after(&other));
            }
        }
    }
}

/* Two milliseconds before, of the jump, and after it: 50 A less a dip, and the bus in amperes. */
static bool found(double dip_a, double before_a, double jump_a, double after_a)
{
    setUp();
    for (int ms = 0; ms < MONITOR_JUMP_STEPS; ms++) {
        const bool during = ms == 2 || ms == 3;
        (void)step(during ? 50.0 - dip_a : 50.0,
                   ms < 2   ? before_a
                   : during ? jump_a
                            : after_a,
                   true);
    }
    return state.since_steps > 0;
}

/* L i^2 is 0.19 J; 0.4 * 2^-30 10^9 of it in two milliseconds are 35.4 W each, 0.668 A of 53 V. A
 * current of 50 A that dips in each has lost 7/32 of its energy together at 2.77 A; that rises has
 * gained a sixteenth at 0.775 A. */
void test_energy_has_to_be_missing_on_both_sides(void)
{
    const double each_a = 0.5 * 0.4 * 0.93132 * 0.19 / 1e-3 / 53.0;
    TEST_ASSERT_TRUE(found(4.0, 0.0, 1.01 * each_a, 0.0));
    TEST_ASSERT_FALSE(found(4.0, 0.0, 0.99 * each_a, 0.0));
    TEST_ASSERT_FALSE(found(4.0, 0.0, 2.0 * each_a, 2.0 * each_a));
    TEST_ASSERT_FALSE(found(4.0, 2.0 * each_a, 2.0 * each_a, 0.0));
    /* The current that dips takes energy up, the other way round it gives it back. */
    TEST_ASSERT_FALSE(found(4.0, 0.0, -2.0 * each_a, 0.0));
    TEST_ASSERT_TRUE(found(-2.0, 0.0, -1.01 * each_a, 0.0));
    TEST_ASSERT_FALSE(found(-2.0, 0.0, -0.99 * each_a, 0.0));
    TEST_ASSERT_FALSE(found(-2.0, 0.0, 2.0 * each_a, 0.0));
    TEST_ASSERT_TRUE(found(2.85, 0.0, 10.0, 0.0));
    TEST_ASSERT_FALSE(found(2.75, 0.0, 10.0, 0.0));
    TEST_ASSERT_TRUE(found(-0.79, 0.0, -10.0, 0.0));
    TEST_ASSERT_FALSE(found(-0.76, 0.0, -10.0, 0.0));
}

/* A current that dips by a tenth at the same voltage makes a tenth less power, and 2 A in two
 * milliseconds are beyond the threshold, 1.336 A. W counts from there. */
void test_power_of_the_current_that_dips_is_no_energy_of_the_jump(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        TEST_ASSERT_FALSE(found(5.0, 10.0 * sign, 9.0 * sign, 10.0 * sign));
        TEST_ASSERT_FALSE(found(5.0, 10.0 * sign, 9.0 * sign + 0.4, 10.0 * sign));
        TEST_ASSERT_TRUE(found(5.0, 10.0 * sign, 9.0 * sign + 0.8, 10.0 * sign));
    }
}

/* Six times what the bus moves in a millisecond on either side: 10 A, without a movement 12 A. */
void test_power_is_steady_beside_a_jump(void)
{
    for (int side = 0; side < 2; side++) {
        for (int k = 0; k < 2; k++) {
            setUp();
            for (int ms = 0; ms < MONITOR_JUMP_STEPS; ms++) {
                const bool during = ms == 2 || ms == 3;
                const double moved_a = ms == 5 * side ? (k == 0 ? 1.6 : 1.7) : 0.0;
                (void)step(during ? 45.0 : 50.0, during ? 5.0 + 0.8 : moved_a, true);
            }
            /* 11.6 A less 0.9025 of what has moved: 10.1 A of 1.6, 10 A of 1.7. */
            TEST_ASSERT_EQUAL_INT(k == 0, state.since_steps > 0);
        }
    }
}

/* Both axes: 120 and 160 A of L_d = 0.5, L_q = 1 mH make 32.8 J; 0.2794 of it are 45.8 A of 100 V
 * in two milliseconds each. */
void test_energy_is_that_of_both_axes(void)
{
    config.motor.d_inductance_nH = 500000;
    config.motor.q_inductance_nH = 1000000;
    config.drive.current_full_scale_mA = 327680;
    for (int k = 0; k < 2; k++) {
        const monitor_jump_state_t fresh = {.filled = 0};
        state = fresh;
        for (int ms = 0; ms < MONITOR_JUMP_STEPS; ms++) {
            const bool during = ms == 2 || ms == 3;
            const monitor_jump_input_t in = {
                .i_pu = {.d = during ? -10500 : -12000, .q = during ? 14000 : 16000},
                .bus_current_mA = during ? (k == 0 ? 62000 : 60000) : 0,
                .bus_voltage_mV = 100000,
                .watched = true};
            (void)monitor_jump_step(&state, &config, &in);
        }
        TEST_ASSERT_EQUAL_INT(k == 0, state.since_steps > 0);
    }
}

/* A current that has changed by more than 3 % was not kept. */
void test_current_before_and_after_is_the_same(void)
{
    for (int percent = -6; percent <= 6; percent += 3) {
        setUp();
        for (int ms = 0; ms < MONITOR_JUMP_STEPS; ms++) {
            const bool during = ms == 2 || ms == 3;
            (void)step(during   ? 40.0
                       : ms < 2 ? 50.0 * (1.0 + 0.01 * percent)
                                : 50.0,
                       during ? 10.0 : 0.0, true);
        }
        TEST_ASSERT_EQUAL_INT(percent > -6 && percent<6, state.since_steps> 0);
    }
}

/* An eighth of 75 A. */
void test_small_currents_are_not_judged(void)
{
    for (int k = 0; k < 2; k++) {
        setUp();
        const double current_a = k == 0 ? 9.3 : 9.5;
        for (int ms = 0; ms < MONITOR_JUMP_STEPS; ms++) {
            const bool during = ms == 2 || ms == 3;
            (void)step(during ? 0.8 * current_a : current_a, during ? 10.0 : 0.0, true);
        }
        TEST_ASSERT_EQUAL_INT(k, state.since_steps > 0);
    }
}

void test_jump_is_named_until_the_loop_is_not_watched(void)
{
    TEST_ASSERT_TRUE(found(5.0, 0.0, 10.0, 0.0));
    TEST_ASSERT_EQUAL_UINT8(1, state.since_steps);
    for (int ms = 2; ms < MONITOR_JUMP_NAME_STEPS; ms++) {
        TEST_ASSERT_FALSE(step(50.0, 5.0, true));
    }
    for (int ms = 0; ms < 1000; ms++) {
        TEST_ASSERT_TRUE(step(0.0, 0.0, true));
    }
    TEST_ASSERT_FALSE(step(50.0, 5.0, false));
    for (int ms = 0; ms < 1000; ms++) {
        TEST_ASSERT_FALSE(step(50.0, 5.0, true));
    }
}

/* What was before a pause is no part of a jump. */
void test_six_milliseconds_are_watched_without_a_pause(void)
{
    for (int pause_ms = 1; pause_ms < MONITOR_JUMP_STEPS; pause_ms++) {
        setUp();
        for (int ms = -MONITOR_JUMP_RING; ms < MONITOR_JUMP_STEPS; ms++) {
            const bool during = ms == 2 || ms == 3;
            (void)step(during ? 45.0 : 50.0, during ? 10.0 : 0.0, ms != pause_ms);
        }
        TEST_ASSERT_EQUAL_UINT8(0, state.since_steps);
    }
}

void test_any_reading_is_no_overflow(void)
{
    config.motor.d_inductance_nH = 1000000000;
    config.motor.q_inductance_nH = 1000000000;
    config.drive.current_full_scale_mA = 4000000;
    for (int ms = 0; ms < 3000; ms++) {
        const monitor_jump_input_t in = {
            .i_pu = {.d = ms % 7 == 0 ? 65536 : -65536, .q = ms % 2 == 0 ? 65536 : -65536},
            .bus_current_mA = ms % 3 == 0 ? INT32_MAX : INT32_MIN,
            .bus_voltage_mV = ms % 5 == 0 ? INT32_MIN : INT32_MAX,
            .watched = true,
        };
        (void)monitor_jump_step(&state, &config, &in);
        TEST_ASSERT_LESS_OR_EQUAL_UINT8(MONITOR_JUMP_STEPS, state.filled);
    }
}
