/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sqrt3.h: the root of three between phases, line voltages and the two axes of the stator frame, in
 * the formats in use. Each constant is SQRT3_Q30 in its format, rounded to nearest. Any context.
 */
#ifndef CORE_SQRT3_H
#define CORE_SQRT3_H

#include <stdint.h>

#define SQRT3_Q30 INT64_C(1859775393)

/* SQRT3_Q30 over `divisor` with `bits` fraction bits, below 30; an integer constant. */
#define SQRT3_OVER(divisor, bits)                                                                  \
    ((int32_t)((SQRT3_Q30 / (divisor) + (INT64_C(1) << (29 - (bits)))) >> (30 - (bits))))

enum {
    SQRT3_Q10 = SQRT3_OVER(1, 10),
    SQRT3_Q25 = SQRT3_OVER(1, 25),
    SQRT3_2_Q15 = SQRT3_OVER(2, 15),       /* sqrt(3)/2 */
    INVERSE_SQRT3_Q15 = SQRT3_OVER(3, 15), /* 1/sqrt(3) */
    INVERSE_SQRT3_Q16 = SQRT3_OVER(3, 16)
};

#endif
