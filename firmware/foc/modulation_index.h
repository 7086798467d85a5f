/* SPDX-License-Identifier: Apache-2.0 */
/*
 * modulation_index.h: length of the voltage vector relative to the radius of the voltage circle.
 * Fast loop.
 */
#ifndef FOC_MODULATION_INDEX_H
#define FOC_MODULATION_INDEX_H

#include <stdint.h>

#include "core/frames.h"
#include "core/q15.h"

/* Square of the index, Q15, 0 .. 65 536. Of the voltage before the circle, in modulation units,
 * each component saturating at 1, so that a value above 1 means that the voltage is not sufficient.
 */
static inline int32_t modulation_index_square_q15(dq_t unsaturated)
{
    const int32_t d = q_saturate16(unsaturated.d);
    const int32_t q = q_saturate16(unsaturated.q);
    const uint32_t square_q30 = (uint32_t)(d * d) + (uint32_t)(q * q);
    return (int32_t)(square_q30 >> 15);
}

#endif
