/* SPDX-License-Identifier: Apache-2.0 */
/*
 * numbers.h: minimum, maximum, clamp. The library's fmin and fmax also decide about NaN
 * and are calls for it; these compile to one instruction. No argument is ever NaN here.
 */
#ifndef PLANT_NUMBERS_H
#define PLANT_NUMBERS_H

static inline double plant_min(double a, double b)
{
    return a < b ? a : b;
}

static inline double plant_max(double a, double b)
{
    return a > b ? a : b;
}

static inline double plant_clamp(double x, double lowest, double highest)
{
    return plant_max(plant_min(x, highest), lowest);
}

/* A fraction of a turn in [0, 1), from one that is at most a turn away from it. */
static inline double plant_wrapped_turn(double turn)
{
    if (turn >= 1.0) {
        return turn - 1.0;
    }
    return turn < 0.0 ? turn + 1.0 : turn;
}

#endif
