/* SPDX-License-Identifier: Apache-2.0 */
/*
 * frames.h: phase, stator and rotor frame as three types that do not convert implicitly.
 *
 * Amplitude-invariant everywhere: a balanced set of peak value X has |alpha-beta| = |dq| = X.
 * Components are per-unit Q15, 1.0 = 32768. They are the 32-bit intermediates of the fast loop, so
 * a register holds one without narrowing: phases stay within 16 bits, alpha-beta and dq vectors of
 * such phases within 1.53 (50 200).
 */
#ifndef CORE_FRAMES_H
#define CORE_FRAMES_H

#include <stdint.h>

typedef struct {
    int32_t a, b, c; /* phases */
} abc_t;

typedef struct {
    int32_t alpha, beta; /* stator frame, alpha along phase a */
} ab_t;

typedef struct {
    int32_t d, q; /* rotor frame, d along the magnet flux, q leading by a quarter electrical turn */
} dq_t;

#endif
