/* SPDX-License-Identifier: Apache-2.0 */
/*
 * One period of the EMF observer: for every state, voltage, current and tuning nothing overflows,
 * and flux and speed stay in their ranges. The flux may be anywhere in its range: no machine, no
 * sensor and no rotor angle is assumed.
 */
#include "vectors.h"

/* Any axis in the octagon around the unit circle instead of the table's 256. */
static const q_pair_t *any_axes;
#define ANGLE_TABLE any_axes
#include "emf_observer.h"
#undef ANGLE_TABLE
#include "fast_ranges.h"

static q_pair_t both(int32_t x)
{
    return q_pair(x, x);
}

static int32_t any_31_bits(void)
{
    return any_within(-(INT32_C(1) << 30), (INT32_C(1) << 30) - 1);
}

/* A state whose flux is anywhere in its range. */
static emf_observer_t any_flux(void)
{
    const emf_observer_t out = {
        .alpha_q30 = any_31_bits(),
        .beta_q30 = any_31_bits(),
    };
    return out;
}

static ab16_t any_current(void)
{
    const ab16_t out = {.v = q_pair(any_within(-32768, 32767), any_within(-32768, 32767))};
    return out;
}

/* The flux does not read what the tracking loop holds, so that stands still. */
void prove_emf_observer_flux(void)
{
    static const q_pair_t axes[ANGLE_TABLE_POINTS];
    any_axes = axes;
    emf_observer_t observer = any_flux();
    const observer_tuning_t tuning = {
        .volt = both(any_within(0, MOST_STEP_Q15)),
        .minus_resistance = both(any_within(-MOST_STEP_Q15, 0)),
        .minus_leak = both(any_within(-MOST_LEAK_Q16, 0)),
        .minus_inductance = both(any_within(-MOST_INDUCTANCE_Q15, 0)),
    };
    emf_observer_step(&observer, any_current(), any_current(), &tuning);
    PROVE(q_abs(q_pair_x(observer.x.v)) <= 32768 && q_abs(q_pair_y(observer.x.v)) <= 32768);
    PROVE(observer.alpha_q30 >= -(INT32_C(1) << 30) && observer.alpha_q30 < INT32_C(1) << 30);
    PROVE(observer.beta_q30 >= -(INT32_C(1) << 30) && observer.beta_q30 < INT32_C(1) << 30);
    PROOF_END();
}

/* The tracking loop reads of the flux x alone. With the largest inductance and any current that
 * takes every value it can have with another one. No overflow with the largest gains, so none with
 * smaller ones: the products grow with the gain, and the angle wraps. Four minutes. */
void prove_emf_observer_tracking(void)
{
    q_pair_t axes[ANGLE_TABLE_POINTS]; /* of any content */
    any_axes = axes;
    emf_observer_t observer = any_flux();
    observer.theta_q32 = nondet_uint32();
    observer.speed_q32 = any_31_bits();
    observer.gains.proportional = MOST_PROPORTIONAL;
    observer.gains.integral = MOST_INTEGRAL;
    axes[observer.theta_q32 >> 24] = any_rotation().v;
    const observer_tuning_t none = {.minus_inductance = both(-MOST_INDUCTANCE_Q15)};
    const ab16_t zero = {.v = both(0)};
    PROOF_EXAMPLE(observer.alpha_q30 == 0 && observer.beta_q30 == 0 && observer.theta_q32 == 0 &&
                  observer.speed_q32 == 0);
    emf_observer_step(&observer, zero, any_current(), &none);
    PROVE(observer.speed_q32 >= -(INT32_C(1) << 30) && observer.speed_q32 < INT32_C(1) << 30);
    PROOF_END();
}
