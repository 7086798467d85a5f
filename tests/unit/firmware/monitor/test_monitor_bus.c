/* SPDX-License-Identifier: Apache-2.0 */
/* The bus sensor beside a battery whose message comes every 100 ms. */
#include "monitor/monitor_bus.h"

#include "unity.h"

enum { CYCLE_ms = 100 };

typedef int32_t (*voltage_t)(int ms);

static monitor_bus_state_t state;

void setUp(void)
{
    const monitor_bus_state_t fresh = {.wrong = false};
    state = fresh;
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
            TEST_ASSERT_GREATER_OR_EQUAL_INT(begin_ms + MONITOR_BUS_QUALIFY_STEPS, at_ms);
            TEST_ASSERT_LESS_OR_EQUAL_INT(begin_ms + 460, at_ms);
        }
    }
}

/* 50 V for ever; 5 % more are reached 250 ms later, and seen in the message after that. */
void test_frozen_sensor_is_named_once_the_voltage_has_moved(void)
{
    const int at_ms = named_at(ramp, frozen, 0, 1000);
    TEST_ASSERT_GREATER_OR_EQUAL_INT(1250 + MONITOR_BUS_QUALIFY_STEPS, at_ms);
    TEST_ASSERT_LESS_OR_EQUAL_INT(1300 + CYCLE_ms + MONITOR_BUS_QUALIFY_STEPS, at_ms);
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
    TEST_ASSERT_GREATER_OR_EQUAL_INT(MONITOR_BUS_QUALIFY_STEPS - 2, heals_ms);
    TEST_ASSERT_LESS_OR_EQUAL_INT(MONITOR_BUS_QUALIFY_STEPS + 2, heals_ms);
}

void test_the_bus_sensor_is_not_judged_without_a_message(void)
{
    for (int ms = 0; ms < 2000; ms++) {
        TEST_ASSERT_FALSE(monitor_bus_step(&state, ms % 2 == 0 ? INT32_MAX : INT32_MIN, 0));
    }
    for (int ms = 0; ms < MONITOR_BUS_WINDOW_STEPS; ms++) {
        TEST_ASSERT_FALSE(monitor_bus_step(&state, INT32_MIN, INT32_MAX));
    }
}
