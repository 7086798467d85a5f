/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_current.h: current sensors that all show no current, which their sum does not reveal.
 * Slow loop, 1 kHz. DERIVATIONS.md, All current sensors.
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
#include "core/measured.h"

typedef struct {
    int32_t missing_pu; /* sum of the references without a current, Q15 times ms */
} monitor_current_state_t;

/* True while the sensors show no current although monitor.current_missing has been demanded.
 * reference_pu: of the averaging window, field weakening included, Q15. The sum begins anew without
 * PWM and with every current; at the voltage limit it stays. */
bool monitor_current_step(monitor_current_state_t *state, const config_t *config,
                          const measured_t *now, dq_t reference_pu);

#endif
