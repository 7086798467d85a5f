/* SPDX-License-Identifier: Apache-2.0 */
/*
 * random_values.h: repeatable random numbers for property tests (splitmix64, Steele, Lea and Flood
 * 2014). Equal seeds give equal sequences on every machine, so a failure is always found again.
 */
#ifndef RANDOM_VALUES_H
#define RANDOM_VALUES_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    uint64_t state;
} random_t;

static inline random_t random_seeded(uint64_t seed)
{
    const random_t out = {.state = seed};
    return out;
}

static inline uint64_t random_u64(random_t *random)
{
    random->state += UINT64_C(0x9E3779B97F4A7C15);
    uint64_t x = random->state;
    x = (x ^ (x >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    x = (x ^ (x >> 27)) * UINT64_C(0x94D049BB133111EB);
    return x ^ (x >> 31);
}

/* Both ends included. */
static inline int32_t random_between(random_t *random, int32_t lowest, int32_t highest)
{
    const uint64_t span = (uint64_t)((int64_t)highest - lowest) + 1U;
    return (int32_t)(lowest + (int64_t)(random_u64(random) % span));
}

/* Any int32_t, the ends and the neighbourhood of zero more often than chance would bring them. */
static inline int32_t random_wild(random_t *random)
{
    const uint64_t bits = random_u64(random);
    const int32_t near_zero = (int32_t)((bits >> 40) % 5U) - 2;
    switch (bits & 7U) {
    case 0:
        return INT32_MIN + (near_zero + 2);
    case 1:
        return INT32_MAX + (near_zero - 2);
    case 2:
        return near_zero;
    default:
        return (int32_t)((int64_t)((bits >> 8) & UINT32_MAX) + INT32_MIN);
    }
}

static inline double random_fraction(random_t *random)
{
    return (double)(random_u64(random) >> 11) / 9007199254740992.0; /* 2^53 */
}

static inline double random_real(random_t *random, double lowest, double highest)
{
    return lowest + (highest - lowest) * random_fraction(random);
}

static inline bool random_chance(random_t *random, double probability)
{
    return random_fraction(random) < probability;
}

#endif
