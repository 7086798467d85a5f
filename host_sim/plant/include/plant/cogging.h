/* SPDX-License-Identifier: Apache-2.0 */
/*
 * cogging.h: magnets that prefer some angles to others: a torque without current.
 *
 *     W(a) = A / n (1 - cos(n a + phase))        T = -dW/da = -A sin(n a + phase)
 *     a mechanical angle, n periods a turn
 *
 * The torque is the slope of a stored energy, so its mean and its work over a turn are zero, and
 * a step's impulse is taken from the energies at its ends: impulse * speed = W before - W after,
 * for any step. A whole machine has n = least common multiple of slots and poles, a multiple
 * of the pole pairs; n = slots is a rotor's, n = poles a stator's imperfection. Source: Z. Q. Zhu,
 * D. Howe, "Influence of design parameters on cogging torque in permanent magnet machines", IEEE
 * Trans. Energy Conversion 15 (2000).
 */
#ifndef PLANT_COGGING_H
#define PLANT_COGGING_H

#include "plant/vectors.h"

typedef struct {
    double amplitude_nm; /* 0: none */
    double per_turn;
    double phase_turn; /* of a period */
} cogging_t;

/* Impulse while the shaft turns by step_turn from shaft_turn in duration_s, at an even speed; N m
 * s. */
static inline double cogging_impulse_nms(const cogging_t *cogging, double shaft_turn,
                                         double step_turn, double duration_s)
{
    const double half_rad = 0.5 * PLANT_TWO_PI * cogging->per_turn * step_turn;
    const double middle_turn =
        cogging->per_turn * (shaft_turn + 0.5 * step_turn) + cogging->phase_turn;
    /* cos a - cos b by the sine of half their difference over it, which is 1 at rest. */
    const double evened = fabs(half_rad) > 1e-6 ? sin(half_rad) / half_rad : 1.0;
    return -cogging->amplitude_nm * sin(PLANT_TWO_PI * middle_turn) * evened * duration_s;
}

static inline double cogging_energy_j(const cogging_t *cogging, double shaft_turn)
{
    if (cogging->per_turn <= 0.0) {
        return 0.0;
    }
    const double turn = cogging->per_turn * shaft_turn + cogging->phase_turn;
    return cogging->amplitude_nm / cogging->per_turn * (1.0 - cos(PLANT_TWO_PI * turn));
}

#endif
