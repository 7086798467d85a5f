/* SPDX-License-Identifier: Apache-2.0 */
#include "core/divide.h"

/*
 * With s = floor(log2 n) and m = ceil(2^(64 + s) / n), which needs 64 bits, floor(x m / 2^(64 + s))
 * = floor(x / n) for all 0 <= x <= 2^63 (Granlund and Montgomery 1994, theorem 4.2): m n exceeds
 * 2^(64 + s) by e < n < 2^(s + 1), so x m / 2^(64 + s) exceeds x / n by x e / (n 2^(64 + s)), less
 * than 1/n, and x / n lies at least 1/n below the next integer. That the constants are such is
 * proved in tests/proofs.
 *
 * HUBFOC_NATIVE_DIVISION, for the simulator's engine on a 64-bit host alone: the compiler's own
 * division by a constant, three instructions there. Both are x / n for every x, this one by the C
 * standard, the other by proof; tests and proofs are built without it.
 */
#ifdef HUBFOC_NATIVE_DIVISION
#define DIVIDE(x, reciprocal, n) ((x) / INT64_C(n))
#else
#define DIVIDE(x, reciprocal, n) divide(x, reciprocal)

typedef struct {
    uint64_t multiplier;
    unsigned shift;
} reciprocal64_t;

static const reciprocal64_t BY_THOUSAND = {.multiplier = UINT64_C(0x83126E978D4FDF3C), .shift = 9};
static const reciprocal64_t BY_MILLION = {.multiplier = UINT64_C(0x8637BD05AF6C69B6), .shift = 19};
static const reciprocal64_t BY_BILLION = {.multiplier = UINT64_C(0x89705F4136B4A598), .shift = 29};

/* Upper half of the 128-bit product. */
static inline uint64_t upper_product(uint64_t a, uint64_t b)
{
    const uint64_t a_low = (uint32_t)a;
    const uint64_t a_high = a >> 32;
    const uint64_t b_low = (uint32_t)b;
    const uint64_t b_high = b >> 32;
    /* Neither sum overflows: (2^32 - 1)^2 + 2 (2^32 - 1) is 2^64 - 1. */
    const uint64_t first = a_high * b_low + (a_low * b_low >> 32);
    const uint64_t second = a_low * b_high + (uint32_t)first;
    return a_high * b_high + (first >> 32) + (second >> 32);
}

static inline int64_t divide(int64_t x, reciprocal64_t reciprocal)
{
    const uint64_t magnitude = x < 0 ? 0U - (uint64_t)x : (uint64_t)x;
    const int64_t quotient =
        (int64_t)(upper_product(magnitude, reciprocal.multiplier) >> reciprocal.shift);
    return x < 0 ? -quotient : quotient;
}
#endif

int64_t divide_by_thousand(int64_t x)
{
    return DIVIDE(x, BY_THOUSAND, 1000);
}

int64_t divide_by_million(int64_t x)
{
    return DIVIDE(x, BY_MILLION, 1000000);
}

int64_t divide_by_billion(int64_t x)
{
    return DIVIDE(x, BY_BILLION, 1000000000);
}
