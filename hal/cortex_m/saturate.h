/* SPDX-License-Identifier: Apache-2.0 */
/*
 * saturate.h: the instructions that core/q15.h and core/scaled.h would like, where the core has
 * them: saturation, saturating sums and leading zeros, and their inlining.
 *
 * The toolchain file puts this header in front of every translation unit of the Arm ports. The
 * meaning is exactly that of the portable definition in q15.h; tests/target runs the same traces
 * with both and compares every bit. Cores without SSAT (Cortex-M0+) fall back to the portable form.
 */
#ifndef HAL_CORTEX_M_SATURATE_H
#define HAL_CORTEX_M_SATURATE_H

#include "pair.h"

#if defined(__ARM_FEATURE_SAT)
/* x clamped to a signed number of `bits` bits. The built-in behind __ssat of <arm_acle.h>, whose
 * macro does not survive -Wconversion; GCC and Clang both have it. */
#define Q_TARGET_SATURATE(x, bits) ((int32_t)__builtin_arm_ssat((x), (bits)))
#define Q_TARGET_POSITIVE(x) ((int32_t)__builtin_arm_usat((x), 31))
#endif

#if defined(__ARM_FEATURE_DSP)
/* Sum and difference, saturated to 32 bits. */
#define Q_TARGET_ADD(a, b) ((int32_t)__builtin_arm_qadd((a), (b)))
#define Q_TARGET_SUBTRACT(a, b) ((int32_t)__builtin_arm_qsub((a), (b)))
#endif

#if defined(__ARM_FEATURE_CLZ)
/* Zero bits above the highest one of x > 0; core/reciprocal.c and core/scaled.h
 * search without it. */
#define Q_TARGET_LEADING_ZEROS(x) ((unsigned)__builtin_clz(x))
#endif

/* -Os on a Cortex-M0+ would make calls of the saturations: twelve in a current step, at four to
 * five times their work. */
#define Q_TARGET_INLINE static inline __attribute__((always_inline))

#endif
