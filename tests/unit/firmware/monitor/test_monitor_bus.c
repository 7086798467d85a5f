/* SPDX-License-Identifier: Apache-2.0 */
/* The bus sensor beside a battery whose message comes every 100 ms, and a bus whose battery leaves.
 */
#include "monitor/monitor_bus.h"

#include "unity.h"

enum { CYCLE_ms = 100 };

/* 112.5 A from full charging to full discharging current move the bus by 5.4 V. */
static const config_battery_t BATTERY = {.max_charge_current_mA = 50000,
                                         .max_discharge_current_mA = 62500,
                                         .max_voltage_mV = 58400,
                                         .resistance_uOhm = 48000};
static monitor_swing_state_t swing;

typedef int32_t (*voltage_t)(int ms);

static monitor_window_t state;

void setUp(void)
{
    monitor_window_restart(&state);
    const monitor_swing_state_t none = {.watching = false};
    swing = none;
}

void tearDown(void) {}

static int32_t steady(int ms)
{
    (void)ms;
    return 53000;
}

/* A current that comes and goes every 70 ms, on 0.1 ohm. */
static int32_t under_load(int ms)
{
    return ms / 70 % 2 == 0 ? 48000 : 58000;
}

/* Charged from 40 to 60 V in two seconds. */
static int32_t ramp(int ms)
{
    return 40000 + 10 * (ms % 2000);
}

static int32_t frozen(int ms)
{
    return ramp(ms < 1000 ? ms : 1000);
}

/* The first millisecond from `begin_ms` on in which the sensor is named; -1: none until 4 s. The
 * reading is of the sensor, in 1/1000 of the truth from begin_ms on. */
static int named_at(voltage_t truth, voltage_t reading, int begin_ms, int32_t share_permille)
{
    setUp();
    for (int ms = 0; ms < 4000; ms++) {
        const int sent_ms = ms / CYCLE_ms * CYCLE_ms;
        const int32_t shown_mV = ms < begin_ms ? reading(ms) : reading(ms) / 1000 * share_permille;
        if (monitor_bus_step(&state, shown_mV, truth(sent_ms))) {
            return ms;
        }
    }
    return -1;
}

void test_healthy_sensor_is_never_named_whatever_the_voltage_does(void)
{
    for (int32_t share = 955; share <= 1045; share += 15) { /* tolerances of both sensors */
        TEST_ASSERT_EQUAL_INT(-1, named_at(steady, steady, 0, share));
        TEST_ASSERT_EQUAL_INT(-1, named_at(under_load, under_load, 0, share));
        TEST_ASSERT_EQUAL_INT(-1, named_at(ramp, ramp, 0, share));
    }
}

/* What was shown before is forgotten after one to two windows; then come 200 ms. */
void test_wrong_gain_is_named_within_460_ms(void)
{
    const int32_t shares[] = {800, 940, 1060, 1200};
    for (int k = 0; k < 4; k++) {
        for (int begin_ms = 1000; begin_ms < 1128; begin_ms += 9) {
            const int at_ms = named_at(steady, steady, begin_ms, shares[k]);
            TEST_ASSERT_GREATER_OR_EQUAL_INT(begin_ms + MONITOR_WINDOW_QUALIFY_STEPS, at_ms);
            TEST_ASSERT_LESS_OR_EQUAL_INT(begin_ms + 460, at_ms);
        }
    }
}

/* 50 V for ever; 5 % more are reached 250 ms later, and seen in the message after that. */
void test_frozen_sensor_is_named_once_the_voltage_has_moved(void)
{
    const int at_ms = named_at(ramp, frozen, 0, 1000);
    TEST_ASSERT_GREATER_OR_EQUAL_INT(1250 + MONITOR_WINDOW_QUALIFY_STEPS, at_ms);
    TEST_ASSERT_LESS_OR_EQUAL_INT(1300 + CYCLE_ms + MONITOR_WINDOW_QUALIFY_STEPS, at_ms);
}

void test_sensor_that_agrees_again_heals_after_the_same_time(void)
{
    for (int ms = 0; ms < 2000; ms++) {
        (void)monitor_bus_step(&state, 60000, 53000);
    }
    TEST_ASSERT_TRUE(state.wrong);
    int heals_ms = 0;
    while (monitor_bus_step(&state, 53000, 53000)) {
        heals_ms++;
    }
    TEST_ASSERT_GREATER_OR_EQUAL_INT(MONITOR_WINDOW_QUALIFY_STEPS - 2, heals_ms);
    TEST_ASSERT_LESS_OR_EQUAL_INT(MONITOR_WINDOW_QUALIFY_STEPS + 2, heals_ms);
}

void test_the_bus_sensor_is_not_judged_without_a_message(void)
{
    for (int ms = 0; ms < 2000; ms++) {
        TEST_ASSERT_FALSE(monitor_bus_step(&state, ms % 2 == 0 ? INT32_MAX : INT32_MIN, 0));
    }
    for (int ms = 0; ms < MONITOR_WINDOW_STEPS; ms++) {
        TEST_ASSERT_FALSE(monitor_bus_step(&state, INT32_MIN, INT32_MAX));
    }
}

/* ---- movement of the bus ---- */

/* From `low_mV` to `high_mV` at 1 ms, and back and forth every `every_ms`, for a second; the
 * millisecond in which the battery counts as gone, -1: never. */
static int gone_at(const config_battery_t *battery, int32_t low_mV, int32_t high_mV, int every_ms)
{
    setUp();
    for (int ms = 0; ms < 1000; ms++) {
        const bool high = ms > 0 && (ms - 1) / every_ms % 2 == 0;
        if (monitor_bus_swings(&swing, battery, high ? high_mV : low_mV, true)) {
            return ms;
        }
    }
    return -1;
}

void test_connected_battery_may_go_from_full_charging_to_full_discharging_current(void)
{
    TEST_ASSERT_EQUAL_INT(-1, gone_at(&BATTERY, 50000, 55400, 30));
    /* A quarter more resistance, of a cold battery; once. */
    TEST_ASSERT_EQUAL_INT(-1, gone_at(&BATTERY, 50000, 56700, 1000));
}

/* 3, 5.6 and 7.9 V against 6.39, 7/64 of 58.4 V: a step's movement has lost an eighth in the next.
 */
void test_bus_that_moves_on_has_lost_its_battery(void)
{
    TEST_ASSERT_EQUAL_INT(3, gone_at(&BATTERY, 40000, 43000, 1));
    /* Of larger steps 7/128 of 58.4 V count, up as well as down: 3.19, 5.99 and 8.4 V. */
    TEST_ASSERT_EQUAL_INT(3, gone_at(&BATTERY, 38000, 45000, 1));
    TEST_ASSERT_EQUAL_INT(3, gone_at(&BATTERY, 45000, 38000, 1));
    /* 0.79 V a step amount to 8 * 0.79 V = 6.32 V, 0.82 V to 6.56 V. */
    TEST_ASSERT_EQUAL_INT(-1, gone_at(&BATTERY, 40000, 40790, 1));
    TEST_ASSERT_GREATER_THAN_INT(8, gone_at(&BATTERY, 40000, 40820, 1));
}

/* A reading that jumps shows it in the mean of one millisecond or of two. */
void test_sensor_that_jumps_is_no_battery_that_has_left(void)
{
    TEST_ASSERT_EQUAL_INT(-1, gone_at(&BATTERY, 0, 75000, 1000));
    TEST_ASSERT_EQUAL_INT(-1, gone_at(&BATTERY, 75000, 0, 1000));
    setUp();
    for (int ms = 0; ms < 1000; ms++) {
        const int32_t shown_mV = ms < 500 ? 53000 : ms == 500 ? 30000 : 10000;
        TEST_ASSERT_FALSE(monitor_bus_swings(&swing, &BATTERY, shown_mV, true));
    }
}

void test_a_stiff_battery_counts_by_its_voltage_a_soft_one_by_its_resistance(void)
{
    config_battery_t battery = BATTERY;
    battery.resistance_uOhm = 100; /* the 7/64 as well */
    TEST_ASSERT_EQUAL_INT(-1, gone_at(&battery, 50000, 50790, 1));
    TEST_ASSERT_GREATER_THAN_INT(8, gone_at(&battery, 50000, 50820, 1));
    battery.resistance_uOhm = 96000; /* 9/8 of 10.8 V are 12.15 V, 1.52 V a step */
    TEST_ASSERT_EQUAL_INT(-1, gone_at(&battery, 50000, 51500, 1));
    TEST_ASSERT_GREATER_THAN_INT(8, gone_at(&battery, 50000, 51560, 1));
    battery.resistance_uOhm = 0; /* not known */
    TEST_ASSERT_EQUAL_INT(-1, gone_at(&battery, 0, 58400, 1));
}

void test_movement_counts_only_while_the_bus_is_watched(void)
{
    for (int ms = 0; ms < 1000; ms++) {
        TEST_ASSERT_FALSE(
            monitor_bus_swings(&swing, &BATTERY, ms % 2 == 0 ? INT32_MAX : INT32_MIN, false));
    }
    TEST_ASSERT_FALSE(monitor_bus_swings(&swing, &BATTERY, 53000, true));
    TEST_ASSERT_FALSE(monitor_bus_swings(&swing, &BATTERY, 53000, true));
    TEST_ASSERT_FALSE(monitor_bus_swings(&swing, &BATTERY, INT32_MIN, true));
    TEST_ASSERT_FALSE(monitor_bus_swings(&swing, &BATTERY, 53000, true));
    TEST_ASSERT_FALSE(monitor_bus_swings(&swing, &BATTERY, INT32_MIN, false));
    TEST_ASSERT_FALSE(monitor_bus_swings(&swing, &BATTERY, INT32_MAX, true));
    TEST_ASSERT_FALSE(monitor_bus_swings(&swing, &BATTERY, INT32_MIN, true));
    TEST_ASSERT_FALSE(monitor_bus_swings(&swing, &BATTERY, INT32_MAX, true));
    TEST_ASSERT_TRUE(monitor_bus_swings(&swing, &BATTERY, INT32_MIN, true));
}

/* Named, with a reading and a message that last for ever. */
static bool named(int32_t reading_mV, int32_t battery_mV)
{
    setUp();
    bool wrong = false;
    for (int ms = 0; ms < MONITOR_WINDOW_STEPS + MONITOR_WINDOW_QUALIFY_STEPS; ms++) {
        wrong = monitor_bus_step(&state, reading_mV, battery_mV);
    }
    return wrong;
}

void test_tolerance_of_a_twentieth_is_exact(void)
{
    TEST_ASSERT_FALSE(named(19000, 20000));
    TEST_ASSERT_TRUE(named(18999, 20000));
    TEST_ASSERT_FALSE(named(21000, 20000));
    TEST_ASSERT_TRUE(named(21001, 20000));
}

/* 0: none, or the contactor is not known to be closed. */
void test_the_smallest_message_counts_and_zero_is_none(void)
{
    TEST_ASSERT_FALSE(named(53000, 0));
    TEST_ASSERT_FALSE(named(53000, -1));
    TEST_ASSERT_TRUE(named(53000, 1));
    TEST_ASSERT_TRUE(named(0, 1));
    TEST_ASSERT_FALSE(named(1, 1));
}

void test_larger_voltages_count_as_the_largest(void)
{
    TEST_ASSERT_FALSE(named(INT32_MAX, INT32_MAX));
    TEST_ASSERT_FALSE(named(MONITOR_BUS_MOST_mV, INT32_MAX));
}

void test_one_step_without_a_message_forgets_what_was_seen(void)
{
    TEST_ASSERT_TRUE(named(60000, 53000));
    TEST_ASSERT_FALSE(monitor_bus_step(&state, 60000, 0));
    for (int ms = 1; ms < MONITOR_WINDOW_STEPS + MONITOR_WINDOW_QUALIFY_STEPS; ms++) {
        TEST_ASSERT_FALSE(monitor_bus_step(&state, 60000, 53000));
    }
    TEST_ASSERT_TRUE(monitor_bus_step(&state, 60000, 53000));
}

/* An eighth of it is forgotten each step, and 7/128 of 58.4 V, 3193 mV, are the most of a step. */
void test_movement_of_the_bus_is_the_sum_of_its_steps(void)
{
    const int32_t shown_mV[] = {-7, 100, 300, 4000, 3000};
    const int32_t swing_mV[] = {0, 100, 88 + 200, 252 + 3193, 3015 + 1000};
    for (int k = 0; k < 5; k++) {
        (void)monitor_bus_swings(&swing, &BATTERY, shown_mV[k], true);
        TEST_ASSERT_EQUAL_INT32(swing_mV[k], swing.swing_mV);
    }
    (void)monitor_bus_swings(&swing, &BATTERY, 0, false);
    TEST_ASSERT_EQUAL_INT32(0, swing.swing_mV);
}

/* 700 mV at most a step: 700, 1313, then 1149 and what the third one adds. */
static bool gone_with_a_third_step(const config_battery_t *battery, int32_t third_mV)
{
    const monitor_swing_state_t none = {.watching = false};
    swing = none;
    (void)monitor_bus_swings(&swing, battery, 0, true);
    TEST_ASSERT_FALSE(monitor_bus_swings(&swing, battery, 5000, true));
    TEST_ASSERT_FALSE(monitor_bus_swings(&swing, battery, 0, true));
    return monitor_bus_swings(&swing, battery, third_mV, true);
}

/* 9/8 of a resistance times a current are 1400 mV, or a thousandth of a millivolt more. */
void test_thresholds_of_the_movement_are_exact(void)
{
    config_battery_t battery = {.max_charge_current_mA = 1, .max_voltage_mV = 12800};
    battery.resistance_uOhm = 1;
    TEST_ASSERT_TRUE(gone_with_a_third_step(&battery, 251));
    TEST_ASSERT_FALSE(gone_with_a_third_step(&battery, 250));
    battery.max_discharge_current_mA = 1399;
    battery.resistance_uOhm = 888888;
    TEST_ASSERT_TRUE(gone_with_a_third_step(&battery, 251));
    battery.resistance_uOhm = 888889;
    TEST_ASSERT_FALSE(gone_with_a_third_step(&battery, 251));
}
