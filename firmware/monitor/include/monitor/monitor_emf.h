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
 * e_q <= -U_q and w psi >= U_q, U_q the uncertainty of e_q, in a salient motor, with halls at a
 * steady speed; and while the voltage is not limited. The error is qualified by
 * monitor.angle_fault_time more implausible than plausible steps; a smaller e counts 1/32.
 * DERIVATIONS.md, Angle check. The same e_q against the magnets' flux: DERIVATIONS.md, Flux and bus
 * voltage.
 */
#ifndef MONITOR_MONITOR_EMF_H
#define MONITOR_MONITOR_EMF_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/measured.h"

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
    int32_t steady_mrad_s;   /* speed, magnitude, from which it has not moved by an eighth ... */
    uint16_t steady_steps;   /* ... for so many steps, saturating */
    int32_t missing_q20; /* share of the flux, 64 ms mean, 1 048 576 = 1.0; 0 unless FLUX_WEAK */
} monitor_emf_state_t;

/* True while the angle is implausible (qualified); never without PWM or with an invalid angle,
 * where the flux stays as it was judged last. Uses latest_... of `now`, of one period and in the
 * frame of the angle in use; currents beyond 10 kA count as that. */
bool monitor_emf_step(monitor_emf_state_t *state, const config_t *config, const measured_t *now);

#endif
