/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sensor_isolation.h: fault isolation of the three current sensors: which of them is wrong when
 * i_a + i_b + i_c is not zero, and which current is used meanwhile. Equations: DERIVATIONS.md,
 * Current sensors.
 *
 * Called in a period whose sum of currents exceeds `suspect_pu`, that is a quarter of the
 * implausible sum; without a fault a period costs one comparison. From the first such period a
 * model predicts the current. Once the sum is implausible the sensor is the one whose residual
 * against the prediction makes up the sum; its phase is reconstructed from the other two in the
 * same period. Two periods in a row with the same answer name the sensor. A sum that no single
 * sensor explains is replaced by the prediction.
 *
 * The phase of a named sensor is reconstructed until its reading has agreed with the other two, to
 * half of the implausible sum, for 20 ms of time with much current, of both signs, over an
 * electrical turn; without current it never proves itself. While its reading disagrees the sum
 * contradicts nothing. Once it has returned from a glitch, that is agreed for 20 ms and a turn with
 * whatever current, a new implausible sum is examined as before: if it is the named sensor's again,
 * nothing comes of it; if not, two sensors are wrong, and the sum is undetermined.
 */
#ifndef FOC_SENSOR_ISOLATION_H
#define FOC_SENSOR_ISOLATION_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/frames.h"
#include "core/q15.h"
#include "foc/state.h"
#include "sense.h"

enum {
    SENSOR_ISOLATION_SUSPECT_SHARE = 4,   /* of the implausible sum: a quarter */
    SENSOR_ISOLATION_NAMED_PERIODS = 2,   /* with the same answer */
    SENSOR_ISOLATION_UNKNOWN_PERIODS = 8, /* without an answer, then `undetermined` */
    SENSOR_ISOLATION_MEMORY_PERIODS = 64, /* a sum between suspect and implausible for so long
                                             begins a new prediction */
    SENSOR_ISOLATION_EVERY_SUM_PU = 1 << 20,
    SENSOR_ISOLATION_AGREES_MS = 20,    /* and an electrical turn: a named sensor has returned */
    SENSOR_ISOLATION_AGREES_SHARE = 2,  /* of the implausible sum, at most: half of it */
    SENSOR_ISOLATION_GLITCH_MS = 240,   /* wrong for longer it cannot return, only prove itself */
    SENSOR_ISOLATION_PROOF_CURRENT = 2, /* implausible sums: less current proves nothing */
    SENSOR_ISOLATION_QUIET_MS = 10000   /* the longest proof; so long in use, and it is 20 ms */
};

/* Divides. */
void sensor_isolation_init(sensor_isolation_t *state, const config_t *config);

/* The fault has been acknowledged: an undetermined sum is examined again, with all three sensors. A
 * named one remains out otherwise. */
void sensor_isolation_acknowledge(sensor_isolation_t *state);

/* 0: no sensor is named, 1 .. 3: that of phase a, b, c. */
static inline uint8_t sensor_isolation_named(const sensor_isolation_t *state)
{
    return (uint8_t)(state->phase < SENSE_PHASES ? state->phase + 1 : 0);
}

/* Whether this period needs sensor_isolation_examine(). */
Q_TARGET_INLINE bool sensor_isolation_due(const sensor_isolation_t *state, int32_t sum_pu)
{
    /* Outside -limit .. limit as one unsigned comparison; any sum while a sensor is named. */
    return (uint32_t)(sum_pu + state->suspect_pu) > state->suspect_range_pu;
}

/* A period in which the bridge does not switch; returns the sampled current, without the named
 * sensor if there is one. sensed: of all three. An implausible sum of 20 ms counts for a sensor
 * that has returned. */
ab16_t sensor_isolation_idle(foc_current_state_t *current, const uint16_t codes[SENSE_PHASES],
                             sense_out_t sensed, const foc_period_t *period);

/* A period that is due. period: angle, reference and sampled current of this period, of which
 * i_ab_pu is replaced by the current to use; the rest is of the one before. sum_pu: of the
 * readings. */
void sensor_isolation_examine(foc_period_t *period, const uint16_t codes[SENSE_PHASES],
                              foc_current_state_t *current, int32_t sum_pu);

#endif
