/* SPDX-License-Identifier: Apache-2.0 */
/*
 * native.h: what core/q15.h and core/scaled.h leave to a port, for the simulator's engine. The
 * build puts it in front of every file of the engine where the compiler is GCC or Clang, as
 * hal/cortex_m/saturate.h is put in front of the board's.
 *
 * The meaning is exactly that of the portable definitions: their tests are run with this header as
 * well (tests/unit/host_sim/bench), and no result of a simulation changes. A processor of a
 * host has no saturation, but it predicts: nearly every number is inside its range, so a compare
 * and a branch that is never taken take the place of the selection between two results.
 */
#ifndef HOST_SIM_NATIVE_H
#define HOST_SIM_NATIVE_H

#include <stdint.h>

#define NATIVE_SELDOM(condition) __builtin_expect_with_probability((condition), 0, 1.0)
#define Q_TARGET_INLINE static inline __attribute__((always_inline))
#define Q_TARGET_LEADING_ZEROS(x) ((unsigned)__builtin_clz(x))
#define Q_TARGET_SATURATE(x, bits) native_saturate((x), (bits))
#define Q_TARGET_SATURATE64(x) native_saturate64(x)

/* x saturated to a signed number of `bits` bits, 1 <= bits <= 31. */
Q_TARGET_INLINE int32_t native_saturate(int32_t x, unsigned bits)
{
    const uint32_t half = (uint32_t)1 << (bits - 1U);
    if (NATIVE_SELDOM(bits == 16U ? (int16_t)x != x : (uint32_t)x + half >= 2U * half)) {
        return (x >> 31) ^ (int32_t)(half - 1U);
    }
    return x;
}

/* x saturated to int32_t. */
Q_TARGET_INLINE int32_t native_saturate64(int64_t x)
{
    if (NATIVE_SELDOM((int32_t)x != x)) {
        return (int32_t)(x >> 63) ^ INT32_MAX;
    }
    return (int32_t)x;
}

#endif
