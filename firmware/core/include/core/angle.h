/* SPDX-License-Identifier: Apache-2.0 */
/*
 * angle.h: electrical angles as uint16_t (65 536 = one turn, wrapping is the arithmetic of the
 * type) and their sine and cosine.
 */
#ifndef CORE_ANGLE_H
#define CORE_ANGLE_H

#include <stdint.h>

#include "core/q15.h"

typedef struct {
    int32_t sin, cos; /* Q15, |.| <= 32768 */
} sincos_t;

enum {
    ANGLE_QUARTER_TURN = 16384,
    ANGLE_TABLE_POINTS = 256, /* a turn */
    ANGLE_TABLE_LENGTH =
        ANGLE_TABLE_POINTS + ANGLE_TABLE_POINTS / 4 /* and a quarter, for the cosine */
};

extern const int16_t ANGLE_SINE_TABLE[ANGLE_TABLE_LENGTH];

/* b - a, the short way round, -32768 .. 32767: positive when b is ahead of a in the forward
 * direction. */
static inline int16_t angle_difference(uint16_t b, uint16_t a)
{
    const uint16_t turn = (uint16_t)(b - a);
    return (int16_t)(turn >= 32768U ? (int32_t)turn - 65536 : (int32_t)turn);
}

/*
 * Sine and cosine together, within 1 LSB of Q15 of the exact values at every one of the 65 536
 * angles.
 *
 * The table's points theta_k lie in the middle of its steps. With delta = theta - theta_k, |delta|
 * <= pi/256:
 *     sin = s + delta c - delta^2/2 s,   cos = c - delta s - delta^2/2 c
 * The neglected cubic term and the rounding of delta and of its square are below 0.02 LSB together.
 * The table is rounded down and so is what is taken from it, so each of the two roundings is below
 * 1 LSB and they point in opposite directions.
 */
Q_TARGET_INLINE sincos_t angle_sincos(uint16_t theta_turn)
{
    const uint32_t k = theta_turn >> 8;
    /* theta_turn & 255 counts from the beginning of the step, the delta from its middle; 2 pi /
     * 65536 in Q25 is 3216.99. */
    const int32_t delta_q22 = ((int32_t)(theta_turn & 255U) * 3217 - (128 * 3217 - 4)) >> 3;
    /* delta^2 is below 2^32, not below 2^31. */
    const int32_t half_square_q22 =
        (int32_t)(((uint32_t)delta_q22 * (uint32_t)delta_q22 + (1U << 22)) >> 23);
    const int32_t s = ANGLE_SINE_TABLE[k];
    const int32_t c = ANGLE_SINE_TABLE[k + ANGLE_TABLE_POINTS / 4];
    const sincos_t out = {
        .sin = s - ((half_square_q22 * s - delta_q22 * c) >> 22),
        .cos = c - ((half_square_q22 * c + delta_q22 * s) >> 22),
    };
    return out;
}

#endif
