/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/random.h"

#include <math.h>

static uint64_t splitmix(uint64_t *x)
{
    *x += UINT64_C(0x9E3779B97F4A7C15);
    uint64_t z = *x;
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

random_t random_init(uint64_t seed, uint64_t stream)
{
    uint64_t x = seed;
    uint64_t mixed = splitmix(&x) ^ stream;
    random_t out = {.has_spare = false};
    for (int k = 0; k < 4; k++) {
        out.state[k] = splitmix(&mixed);
    }
    return out;
}

static uint64_t rotated(uint64_t x, unsigned by)
{
    return (x << by) | (x >> (64U - by));
}

static uint64_t next(random_t *random)
{
    uint64_t *s = random->state;
    const uint64_t out = rotated(s[0] + s[3], 23) + s[0];
    const uint64_t shifted = s[1] << 17;
    s[2] ^= s[0];
    s[3] ^= s[1];
    s[1] ^= s[2];
    s[0] ^= s[3];
    s[2] ^= shifted;
    s[3] = rotated(s[3], 45);
    return out;
}

double random_uniform(random_t *random)
{
    return (double)(next(random) >> 11) * 0x1p-53;
}

double random_gaussian(random_t *random)
{
    if (random->has_spare) {
        random->has_spare = false;
        return random->spare;
    }
    double x;
    double y;
    double square;
    do {
        x = 2.0 * random_uniform(random) - 1.0;
        y = 2.0 * random_uniform(random) - 1.0;
        square = x * x + y * y;
    } while (square >= 1.0 || square == 0.0);
    const double scale = sqrt(-2.0 * log(square) / square);
    random->spare = y * scale;
    random->has_spare = true;
    return x * scale;
}
