/* SPDX-License-Identifier: Apache-2.0 */
/*
 * frozen_currents.h: current sensors that show the same codes again and again, several at once: a
 * converter or its transfer that has stopped. Their sum may stay zero, and no single one explains
 * it if not. DERIVATIONS.md, Frozen readings.
 *
 * A current error that the controller sees becomes a voltage, and that moves the current. Two of
 * the three readings, any two, unmoved at every look for twelve periods with a large error are
 * frozen; for eight with a very large one. No single look decides, because two readings repeat by
 * chance. Two are enough: the third one either stays as well, or contradicts them in the sum.
 */
#ifndef FOC_FROZEN_CURRENTS_H
#define FOC_FROZEN_CURRENTS_H

#include <stdbool.h>
#include <stdint.h>

#include "core/q15.h"
#include "foc/state.h"

enum {
    FROZEN_CURRENTS_GAP_PERIODS = 8,   /* from look to look at most: one may fail to come */
    FROZEN_CURRENTS_STAY_PERIODS = 12, /* without a movement */
    FROZEN_CURRENTS_SHORT_PERIODS = 8, /* likewise, with a very large error */
    FROZEN_CURRENTS_SENSORS = 2,       /* that have not moved */
    FROZEN_CURRENTS_ERROR_LOG2 = 21,   /* of the error's square, Q30: 1 448 of 32 768, 90 codes */
    FROZEN_CURRENTS_LARGE_LOG2 = 22    /* 2 048, 128 codes */
};

/* Square of the current error in the latest period, Q30. */
Q_TARGET_INLINE uint32_t frozen_currents_error(const foc_period_t *latest)
{
    return q_pair_square(q_pair_subtract(latest->i_reference_pu.v, latest->i_pu.v));
}

/* Whether the error calls for a look. Once in four periods while the bridge switches. */
Q_TARGET_INLINE bool frozen_currents_due(const foc_period_t *latest)
{
    return frozen_currents_error(latest) >> FROZEN_CURRENTS_ERROR_LOG2 != 0;
}

/* One look, if due. latest: this period; codes: its readings. Returns true if they are
 * frozen. */
bool frozen_currents_step(frozen_currents_t *state, const foc_period_t *latest,
                          const uint16_t codes[SENSE_PHASES]);

#endif
