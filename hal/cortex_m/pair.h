/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pair.h: core/pair.h with the packed 16-bit instructions of ARMv7E-M (Cortex-M4, M7; Arm DDI 0403,
 * A7.7): x in the lower half of a word, y in the upper half. Included by saturate.h in front of
 * every translation unit; cores without these instructions use the portable definition, whose
 * results are the same bit for bit (tests/proofs/prove_pair.c, tests/target). A Cortex-M3 uses that
 * with LDRD.
 */
#ifndef HAL_CORTEX_M_PAIR_H
#define HAL_CORTEX_M_PAIR_H

#if defined(__ARM_FEATURE_SAT) && defined(__ARM_FEATURE_DSP)

#include <stdint.h>

#define Q_TARGET_PAIR

typedef struct {
    int32_t xy;
} q_pair_t;

#define PAIR_INLINE static inline __attribute__((always_inline, const))

#define Q_PAIR_INIT(x_value, y_value)                                                              \
    {                                                                                              \
        (int32_t)((uint32_t)(uint16_t)(x_value) | (uint32_t)(uint16_t)(y_value) << 16)             \
    }

/* A statement expression, because the shift is part of the instruction. */
#define Q_PAIR_SHIFTED(x_value, bits, y_value)                                                     \
    __extension__({                                                                                \
        q_pair_t pair_;                                                                            \
        __asm("pkhtb %0, %1, %2, asr #" #bits : "=r"(pair_.xy) : "r"(y_value), "r"(x_value));      \
        pair_;                                                                                     \
    })

PAIR_INLINE q_pair_t q_pair(int32_t x, int32_t y)
{
    q_pair_t out;
    __asm("pkhbt %0, %1, %2, lsl #16" : "=r"(out.xy) : "r"(x), "r"(y));
    return out;
}

PAIR_INLINE q_pair_t q_pair_of_q25(int32_t x, int32_t y_q25)
{
    q_pair_t out;
    __asm("pkhbt %0, %1, %2, lsl #6" : "=r"(out.xy) : "r"(x), "r"(y_q25));
    return out;
}

PAIR_INLINE int32_t q_pair_x(q_pair_t a)
{
    return (int16_t)a.xy;
}

PAIR_INLINE int32_t q_pair_y(q_pair_t a)
{
    return a.xy >> 16;
}

static inline q_pair_t q_pair_load(const q_pair_t *from)
{
    return *from;
}

PAIR_INLINE int32_t q_mac_lower(int32_t sum, int32_t a, int32_t b)
{
    int32_t out;
    __asm("smlabb %0, %1, %2, %3" : "=r"(out) : "r"(a), "r"(b), "r"(sum));
    return out;
}

#define PAIR_TO_PAIR(name, instruction)                                                            \
    PAIR_INLINE q_pair_t name(q_pair_t a, q_pair_t b)                                              \
    {                                                                                              \
        q_pair_t out;                                                                              \
        __asm(instruction " %0, %1, %2" : "=r"(out.xy) : "r"(a.xy), "r"(b.xy));                    \
        return out;                                                                                \
    }

#define PAIR_TO_WORD(name, instruction)                                                            \
    PAIR_INLINE int32_t name(q_pair_t a, q_pair_t b)                                               \
    {                                                                                              \
        int32_t out;                                                                               \
        __asm(instruction " %0, %1, %2" : "=r"(out) : "r"(a.xy), "r"(b.xy));                       \
        return out;                                                                                \
    }

#define PAIR_ACCUMULATE(name, instruction)                                                         \
    PAIR_INLINE int32_t name(int32_t sum, q_pair_t a, q_pair_t b)                                  \
    {                                                                                              \
        int32_t out;                                                                               \
        __asm(instruction " %0, %1, %2, %3" : "=r"(out) : "r"(a.xy), "r"(b.xy), "r"(sum));         \
        return out;                                                                                \
    }

PAIR_INLINE int32_t q_mac_q17(int32_t sum, int32_t a, int32_t b_q17)
{
    int32_t out;
    __asm("smmla %0, %1, %2, %3" : "=r"(out) : "r"(a), "r"(b_q17 << 15), "r"(sum));
    return out;
}

PAIR_INLINE q_pair_t q_pair_scale(q_pair_t a, int32_t factor_q16)
{
    int32_t x;
    int32_t y;
    __asm("smulwb %0, %1, %2" : "=r"(x) : "r"(factor_q16), "r"(a.xy));
    __asm("smulwt %0, %1, %2" : "=r"(y) : "r"(factor_q16), "r"(a.xy));
    return q_pair(x, y);
}

PAIR_TO_PAIR(q_pair_add, "sadd16")
PAIR_TO_PAIR(q_pair_difference, "ssub16")
PAIR_TO_PAIR(q_pair_subtract, "qsub16")
PAIR_TO_WORD(q_pair_dot, "smuad")
PAIR_TO_WORD(q_pair_cross, "smusdx")
PAIR_TO_WORD(q_pair_re, "smusd")
PAIR_TO_WORD(q_pair_im, "smuadx")
PAIR_ACCUMULATE(q_pair_mac_x, "smlabb")
PAIR_ACCUMULATE(q_pair_mac_y, "smlatt")

PAIR_INLINE uint32_t q_pair_square(q_pair_t a)
{
    return (uint32_t)q_pair_dot(a, a);
}

#elif defined(__ARM_ARCH_7M__)

/* Two words by one instruction, which the compiler's scheduling would separate. */
#define Q_TARGET_LOAD_TWO(first, second, from)                                                     \
    __asm("ldrd %0, %1, %2" : "=&r"(first), "=r"(second) : "o"(*(from)))

#endif

#endif
