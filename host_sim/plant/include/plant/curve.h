/* SPDX-License-Identifier: Apache-2.0 */
/*
 * curve.h: a quantity over another as straight lines between points; outside the points the nearest
 * one counts.
 */
#ifndef PLANT_CURVE_H
#define PLANT_CURVE_H

#include <stdbool.h>

enum { CURVE_POINTS_MAX = 64 };

typedef struct {
    int points; /* 1 .. CURVE_POINTS_MAX */
    double x[CURVE_POINTS_MAX];
    double y[CURVE_POINTS_MAX];
} curve_t;

/* The same value everywhere. */
curve_t curve_constant(double y);

/* False, and nothing changed, unless 1 <= points <= CURVE_POINTS_MAX and x rises strictly. */
bool curve_set(curve_t *curve, const double *x, const double *y, int points);

double curve_at(const curve_t *curve, double x);

#endif
