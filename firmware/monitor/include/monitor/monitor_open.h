/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_open.h: a phase wire, or one switch of a leg, that is open. Slow loop, 1 kHz, from the
 * currents of one PWM period.
 *
 * The reference wants current in this phase, its measurement has less than a quarter of it and less
 * than a sixth of the other two phases', opposite currents, or these carry hardly any either: in
 * MONITOR_OPEN_STEPS samples of the same sign of the reference, without one in between that has
 * half of it. Or, of a slow rotor: a phase stays at zero beside the others' current in
 * MONITOR_OPEN_STEPS samples, while the rotor turns through MONITOR_OPEN_TURN and the reference
 * wants a quarter of that current in it. Samples after a jump of the angle, ahead of the currents,
 * do not count. A dead current sensor looks like that only below the tolerance of the sum; above it
 * its sample is replaced. Three that are dead are monitor_current.h's. DERIVATIONS.md, Open phase.
 */
#ifndef MONITOR_MONITOR_OPEN_H
#define MONITOR_MONITOR_OPEN_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/frames.h"
#include "core/measured.h"
#include "core/reason.h"

enum {
    MONITOR_OPEN_STEPS = 3,            /* ms, qualify time */
    MONITOR_OPEN_SUSPECT_STEPS = 2,    /* that explain an over-current */
    MONITOR_OPEN_TURN = 5461,          /* of 65 536: 30 degrees electrical, qualify angle */
    MONITOR_OPEN_FASTEST_TURN = 10923, /* 60 degrees, between two samples that are compared */
    MONITOR_OPEN_JUMP_TURN = 3641,     /* 20 degrees: change of the step, as at a hall edge */
    MONITOR_OPEN_JUMP_STEPS = 2,       /* ms, until the current loop has followed that */
    MONITOR_OPEN_OTHERS_PU = 800,      /* less is none in any phase, Q15: 2.4 % of the range */
    MONITOR_OPEN_DEAD_PU = 24,         /* less is none of a sensor, Q15: one and a half codes */
    MONITOR_OPEN_WANTED_PU = 1280,     /* least reference of a phase that is judged, 3.9 % */
    MONITOR_OPEN_LEAST_PU = 2048,      /* least current beside which one at zero counts, 6 % */
    MONITOR_OPEN_EDGE_SHARE = 16,      /* rad: 3.6 degrees that a hall edge is beside its place */
    MONITOR_OPEN_MOST_EDGE_PU = 32768
};

typedef struct {
    uint8_t missing[3][2]; /* samples a phase; current wanted out of the motor, into it */
    uint8_t zeros[3];      /* consecutive samples of a phase at zero */
    uint16_t turned[3];    /* electrical angle from the first of these to the latest */
    uint16_t theta_turn;   /* of the latest sample */
    int32_t step_turn;     /* from the sample before to the latest one */
    uint8_t steps_known;   /* of the angle's steps, up to two */
    uint8_t unsettled;     /* samples until the currents follow an angle that has jumped */
    bool suspected;        /* in the latest step with PWM */
} monitor_open_state_t;

/* What a misplaced hall edge makes flow beside the reference, Q15 of the current base, 0 ..
 * MONITOR_OPEN_MOST_EDGE_PU: the voltage error w psi/16 over the proportional gain. 0 of other
 * sensors. */
int32_t monitor_open_edge_pu(const config_t *config, const measured_t *now);

/* PHASE_OPEN while a phase is open, CURRENT_SUM while a sensor shows no current of its phase
 * (qualified); else REASON_NONE, and while the bridge does not switch. The two differ in the sum of
 * the three readings. Of `now` it uses current, sum and angle of the latest period. reference_pu:
 * of the averaging window, field weakening included, in the rotor frame, Q15 of the current base,
 * components within two full scales (65 536). edge_pu: of monitor_open_edge_pu(); a reference below
 * twice and a current below three times that are not judged. */
reason_t monitor_open_step(monitor_open_state_t *state, const measured_t *now, dq_t reference_pu,
                           int32_t edge_pu);

#endif
