/* SPDX-License-Identifier: Apache-2.0 */
/*
 * bridge_choice.h: whether the bridge switches or takes its safe state while torque is enabled.
 * Slow loop, 1 kHz.
 *
 * PWM while currents within the limits can make the commanded torque; the safe state where they
 * cannot. Without a command for modes.coast_delay, the open bridge as long as PWM could hold the
 * EMF without a demagnetising current, so that closing it needs none either. README, Letting go.
 */
#ifndef CONTROLLER_BRIDGE_CHOICE_H
#define CONTROLLER_BRIDGE_CHOICE_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/bridge.h"

enum {
    /* Steps without a feasible torque before the bridge leaves PWM: one may be a disturbed mean. */
    BRIDGE_CHOICE_INFEASIBLE_STEPS = 2,
    /* Steps with a feasible one before it returns. */
    BRIDGE_CHOICE_RETURN_STEPS = 5,
    /* What PWM must have more of the voltage before it returns, 1/2^7: the hysteresis. */
    BRIDGE_CHOICE_HYSTERESIS_LOG2 = 7,
    /* Heal time of the warning. */
    BRIDGE_CHOICE_OVERSPEED_STEPS = 1000
};

typedef struct {
    uint16_t idle_steps;       /* that fit coasting, saturating */
    uint16_t infeasible_steps; /* saturating */
    uint16_t return_steps;     /* left until PWM is taken again */
    uint16_t overspeed_steps;  /* left of the warning's heal time */
    bool overspeed;            /* warning: no current makes the commanded torque */
} bridge_choice_state_t;

typedef struct {
    bool torque_enabled;  /* any share of torque */
    bool torque_wanted;   /* demand or torque command is not zero */
    bool torque_feasible; /* voltage and phase current suffice for PWM, forced torque or not */
    int32_t forced_mNm;   /* braking torque that PWM makes whatever is commanded, magnitude */
    bool observer_used;   /* no sensor: a coasting bridge does not switch to find the angle */
    bool rotor_valid;     /* without it the bridge keeps switching, so that an observer sees */
    bridge_mode_t bridge; /* actual mode */
    bridge_mode_t safe_bridge;
    int32_t safe_torque_mNm;  /* braking torque of the safe state, magnitude */
    int32_t emf_mV;           /* w psi, peak phase */
    int32_t phase_voltage_mV; /* peak phase: what PWM can make without a demagnetising current */
    int32_t i_d_mA, i_q_mA;   /* of the latest period, peak phase */
} bridge_choice_input_t;

void bridge_choice_init(bridge_choice_state_t *state);

/* The phase voltage that PWM would have instead of a bridge whose diodes charge the battery and so
 * lift its voltage, less the hysteresis. charging_mA >= 0: of this motor. */
int32_t bridge_choice_phase_mV(const config_t *config, int32_t phase_mV, int32_t bus_mV,
                               int32_t charging_mA);

bridge_mode_t bridge_choice_step(bridge_choice_state_t *state, const config_t *config,
                                 const bridge_choice_input_t *in);

#endif
