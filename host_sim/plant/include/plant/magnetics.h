/* SPDX-License-Identifier: Apache-2.0 */
/*
 * magnetics.h: the iron of a machine: which current magnetises it how far, and what energy that
 * takes.
 *
 * Without saturation psi_d = psi + L_d i_d and psi_q = L_q i_q. With it, x = psi_d - psi and y =
 * psi_q follow from one energy of the field (per 3/2 of three phases), z = x + L_d I_b being the
 * flux that d current and magnets make in the iron:
 *
 *     W(x, y) = g_d x^2/2 + g_q y^2/2 + a_d (z^4 - z_0^4)/4 + a_q y^4/4
 *               + a_c (z^2 - z_0^2) y^2/2 - a_d z_0^3 x
 *     i_d = dW/dx = g_d x + a_d (z^3 - z_0^3) + a_c z y^2
 *     i_q = dW/dy = (g_q + a_q y^2 + a_c (z^2 - z_0^2)) y
 *     a_d = 4 / (L_d^3 I_sd^2)        a_q = 4 / (L_q^3 I_sq^2)        a_c = share sqrt(a_d a_q)
 *     z_0 = L_d I_b
 *
 * and g_d = 1/L_d - 3 a_d z_0^2, g_q = 1/L_q: at zero current the machine has the inductances L_d
 * and L_q with any saturation. Both currents are gradients of one energy, so di_d/dpsi_q =
 * di_q/dpsi_d, the inductances are reciprocal and a closed cycle of currents has zero energy; the
 * co-energy psi . i - W has the fluxes as its slopes. W is convex for 0 <= share <= 1, g_d > 0 and
 * g_q > a_c z_0^2, and then has one flux for every current. Without bias I_s is the current whose
 * flux is half of L I_s. With bias, current in q also takes flux out of d: the torque for an ampere
 * falls with load, as it does in machines whose teeth are full.
 *
 * A measured motor has an energy map (energy_map.h) for what its iron adds to the straight lines.
 * It is a function of the whole flux, so magnets that are weaker by s than those of the map move
 * along it, as a smaller magnetising current would:
 *
 *     W(x, y) = g_d x^2/2 + g_q y^2/2 + M(x + s, y) - M(s, 0) - x M_x(s, 0)
 *
 * Sources: M. Hinkkanen et al., "Sensorless self-commissioning of synchronous reluctance motors at
 * standstill without rotor locking", IEEE Trans. Ind. Appl. 53 (2017): currents as such functions
 * of flux, reciprocity; here with fixed exponents, which are right for steel that bends softly, and
 * about the magnets' working point.
 */
#ifndef PLANT_MAGNETICS_H
#define PLANT_MAGNETICS_H

#include <stdbool.h>
#include <stddef.h>

#include "plant/energy_map.h"
#include "plant/vectors.h"

/* Saturation data of a machine. A current of 0: that axis does not saturate. */
typedef struct {
    double d_inductance_h, q_inductance_h;
    double d_saturation_a, q_saturation_a; /* I_sd, I_sq */
    double cross_share;
    double bias_a;           /* I_b */
    const energy_map_t *map; /* M; NULL: none. Outlives what is worked out with it */
    double shift_wb;         /* s, 0 with magnets as they were when the map was measured */
} magnetics_data_t;

/* Worked out once. */
typedef struct {
    bool saturates;
    double per_l_d, per_l_q; /* g_d, g_q */
    double a_d, a_q, a_c;
    double bias_wb; /* z_0 */
    double d_inductance_h, q_inductance_h;
    const energy_map_t *map; /* M; NULL: none */
    double shift_wb;
    energy_at_t shifted; /* M(s, 0) */
} magnetics_t;

/* 1/H: di_d/dpsi_d, di_q/dpsi_q, and di_d/dpsi_q = di_q/dpsi_d. */
typedef struct {
    double dd, qq, dq;
} magnetics_slope_t;

magnetics_t magnetics_of(const magnetics_data_t *data);

/* False where W would not be convex: the magnets alone would need more iron than these data have,
 * or the map has an inductance that is not above zero. */
bool magnetics_is_possible(const magnetics_data_t *data);

/* What the map adds to W and its derivatives. */
energy_at_t magnetics_map(const magnetics_t *m, plant_dq_t flux);

/* flux: of the currents, the magnets' taken off. */
static inline plant_dq_t magnetics_current(const magnetics_t *m, plant_dq_t flux)
{
    const double z = flux.d + m->bias_wb;
    const double z0 = m->bias_wb;
    const double y_square = flux.q * flux.q;
    /* z^3 - z0^3 and z^2 - z0^2 by their factor x: exactly zero without current. */
    plant_dq_t out = {
        .d = (m->per_l_d + m->a_d * (z * z + z * z0 + z0 * z0)) * flux.d + m->a_c * z * y_square,
        .q = (m->per_l_q + m->a_q * y_square + m->a_c * (z + z0) * flux.d) * flux.q,
    };
    if (m->map != NULL) {
        const plant_dq_t of_map = magnetics_map(m, flux).current_a;
        out.d += of_map.d;
        out.q += of_map.q;
    }
    return out;
}

magnetics_slope_t magnetics_slope(const magnetics_t *m, plant_dq_t flux);

/* The flux that belongs to a current, to rounding. */
plant_dq_t magnetics_flux(const magnetics_t *m, plant_dq_t current_a);

/* W of three phases, J; 0 without current. */
double magnetics_energy_j(const magnetics_t *m, plant_dq_t flux);

#endif
