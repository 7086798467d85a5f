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
 * same period. Two periods in a row with the same answer name the sensor, and its phase is
 * reconstructed until a restart. A sum that no single sensor explains is replaced by the
 * prediction.
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
    SENSOR_ISOLATION_MEMORY_PERIODS = 64  /* a sum between suspect and implausible for so long
                                             begins a new prediction */
};

/* Divides. */
void sensor_isolation_init(sensor_isolation_t *state, const config_t *config);

/* The fault has been acknowledged: an undetermined sum is examined again. A named sensor remains.
 */
void sensor_isolation_acknowledge(sensor_isolation_t *state);

/* 0: no sensor is named, 1 .. 3: that of phase a, b, c. */
static inline uint8_t sensor_isolation_named(const sensor_isolation_t *state)
{
    return (uint8_t)(state->phase < SENSE_PHASES ? state->phase + 1 : 0);
}

/* Whether this period needs sensor_isolation_examine(). */
Q_TARGET_INLINE bool sensor_isolation_due(const sensor_isolation_t *state, int32_t sum_pu)
{
    /* Outside -limit .. limit as one unsigned comparison; limit 0 while a sensor is named. */
    return (uint32_t)(sum_pu + state->suspect_pu) > state->suspect_range_pu;
}

/* The sampled current with the bridge off: without the named sensor if there is one. */
static inline ab16_t sensor_isolation_current(const foc_current_state_t *current,
                                              const uint16_t codes[SENSE_PHASES], ab16_t sensed)
{
    const uint8_t phase = current->isolation.phase;
    return phase < SENSE_PHASES ? sense_without(&current->sense, codes, phase) : sensed;
}

/* A period that is due. period: angle, reference and sampled current of this period, of which
 * i_ab_pu is replaced by the current to use; the rest is of the one before. sum_pu: of the
 * readings. */
void sensor_isolation_examine(foc_period_t *period, const uint16_t codes[SENSE_PHASES],
                              foc_current_state_t *current, int32_t sum_pu);

#endif
