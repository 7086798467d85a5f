/* The machine of pmsm.h where its iron saturates: the same circuit and stages, integrated in the fluxes. */
#include "pmsm_stages.h"

static inline stage_t stage_at(const pmsm_t *machine, const equations_t *eq, plant_dq_t u, plant_dq_t flux)
{
    const plant_dq_t i_t = magnetics_current(&machine->magnetics, flux);
    const plant_dq_t e = along(u, -eq->resistance_ohm, i_t);
    const plant_dq_t i = along(i_t, eq->conductance_s, e);
    const double flux_d = flux.d + eq->flux_wb;
    const stage_t out = {
        .slope = {.d = eq->share * e.d + eq->w * flux.q, .q = eq->share * e.q - eq->w * flux_d},
        .terminal = i,
        .terminal_square = i.d * i.d + i.q * i.q,
        .drop_square = e.d * e.d + e.q * e.q,
        .torque_per_3_2_p = flux_d * i_t.q - flux.q * i_t.d,
    };
    return out;
}

void pmsm_saturated_advance(const pmsm_t *machine, const equations_t *eq, pmsm_state_t *state, plant_ab_t u, double h,
                            plant_phasor_t half_turn, pmsm_flow_t *flow)
{
    const stage_axes_t axes = stage_axes(state->axis, half_turn);
    const plant_dq_t u_middle = plant_park(u, axes.middle);
    plant_dq_t flux = magnetics_flux(&machine->magnetics, state->i_t);
    const stage_t s1 = stage_at(machine, eq, plant_park(u, axes.start), flux);
    const stage_t s2 = stage_at(machine, eq, u_middle, along(flux, 0.5 * h, s1.slope));
    const stage_t s3 = stage_at(machine, eq, u_middle, along(flux, 0.5 * h, s2.slope));
    const stage_t s4 = stage_at(machine, eq, plant_park(u, axes.end), along(flux, h, s3.slope));
    flux.d += h / 6.0 * simpson(s1.slope.d, s2.slope.d, s3.slope.d, s4.slope.d);
    flux.q += h / 6.0 * simpson(s1.slope.q, s2.slope.q, s3.slope.q, s4.slope.q);
    state->i_t = magnetics_current(&machine->magnetics, flux);
    book_currents(&s1, between(s2.terminal, s3.terminal), &s4, &axes, h / 6.0, state, flow);
    book_heat_and_torque(&s1, &s2, &s3, &s4, h / 6.0, flow);
}

plant_dq_t pmsm_saturated_implicit(const pmsm_t *machine, double omega_rad_s, plant_dq_t before, double h, double r,
                                   plant_dq_t drive)
{
    /* Straight lines from where the step begins: (1/h + r S + j w) change = drive - r i - j w flux, S the slope of i. */
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
