/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/curve.h"

curve_t curve_constant(double y)
{
    curve_t out = {.points = 1};
    out.y[0] = y;
    return out;
}

bool curve_set(curve_t *curve, const double *x, const double *y, int points)
{
    if (points < 1 || points > CURVE_POINTS_MAX) {
        return false;
    }
    for (int k = 1; k < points; k++) {
        if (!(x[k] > x[k - 1])) {
            return false;
        }
    }
    curve->points = points;
    for (int k = 0; k < points; k++) {
        curve->x[k] = x[k];
        curve->y[k] = y[k];
    }
    return true;
}

double curve_at(const curve_t *curve, double x)
{
    const int last = curve->points - 1;
    if (last == 0 || x <= curve->x[0]) {
        return curve->y[0];
    }
    if (x >= curve->x[last]) {
        return curve->y[last];
    }
    int k = 1;
    while (x > curve->x[k]) {
        k++;
    }
    const double share = (x - curve->x[k - 1]) / (curve->x[k] - curve->x[k - 1]);
    return curve->y[k - 1] + share * (curve->y[k] - curve->y[k - 1]);
}
