/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/energy_map.h"

#include "plant/numbers.h"

enum { WEIGHTS = 4 };

/* The four B-splines that are not zero at a place, with two derivatives. */
typedef struct {
    int first; /* coefficient of the first one */
    double value[WEIGHTS], slope[WEIGHTS], bend[WEIGHTS];
} weights_t;

static weights_t weights_at(const energy_axis_t *axis, double flux_wb)
{
    const double per_step = 1.0 / axis->step_wb;
    const double place = (flux_wb - axis->first_wb) * per_step;
    const double within = plant_clamp(place, 0.0, axis->cells);
    const double cell = plant_min(floor(within), axis->cells - 1.0);
    const double t = within - cell;
    const double s = 1.0 - t;
    weights_t out = {
        .first = (int)cell,
        .value = {s * s * s / 6.0, (3.0 * t * t * (t - 2.0) + 4.0) / 6.0,
                  (3.0 * s * s * (s - 2.0) + 4.0) / 6.0, t * t * t / 6.0},
        .slope = {-0.5 * s * s, 0.5 * t * (3.0 * t - 4.0), -0.5 * s * (3.0 * s - 4.0), 0.5 * t * t},
        .bend = {s, 3.0 * t - 2.0, 3.0 * s - 2.0, t},
    };
    const double beyond = place - within; /* in steps; 0 inside the grid */
    for (int n = 0; n < (int)WEIGHTS; n++) {
        out.value[n] += beyond * (out.slope[n] + 0.5 * beyond * out.bend[n]);
        out.slope[n] = (out.slope[n] + beyond * out.bend[n]) * per_step;
        out.bend[n] *= per_step * per_step;
    }
    return out;
}

energy_at_t energy_map_at(const energy_map_t *map, plant_dq_t flux)
{
    const weights_t d = weights_at(&map->d, flux.d);
    const weights_t q = weights_at(&map->q, flux.q);
    const int row_length = map->q.cells + (int)ENERGY_MAP_MORE;
    energy_at_t out = {.energy_j = 0.0};
    for (int n = 0; n < (int)WEIGHTS; n++) {
        const double *row = map->coefficient_j + (d.first + n) * row_length + q.first;
        double value = 0.0;
        double slope = 0.0;
        double bend = 0.0;
        for (int k = 0; k < (int)WEIGHTS; k++) {
            value += row[k] * q.value[k];
            slope += row[k] * q.slope[k];
            bend += row[k] * q.bend[k];
        }
        out.energy_j += d.value[n] * value;
        out.current_a.d += d.slope[n] * value;
        out.current_a.q += d.value[n] * slope;
        out.dd += d.bend[n] * value;
        out.qq += d.value[n] * bend;
        out.dq += d.slope[n] * slope;
    }
    return out;
}
