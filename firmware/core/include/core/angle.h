/* SPDX-License-Identifier: Apache-2.0 */
/*
 * angle.h: electrical angles as uint16_t (65 536 = one turn, so they wrap by unsigned arithmetic)
 * and their sine and cosine. Fast loop.
 */
#ifndef CORE_ANGLE_H
#define CORE_ANGLE_H

#include <stdint.h>

#include "core/pair.h"
#include "core/q15.h"

typedef struct {
    int32_t sin, cos; /* Q15, 16 bits */
} sincos_t;

/* cos + j sin of an angle, packed. */
typedef struct {
    q_pair_t v;
} rotation_t;

#define ANGLE_PI_Q24 INT64_C(52707179) /* 2^24 pi */

enum { ANGLE_QUARTER_TURN = 16384, ANGLE_TABLE_POINTS = 256 /* a turn */ };

extern const q_pair_t ANGLE_TABLE[ANGLE_TABLE_POINTS];

/* b - a modulo one turn, -32768 .. 32767: positive when b is ahead of a in the forward
 * direction. */
static inline int16_t angle_difference(uint16_t b, uint16_t a)
{
    const uint16_t turn = (uint16_t)(b - a);
    return (int16_t)(turn >= 32768U ? (int32_t)turn - 65536 : (int32_t)turn);
}

/*
 * Cosine and sine together, within 1 LSB of Q15 of the exact values at every one of the 65 536
 * angles; +1 saturates to 32 767.
 *
 * The table's points theta_k lie in the middle of its steps; with delta = theta - theta_k and
 * h = delta^2/2: cos = c - (h c + delta s), sin = s - (h s - delta c).
 */
Q_TARGET_INLINE rotation_t angle_rotation(uint16_t theta_turn)
{
    /* delta: 2 pi / 65 536 in Q37 from the middle of the step, rounded to Q21. */
    const uint32_t from_begin_q37 = (theta_turn & 255U) * 13176795U;
    const int32_t delta_q37 = (int32_t)(from_begin_q37 + 32768U - 128U * 13176795U);
    const int32_t delta_q21 = delta_q37 >> 16;
    const int32_t square_q42 = delta_q21 * delta_q21 + (1 << 21);
    const q_pair_t small_q21 = Q_PAIR_SHIFTED(square_q42, 22, delta_q37);
    const q_pair_t point = q_pair_load(&ANGLE_TABLE[theta_turn >> 8]);
    const int32_t cos_q36 = q_pair_dot(small_q21, point);
    const int32_t sin_q31 = q_pair_cross(small_q21, point) >> 5;
    const rotation_t out = {
        .v = q_pair_subtract(point, Q_PAIR_SHIFTED(cos_q36, 21, sin_q31)),
    };
    return out;
}

/* As angle_rotation(), unpacked. */
static inline sincos_t angle_sincos(uint16_t theta_turn)
{
    const rotation_t rotation = angle_rotation(theta_turn);
    const sincos_t out = {.sin = q_pair_y(rotation.v), .cos = q_pair_x(rotation.v)};
    return out;
}

#endif
