/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_stuck.h: on which side a switch of the bridge that is off is stuck closed. Slow loop,
 * 1 kHz.
 *
 * In freewheel a stuck switch and the diodes of its own side carry half waves: the mean of one
 * phase current over an electrical turn is far from zero, negative with a stuck low side, positive
 * with a stuck high side. DERIVATIONS.md, A switch that is stuck closed. The answer is the active
 * short circuit on that side, from then on until the trip is acknowledged, or, without a trip
 * (found while coasting with the bridge off), until the wheel is at rest.
 *
 * Windows of at least one electrical turn by the valid rotor sensor in one mode of the bridge, and
 * at most MONITOR_STUCK_STEPS; no side is determined without a valid rotor sensor, with a named
 * current sensor, or if the sum of the currents is implausible in more than three quarters of the
 * steps: a sensor that is wrong, and not one that half waves drive beyond its range.
 */
#ifndef MONITOR_MONITOR_STUCK_H
#define MONITOR_MONITOR_STUCK_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/bridge.h"
#include "core/measured.h"
#include "core/reason.h"

enum {
    MONITOR_STUCK_STEPS = 250, /* longest window: a turn at 4 Hz electrical */
    MONITOR_STUCK_SHARE = 4,   /* half waves have a mean of more than a quarter of the trip current;
                                  a whole number of turns and a bit of a healthy current at its
                                  limit has less: sin(1.43 pi)/(1.43 pi) = 0.22 */
    MONITOR_STUCK_PARTS = 8,   /* each of the other two brings back an eighth at least: a
                                 sensor that shows a constant makes two equal means, where
                                 the third phase is computed */
    MONITOR_STUCK_SHORT_WINDOWS = 3,    /* equal windows while a short circuit is commanded, whose
                                           own direct current has decayed */
    MONITOR_STUCK_LONGEST_STEPS = 1000, /* for which that decay is waited for */
    MONITOR_STUCK_RELEASE_STEPS = 10    /* in which the hardware's latch may be released */
};

typedef struct {
    bridge_mode_t side; /* of the stuck switch: BRIDGE_SHORT, BRIDGE_SHORT_HIGH; OFF: not known */
    bridge_mode_t candidate;
    bridge_mode_t bridge;  /* of the step before */
    int32_t same_steps;    /* for which the bridge has been in that mode */
    int32_t windows;       /* in which it was the candidate */
    int32_t release_steps; /* left */
    int32_t steps;         /* of this window */
    int32_t good_steps;    /* of these with a plausible sum */
    int32_t turned_mrad;   /* electrical, in this window, signed */
    uint32_t begin_alpha_pu, begin_beta_pu;
    uint16_t begin_step;
} monitor_stuck_state_t;

typedef struct {
    bridge_mode_t side; /* as in the state */
    bool release_break; /* the bridge is to leave the hardware's latch, for the short circuit */
} monitor_stuck_output_t;

/* The side, once known, stays while there is a trip or the wheel turns. turning: the speed upper
 * bound is above standstill. release_break: for MONITOR_STUCK_RELEASE_STEPS after the side has been
 * found, with a trip only. */
monitor_stuck_output_t monitor_stuck_step(monitor_stuck_state_t *state, const config_t *config,
                                          const measured_t *now, bool turning);

#endif
