/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_case.h: a millisecond as the monitor and its checks see it, as one value that a test
 * writes down.
 */
#ifndef MONITOR_CASE_H
#define MONITOR_CASE_H

#include "core/last.h"
#include "core/measured.h"

typedef struct {
    fast_report_t report;
    battery_limits_t battery;
    wheel_temperatures_t shown; /* by the sensors */
    measured_t now;             /* without its pointers */
    last_t last;
} monitor_case_t;

/* What is measured in a case; until the next call. */
static inline const measured_t *measured_of(const monitor_case_t *at)
{
    static monitor_case_t seen;
    static slow_input_t in;
    seen = *at;
    in.temperature = at->shown;
    seen.now.report = &seen.report;
    seen.now.battery = &seen.battery;
    seen.now.in = &in;
    return &seen.now;
}

static inline bridge_mode_t pwm_if(bool switching)
{
    return switching ? BRIDGE_PWM : BRIDGE_OFF;
}

static inline contactor_t open_if(bool open)
{
    return open ? CONTACTOR_OPEN : CONTACTOR_CLOSED;
}

#endif
