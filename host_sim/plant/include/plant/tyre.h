/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tyre.h: how much a tyre can pull along the road: an average lumped LuGre model.
 *
 *     dz/dt = v_r - (s0 |v_r| / g + k |w r|) z        F = N (s0 z + s1 dz/dt)        k = 7 / (6 L)
 *     g = mu [share + (1 - share) exp(-sqrt(|v_r| / v_s))]        v_r = w r - v
 *
 * z is the deflection of the contact's bristles: a spring while the tyre sticks (a braked wheel
 * holds a slope without creeping), slip in steady rolling, where with s = v_r / (w r) force over
 * load is g s / (|s| + k g / s0): the slope at no slip is s0 / k, the end is mu times share. The
 * deflection is stepped implicitly, so a locked wheel is stable at any step. Source: Canudas de
 * Wit, Tsiotras, Velenis, Basset, Gissinger, "Dynamic friction models for road/tire longitudinal
 * interaction", Vehicle System Dynamics 39 (2003); k for an even pressure: Deur, Asgari, Hrovat,
 * ibid. 42 (2004).
 */
#ifndef PLANT_TYRE_H
#define PLANT_TYRE_H

#include "plant/parameter.h"

/* clang-format off */
#define TYRE_PARAMETERS(X) \
    X(bristle_stiffness_per_m,   0.0, 1e5,  "1/m", "s0, force over load a metre of deflection") \
    X(bristle_damping_s_per_m,   0.0, 100.0, "s/m", "s1") \
    X(contact_length_m,          0.0, 1.0,  "m",   "L of the contact patch") \
    X(sliding_share,             0.0, 1.0,  "1", \
      "friction of a locked wheel at speed over that at rest") \
    X(stribeck_speed_m_per_s,    0.0, 100.0, "m/s", \
      "v_s, where friction has fallen most of the way")
/* clang-format on */

typedef struct {
    TYRE_PARAMETERS(PLANT_PARAMETER_MEMBER)
} tyre_params_t;

typedef struct {
    double deflection_m;
} tyre_state_t;

/* The state of one contact during a step. */
typedef struct {
    double friction; /* mu */
    double load_n;   /* N >= 0 */
    double slip_m_per_s;
    double rolling_m_per_s; /* w r */
} tyre_contact_t;

/* Mean force of the step, positive pushing the vehicle forward. Needs friction, stiffness, length
 * and v_s above 0. */
double tyre_step(const tyre_params_t *params, tyre_state_t *state, const tyre_contact_t *contact,
                 double step_s);

/* Energy in the bristles. */
double tyre_stored_j(const tyre_params_t *params, const tyre_state_t *state, double load_n);

#endif
