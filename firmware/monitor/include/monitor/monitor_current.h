/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_current.h: current sensors that all show no current, which their sum does not reveal.
 * Slow loop, 1 kHz. README, All current sensors.
 *
 * The response of the current loop is known: every period it adds a share K of the error that it
 * sees. Without any current seen the error is the reference, so the integral of the reference over
 * the time, multiplied by K f, is the current that flows unseen.
 */
#ifndef MONITOR_MONITOR_CURRENT_H
#define MONITOR_MONITOR_CURRENT_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/frames.h"

typedef struct {
    int32_t missing_pu; /* sum of the references without a current, Q15 times ms */
} monitor_current_state_t;

/* In the estimated frame. */
typedef struct {
    dq_t sampled_pu;   /* mean of the samples of the last millisecond, Q15 */
    dq_t reference_pu; /* of that millisecond, Q15 */
    bool switching;
    bool voltage_limited; /* the current loop cannot do what its reference says: not counted */
} monitor_current_input_t;

/* True while the sensors show no current although monitor.current_missing has been demanded. */
bool monitor_current_step(monitor_current_state_t *state, const config_t *config,
                          const monitor_current_input_t *in);

#endif
