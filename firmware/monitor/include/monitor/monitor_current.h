/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_current.h: current sensors that all show no current, which their sum does not reveal, and
 * a current that is far beyond its reference. Slow loop, 1 kHz. README, All current sensors; Lost
 * current control.
 *
 * The response of the current loop is known: every period it adds a share K of the error that it
 * sees. Without any current seen the error is the reference, so the integral of the reference over
 * the time, multiplied by K f, is the current that flows unseen.
 *
 * The same response leaves a millisecond no mean that is longer than its reference by half of the
 * trip current, where the bus has the voltage for the EMF and the angle is known.
 */
#ifndef MONITOR_MONITOR_CURRENT_H
#define MONITOR_MONITOR_CURRENT_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/frames.h"
#include "core/reason.h"

enum { MONITOR_CURRENT_BEYOND_STEPS = 3 }; /* ms, qualify time */

typedef struct {
    int32_t missing_pu;   /* sum of the references without a current, Q15 times ms */
    int32_t beyond_steps; /* in which the current was beyond its reference */
} monitor_current_state_t;

/* In the estimated frame. */
typedef struct {
    dq_t sampled_pu;   /* mean of the samples of the last millisecond, Q15 */
    dq_t reference_pu; /* of that millisecond, Q15 */
    bool switching;
    bool voltage_limited; /* the current loop cannot do what its reference says: not counted */
    int32_t speed_mrad_s, bus_voltage_mV;
    bool angle_known; /* no warning of the rotor sensor: the frame is the rotor's */
} monitor_current_input_t;

/* REASON_CURRENT_SENSOR while the sensors show no current although monitor.current_missing has been
 * demanded; REASON_OVERCURRENT while the current is beyond its reference (qualified).
 *
 * @pre is_within(state->missing_pu, 0, config->monitor.current_missing_pu_q15)
 *
 * @pre is_within(state->beyond_steps, 0, MONITOR_CURRENT_BEYOND_STEPS)
 *
 * @post is_within(state->missing_pu, 0, config->monitor.current_missing_pu_q15)
 *
 * @post is_within(state->beyond_steps, 0, MONITOR_CURRENT_BEYOND_STEPS)
 *
 * @post in->switching || (state->beyond_steps == 0 && state->missing_pu == 0)
 *
 * @post !in->voltage_limited || state->missing_pu <= old(state->missing_pu)
 *
 * @post (result == REASON_CURRENT_SENSOR) == (state->missing_pu ==
 * config->monitor.current_missing_pu_q15)
 *
 * @post result == REASON_NONE || result == REASON_CURRENT_SENSOR || (result == REASON_OVERCURRENT
 * && state->beyond_steps == MONITOR_CURRENT_BEYOND_STEPS)
 */
reason_t monitor_current_step(monitor_current_state_t *state, const config_t *config,
                              const monitor_current_input_t *in);

#endif
