/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/magnetics.h"

#include "plant/numbers.h"

/* Newton's steps: from the straight line's flux every one at least takes a third off; near the end
 * they double the digits. */
enum { STEPS_MAX = 60, HALVINGS_MAX = 20 };
static const double SMALL_ENOUGH = 1e-15; /* of the currents */
static const double ROUNDED = 1e-12;      /* likewise: less is not searched for in parts of steps */

static double quartic(double inductance_h, double saturation_a)
{
    return saturation_a > 0.0
               ? 4.0 / (inductance_h * inductance_h * inductance_h * saturation_a * saturation_a)
               : 0.0;
}

magnetics_t magnetics_of(const magnetics_data_t *data)
{
    const double a_d = quartic(data->d_inductance_h, data->d_saturation_a);
    const double a_q = quartic(data->q_inductance_h, data->q_saturation_a);
    const double bias_wb = data->d_inductance_h * data->bias_a;
    magnetics_t out = {
        .saturates = a_d > 0.0 || a_q > 0.0 || data->map != NULL,
        .per_l_d = 1.0 / data->d_inductance_h - 3.0 * a_d * bias_wb * bias_wb,
        .per_l_q = 1.0 / data->q_inductance_h,
        .a_d = a_d,
        .a_q = a_q,
        .a_c = data->cross_share * sqrt(a_d * a_q),
        .bias_wb = bias_wb,
        .d_inductance_h = data->d_inductance_h,
        .q_inductance_h = data->q_inductance_h,
        .map = data->map,
        .shift_wb = data->shift_wb,
    };
    if (out.map != NULL) {
        const plant_dq_t without_current = {.d = out.shift_wb, .q = 0.0};
        out.shifted = energy_map_at(out.map, without_current);
    }
    return out;
}

energy_at_t magnetics_map(const magnetics_t *m, plant_dq_t flux)
{
    const plant_dq_t whole = {.d = flux.d + m->shift_wb, .q = flux.q};
    energy_at_t out = energy_map_at(m->map, whole);
    out.energy_j -=
        m->shifted.energy_j + m->shifted.current_a.d * flux.d + m->shifted.current_a.q * flux.q;
    out.current_a.d -= m->shifted.current_a.d;
    out.current_a.q -= m->shifted.current_a.q;
    return out;
}

/* Whether the inductances are above zero at both ends and in the middle of every cell. */
static bool map_is_possible(const magnetics_t *m)
{
    for (int j = 0; j <= 2 * m->map->d.cells; j++) {
        for (int k = 0; k <= 2 * m->map->q.cells; k++) {
            const plant_dq_t flux = {.d = m->map->d.first_wb + 0.5 * j * m->map->d.step_wb -
                                          m->shift_wb,
                                     .q = m->map->q.first_wb + 0.5 * k * m->map->q.step_wb};
            const magnetics_slope_t s = magnetics_slope(m, flux);
            if (!(s.dd > 0.0 && s.dd * s.qq > s.dq * s.dq)) {
                return false;
            }
        }
    }
    return true;
}

bool magnetics_is_possible(const magnetics_data_t *data)
{
    const magnetics_t m = magnetics_of(data);
    /* y^2/2 (g_q - a_c z_0^2) must not fall below a parabola either: the iron of both axes is the
     * same. */
    return m.per_l_d > 0.0 && m.per_l_q > m.a_c * m.bias_wb * m.bias_wb &&
           (m.map == NULL || map_is_possible(&m));
}

magnetics_slope_t magnetics_slope(const magnetics_t *m, plant_dq_t flux)
{
    const double z = flux.d + m->bias_wb;
    const double y_square = flux.q * flux.q;
    magnetics_slope_t out = {
        .dd = m->per_l_d + 3.0 * m->a_d * z * z + m->a_c * y_square,
        .qq = m->per_l_q + 3.0 * m->a_q * y_square + m->a_c * (z + m->bias_wb) * flux.d,
        .dq = 2.0 * m->a_c * z * flux.q,
    };
    if (m->map != NULL) {
        const energy_at_t of_map = magnetics_map(m, flux);
        out.dd += of_map.dd;
        out.qq += of_map.qq;
        out.dq += of_map.dq;
    }
    return out;
}

static double miss_of(const magnetics_t *m, plant_dq_t current_a, plant_dq_t flux, plant_dq_t *miss)
{
    const plant_dq_t current = magnetics_current(m, flux);
    miss->d = current_a.d - current.d;
    miss->q = current_a.q - current.q;
    return fabs(miss->d) + fabs(miss->q);
}

static double within(const energy_axis_t *axis, double flux_wb)
{
    return plant_clamp(flux_wb, axis->first_wb, axis->first_wb + axis->cells * axis->step_wb);
}

plant_dq_t magnetics_flux(const magnetics_t *m, plant_dq_t current_a)
{
    plant_dq_t flux = {.d = m->d_inductance_h * current_a.d, .q = m->q_inductance_h * current_a.q};
    if (!m->saturates) {
        return flux;
    }
    if (m->map != NULL) {
        flux.d = within(&m->map->d, flux.d + m->shift_wb) - m->shift_wb;
        flux.q = within(&m->map->q, flux.q);
    }
    const double asked_a = fabs(current_a.d) + fabs(current_a.q);
    plant_dq_t miss;
    double miss_a = miss_of(m, current_a, flux, &miss);
    for (int k = 0; k < STEPS_MAX && miss_a > SMALL_ENOUGH * asked_a; k++) {
        const magnetics_slope_t s = magnetics_slope(m, flux);
        const double per_determinant = 1.0 / (s.dd * s.qq - s.dq * s.dq);
        plant_dq_t step = {.d = (s.qq * miss.d - s.dq * miss.q) * per_determinant,
                           .q = (s.dd * miss.q - s.dq * miss.d) * per_determinant};
        const plant_dq_t before = flux;
        const double before_a = miss_a;
        flux.d += step.d;
        flux.q += step.q;
        miss_a = miss_of(m, current_a, flux, &miss);
        /* W is convex, so a part of the step brings the current closer wherever the whole one,
         * across a bend of the map, does not. */
        for (int n = 0; n < HALVINGS_MAX && miss_a > before_a && miss_a > ROUNDED * asked_a; n++) {
            step.d *= 0.5;
            step.q *= 0.5;
            flux.d = before.d + step.d;
            flux.q = before.q + step.q;
            miss_a = miss_of(m, current_a, flux, &miss);
        }
        if (flux.d == before.d && flux.q == before.q) {
            break;
        }
    }
    return flux;
}

double magnetics_energy_j(const magnetics_t *m, plant_dq_t flux)
{
    const double x = flux.d;
    const double z0 = m->bias_wb;
    const double x_square = x * x;
    const double y_square = flux.q * flux.q;
    /* (z^4 - z0^4)/4 - z0^3 x = x^2 (x^2 + 4 x z0 + 6 z0^2)/4 and z^2 - z0^2 = x (x + 2 z0) */
    const double of_d = 0.25 * m->a_d * x_square * (x_square + 4.0 * x * z0 + 6.0 * z0 * z0);
    const double of_q = 0.25 * m->a_q * y_square * y_square;
    const double of_both = 0.5 * m->a_c * x * (x + 2.0 * z0) * y_square;
    const double of_map = m->map != NULL ? magnetics_map(m, flux).energy_j : 0.0;
    return 1.5 * (0.5 * m->per_l_d * x_square + 0.5 * m->per_l_q * y_square + of_d + of_q +
                  of_both + of_map);
}
