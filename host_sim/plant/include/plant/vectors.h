/* SPDX-License-Identifier: Apache-2.0 */
/*
 * vectors.h: the frames of a three-phase machine as types, double precision, SI,
 * amplitude-invariant.
 *
 * abc are the phases, ab (alpha, beta) the stator frame, dq the rotor frame. The compiler rejects a
 * vector of one frame in place of another. The d axis lies on phase a at electrical angle 0; power
 * is P = 3/2 (u . i).
 */
#ifndef PLANT_VECTORS_H
#define PLANT_VECTORS_H

#include <math.h>

typedef struct {
    double a, b, c;
} plant_abc_t;

typedef struct {
    double alpha, beta;
} plant_ab_t;

typedef struct {
    double d, q;
} plant_dq_t;

/* exp(j angle) */
typedef struct {
    double cos, sin;
} plant_phasor_t;

static const double PLANT_SQRT3 = 1.7320508075688772;
static const double PLANT_INV_SQRT3 = 0.57735026918962576;
static const double PLANT_TWO_PI = 6.2831853071795865;

static inline plant_ab_t plant_clarke(plant_abc_t x)
{
    const plant_ab_t out = {.alpha = (2.0 * x.a - x.b - x.c) * (1.0 / 3.0),
                            .beta = (x.b - x.c) * PLANT_INV_SQRT3};
    return out;
}

static inline plant_abc_t plant_inverse_clarke(plant_ab_t x)
{
    const double half = 0.5 * x.alpha;
    const double rest = 0.5 * PLANT_SQRT3 * x.beta;
    const plant_abc_t out = {.a = x.alpha, .b = rest - half, .c = -rest - half};
    return out;
}

static inline plant_dq_t plant_park(plant_ab_t x, plant_phasor_t axis)
{
    const plant_dq_t out = {.d = x.alpha * axis.cos + x.beta * axis.sin,
                            .q = x.beta * axis.cos - x.alpha * axis.sin};
    return out;
}

static inline plant_ab_t plant_inverse_park(plant_dq_t x, plant_phasor_t axis)
{
    const plant_ab_t out = {.alpha = x.d * axis.cos - x.q * axis.sin,
                            .beta = x.q * axis.cos + x.d * axis.sin};
    return out;
}

static inline plant_phasor_t plant_turned(plant_phasor_t x, plant_phasor_t by)
{
    const plant_phasor_t out = {.cos = x.cos * by.cos - x.sin * by.sin,
                                .sin = x.sin * by.cos + x.cos * by.sin};
    return out;
}

/* exp(j x) for |x| <= 0.25 rad, by series, summed in pairs: error below 1e-14, a fifth of the
 * library's cost. */
static inline plant_phasor_t plant_small_phasor(double x)
{
    const double s = x * x;
    const double ss = s * s;
    const double sin_part =
        (1.0 - s * (1.0 / 6)) + ss * ((1.0 / 120 - s * (1.0 / 5040)) + ss * (1.0 / 362880));
    const double cos_part = (1.0 - s * (1.0 / 2)) + ss * ((1.0 / 24 - s * (1.0 / 720)) +
                                                          ss * (1.0 / 40320 - s * (1.0 / 3628800)));
    const plant_phasor_t out = {.cos = cos_part, .sin = x * sin_part};
    return out;
}

/* Half of an angle within a quarter turn of zero. */
static inline plant_phasor_t plant_half_angle(plant_phasor_t x)
{
    const double half_cos = sqrt(0.5 + 0.5 * x.cos);
    const plant_phasor_t out = {.cos = half_cos, .sin = 0.5 * x.sin / half_cos};
    return out;
}

static inline plant_phasor_t plant_phasor_of_turn(double turn)
{
    const plant_phasor_t out = {.cos = cos(turn * PLANT_TWO_PI), .sin = sin(turn * PLANT_TWO_PI)};
    return out;
}

/* |a| + |b| + |c|: with a + b + c = 0 it is twice the largest of them. */
static inline double plant_rectified_sum(plant_ab_t x)
{
    const plant_abc_t phase = plant_inverse_clarke(x);
    return fabs(phase.a) + fabs(phase.b) + fabs(phase.c);
}

#endif
