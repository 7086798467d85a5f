/* SPDX-License-Identifier: Apache-2.0 */
/*
 * random.h: random numbers of the oracle's own, the same on every machine: SplitMix64 (Steele, Lea
 * and Flood 2014), and sine and cosine from products and sums alone.
 */
#ifndef ORACLE_RANDOM_H
#define ORACLE_RANDOM_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    uint64_t state;
} random_t;

static inline uint64_t random_bits(random_t *random)
{
    random->state += UINT64_C(0x9E3779B97F4A7C15);
    uint64_t x = random->state;
    x = (x ^ (x >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    x = (x ^ (x >> 27)) * UINT64_C(0x94D049BB133111EB);
    return x ^ (x >> 31);
}

/* A generator for one run: `number` of the kind that `seed` stands for. */
static inline random_t random_for(uint64_t seed, uint64_t number)
{
    random_t out = {.state = seed};
    out.state = random_bits(&out) + number * UINT64_C(0xD1342543DE82EF95);
    out.state = random_bits(&out);
    return out;
}

/* From low to high, both included. */
static inline int32_t random_between(random_t *random, int32_t low, int32_t high)
{
    const uint64_t count = (uint64_t)((int64_t)high - low) + 1U;
    return (int32_t)(low + (int64_t)((random_bits(random) >> 32) * count >> 32));
}

static inline bool random_chance(random_t *random, int32_t per_mille)
{
    return random_between(random, 0, 999) < per_mille;
}

/* From low to below high. */
static inline double random_real(random_t *random, double low, double high)
{
    const double share = (double)(random_bits(random) >> 11) / 9007199254740992.0;
    return low + (high - low) * share;
}

/* Any number, with a preference for small ones and for the ends of the range. */
static inline int32_t random_wild(random_t *random)
{
    const int32_t kind = random_between(random, 0, 7);
    if (kind < 2) {
        return random_between(random, 0, 1) == 0 ? INT32_MIN : INT32_MAX;
    }
    const int32_t bits = random_between(random, 1, 31);
    const int32_t most = (int32_t)((UINT32_C(1) << bits) - 1U);
    return random_between(random, -most, most);
}

#endif
