/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_emf.h: plausibility of the rotor angle against the back-EMF. Slow loop, 1 kHz, from the
 * voltage and current of one PWM period.
 *
 *     e_d = u_d - R i_d + w L_q i_q        e_q = u_q - R i_q - w L_d i_d
 *
 * is (0, w psi) at the right angle, in the estimated frame. The angle is implausible if e is more
 * than 45 degrees away from the q axis, or if e_q and the speed have opposite signs, and e is at
 * least w psi/2 in its larger component: a smaller one shows no angle but a rotor that is slower
 * than its sensor says. It is checked only where w psi >= 4 U, U the uncertainty of e, or where
 * e_q <= -U_q and w psi >= U_q, U_q the uncertainty of e_q, in a salient motor; and while the
 * voltage is not limited. The error is qualified by monitor.angle_fault_time more implausible than
 * plausible steps; a smaller e counts 1/32. README, Angle check.
 */
#ifndef MONITOR_MONITOR_EMF_H
#define MONITOR_MONITOR_EMF_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"

enum {
    MONITOR_EMF_FLUX_STEPS = 200, /* ms, qualify and heal time */
    MONITOR_EMF_SEEN = 32         /* weight of a step with an EMF; 1: a smaller one */
};

/* What e_q says of the magnets' flux at the configured temperature coefficient. */
typedef enum {
    MONITOR_EMF_FLUX_PLAUSIBLE,
    MONITOR_EMF_FLUX_WEAK,  /* magnets weak, or the bus voltage reads low */
    MONITOR_EMF_FLUX_STRONG /* the bus voltage reads high: magnets never gain flux */
} monitor_emf_flux_t;

typedef struct {
    uint16_t level; /* in 1/32 steps */
    int16_t flux_level;
    monitor_emf_flux_t flux; /* qualified; stays where it cannot be judged */
    int32_t missing_q20; /* share of the flux, 64 ms mean, 1 048 576 = 1.0; 0 unless FLUX_WEAK */
} monitor_emf_state_t;

/* Of the same PWM period, in the estimated frame: peak phase quantities, applied
 * terminal voltage. */
typedef struct {
    int32_t u_d_mV, u_q_mV;
    int32_t i_d_mA, i_q_mA;
    int32_t bus_voltage_mV;
    int32_t winding_temperature_cC;
    int32_t speed_mrad_s; /* mechanical, signed, as estimated */
    bool switching;       /* the voltage was applied */
    bool voltage_limited; /* the motor may be disconnected: not checked */
    bool rotor_valid;     /* an invalid angle is not checked */
} monitor_emf_input_t;

/* True while the angle is implausible (qualified). */
bool monitor_emf_step(monitor_emf_state_t *state, const config_t *config,
                      const monitor_emf_input_t *in);

#endif
