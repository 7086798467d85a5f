/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_open.h: a phase wire, or one switch of a leg, that is open. Slow loop, 1 kHz, from the
 * currents of one PWM period.
 *
 * The reference wants current in this phase, its measurement has less than a quarter of it and less
 * than a sixth of the other two phases', opposite currents: in MONITOR_OPEN_STEPS samples of the
 * same sign of the reference, without one in between that has half of it. Or, of a slow rotor: a
 * phase stays at zero beside the others' current in MONITOR_OPEN_STEPS samples, while the rotor
 * turns through MONITOR_OPEN_TURN and the reference wants a quarter of that current in it. Samples
 * after a jump of the angle, ahead of the currents, do not count. A dead current sensor looks like
 * that only below the tolerance of the sum; above it its sample is replaced. monitor_open_reason()
 * tells the two. README, Open phase.
 */
#ifndef MONITOR_MONITOR_OPEN_H
#define MONITOR_MONITOR_OPEN_H

#include <stdbool.h>
#include <stdint.h>

#include "core/frames.h"
#include "core/reason.h"

enum {
    MONITOR_OPEN_STEPS = 3,            /* ms, qualify time */
    MONITOR_OPEN_SUSPECT_STEPS = 2,    /* that explain an over-current */
    MONITOR_OPEN_TURN = 5461,          /* of 65 536: 30 degrees electrical, qualify angle */
    MONITOR_OPEN_FASTEST_TURN = 10923, /* 60 degrees, between two samples that are compared */
    MONITOR_OPEN_JUMP_TURN = 3641,     /* 20 degrees: change of the step, as at a hall edge */
    MONITOR_OPEN_JUMP_STEPS = 2,       /* ms, until the current loop has followed that */
    MONITOR_OPEN_OTHERS_PU = 800,      /* least current of the other two, Q15: 2.4 % of the range */
    MONITOR_OPEN_LEAST_PU = 1280       /* least reference of a phase that is judged, Q15 */
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

/* Rotor frame, Q15 of the current base, components within 17 bits. */
typedef struct {
    dq_t sampled_pu; /* of the latest period */
    dq_t reference_pu;
    uint16_t theta_turn; /* electrical angle of that frame in that period */
    bool switching;
} monitor_open_input_t;

/* True while a phase is open (qualified); never while the bridge does not switch. */
bool monitor_open_step(monitor_open_state_t *state, const monitor_open_input_t *in);

/* Name of what monitor_open_step() has found, from the current and the sum of the three readings in
 * the same period, Q15 of the current base. An open phase leaves the other two opposite currents,
 * which add up to zero; a sensor that shows none leaves a sum of what its phase carries, up to the
 * tolerance of that check. */
reason_t monitor_open_reason(dq_t sampled_pu, int32_t current_sum_pu);

#endif
