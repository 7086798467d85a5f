/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_current.h: current sensors that all show no current, or at rest all the same as before,
 * which their sum does not reveal. Slow loop, 1 kHz. DERIVATIONS.md, All current sensors.
 *
 * The response of the current loop is known: every period it adds a share K of the error that it
 * sees. While no current moves what is seen, the integral of the error over the time, multiplied by
 * K f, is the current that flows unseen.
 */
#ifndef MONITOR_MONITOR_CURRENT_H
#define MONITOR_MONITOR_CURRENT_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/frames.h"
#include "core/measured.h"

typedef struct {
    int32_t missing_pu; /* sum of the errors that move no reading, Q15 times ms */
    dq_t shown_pu;      /* latest at rest or none, which is 0 */
    uint16_t theta_turn;
} monitor_current_state_t;

/* True while the readings have not followed although monitor.current_missing has been demanded.
 * reference_pu: of the averaging window, field weakening included, Q15. The sum begins anew without
 * PWM, with every current of a rotor that turns and with every change of one at rest; at the
 * voltage limit it stays. */
bool monitor_current_step(monitor_current_state_t *state, const config_t *config,
                          const measured_t *now, dq_t reference_pu);

#endif
