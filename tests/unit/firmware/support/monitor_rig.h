/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_rig.h: the slow monitor of the paper's vehicle and its input `in`, which a test changes
 * between steps. recover() restores the input of a healthy drive. Included once in a program.
 */
#ifndef MONITOR_RIG_H
#define MONITOR_RIG_H

#include "monitor/monitor.h"
#include "paper_vehicle.h"
#include "unity.h"

enum { FAST_PER_SLOW = 20 /* 20 kHz over 1 kHz */ };

static config_t config;
static monitor_slow_state_t state;
static monitor_slow_input_t in;
static monitor_slow_input_t healthy;
static uint16_t fast_steps_per_slow;

static inline void rig_up(const monitor_slow_input_t *as_healthy)
{
    config = paper_vehicle();
    monitor_slow_init(&state);
    healthy = *as_healthy;
    in = healthy;
    fast_steps_per_slow = FAST_PER_SLOW;
}

static inline monitor_output_t step(void)
{
    in.fast_step_count = (uint16_t)(in.fast_step_count + fast_steps_per_slow);
    return monitor_slow_step(&state, &config, &in);
}

static inline monitor_output_t run(int milliseconds)
{
    for (int n = 1; n < milliseconds; n++) {
        step();
    }
    return step();
}

static inline void recover(void)
{
    const uint16_t count = in.fast_step_count;
    in = healthy;
    in.fast_step_count = count;
}

/* The condition in `in` is a fault after exactly `milliseconds`, and no fault after recover(). */
static inline void assert_fault_after(int milliseconds, reason_t fault)
{
    for (int n = 1; n < milliseconds; n++) {
        TEST_ASSERT_EQUAL_INT(REASON_NONE, step().fault);
    }
    TEST_ASSERT_EQUAL_INT(fault, step().fault);
    TEST_ASSERT_EQUAL_INT(fault, run(100).fault);
    recover();
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().fault); /* modes latches a fault, not the monitor */
}

static inline void assert_never_a_fault(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000).fault);
    recover();
}

#endif
