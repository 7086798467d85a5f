/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_jump.h: a common gain of all current sensors that changes at once, by the energy of the
 * motor's inductance. Slow loop, 1 kHz, from means of the last millisecond.
 *
 * The current of an inductance does not jump. Sensors that show g times the current from one period
 * to the next make the current loop drive it to 1/g of what it was. Soon the shown current is the
 * same again, and the loop has put W = 3/2 (L_d i_d^2 + L_q i_q^2) (1/g - 1) into a motor that
 * shows no other current than before. No healthy sensor shows that. Named are steps to g >= 1.3 or
 * g <= 0.7. README, Jump of the gain of all current sensors.
 */
#ifndef MONITOR_MONITOR_JUMP_H
#define MONITOR_MONITOR_JUMP_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/frames.h"

enum {
    MONITOR_JUMP_STEPS = 6,       /* ms: two before, two of the jump, two after it */
    MONITOR_JUMP_RING = 8,        /* a power of two */
    MONITOR_JUMP_NAME_STEPS = 8,  /* ms in which another cause may show itself */
    MONITOR_JUMP_LEAST_SHARE = 8, /* of the largest phase current: least current */
    MONITOR_JUMP_SHARE = 16,      /* of L i^2: largest change from before to after, least rise */
    MONITOR_JUMP_DIPS = 7,        /* halves of that: least dip */
    MONITOR_JUMP_STEADY_SHARE =
        6,                      /* of W: largest change of the power in a millisecond beside it */
    MONITOR_JUMP_ENERGY = 400,  /* 1/1000 of L i^2, by way of 2^30: least W, 0.37 L i^2 */
    MONITOR_JUMP_MOST = 1 << 26 /* mA, uJ; larger ones count as that */
};

typedef struct {
    int32_t bus_mA[MONITOR_JUMP_RING];    /* of the latest milliseconds */
    int32_t energy_uJ[MONITOR_JUMP_RING]; /* L i^2, 7 % less */
    uint8_t newest;                       /* its place */
    uint8_t filled;                       /* up to MONITOR_JUMP_STEPS */
    uint8_t since_steps;                  /* since the jump, 0: none */
} monitor_jump_state_t;

/* Means of the same millisecond. */
typedef struct {
    dq_t i_pu;              /* sampled, Q15 */
    int32_t bus_current_mA; /* by the current loop, positive out of the battery */
    int32_t bus_voltage_mV;
    bool watched; /* PWM with a valid angle, below the voltage limit, nothing else is suspected */
} monitor_jump_input_t;

/* True MONITOR_JUMP_NAME_STEPS after a jump, for as long as it is watched.
 *
 * @pre every(i, MONITOR_JUMP_RING, is_within(state->bus_mA[i], -MONITOR_JUMP_MOST,
 * MONITOR_JUMP_MOST) && is_within(state->energy_uJ[i], 0, MONITOR_JUMP_MOST))
 *
 * @pre state->filled <= MONITOR_JUMP_STEPS && state->since_steps <= MONITOR_JUMP_NAME_STEPS &&
 * state->newest < MONITOR_JUMP_RING
 *
 * @pre vectors_hold(in->i_pu, in->i_pu)
 *
 * @post every(i, MONITOR_JUMP_RING, is_within(state->bus_mA[i], -MONITOR_JUMP_MOST,
 * MONITOR_JUMP_MOST) && is_within(state->energy_uJ[i], 0, MONITOR_JUMP_MOST))
 *
 * @post state->filled <= MONITOR_JUMP_STEPS && state->since_steps <= MONITOR_JUMP_NAME_STEPS &&
 * state->newest < MONITOR_JUMP_RING
 *
 * @post result == (state->since_steps == MONITOR_JUMP_NAME_STEPS)
 *
 * @post in->watched || state->since_steps == 0
 */
bool monitor_jump_step(monitor_jump_state_t *state, const config_t *config,
                       const monitor_jump_input_t *in);

#endif
