/* SPDX-License-Identifier: Apache-2.0 */
/*
 * bridge_choice.h: whether the bridge switches or takes its safe state while torque is enabled.
 * Slow loop, 1 kHz.
 *
 * PWM while currents within the limits can make the commanded torque; the safe state where they
 * cannot. Without a command for modes.coast_delay, the open bridge as long as PWM could hold the
 * EMF without a demagnetising current, so that closing it needs none either. A short circuit near
 * standstill, where a lost demand is kept and no other brake is commanded. README and
 * DERIVATIONS.md, Letting go.
 */
#ifndef CONTROLLER_BRIDGE_CHOICE_H
#define CONTROLLER_BRIDGE_CHOICE_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/bridge.h"
#include "core/findings.h"
#include "core/measured.h"
#include "core/monitored.h"
#include "core/torque_enable.h"
#include "torque/torque.h"

enum {
    /* Steps without a feasible torque before the bridge leaves PWM: one may be a disturbed mean. */
    BRIDGE_CHOICE_INFEASIBLE_STEPS = 2,
    /* Steps with a feasible one before it returns. */
    BRIDGE_CHOICE_RETURN_STEPS = 5
};

typedef struct {
    uint16_t idle_steps;       /* that fit coasting, saturating */
    uint16_t infeasible_steps; /* saturating */
    uint16_t return_steps;     /* left until PWM is taken again */
} bridge_choice_state_t;

void bridge_choice_init(bridge_choice_state_t *state);

/* torque: of this step. demanded: driving or braking torque is demanded. Returns BRIDGE_PWM, the
 * monitor's safe state, always that one while no torque is enabled, or that short circuit. Sets the
 * finding FORCED_TORQUE, which acts in the next step. */
bridge_mode_t bridge_choice_step(bridge_choice_state_t *state, const config_t *config,
                                 const measured_t *now, const monitored_t *watch,
                                 const torque_output_t *torque, const torque_enable_t *enable,
                                 bool demanded, findings_t *findings);

#endif
