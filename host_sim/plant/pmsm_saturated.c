/* SPDX-License-Identifier: Apache-2.0 */
/* The machine of pmsm.h where its iron saturates: the same circuit and stages, integrated in the
 * fluxes. */
#include "pmsm_stages.h"

typedef struct {
    stage_t stage;
    double opposed_a;
} opposed_stage_t;

static inline opposed_stage_t stage_at(const pmsm_t *machine, const equations_t *eq,
                                       const pmsm_opposition_t *opposition, plant_ab_t u_ab,
                                       plant_phasor_t axis, plant_dq_t flux)
{
    const plant_dq_t i_t = magnetics_current(&machine->magnetics, flux);
    plant_dq_t u = plant_park(u_ab, axis);
    plant_dq_t share = {0.0, 0.0};
    if (opposition->volts != 0.0) {
        const plant_dq_t unopposed =
            along(i_t, eq->conductance_s, along(u, -eq->resistance_ohm, i_t));
        share = opposed_share(1.0 / opposition->zone_a, unopposed, axis);
        u = along(u, -opposition->volts, share);
    }
    const plant_dq_t e = along(u, -eq->resistance_ohm, i_t);
    const plant_dq_t i = along(i_t, eq->conductance_s, e);
    const double flux_d = flux.d + machine->flux_wb;
    const opposed_stage_t out = {
        .stage = {.slope = {.d = eq->share * e.d + eq->w * flux.q,
                            .q = eq->share * e.q - eq->w * flux_d},
                  .terminal = i,
                  .terminal_square = i.d * i.d + i.q * i.q,
                  .drop_square = e.d * e.d + e.q * e.q,
                  .torque_per_3_2_p = flux_d * i_t.q - flux.q * i_t.d},
        .opposed_a = opposed_a(share, i),
    };
    return out;
}

void pmsm_saturated_advance(const pmsm_t *machine, const equations_t *eq,
                            const pmsm_opposition_t *opposition, pmsm_state_t *state, plant_ab_t u,
                            double h, plant_phasor_t half_turn, pmsm_flow_t *flow)
{
    const stage_axes_t axes = stage_axes(state->axis, half_turn);
    const plant_dq_t begin = magnetics_flux(&machine->magnetics, state->i_t);
    const opposed_stage_t first = stage_at(machine, eq, opposition, u, axes.start, begin);
    const stage_t *s1 = &first.stage;
    const opposed_stage_t o2 =
        stage_at(machine, eq, opposition, u, axes.middle, along(begin, 0.5 * h, s1->slope));
    const stage_t *s2 = &o2.stage;
    const opposed_stage_t o3 =
        stage_at(machine, eq, opposition, u, axes.middle, along(begin, 0.5 * h, s2->slope));
    const stage_t *s3 = &o3.stage;
    const opposed_stage_t o4 =
        stage_at(machine, eq, opposition, u, axes.end, along(begin, h, s3->slope));
    const plant_dq_t end = after(begin, h / 6.0, s1, s2, s3, &o4.stage);

    /* Energies by Simpson's rule over the states of the step, its middle by Hermite's cubic: where
     * the zone's slope acts like a large resistance, the stages are too far from them. */
    const opposed_stage_t last = stage_at(machine, eq, opposition, u, axes.end, end);
    const plant_dq_t turn = along(s1->slope, -1.0, last.stage.slope);
    const plant_dq_t middle = along(along(begin, 0.5, along(end, -1.0, begin)), 0.125 * h, turn);
    const opposed_stage_t half = stage_at(machine, eq, opposition, u, axes.middle, middle);
    const stage_t *sm = &half.stage;
    const stage_t *sl = &last.stage;
    const wires_t wires = wires_of(s1, sm, sm, sl, &axes);
    state->i_t = magnetics_current(&machine->magnetics, end);
    state->axis = axes.end;
    state->terminal = wires.end;
    book_charge(charge_of(&wires, h / 6.0), flow);
    flow->rectified_as += rectified_of(&wires, h / 6.0);
    book_heat_and_torque(s1, sm, sm, sl, h / 6.0, flow);
    flow->opposed_as +=
        h / 6.0 * simpson(first.opposed_a, half.opposed_a, half.opposed_a, last.opposed_a);
}

plant_dq_t pmsm_saturated_implicit(const pmsm_t *machine, double omega_rad_s, plant_dq_t before,
                                   double h, double r, plant_dq_t drive)
{
    /* Straight lines from where the step begins: (1/h + r S + j w) change = drive - r i - j w flux,
     * S the slope of i. */
    const magnetics_t *m = &machine->magnetics;
    const plant_dq_t flux = magnetics_flux(m, before);
    const magnetics_slope_t s = magnetics_slope(m, flux);
    const double w = omega_rad_s;
    const double a = 1.0 / h + r * s.dd;
    const double b = r * s.dq - w;
    const double c = r * s.dq + w;
    const double d = 1.0 / h + r * s.qq;
    const double right_d = drive.d - r * before.d + w * flux.q;
    const double right_q = drive.q - r * before.q - w * flux.d;
    const double per_determinant = 1.0 / (a * d - b * c);
    const plant_dq_t end = {.d = flux.d + (right_d * d - b * right_q) * per_determinant,
                            .q = flux.q + (a * right_q - c * right_d) * per_determinant};
    return magnetics_current(m, end);
}
