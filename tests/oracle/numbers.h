/* SPDX-License-Identifier: Apache-2.0 */
/*
 * numbers.h: the few functions of real numbers that the oracle's vehicles need, from the four
 * operations and conversions alone, so that they give the same on every machine.
 */
#ifndef ORACLE_NUMBERS_H
#define ORACLE_NUMBERS_H

#include <stdint.h>

static const double NUMBERS_PI = 3.14159265358979323846;
static const double NUMBERS_SQRT3 = 1.73205080756887729353;

static inline double numbers_limited(double x, double most)
{
    return x > most ? most : x < -most ? -most : x;
}

static inline double numbers_size(double x)
{
    return x < 0.0 ? -x : x;
}

/* Newton's iteration, from above. */
static inline double numbers_root(double square)
{
    if (!(square > 0.0)) {
        return 0.0;
    }
    double x = square > 1.0 ? square : 1.0;
    for (int k = 0; k < 60; k++) {
        x = 0.5 * (x + square / x);
    }
    return x;
}

/* To the nearest. */
static inline int32_t numbers_whole(double x)
{
    const double within = numbers_limited(x, 2147483000.0);
    return (int32_t)(within >= 0.0 ? within + 0.5 : within - 0.5);
}

/* The same within low .. high. */
static inline int32_t numbers_within(double x, int32_t low, int32_t high)
{
    const int32_t whole = numbers_whole(x);
    return whole > high ? high : whole < low ? low : whole;
}

/* Of a turn: 0 .. 1. */
static inline double numbers_fraction(double turns)
{
    const double rest = turns - (double)(int64_t)turns;
    return rest < 0.0 ? rest + 1.0 : rest;
}

static inline uint16_t numbers_turn16(double turns)
{
    return (uint16_t)(uint32_t)(numbers_fraction(turns) * 65536.0);
}

/* Taylor's series within half a turn, to 1e-12. */
static inline double numbers_sine(double turns)
{
    const double x = 2.0 * NUMBERS_PI * (numbers_fraction(turns + 0.5) - 0.5);
    double term = x;
    double sum = x;
    for (int k = 1; k < 14; k++) {
        term *= -x * x / ((2.0 * k) * (2.0 * k + 1.0));
        sum += term;
    }
    return sum;
}

static inline double numbers_cosine(double turns)
{
    return numbers_sine(turns + 0.25);
}

#endif
