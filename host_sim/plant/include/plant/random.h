/* SPDX-License-Identifier: Apache-2.0 */
/*
 * random.h: repeatable noise. Same seed and stream, same numbers, on every machine with IEEE 754
 * arithmetic.
 *
 * xoshiro256++ (Blackman and Vigna 2019) started by splitmix64; Gaussian by the polar method
 * (Marsaglia and Bray 1964).
 */
#ifndef PLANT_RANDOM_H
#define PLANT_RANDOM_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    uint64_t state[4];
    double spare; /* the polar method makes two at a time */
    bool has_spare;
} random_t;

/* Streams of one seed are independent: one for each wheel. */
random_t random_init(uint64_t seed, uint64_t stream);

/* 0 <= x < 1, 53 bits. */
double random_uniform(random_t *random);

/* Mean 0, standard deviation 1. */
double random_gaussian(random_t *random);

#endif
