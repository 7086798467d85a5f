/* SPDX-License-Identifier: Apache-2.0 */
/* The bus current of the loop beside that of a battery whose message comes every 100 ms. */
#include "monitor/monitor_gain.h"

#include "monitor_case.h"
#include "unity.h"

/* 30 N m at 70 rad/s: 2100 W. 40 A make that at 52.5 V. */
enum { CYCLE_ms = 100, BUS_mV = 52500, RATED_mA = 40000, LEAST_mA = RATED_mA / 16 };

typedef int32_t (*current_t)(int ms);

static monitor_window_t state;
static config_t config;
static int32_t sign, level_mA, losses_mA, battery_permille;

void setUp(void)
{
    const config_t fresh = {.motor = {.rated_torque_mNm = 30000, .max_speed_mrad_s = 70000},
                            .battery = {.driven_wheels = 1}};
    config = fresh;
    sign = 1;
    level_mA = RATED_mA / 2;
    losses_mA = 0;
    battery_permille = 1000;
    monitor_window_restart(&state);
}

void tearDown(void) {}

static int32_t steady(int ms)
{
    (void)ms;
    return sign * level_mA;
}

/* To zero in 1.2 s, again and again. */
static int32_t stops(int ms)
{
    return sign * (level_mA - level_mA * (ms % 1200) / 1200);
}

static int32_t pulses(int ms)
{
    return ms / 150 % 2 == 0 ? sign * level_mA : -sign * level_mA;
}

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

/* The first millisecond in which the gain is named; -1: none in 6 s. */
static int named_at(current_t truth, int begin_ms, int32_t gain_permille)
{
    monitor_window_restart(&state);
    for (int ms = 0; ms < 6000; ms++) {
        const int32_t gain = ms < begin_ms ? 1000 : gain_permille;
        const int32_t battery_mA =
            (truth(ms / CYCLE_ms * CYCLE_ms) + losses_mA) * battery_permille / 1000;
        const monitor_case_t in = case_of(truth(ms) * gain / 1000, battery_mA);
        if (monitor_gain_step(&state, &config, measured_of(&in))) {
            return ms;
        }
    }
    return -1;
}

void test_healthy_sensors_are_never_named_whatever_the_current_does(void)
{
    for (sign = -1; sign <= 1; sign += 2) {
        for (int32_t gain = 960; gain <= 1040; gain += 20) { /* of all current sensors */
            for (battery_permille = 970; battery_permille <= 1030; battery_permille += 30) {
                for (losses_mA = 0; losses_mA <= RATED_mA / 64; losses_mA += RATED_mA / 64) {
                    TEST_ASSERT_EQUAL_INT(-1, named_at(steady, 0, gain));
                    TEST_ASSERT_EQUAL_INT(-1, named_at(stops, 0, gain));
                    TEST_ASSERT_EQUAL_INT(-1, named_at(pulses, 0, gain));
                }
            }
        }
    }
}

/* What was shown before is forgotten after one to two windows; then come 200 ms. */
void test_gain_wrong_by_30_percent_is_named_within_460_ms(void)
{
    const int32_t gains[] = {500, 700, 1300, 2000};
    for (sign = -1; sign <= 1; sign += 2) {
        for (int k = 0; k < 4; k++) {
            for (int begin_ms = 1000; begin_ms < 1128; begin_ms += 9) {
                const int at_ms = named_at(steady, begin_ms, gains[k]);
                TEST_ASSERT_GREATER_OR_EQUAL_INT(begin_ms + MONITOR_WINDOW_QUALIFY_STEPS, at_ms);
                TEST_ASSERT_LESS_OR_EQUAL_INT(begin_ms + 460, at_ms);
            }
        }
    }
}

/* Two thirds of rated torque at half speed are a third of the power. The bridge's losses of 5 % of
 * it only help while braking and hide a part while driving. */
void test_gain_is_named_from_a_third_of_the_power_on_with_losses(void)
{
    level_mA = RATED_mA / 3;
    losses_mA = level_mA / 20;
    for (sign = -1; sign <= 1; sign += 2) {
        TEST_ASSERT_GREATER_THAN_INT(0, named_at(steady, 0, 700));
        TEST_ASSERT_GREATER_THAN_INT(0, named_at(steady, 0, 1300));
    }
}

/* Beside losses of a 64th of the power: 0.65 while braking, where they hide nothing, and what 1.35
 * leaves of a ninth of the power. */
void test_smaller_powers_show_larger_errors(void)
{
    losses_mA = RATED_mA / 64;
    sign = -1;
    level_mA = LEAST_mA * 1000 / 650 + 100;
    TEST_ASSERT_GREATER_THAN_INT(0, named_at(steady, 0, 650));
    losses_mA = 0;
    level_mA = RATED_mA / 9;
    for (sign = -1; sign <= 1; sign += 2) {
        TEST_ASSERT_GREATER_THAN_INT(0, named_at(steady, 0, 1350));
    }
}

void test_small_powers_are_not_judged(void)
{
    for (sign = -1; sign <= 1; sign += 2) {
        level_mA = LEAST_mA - 100; /* as shown: three times what flows */
        battery_permille = 300;
        TEST_ASSERT_EQUAL_INT(-1, named_at(steady, 0, 1000));
        level_mA = LEAST_mA + 100;
        TEST_ASSERT_GREATER_THAN_INT(0, named_at(steady, 0, 1000));
    }
}

void test_another_load_of_a_64th_of_the_power_is_tolerated(void)
{
    level_mA = LEAST_mA + 100;
    for (sign = -1; sign <= 1; sign += 2) {
        losses_mA = RATED_mA / 64 + level_mA / 8 - 100;
        TEST_ASSERT_EQUAL_INT(-1, named_at(steady, 0, 1000));
        losses_mA = RATED_mA / 64 + level_mA / 8 + 100;
        TEST_ASSERT_GREATER_THAN_INT(0, named_at(steady, 0, 1000));
        losses_mA = 0;
    }
}

void test_what_is_compared_needs_one_wheel_a_message_and_a_bridge_that_switches(void)
{
    monitor_case_t in = case_of(40000, 0);
    for (int part = 0; part < 5; part++) {
        setUp();
        config.battery.driven_wheels = part == 1 ? 4 : 1;
        in.battery.current_given = part != 2;
        in.report.bridge = pwm_if(part != 3);
        in.battery.contactor = open_if(part == 4);
        bool named = false;
        for (int ms = 0; ms < 1000; ms++) {
            named = monitor_gain_step(&state, &config, measured_of(&in));
        }
        TEST_ASSERT_EQUAL_INT(part == 0, named);
    }
}

void test_name_goes_after_the_qualify_time_without_a_contradiction(void)
{
    monitor_case_t in = case_of(40000, 0);
    for (int ms = 0; ms < 1000; ms++) {
        (void)monitor_gain_step(&state, &config, measured_of(&in));
    }
    TEST_ASSERT_TRUE(state.wrong);
    in.battery.current_mA = 40000;
    int heals_ms = 0;
    while (monitor_gain_step(&state, &config, measured_of(&in))) {
        heals_ms++;
    }
    TEST_ASSERT_INT_WITHIN(2, MONITOR_WINDOW_QUALIFY_STEPS, heals_ms);
}

void test_any_reading_is_no_overflow(void)
{
    for (int ms = 0; ms < 3000; ms++) {
        monitor_case_t in =
            case_of(ms % 2 == 0 ? INT32_MAX : INT32_MIN, ms % 3 == 0 ? INT32_MAX : INT32_MIN + 1);
        in.now.bus_voltage_mV = ms % 5 == 0 ? INT32_MIN : INT32_MAX;
        TEST_ASSERT_FALSE(monitor_gain_step(&state, &config, measured_of(&in)));
    }
}

/* Named, with a current of the loop and one of the battery that last for ever. */
static bool named(int32_t loop_mA, int32_t battery_mA)
{
    const monitor_case_t in = case_of(loop_mA, battery_mA);
    monitor_window_restart(&state);
    bool wrong = false;
    for (int ms = 0; ms < MONITOR_WINDOW_STEPS + MONITOR_WINDOW_QUALIFY_STEPS; ms++) {
        wrong = monitor_gain_step(&state, &config, measured_of(&in));
    }
    return wrong;
}

/* 2100 W: a sixteenth is 2.5 A, a 64th 625 mA. */
void test_thresholds_of_power_tolerance_and_other_loads_are_exact(void)
{
    TEST_ASSERT_TRUE(named(LEAST_mA, 0));
    TEST_ASSERT_FALSE(named(LEAST_mA - 1, 0));
    TEST_ASSERT_TRUE(named(-LEAST_mA, 0));
    TEST_ASSERT_FALSE(named(-LEAST_mA + 1, 0));
    TEST_ASSERT_FALSE(named(RATED_mA, RATED_mA - RATED_mA / 8));
    TEST_ASSERT_TRUE(named(RATED_mA, RATED_mA - RATED_mA / 8 - 1));
    TEST_ASSERT_FALSE(named(RATED_mA, RATED_mA + RATED_mA / 8 + 625));
    TEST_ASSERT_TRUE(named(RATED_mA, RATED_mA + RATED_mA / 8 + 626));
    TEST_ASSERT_FALSE(named(-RATED_mA, -RATED_mA + RATED_mA / 8 + 625));
    TEST_ASSERT_TRUE(named(-RATED_mA, -RATED_mA + RATED_mA / 8 + 626));
    TEST_ASSERT_FALSE(named(-RATED_mA, -RATED_mA - RATED_mA / 8));
    TEST_ASSERT_TRUE(named(-RATED_mA, -RATED_mA - RATED_mA / 8 - 1));
}

/* 10 000 A: 8888.334 A and an eighth are 625 mA less. */
void test_larger_currents_count_as_the_largest(void)
{
    TEST_ASSERT_FALSE(named(8888334, MONITOR_WINDOW_MOST + 1));
    TEST_ASSERT_TRUE(named(8888333, MONITOR_WINDOW_MOST));
    (void)named(INT32_MAX, 0);
    TEST_ASSERT_EQUAL_INT32(MONITOR_WINDOW_MOST, monitor_window_lowest(&state));
    (void)named(INT32_MIN, 0);
    TEST_ASSERT_EQUAL_INT32(-MONITOR_WINDOW_MOST, monitor_window_highest(&state));
}

/* A motor far below the validated range: 1 mA makes a sixteenth of its power. */
void test_smallest_current_drives(void)
{
    config.motor.rated_torque_mNm = 1;
    config.motor.max_speed_mrad_s = 16 * BUS_mV;
    TEST_ASSERT_TRUE(named(1, 0));
    TEST_ASSERT_FALSE(named(0, 0));
    TEST_ASSERT_TRUE(named(-1, 0));
}

void test_one_step_without_pwm_forgets_what_was_seen(void)
{
    monitor_case_t in = case_of(RATED_mA, 0);
    in.report.bridge = BRIDGE_OFF;
    TEST_ASSERT_TRUE(named(RATED_mA, 0));
    TEST_ASSERT_FALSE(monitor_gain_step(&state, &config, measured_of(&in)));
    in.report.bridge = BRIDGE_PWM;
    for (int ms = 1; ms < MONITOR_WINDOW_STEPS + MONITOR_WINDOW_QUALIFY_STEPS; ms++) {
        TEST_ASSERT_FALSE(monitor_gain_step(&state, &config, measured_of(&in)));
    }
    TEST_ASSERT_TRUE(monitor_gain_step(&state, &config, measured_of(&in)));
}
