/*
 * angle.h: electrical angles as uint16_t (65 536 = one turn, wrapping is the arithmetic of the type) and their
 * sine and cosine.
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
    ANGLE_TABLE_POINTS = 128,                                            /* a turn */
    ANGLE_TABLE_LENGTH = ANGLE_TABLE_POINTS + ANGLE_TABLE_POINTS / 4 + 1 /* and a quarter, for the cosine */
};

extern const int16_t ANGLE_SINE_TABLE[ANGLE_TABLE_LENGTH];

/* b - a, the short way round, -32768 .. 32767: positive when b is ahead of a in the forward direction. */
static inline int16_t angle_difference(uint16_t b, uint16_t a)
{
    const uint16_t turn = (uint16_t)(b - a);
    return (int16_t)(turn >= 32768U ? (int32_t)turn - 65536 : (int32_t)turn);
}

/*
 * Sine and cosine together, at most 1 LSB of Q15 from the correctly rounded value at every one of the 65 536 angles.
 *
 * With the nearest table point theta_k and delta = theta - theta_k, |delta| <= pi/128:
 *     sin = s + delta c - delta^2/2 s,   cos = c - delta s - delta^2/2 c
 * The neglected cubic term is below 0.1 LSB, the rounding of delta below 0.3 LSB. The table is rounded down and what is
 * taken from it too, so each of the two roundings is below 1 LSB and they point in opposite directions.
 */
Q_TARGET_INLINE sincos_t angle_sincos(uint16_t theta_turn)
{
    const uint32_t k = ((theta_turn + 256U) >> 9) & (ANGLE_TABLE_POINTS - 1U);
    const int32_t offset = (int32_t)((uint32_t)theta_turn << 23) >> 23; /* to the nearest point, -256 .. 255 */
    const int32_t delta_q21 = offset * 201;                             /* 2 pi / 65536 in Q21 is 201.06 */
    /* delta^2 is below 2^32, not below 2^31. */
    const int32_t half_square_q21 = (int32_t)(((uint32_t)delta_q21 * (uint32_t)delta_q21) >> 22);
    const int32_t s = ANGLE_SINE_TABLE[k];
    const int32_t c = ANGLE_SINE_TABLE[k + ANGLE_TABLE_POINTS / 4];
    const sincos_t out = {
        .sin = s - ((half_square_q21 * s - delta_q21 * c) >> 21),
        .cos = c - ((half_square_q21 * c + delta_q21 * s) >> 21),
    };
    return out;
}

#endif
