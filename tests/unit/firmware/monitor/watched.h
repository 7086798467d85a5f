/* SPDX-License-Identifier: Apache-2.0 */
/*
 * watched.h: the slow watcher of the paper's vehicle and what it is shown; `in` may be changed
 * between steps, and a fault's condition is taken back by showing a healthy drive again. Included
 * once in a program.
 */
#ifndef TEST_MONITOR_WATCHED_H
#define TEST_MONITOR_WATCHED_H

#include "monitor/monitor.h"
#include "paper_vehicle.h"
#include "unity.h"

enum { FAST_PER_SLOW = 20 /* 20 kHz over 1 kHz */ };

static config_t config;
static monitor_slow_state_t state;
static monitor_slow_input_t in;
static monitor_slow_input_t healthy;
static uint16_t fast_steps_per_slow;

static inline void watch(const monitor_slow_input_t *as_healthy)
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

/* The condition that `in` describes now is a fault after exactly `milliseconds`, and none once it
 * has gone. */
static inline void assert_fault_after(int milliseconds, reason_t fault)
{
    for (int n = 1; n < milliseconds; n++) {
        TEST_ASSERT_EQUAL_INT(REASON_NONE, step().fault);
    }
    TEST_ASSERT_EQUAL_INT(fault, step().fault);
    TEST_ASSERT_EQUAL_INT(fault, run(100).fault);
    recover();
    TEST_ASSERT_EQUAL_INT(REASON_NONE,
                          step().fault); /* remembering a fault is the business of modes */
}

static inline void assert_never_a_fault(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000).fault);
    recover();
}

#endif
