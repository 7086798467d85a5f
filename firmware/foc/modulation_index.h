/* SPDX-License-Identifier: Apache-2.0 */
/*
 * modulation_index.h: length of the voltage vector relative to the radius of the voltage circle.
 * Fast loop.
 */
#ifndef FOC_MODULATION_INDEX_H
#define FOC_MODULATION_INDEX_H

#include <stdint.h>

#include "core/q15.h"

/* Square of the index, Q15, 0 .. 65 536; q saturates at 1. d: applied, q: unsaturated voltage in
 * modulation units, so that a value above 1 means that the voltage is not sufficient. */
static inline int32_t modulation_index_square_q15(int32_t d, int32_t q)
{
    const int32_t limited_q = q_saturate16(q);
    const uint32_t square_q30 = (uint32_t)(d * d) + (uint32_t)(limited_q * limited_q);
    return (int32_t)(square_q30 >> 15);
}

#endif
