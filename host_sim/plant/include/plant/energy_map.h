/* SPDX-License-Identifier: Apache-2.0 */
/*
 * energy_map.h: an energy of the field over both flux linkages, as a bicubic spline.
 *
 *     W(x, y) = sum over j, k of c_jk B(x/h_x - x_0/h_x - j + 1) B(y/h_y - y_0/h_y - k + 1)
 *
 * B is the uniform cubic B-spline, so W has continuous second derivatives. What is read from the
 * map are its slopes, the currents, and their slopes, the inverse inductances: both come from one
 * function, so the inductances are reciprocal and a closed cycle has zero energy, whatever the
 * coefficients are. Beyond the grid each factor B goes on as its parabola at the edge: the slopes
 * still are those of one W, and along an axis the inductance stays that of the edge.
 */
#ifndef PLANT_ENERGY_MAP_H
#define PLANT_ENERGY_MAP_H

#include "plant/vectors.h"

enum { ENERGY_MAP_MORE = 3, ENERGY_MAP_CELLS_MAX = 200 };

/* cells intervals of step_wb from first_wb on; cells + ENERGY_MAP_MORE coefficients. */
typedef struct {
    double first_wb, step_wb;
    int cells;
} energy_axis_t;

typedef struct {
    energy_axis_t d, q;
    const double *coefficient_j; /* c of an axis q behind each other, for every j of d */
} energy_map_t;

typedef struct {
    double energy_j;
    plant_dq_t current_a; /* dW/dx, dW/dy */
    double dd, qq, dq;    /* second derivatives, 1/H */
} energy_at_t;

/* W and its derivatives; any flux. */
energy_at_t energy_map_at(const energy_map_t *map, plant_dq_t flux);

#endif
