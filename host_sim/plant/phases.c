/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/phases.h"

#include <math.h>

#include "plant/numbers.h"

/* Time constant of what current a winding still has when its leg opens. */
static const double FADE_S = 2e-6;
const double PHASES_OPEN_STEP_S = 0.5e-6;
/* Longest step, times the rate of that fade: four stages of Runge and Kutta are stable to 2.78. */
static const double OPEN_SHARE = 1.3;
/* Longest step, times the fastest rate, that three stages take: 1e-10 of the current. */
static const double SHORT_SHARE = 0.007;
/* Less has died out. */
static const double QUIET_A = 1e-5;
/* Largest turn at once: twice what plant_small_phasor() takes. */
static const double COAST_RAD = 0.5;

phases_t phases_at(const pmsm_t *machine, double omega_rad_s)
{
    const pmsm_params_t *p = &machine->params;
    const double per_l_d = 1.0 / p->d_inductance_h;
    const double per_l_q = 1.0 / p->q_inductance_h;
    const double iron_ohm =
        p->iron_loss_resistance_ohm + p->iron_loss_resistance_slope_ohm_s * fabs(omega_rad_s);
    const phases_t out = {
        .machine = machine,
        .omega_rad_s = omega_rad_s,
        .iron_s = iron_ohm > 0.0 ? 1.0 / iron_ohm : 0.0,
        .open_ohm = plant_max(p->d_inductance_h, p->q_inductance_h) / FADE_S,
        .iron_sees_ripple = false,
        .per_l_sum = 0.5 * (per_l_d + per_l_q),
        .per_l_difference = 0.5 * (per_l_d - per_l_q),
    };
    return out;
}

static void to_phases(plant_ab_t x, double out[PHASES])
{
    const plant_abc_t abc = plant_inverse_clarke(x);
    out[0] = abc.a;
    out[1] = abc.b;
    out[2] = abc.c;
}

static plant_ab_t from_phases(const double x[PHASES])
{
    const plant_abc_t abc = {.a = x[0], .b = x[1], .c = x[2]};
    return plant_clarke(abc);
}

phases_state_t phases_from(const phases_t *phases, const pmsm_state_t *rotor)
{
    plant_dq_t flux = magnetics_flux(&phases->machine->magnetics, rotor->i_t);
    flux.d += phases->machine->flux_wb;
    phases_state_t out = {.axis = rotor->axis};
    to_phases(plant_inverse_park(flux, rotor->axis), out.flux_wb);
    to_phases(rotor->terminal, out.current_a);
    return out;
}

double phases_open_ohm(const phases_t *phases, const phases_state_t *state, double step_s)
{
    const magnetics_t *m = &phases->machine->magnetics;
    if (!m->saturates) {
        const double per_l = phases->per_l_sum + fabs(phases->per_l_difference);
        return plant_min(phases->open_ohm, OPEN_SHARE / (step_s * per_l));
    }
    plant_dq_t flux = plant_park(from_phases(state->flux_wb), state->axis);
    flux.d -= phases->machine->flux_wb;
    const magnetics_slope_t slope = magnetics_slope(m, flux);
    const double fade_s = plant_max(FADE_S, step_s / OPEN_SHARE);
    return plant_min(phases->open_ohm,
                     1.0 / (fade_s * (plant_max(slope.dd, slope.qq) + fabs(slope.dq))));
}

void phases_to(const phases_t *phases, const phases_state_t *state, pmsm_state_t *rotor)
{
    const pmsm_params_t *p = &phases->machine->params;
    plant_dq_t flux = plant_park(from_phases(state->flux_wb), state->axis);
    flux.d -= phases->machine->flux_wb;
    if (phases->machine->magnetics.saturates) {
        rotor->i_t = magnetics_current(&phases->machine->magnetics, flux);
    } else {
        rotor->i_t.d = flux.d / p->d_inductance_h;
        rotor->i_t.q = flux.q / p->q_inductance_h;
    }
    rotor->terminal = from_phases(state->current_a);
    rotor->axis = state->axis;
}

/* i_t of three windings: L^-1 in the stator is a circle plus a part that turns at twice the rotor's
 * angle. */
static plant_ab_t without_iron(const phases_t *phases, plant_ab_t flux, plant_phasor_t axis)
{
    const double psi = phases->machine->flux_wb;
    if (phases->machine->magnetics.saturates) {
        plant_dq_t of_rotor = plant_park(flux, axis);
        of_rotor.d -= psi;
        return plant_inverse_park(magnetics_current(&phases->machine->magnetics, of_rotor), axis);
    }
    const double x = flux.alpha - psi * axis.cos;
    const double y = flux.beta - psi * axis.sin;
    const double cos2 = axis.cos * axis.cos - axis.sin * axis.sin;
    const double sin2 = 2.0 * axis.cos * axis.sin;
    const plant_ab_t out = {
        .alpha = phases->per_l_sum * x + phases->per_l_difference * (cos2 * x + sin2 * y),
        .beta = phases->per_l_sum * y + phases->per_l_difference * (sin2 * x - cos2 * y),
    };
    return out;
}

/* Of windings and their iron, which sees the turning flux alone. */
static plant_ab_t wire_current(const phases_t *phases, plant_ab_t flux, plant_phasor_t axis)
{
    const plant_ab_t i_t = without_iron(phases, flux, axis);
    const double turning_s = phases->iron_s * phases->omega_rad_s;
    const plant_ab_t out = {.alpha = i_t.alpha - turning_s * flux.beta,
                            .beta = i_t.beta + turning_s * flux.alpha};
    return out;
}

/* Everything at one instant. */
typedef struct {
    double volts[PHASES];   /* v_x */
    double current[PHASES]; /* i_x of the winding and its iron; the wire's too unless the leg is
                               open */
    double iron_v[PHASES];  /* w_x */
    double star_v;
    double torque_per_p;
} instant_t;

static instant_t instant_at(const phases_t *phases, const phases_leg_t legs[PHASES],
                            const double flux_wb[PHASES], plant_phasor_t axis)
{
    const plant_ab_t flux = from_phases(flux_wb);
    const plant_ab_t i_t_ab = without_iron(phases, flux, axis);
    const plant_ab_t turning = {.alpha = -phases->omega_rad_s * flux.beta,
                                .beta = phases->omega_rad_s * flux.alpha};
    const double iron_now_s =
        phases->iron_sees_ripple ? 0.0 : phases->iron_s; /* known before v is */
    const double iron_late_s = phases->iron_s - iron_now_s;
    double i_t[PHASES];
    instant_t out = {.torque_per_p = 1.5 * (flux.alpha * i_t_ab.beta - flux.beta * i_t_ab.alpha)};
    to_phases(i_t_ab, i_t);
    to_phases(turning, out.iron_v);
    double share[PHASES];
    double shares = 0.0;
    double sum = 0.0;
    for (int x = 0; x < PHASES; x++) {
        out.current[x] = i_t[x] + iron_now_s * out.iron_v[x];
        if (legs[x].open) {
            share[x] = 0.0;
            out.volts[x] = out.iron_v[x] - phases->open_ohm * out.current[x];
        } else {
            const double ohms = phases->machine->resistance_ohm + legs[x].ohms;
            share[x] = 1.0 / (1.0 + ohms * iron_late_s);
            out.volts[x] = share[x] * (legs[x].volts - ohms * out.current[x]);
        }
        shares += share[x];
        sum += out.volts[x];
    }
    out.star_v = shares > 0.0 ? sum / shares : 0.0;
    for (int x = 0; x < PHASES; x++) {
        out.volts[x] -= share[x] * out.star_v;
        if (phases->iron_sees_ripple) {
            out.iron_v[x] = out.volts[x];
            out.current[x] += iron_late_s * out.volts[x];
        }
    }
    return out;
}

static void along(const double from[PHASES], double h, const double slope[PHASES],
                  double out[PHASES])
{
    for (int x = 0; x < PHASES; x++) {
        out[x] = from[x] + h * slope[x];
    }
}

static void add(const phases_t *phases, const phases_leg_t legs[PHASES], const instant_t *at,
                double weight_s, phases_flow_t *flow)
{
    for (int x = 0; x < PHASES; x++) {
        flow->iron_j += weight_s * at->volts[x] * at->iron_v[x] * phases->iron_s;
        if (legs[x].open) {
            flow->open_j -= weight_s * (at->volts[x] + at->star_v) * at->current[x];
        } else {
            flow->charge_as[x] += weight_s * at->current[x];
            flow->square_a2s[x] += weight_s * at->current[x] * at->current[x];
        }
    }
    flow->torque_nms += weight_s * phases->machine->params.pole_pairs * at->torque_per_p;
}

/* Four stages of Runge and Kutta. */
static void four_stages(const phases_t *phases, phases_state_t *state,
                        const phases_leg_t legs[PHASES], double h, plant_phasor_t middle,
                        plant_phasor_t end, phases_flow_t *flow)
{
    double at[PHASES];
    const instant_t s1 = instant_at(phases, legs, state->flux_wb, state->axis);
    along(state->flux_wb, 0.5 * h, s1.volts, at);
    const instant_t s2 = instant_at(phases, legs, at, middle);
    along(state->flux_wb, 0.5 * h, s2.volts, at);
    const instant_t s3 = instant_at(phases, legs, at, middle);
    along(state->flux_wb, h, s3.volts, at);
    const instant_t s4 = instant_at(phases, legs, at, end);
    const double sixth = h * (1.0 / 6.0);
    add(phases, legs, &s1, sixth, flow);
    add(phases, legs, &s2, 2.0 * sixth, flow);
    add(phases, legs, &s3, 2.0 * sixth, flow);
    add(phases, legs, &s4, sixth, flow);
    for (int x = 0; x < PHASES; x++) {
        state->flux_wb[x] +=
            sixth * (s1.volts[x] + 2.0 * (s2.volts[x] + s3.volts[x]) + s4.volts[x]);
    }
}

/* Kutta's three stages. */
static void three_stages(const phases_t *phases, phases_state_t *state,
                         const phases_leg_t legs[PHASES], double h, plant_phasor_t middle,
                         plant_phasor_t end, phases_flow_t *flow)
{
    double at[PHASES];
    const instant_t s1 = instant_at(phases, legs, state->flux_wb, state->axis);
    along(state->flux_wb, 0.5 * h, s1.volts, at);
    const instant_t s2 = instant_at(phases, legs, at, middle);
    along(state->flux_wb, -h, s1.volts, at);
    along(at, 2.0 * h, s2.volts, at);
    const instant_t s3 = instant_at(phases, legs, at, end);
    const double sixth = h * (1.0 / 6.0);
    add(phases, legs, &s1, sixth, flow);
    add(phases, legs, &s2, 4.0 * sixth, flow);
    add(phases, legs, &s3, sixth, flow);
    for (int x = 0; x < PHASES; x++) {
        state->flux_wb[x] += sixth * (s1.volts[x] + 4.0 * s2.volts[x] + s3.volts[x]);
    }
}

/* Whether three stages are as good as exact: their error is (rate h)^4 / 24 of the current. Where a
 * leg is open or iron saturates, rates are others. */
static bool is_short(const phases_t *phases, const phases_leg_t legs[PHASES], double h)
{
    double most_ohm = 0.0;
    bool open = phases->machine->magnetics.saturates;
    for (int x = 0; x < PHASES; x++) {
        open = open || legs[x].open;
        most_ohm = plant_max(most_ohm, legs[x].ohms);
    }
    const double per_l = phases->per_l_sum + fabs(phases->per_l_difference);
    const double rate_1_per_s =
        fabs(phases->omega_rad_s) + (phases->machine->resistance_ohm + most_ohm) * per_l;
    return !open && rate_1_per_s * h <= SHORT_SHARE;
}

static void remember_currents(const phases_t *phases, phases_state_t *state,
                              const phases_leg_t legs[PHASES])
{
    if (phases->iron_sees_ripple) {
        const instant_t now = instant_at(phases, legs, state->flux_wb, state->axis);
        for (int x = 0; x < PHASES; x++) {
            state->current_a[x] = legs[x].open ? 0.0 : now.current[x];
        }
        return;
    }
    const plant_ab_t i = wire_current(phases, from_phases(state->flux_wb), state->axis);
    double current_a[PHASES];
    to_phases(i, current_a);
    for (int x = 0; x < PHASES; x++) {
        state->current_a[x] = legs[x].open ? 0.0 : current_a[x];
    }
}

void phases_advance(const phases_t *phases, phases_state_t *state, const phases_leg_t legs[PHASES],
                    double h, phases_flow_t *flow)
{
    const plant_phasor_t half_turn = plant_small_phasor(0.5 * phases->omega_rad_s * h);
    const plant_phasor_t middle = plant_turned(state->axis, half_turn);
    const plant_phasor_t end = plant_turned(middle, half_turn);
    if (is_short(phases, legs, h)) {
        three_stages(phases, state, legs, h, middle, end, flow);
    } else {
        four_stages(phases, state, legs, h, middle, end, flow);
    }
    state->axis = end;
    remember_currents(phases, state, legs);
}

bool phases_coast(const phases_t *phases, phases_state_t *state, double most_v, double h,
                  phases_flow_t *flow)
{
    const double w = phases->omega_rad_s;
    const plant_ab_t flux = from_phases(state->flux_wb);
    const double square = flux.alpha * flux.alpha + flux.beta * flux.beta;
    const plant_ab_t i = wire_current(phases, flux, state->axis);
    if (fabs(i.alpha) + fabs(i.beta) > QUIET_A || 3.0 * w * w * square >= most_v * most_v ||
        fabs(w) * h > COAST_RAD) {
        return false;
    }
    const plant_phasor_t half_turn = plant_small_phasor(0.5 * w * h);
    const plant_phasor_t turn = plant_turned(half_turn, half_turn);
    const plant_ab_t turned = {.alpha = flux.alpha * turn.cos - flux.beta * turn.sin,
                               .beta = flux.beta * turn.cos + flux.alpha * turn.sin};
    to_phases(turned, state->flux_wb);
    state->axis = plant_turned(state->axis, turn);
    const double drag_j_per_rad = 1.5 * h * phases->iron_s * w * square;
    flow->iron_j += w * drag_j_per_rad;
    flow->torque_nms -= phases->machine->params.pole_pairs * drag_j_per_rad;
    return true;
}

void phases_terminals(const phases_t *phases, const phases_state_t *state,
                      const phases_leg_t legs[PHASES], double current_a[PHASES],
                      double end_v[PHASES])
{
    const instant_t now = instant_at(phases, legs, state->flux_wb, state->axis);
    for (int x = 0; x < PHASES; x++) {
        current_a[x] = legs[x].open ? 0.0 : now.current[x];
        end_v[x] = legs[x].open ? now.volts[x] + now.star_v
                                : legs[x].volts - legs[x].ohms * now.current[x];
    }
}
