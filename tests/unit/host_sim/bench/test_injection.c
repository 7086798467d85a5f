/* SPDX-License-Identifier: Apache-2.0 */
/* Faults of the program that need no controller; the others: tests/unit/host_sim/python. */
#include "bench/injection.h"

#include <stddef.h>
#include <string.h>

#include "config/validate.h"
#include "unity.h"

static fault_params_t fault;
static injection_t state;

void setUp(void)
{
    memset(&fault, 0, sizeof(fault));
    memset(&state, 0, sizeof(state));
}

void tearDown(void) {}

void test_a_healthy_program_has_no_injection_and_a_late_step_is_one(void)
{
    TEST_ASSERT_FALSE(injection_present(&fault));
    fault.fast_late = 1.0;
    TEST_ASSERT_TRUE(injection_present(&fault));
}

void test_a_late_hydraulic_brake_gets_the_command_of_so_many_milliseconds_before(void)
{
    for (int k = 0; k < 3000; k++) {
        fault.hydraulic_late_s = k < 1500 ? 0.0 : 0.25;
        const double expected_nm = k < 1500 ? k : k - 250;
        TEST_ASSERT_EQUAL_DOUBLE(expected_nm, injection_hydraulic_nm(&fault, &state, k));
    }
}

void test_a_wrong_report_of_the_brake_is_off_by_a_share_of_the_largest_torque_or_stuck_at_one(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(40.0, injection_report_nm(&fault, &state, 40.0, 300.0));
    fault.hydraulic_report_offset = -0.125;
    TEST_ASSERT_EQUAL_DOUBLE(2.5, injection_report_nm(&fault, &state, 40.0, 300.0));
    fault.hydraulic_report_shown = 0.75; /* not yet stuck */
    TEST_ASSERT_EQUAL_DOUBLE(2.5, injection_report_nm(&fault, &state, 40.0, 300.0));
    fault.hydraulic_report_stuck = 1.0;
    TEST_ASSERT_EQUAL_DOUBLE(225.0, injection_report_nm(&fault, &state, 40.0, 300.0));
}

/* 30 ms each: lost from the first millisecond on. */
void test_a_brake_and_its_sensor_flicker_in_turn(void)
{
    fault.hydraulic_flicker_s = 0.03;
    fault.hydraulic_flicker_loss = 0.75;
    fault.hydraulic_report_flicker_loss = 0.5;
    for (int ms = 0; ms < 200; ms++) {
        injection_brake_step(&fault, &state);
        const bool lost = ms / 30 % 2 == 0;
        TEST_ASSERT_EQUAL_DOUBLE(lost ? 0.25 : 1.0, injection_brake_share(&fault, &state));
        TEST_ASSERT_EQUAL_DOUBLE(lost ? 20.0 : 40.0, injection_report_nm(&fault, &state, 40, 300));
    }
    fault.hydraulic_flicker_s = 0.0; /* the fault has ended */
    injection_brake_step(&fault, &state);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, injection_brake_share(&fault, &state));
    TEST_ASSERT_EQUAL_DOUBLE(40.0, injection_report_nm(&fault, &state, 40.0, 300.0));
}

void test_a_report_that_drifts_shows_another_share_of_the_torque_each_second(void)
{
    fault.hydraulic_report_drift_per_s = -0.1;
    for (int ms = 0; ms < 2000; ms++) {
        injection_brake_step(&fault, &state);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.8 * 40.0, injection_report_nm(&fault, &state, 40.0, 300.0));
    TEST_ASSERT_EQUAL_DOUBLE(1.0, injection_brake_share(&fault, &state));
}

void test_the_slow_step_that_has_stopped_keeps_its_messages_until_their_counter_is_missed(void)
{
    fault.slow_stopped = 1.0;
    static controller_t controller;
    static config_t config;
    fast_setpoint_t to_fast;
    memset(&to_fast, 0, sizeof(to_fast));
    const injection_target_t target = {
        .controller = &controller, .config = &config, .to_fast = &to_fast};
    const slow_input_t in = {.selftest_passed = true};
    slow_output_t last = {.mode = MODE_RUN, .hydraulic_torque_mNm = 30000, .hydraulic_valid = true};
    for (int k = 1; k <= INJECTION_WATCHDOG_MS; k++) {
        last = injection_slow(&fault, &state, &target, &in, &last);
        TEST_ASSERT_EQUAL_INT(30000, last.hydraulic_torque_mNm);
        const bool named = k >= INJECTION_SLOW_STOPPED_MS;
        TEST_ASSERT_EQUAL_INT(named ? MODE_FAULT : MODE_RUN, last.mode);
        TEST_ASSERT_EQUAL_INT(named ? REASON_PROGRAM_FLOW : REASON_NONE, last.fault_reason);
        TEST_ASSERT_TRUE(last.hydraulic_valid);
    }
}

/* The slow step is stopped, so that nothing else changes the state. */
static void flip_once(controller_t *controller, double part, double bit)
{
    static config_t config;
    fast_setpoint_t to_fast;
    memset(&to_fast, 0, sizeof(to_fast));
    const injection_target_t target = {
        .controller = controller, .config = &config, .to_fast = &to_fast};
    const slow_input_t in = {.selftest_passed = true};
    const slow_output_t last = {.mode = MODE_RUN};
    const injection_t fresh = {.has_restarted = false};
    state = fresh;
    fault.slow_stopped = 1.0;
    fault.state_part = part;
    fault.state_bit = bit;
    (void)injection_slow(&fault, &state, &target, &in, &last);
}

static int bits_set(const void *memory, size_t size_bytes)
{
    const unsigned char *bytes = memory;
    int count = 0;
    for (size_t k = 0; k < size_bytes; k++) {
        for (unsigned bit = 0; bit < 8U; bit++) {
            count += (int)((bytes[k] >> bit) & 1U);
        }
    }
    return count;
}

void test_a_bit_flips_in_the_part_of_the_state_that_is_named(void)
{
    static controller_t controller;
    const struct {
        const void *at;
        size_t size_bytes;
    } parts[] = {
        {&controller, sizeof(controller)},
        {&controller.slow.modes.mode, 1},
        {&controller.slow.modes.fault, 1},
        {&controller.fast.monitor.trip, 1},
        {&controller.fast.monitor.overcurrent_square,
         sizeof(controller.fast.monitor.overcurrent_square)},
        {&controller.fast.monitor.overvoltage_pu, sizeof(controller.fast.monitor.overvoltage_pu)},
    };
    const double bits[] = {1.0, 8.0, 17.0, 32.0, 999983.0};
    for (int part = 0; part < (int)(sizeof(parts) / sizeof(parts[0])); part++) {
        for (int k = 0; k < (int)(sizeof(bits) / sizeof(bits[0])); k++) {
            memset(&controller, 0, sizeof(controller));
            flip_once(&controller, part, bits[k]);
            TEST_ASSERT_EQUAL_INT(1, bits_set(parts[part].at, parts[part].size_bytes));
            TEST_ASSERT_EQUAL_INT(1, bits_set(&controller, sizeof(controller)));
        }
    }
}

void test_a_flipped_bit_of_the_configuration_is_found_within_a_round_and_for_ever(void)
{
    static config_t config;
    config.crc32 = config_crc32(&config, (uint32_t)offsetof(config_t, crc32));
    config_watch_t watch = {.at_bytes = 0};
    const int round_ms = (int)(sizeof(config) / CONFIG_WATCH_BYTES) + 2 + CONFIG_WATCH_PROGRAM_MS;
    for (int ms = 0; ms < 3 * round_ms; ms++) {
        (void)config_watch_step(&watch, &config);
        TEST_ASSERT_FALSE(watch.damaged);
    }
    unsigned char *bytes = (unsigned char *)&config;
    bytes[1234] ^= 0x10U;
    for (int ms = 0; ms < 2 * round_ms; ms++) {
        (void)config_watch_step(&watch, &config);
    }
    TEST_ASSERT_TRUE(watch.damaged);
    bytes[1234] ^= 0x10U;
    for (int ms = 0; ms < 2 * round_ms; ms++) {
        (void)config_watch_step(&watch, &config);
        TEST_ASSERT_TRUE(watch.damaged);
    }
}
