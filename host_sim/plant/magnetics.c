/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/magnetics.h"

/* Newton's steps: from the straight line's flux every one at least takes a third off; near the end
 * they double the digits. */
enum { STEPS_MAX = 60 };
static const double SMALL_ENOUGH = 1e-15; /* of the currents */

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
    const magnetics_t out = {
        .saturates = a_d > 0.0 || a_q > 0.0,
        .per_l_d = 1.0 / data->d_inductance_h - 3.0 * a_d * bias_wb * bias_wb,
        .per_l_q = 1.0 / data->q_inductance_h,
        .a_d = a_d,
        .a_q = a_q,
        .a_c = data->cross_share * sqrt(a_d * a_q),
        .bias_wb = bias_wb,
        .d_inductance_h = data->d_inductance_h,
        .q_inductance_h = data->q_inductance_h,
    };
    return out;
}

bool magnetics_is_possible(const magnetics_data_t *data)
{
    const magnetics_t m = magnetics_of(data);
    /* y^2/2 (g_q - a_c z_0^2) must not fall below a parabola either: the iron of both axes is the
     * same. */
    return m.per_l_d > 0.0 && m.per_l_q > m.a_c * m.bias_wb * m.bias_wb;
}

magnetics_slope_t magnetics_slope(const magnetics_t *m, plant_dq_t flux)
{
    const double z = flux.d + m->bias_wb;
    const double y_square = flux.q * flux.q;
    const magnetics_slope_t out = {
        .dd = m->per_l_d + 3.0 * m->a_d * z * z + m->a_c * y_square,
        .qq = m->per_l_q + 3.0 * m->a_q * y_square + m->a_c * (z + m->bias_wb) * flux.d,
        .dq = 2.0 * m->a_c * z * flux.q,
    };
    return out;
}

plant_dq_t magnetics_flux(const magnetics_t *m, plant_dq_t current_a)
{
    plant_dq_t flux = {.d = m->d_inductance_h * current_a.d, .q = m->q_inductance_h * current_a.q};
    if (!m->saturates) {
        return flux;
    }
    const double small_a = SMALL_ENOUGH * (fabs(current_a.d) + fabs(current_a.q));
    for (int k = 0; k < STEPS_MAX; k++) {
        const plant_dq_t current = magnetics_current(m, flux);
        const double miss_d = current_a.d - current.d;
        const double miss_q = current_a.q - current.q;
        if (fabs(miss_d) + fabs(miss_q) <= small_a) {
            break;
        }
        const magnetics_slope_t s = magnetics_slope(m, flux);
        const double per_determinant = 1.0 / (s.dd * s.qq - s.dq * s.dq);
        const plant_dq_t before = flux;
        flux.d += (s.qq * miss_d - s.dq * miss_q) * per_determinant;
        flux.q += (s.dd * miss_q - s.dq * miss_d) * per_determinant;
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
    return 1.5 *
           (0.5 * m->per_l_d * x_square + 0.5 * m->per_l_q * y_square + of_d + of_q + of_both);
}
