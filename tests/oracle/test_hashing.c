/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Every accessor counts: one added to any value of any step changes the hash that it belongs to,
 * and no other.
 */
#include "config/bases.h"
#include "configurations.h"
#include "controller/controller.h"
#include "hashing.h"
#include "unity.h"

#include <string.h>

enum { FAST_STEPS = 60, FAST_STEPS_A_SLOW_STEP = 20, CHANGED_STEP = 1 };

void setUp(void) {}

void tearDown(void) {}

/* Sixty periods at standstill, with the report after each. */
static oracle_hashes_t short_run(int changed_place, int64_t changed_step)
{
    static controller_t controller;
    const config_t *config = configuration_shipped(0);
    controller_init(&controller, config, BASES_MODEL_TIMER_Hz);
    fast_setpoint_t setpoint = controller_initial_setpoint(config, BASES_MODEL_TIMER_Hz);
    const fast_input_t in = {.phase_current_code = {2048, 2048, 2048}, .bus_voltage_code = 2400};
    const slow_input_t slow_in = {.config_accepted = true, .selftest_passed = true};
    oracle_begin(1);
    if (changed_place >= 0) {
        oracle_change(changed_place, changed_step);
    }
    for (int step = 1; step <= FAST_STEPS; step++) {
        (void)controller_fast_step(&controller.fast, config, &setpoint, &in);
        if (step % FAST_STEPS_A_SLOW_STEP == 0) {
            fast_report_t report;
            controller_fast_report(&controller.fast, &report);
            (void)controller_slow_step(&controller.slow, config, &report, &slow_in, &setpoint);
        }
    }
    return oracle_end();
}

void test_every_step_is_counted(void)
{
    const oracle_hashes_t hashes = short_run(-1, 0);
    TEST_ASSERT_EQUAL_INT64(FAST_STEPS, hashes.fast_steps);
    TEST_ASSERT_EQUAL_INT64(FAST_STEPS / FAST_STEPS_A_SLOW_STEP, hashes.slow_steps);
}

void test_equal_steps_give_equal_hashes(void)
{
    const oracle_hashes_t once = short_run(-1, 0);
    const oracle_hashes_t again = short_run(-1, 0);
    TEST_ASSERT_EQUAL_HEX64(once.fast, again.fast);
    TEST_ASSERT_EQUAL_HEX64(once.slow, again.slow);
    TEST_ASSERT_EQUAL_HEX64(once.events, again.events);
}

void test_a_change_of_any_value_changes_its_own_hash_only(void)
{
    const oracle_hashes_t right = short_run(-1, 0);
    for (int place = 0; place < oracle_value_count(); place++) {
        const char *name = oracle_value_name(place);
        const oracle_hashes_t changed = short_run(place, CHANGED_STEP);
        const bool is_fast = strncmp(name, "fast_", 5) == 0;
        TEST_ASSERT_TRUE_MESSAGE((changed.fast != right.fast) == is_fast, name);
        TEST_ASSERT_TRUE_MESSAGE((changed.slow != right.slow) == !is_fast, name);
    }
    TEST_ASSERT_TRUE(oracle_value_count() > 100);
    TEST_ASSERT_NULL(oracle_value_name(oracle_value_count()));
}

void test_a_change_in_a_step_beyond_the_run_has_no_effect(void)
{
    const oracle_hashes_t right = short_run(-1, 0);
    const oracle_hashes_t changed = short_run(0, FAST_STEPS);
    TEST_ASSERT_EQUAL_HEX64(right.fast, changed.fast);
}

void test_bytes_are_hashed_one_by_one(void)
{
    oracle_begin(0);
    oracle_bytes("ab", 2);
    const oracle_hashes_t both = oracle_end();
    oracle_begin(0);
    oracle_bytes("a", 1);
    oracle_bytes("b", 1);
    const oracle_hashes_t parts = oracle_end();
    oracle_begin(0);
    oracle_bytes("ba", 2);
    const oracle_hashes_t other = oracle_end();
    TEST_ASSERT_EQUAL_HEX64(both.bytes, parts.bytes);
    TEST_ASSERT_TRUE(both.bytes != other.bytes);
}
