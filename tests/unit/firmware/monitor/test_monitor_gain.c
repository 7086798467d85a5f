/* SPDX-License-Identifier: Apache-2.0 */
/* The bus current of the loop beside that of a battery whose message comes every 100 ms and filters
 * its current. */
#include "monitor/monitor_gain.h"

#include <math.h>

#include "monitor_case.h"
#include "unity.h"

/* 30 N m at 70 rad/s: 2100 W. 40 A make that at 52.5 V. */
enum {
    CYCLE_ms = 100,
    BUS_mV = 52500,
    RATED_mA = 40000,
    LEAST_mA = RATED_mA / 16,
    EXTRA_mA = RATED_mA / 64,
    MOVES_mA = RATED_mA / 8,
    FILTER_ms = 2000,
    WINDOW_ms = 8 * (FILTER_ms + 128),
    SHORT_WINDOW_ms = 8 * 128, /* without a filter */
    RIDE_ms = 150000
};

typedef double (*current_t)(int ms);

static monitor_gain_state_t state;
static config_t config;
static double sign, level_mA;

void setUp(void)
{
    const config_t fresh = {.motor = {.rated_torque_mNm = 30000, .max_speed_mrad_s = 70000},
                            .battery = {.driven_wheels = 1, .current_filter_ms = FILTER_ms}};
    config = fresh;
    sign = 1.0;
    level_mA = RATED_mA / 2.0;
    monitor_gain_restart(&state);
}

void tearDown(void) {}

/* ---- rides ---- */

/* From rest on. */
static double steady(int ms)
{
    return ms < 500 ? 0.0 : level_mA;
}

/* A stop within 5 s, again and again. */
static double stops(int ms)
{
    return level_mA - level_mA * (ms % 5000) / 5000;
}

/* Four seconds of driving, two of braking, and standing: twenty seconds. */
static double urban(int ms)
{
    const int at_ms = ms % 20000;
    return at_ms < 4000 ? level_mA : at_ms < 6000 ? -level_mA : 0.0;
}

static double to_and_fro(int ms)
{
    return ms / 3000 % 2 == 0 ? level_mA : -level_mA;
}

/* Long rest, so that windows begin anywhere, then a short burst. */
static double bursts(int ms)
{
    return ms % 23000 < 3000 ? 2.0 * level_mA : 0.0;
}

static const current_t RIDES[] = {steady, stops, urban, to_and_fro, bursts};
enum { RIDE_COUNT = sizeof RIDES / sizeof RIDES[0] };

/* The loop's current and that of the battery's message, with PWM. */
static monitor_case_t case_of(int32_t loop_mA, int32_t battery_mA)
{
    const monitor_case_t out = {
        .report = {.bridge = BRIDGE_PWM},
        .battery = {.current_mA = battery_mA, .current_given = true},
        .now = {.bus_current_mA = loop_mA, .bus_voltage_mV = BUS_mV},
    };
    return out;
}

static bool step(int32_t loop_mA, int32_t battery_mA)
{
    const monitor_case_t in = case_of(loop_mA, battery_mA);
    return monitor_gain_step(&state, &config, measured_of(&in), true);
}

/* The first millisecond in which the gain is named; -1: none. */
static int named_at(current_t truth, double filter_ms, double loop_gain, double battery_gain,
                    double battery_extra_mA)
{
    double filtered_mA = battery_extra_mA;
    int32_t message_mA = 0;
    monitor_gain_restart(&state);
    for (int ms = 0; ms < RIDE_ms; ms++) {
        const double flows_mA = sign * truth(ms);
        filtered_mA += (flows_mA + battery_extra_mA - filtered_mA) / (1.0 + filter_ms);
        if (ms % CYCLE_ms == 0) {
            message_mA = (int32_t)lround(battery_gain * filtered_mA);
        }
        if (step((int32_t)lround(loop_gain * flows_mA), message_mA)) {
            return ms;
        }
    }
    return -1;
}

/* ---- healthy sensors ---- */

void test_healthy_sensors_are_never_named_whatever_the_filter_and_the_ride(void)
{
    for (int ride = 0; ride < RIDE_COUNT; ride++) {
        for (sign = -1.0; sign <= 1.0; sign += 2.0) {
            for (double filter_ms = 0.0; filter_ms <= FILTER_ms; filter_ms += FILTER_ms / 4.0) {
                for (double gain = 0.96; gain < 1.05; gain += 0.08) {
                    TEST_ASSERT_EQUAL_INT(-1, named_at(RIDES[ride], filter_ms, gain, 1.0, 0.0));
                    TEST_ASSERT_EQUAL_INT(-1,
                                          named_at(RIDES[ride], filter_ms, gain, 1.03, EXTRA_mA));
                    TEST_ASSERT_EQUAL_INT(-1,
                                          named_at(RIDES[ride], filter_ms, gain, 0.97, -EXTRA_mA));
                }
            }
        }
    }
}

/* A filter leaves tau times its change; slower than it is configured that is beyond what the change
 * of twice the configured delay explains. */
void test_a_filter_slower_than_configured_is_no_longer_explained(void)
{
    config.battery.current_filter_ms = 500;
    TEST_ASSERT_EQUAL_INT(-1, named_at(to_and_fro, 500.0, 1.0, 1.0, 0.0));
    TEST_ASSERT_GREATER_THAN_INT(0, named_at(stops, 500.0, 0.7, 1.0, 0.0));
    TEST_ASSERT_GREATER_THAN_INT(0, named_at(steady, 3000.0, 1.0, 1.0, 0.0));
}

/* ---- wrong gains ---- */

/* The window in which the current begins to flow may show too little of it. */
void test_gain_wrong_by_30_percent_is_named_within_two_windows(void)
{
    static const double GAINS[] = {0.5, 0.7, 1.4, 2.0};
    for (sign = -1.0; sign <= 1.0; sign += 2.0) {
        for (int k = 0; k < 4; k++) {
            for (double filter_ms = 0.0; filter_ms <= FILTER_ms; filter_ms += FILTER_ms / 2.0) {
                const int at_ms = named_at(steady, filter_ms, GAINS[k], 1.0, 0.0);
                TEST_ASSERT_GREATER_OR_EQUAL_INT(WINDOW_ms - 1, at_ms);
                TEST_ASSERT_LESS_THAN_INT(2 * WINDOW_ms, at_ms);
            }
            TEST_ASSERT_GREATER_THAN_INT(0, named_at(stops, 20.0, GAINS[k], 1.0, 0.0));
        }
    }
}

/* 30 % of a net third of the charge is a tenth of it: below an eighth. Braking that returns nothing
 * leaves all of it. */
void test_charge_that_goes_to_and_fro_hides_an_error(void)
{
    TEST_ASSERT_EQUAL_INT(-1, named_at(to_and_fro, 20.0, 0.7, 1.0, 0.0));
    TEST_ASSERT_GREATER_THAN_INT(0, named_at(bursts, 20.0, 0.7, 1.0, 0.0));
}

static int32_t missing_after(double loop_gain)
{
    (void)named_at(steady, 0.0, loop_gain, 1.0, 0.0);
    return state.missing_q15;
}

/* Within the 128 ms that the message may be late in a window of 17 s. */
void test_missing_share_is_that_of_the_charges_up_to_four_tenths(void)
{
    TEST_ASSERT_INT_WITHIN(250, 8192, missing_after(0.75));
    TEST_ASSERT_INT_WITHIN(250, 9830, missing_after(0.7));
    TEST_ASSERT_EQUAL_INT(13107, missing_after(0.59));
    TEST_ASSERT_EQUAL_INT(13107, missing_after(0.3));
    TEST_ASSERT_EQUAL_INT(0, missing_after(1.4));
    TEST_ASSERT_EQUAL_INT(0, missing_after(1.0));
}

/* ---- exact bounds: a window of 1024 ms, in which 1 mA is one unit of charge ---- */

static bool windows(int count, int32_t loop_mA, int32_t battery_mA)
{
    bool wrong = false;
    for (int ms = 0; ms < count * SHORT_WINDOW_ms; ms++) {
        wrong = step(loop_mA, battery_mA);
    }
    return wrong;
}

/* Without a filter, of a battery that has been seen to follow, at a window's begin. */
static void start_short(void)
{
    config.battery.current_filter_ms = 0;
    monitor_gain_restart(&state);
    (void)step(0, 0);
    for (int ms = 1; ms < SHORT_WINDOW_ms; ms++) {
        TEST_ASSERT_FALSE(step(RATED_mA, RATED_mA));
    }
    TEST_ASSERT_TRUE(state.follows);
    TEST_ASSERT_EQUAL_INT32(0, state.steps);
}

static bool named(int32_t loop_mA, int32_t battery_mA)
{
    start_short();
    return windows(1, loop_mA, battery_mA);
}

void test_thresholds_of_charge_and_extra_are_exact(void)
{
    const int32_t most_mA = RATED_mA / 8 + EXTRA_mA;
    for (int32_t way = -1; way <= 1; way += 2) {
        const int32_t loop_mA = way * RATED_mA;
        TEST_ASSERT_FALSE(named(loop_mA, loop_mA + most_mA - 1));
        TEST_ASSERT_TRUE(named(loop_mA, loop_mA + most_mA));
        TEST_ASSERT_FALSE(named(loop_mA, loop_mA - most_mA + 1));
        TEST_ASSERT_TRUE(named(loop_mA, loop_mA - most_mA));
    }
}

void test_weak_windows_decide_nothing(void)
{
    for (int32_t way = -1; way <= 1; way += 2) {
        TEST_ASSERT_TRUE(named(way * LEAST_mA, 0));
        TEST_ASSERT_FALSE(named(way * (LEAST_mA - 1), 0));
        TEST_ASSERT_TRUE(named(RATED_mA, 0));
        TEST_ASSERT_TRUE(windows(3, way * (LEAST_mA - 1), way * (LEAST_mA - 1)));
        TEST_ASSERT_FALSE(windows(1, way * LEAST_mA, way * LEAST_mA));
    }
}

/* What a message of 128 ms explains of a change of 8 A: 0 to 1 A of the mean. */
void test_a_change_explains_a_difference_of_its_own_sign_only(void)
{
    const int32_t most_mA = RATED_mA / 8 + EXTRA_mA;
    for (int32_t way = -1; way <= 1; way += 2) {
        for (int32_t explained_mA = -1000; explained_mA <= 1000; explained_mA += 1000) {
            for (int beyond = 0; beyond <= 1; beyond++) {
                start_short();
                const int32_t less_mA = most_mA - 1 + beyond + (explained_mA > 0 ? 1000 : 0);
                /* Mean of the battery's current: its first and its last value cancel. */
                const int32_t loop_mA = way * RATED_mA;
                const int32_t battery_mA = loop_mA - way * less_mA;
                bool wrong = step(loop_mA, battery_mA - way * 4 * explained_mA);
                for (int ms = 2; ms < SHORT_WINDOW_ms; ms++) {
                    wrong = step(loop_mA, battery_mA);
                }
                wrong = step(loop_mA, battery_mA + way * 4 * explained_mA);
                TEST_ASSERT_EQUAL_INT(beyond, wrong);
            }
        }
    }
}

/* 5625 mA too little, of which a change explains between nothing and 1 A. */
void test_a_window_that_neither_contradicts_nor_agrees_leaves_the_finding_as_it_is(void)
{
    for (int found = 0; found <= 1; found++) {
        start_short();
        TEST_ASSERT_EQUAL_INT(found, windows(1, RATED_mA, found ? 2 * RATED_mA : RATED_mA));
        const int32_t missing_q15 = state.missing_q15;
        const int32_t battery_mA = RATED_mA - RATED_mA / 8 - EXTRA_mA;
        (void)step(RATED_mA, battery_mA - 4000);
        for (int ms = 2; ms < SHORT_WINDOW_ms; ms++) {
            (void)step(RATED_mA, battery_mA);
        }
        TEST_ASSERT_EQUAL_INT(found, step(RATED_mA, battery_mA + 4000));
        TEST_ASSERT_EQUAL_INT32(missing_q15, state.missing_q15);
    }
}

void test_gain_heals_with_the_next_window_that_agrees(void)
{
    TEST_ASSERT_TRUE(named(RATED_mA, 2 * RATED_mA));
    TEST_ASSERT_EQUAL_INT32(MONITOR_GAIN_MOST_MISSING_Q15, state.missing_q15);
    for (int ms = 1; ms < SHORT_WINDOW_ms; ms++) {
        TEST_ASSERT_TRUE(step(RATED_mA, RATED_mA));
    }
    TEST_ASSERT_FALSE(step(RATED_mA, RATED_mA));
    TEST_ASSERT_EQUAL_INT32(0, state.missing_q15);
}

/* ---- what is not compared ---- */

/* From rest to a current of the loop, while the battery's goes from `from` to `to`. */
static bool moved(int32_t loop_mA, int32_t from_mA, int32_t to_mA)
{
    bool wrong = step(0, from_mA);
    for (int ms = 1; ms < SHORT_WINDOW_ms; ms++) {
        wrong = step(loop_mA, to_mA);
    }
    return wrong;
}

void test_a_current_that_stands_while_power_moves_counts_as_not_given(void)
{
    for (int32_t stuck_mA = -RATED_mA; stuck_mA <= RATED_mA; stuck_mA += RATED_mA) {
        config.battery.current_filter_ms = 0;
        monitor_gain_restart(&state);
        TEST_ASSERT_FALSE(moved(RATED_mA, stuck_mA, stuck_mA));
        TEST_ASSERT_FALSE(windows(5, RATED_mA, stuck_mA));
        start_short(); /* a good one that stops */
        TEST_ASSERT_FALSE(moved(RATED_mA, stuck_mA, stuck_mA));
        TEST_ASSERT_FALSE(windows(5, RATED_mA, stuck_mA));
    }
}

void test_bounds_of_what_moves_are_exact(void)
{
    start_short();
    TEST_ASSERT_FALSE(moved(MOVES_mA, 0, 0));
    TEST_ASSERT_FALSE(state.follows);
    TEST_ASSERT_FALSE(moved(MOVES_mA - 1, 0, MOVES_mA)); /* shows nothing of the battery */
    TEST_ASSERT_FALSE(state.follows);
    TEST_ASSERT_FALSE(moved(RATED_mA, 0, RATED_mA / 8 - 1));
    TEST_ASSERT_FALSE(state.follows);
    TEST_ASSERT_TRUE(moved(RATED_mA, 0, RATED_mA / 8));
    TEST_ASSERT_TRUE(state.follows);
    TEST_ASSERT_TRUE(moved(MOVES_mA - 1, 0, 0));
    TEST_ASSERT_TRUE(state.follows);
    TEST_ASSERT_FALSE(moved(-MOVES_mA, 0, 0)); /* ends the finding */
}

void test_what_is_compared_needs_one_wheel_a_message_and_a_closed_contactor(void)
{
    monitor_case_t in = case_of(RATED_mA, 0);
    for (int part = 0; part < 4; part++) {
        setUp();
        TEST_ASSERT_TRUE(named(RATED_mA, 0));
        config.battery.driven_wheels = part == 1 ? 4 : 1;
        in.battery.current_given = part != 2;
        in.battery.contactor = open_if(part == 3);
        TEST_ASSERT_EQUAL_INT(part == 0,
                              monitor_gain_step(&state, &config, measured_of(&in), true));
        TEST_ASSERT_EQUAL_INT(part == 0, state.follows && state.missing_q15 == 0 && state.wrong);
    }
}

/* Diodes that conduct: what flows is not known, but what was found stays. */
void test_a_current_that_is_not_known_begins_the_window_anew(void)
{
    const monitor_case_t in = case_of(0, 0);
    TEST_ASSERT_TRUE(named(RATED_mA, 0));
    for (int ms = 1; ms < SHORT_WINDOW_ms; ms++) {
        TEST_ASSERT_TRUE(step(RATED_mA, RATED_mA));
    }
    TEST_ASSERT_TRUE(monitor_gain_step(&state, &config, measured_of(&in), false));
    for (int ms = 1; ms < SHORT_WINDOW_ms; ms++) {
        TEST_ASSERT_TRUE(step(RATED_mA, RATED_mA));
    }
    TEST_ASSERT_FALSE(step(RATED_mA, RATED_mA));
}

/* A battery that goes on filtering what it gave. */
void test_without_pwm_no_current_flows_and_the_window_goes_on(void)
{
    monitor_case_t in = case_of(RATED_mA, RATED_mA);
    start_short();
    for (int ms = 0; ms < SHORT_WINDOW_ms; ms++) {
        in.report.bridge = pwm_if(ms < SHORT_WINDOW_ms / 2);
        in.battery.current_mA = ms < SHORT_WINDOW_ms / 2 ? RATED_mA : 0;
        TEST_ASSERT_FALSE(monitor_gain_step(&state, &config, measured_of(&in), true));
    }
    TEST_ASSERT_TRUE(state.follows);
    for (int ms = 0; ms < SHORT_WINDOW_ms; ms++) {
        in.report.bridge = pwm_if(ms < SHORT_WINDOW_ms / 2);
        in.battery.current_mA = RATED_mA;
        (void)monitor_gain_step(&state, &config, measured_of(&in), true);
    }
    TEST_ASSERT_FALSE(state.follows); /* the loop's current moved */
}

void test_any_reading_is_no_overflow(void)
{
    static const int32_t FILTERS_ms[] = {0, 10000};
    config.motor.rated_torque_mNm = 20000000;
    config.motor.max_speed_mrad_s = 5000000;
    for (int k = 0; k < 2; k++) {
        config.battery.current_filter_ms = FILTERS_ms[k];
        monitor_gain_restart(&state);
        for (int ms = 0; ms < 200000; ms++) {
            monitor_case_t in = case_of(ms / 50000 % 2 == 0 ? INT32_MAX : INT32_MIN,
                                        ms / 70000 % 2 == 0 ? INT32_MIN : INT32_MAX);
            in.now.bus_voltage_mV = ms % 5 == 0 ? INT32_MIN : INT32_MAX;
            (void)monitor_gain_step(&state, &config, measured_of(&in), true);
            TEST_ASSERT_TRUE(state.missing_q15 >= 0 &&
                             state.missing_q15 <= MONITOR_GAIN_MOST_MISSING_Q15);
        }
    }
}

/* 10 000 A: an eighth, and 625 mA more. */
void test_larger_currents_count_as_the_largest(void)
{
    const int32_t most_mA = MONITOR_GAIN_MOST_mA;
    TEST_ASSERT_FALSE(named(INT32_MAX, most_mA - most_mA / 8 - 624));
    TEST_ASSERT_TRUE(named(INT32_MAX, most_mA - most_mA / 8 - 625));
    TEST_ASSERT_FALSE(named(-most_mA + most_mA / 9, INT32_MIN));
    TEST_ASSERT_TRUE(named(-most_mA + most_mA / 8, INT32_MIN));
}
