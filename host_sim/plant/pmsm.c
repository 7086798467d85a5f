/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/pmsm.h"

#include <stddef.h>

#include "plant/numbers.h"
#include "pmsm_linear.h"

/* Coldest and hottest windings of a broken scenario still have copper in them. */
static const double LEAST_SHARE = 0.05;

static const double DIED_OUT_A = 1e-30;

static double flux_at(const pmsm_params_t *params, double winding_temperature_c)
{
    const double rise_k = winding_temperature_c - params->reference_temperature_c;
    const double share = 1.0 + params->flux_temperature_coefficient_per_k * rise_k;
    return params->flux_linkage_wb * plant_max(share, LEAST_SHARE);
}

static magnetics_data_t iron_of(const pmsm_params_t *params, double flux_wb)
{
    const magnetics_data_t out = {
        .d_inductance_h = params->d_inductance_h,
        .q_inductance_h = params->q_inductance_h,
        .d_saturation_a = params->d_saturation_current_a,
        .q_saturation_a = params->q_saturation_current_a,
        .cross_share = params->cross_saturation,
        .bias_a = params->magnet_bias_current_a,
        .map = params->energy_map,
        .shift_wb = flux_wb - params->flux_linkage_wb,
    };
    return out;
}

const char *pmsm_objection(const pmsm_params_t *params)
{
    const magnetics_data_t iron = iron_of(params, params->flux_linkage_wb);
    const bool has_map = params->energy_map != NULL;
    if (has_map && (params->d_saturation_current_a > 0.0 || params->q_saturation_current_a > 0.0)) {
        return "motor.d_saturation_current_a, motor.q_saturation_current_a: accepted: 0 with a "
               "flux map";
    }
    if (!magnetics_is_possible(&iron)) {
        return has_map ? "flux map: accepted: inductances above zero at every current"
                       : "motor.magnet_bias_current_a: accepted: less than 0.28 "
                         "motor.d_saturation_current_a, and so little that "
                         "4 motor.cross_saturation sqrt(d_inductance_h / q_inductance_h) bias^2 is "
                         "less than the product of both "
                         "saturation currents";
    }
    if (params->cogging_torque_nm > 0.0 &&
        (params->cogging_per_turn < 1.0 ||
         params->cogging_per_turn != floor(params->cogging_per_turn))) {
        return "motor.cogging_per_turn: accepted: a whole number from 1 where "
               "motor.cogging_torque_nm is above 0";
    }
    return NULL;
}

pmsm_t pmsm_at_temperature(const pmsm_params_t *params, double winding_temperature_c)
{
    const double rise_k = winding_temperature_c - params->reference_temperature_c;
    const double resistance_share = 1.0 + params->resistance_temperature_coefficient_per_k * rise_k;
    const double flux_wb = flux_at(params, winding_temperature_c);
    const magnetics_data_t iron = iron_of(params, flux_wb);
    const pmsm_t out = {
        .params = *params,
        .resistance_ohm = params->phase_resistance_ohm * plant_max(resistance_share, LEAST_SHARE),
        .flux_wb = flux_wb,
        .saliency_h = params->d_inductance_h - params->q_inductance_h,
        .magnetics = magnetics_of(&iron),
        .cogging = {.amplitude_nm = params->cogging_torque_nm,
                    .per_turn = params->cogging_per_turn,
                    .phase_turn = params->cogging_deg / 360.0},
    };
    return out;
}

pmsm_state_t pmsm_at_rest(double theta_turn)
{
    const double within = theta_turn - floor(theta_turn);
    const pmsm_state_t out = {.i_t = {0.0, 0.0},
                              .terminal = {0.0, 0.0},
                              .theta_turn = within,
                              .axis = plant_phasor_of_turn(within)};
    return out;
}

void pmsm_rest(pmsm_state_t *state)
{
    if (fabs(state->i_t.d) + fabs(state->i_t.q) < DIED_OUT_A) {
        state->i_t.d = 0.0;
        state->i_t.q = 0.0;
    }
}

static equations_t equations_at(const pmsm_t *machine, const pmsm_step_t *step)
{
    const pmsm_params_t *p = &machine->params;
    const double w = step->omega_rad_s;
    equations_t out = {
        .resistance_ohm = machine->resistance_ohm + step->series_resistance_ohm,
        .share = 1.0,
        .conductance_s = 0.0,
        .w = w,
        .machine = machine,
    };
    if (p->iron_loss_resistance_ohm + p->iron_loss_resistance_slope_ohm_s > 0.0) {
        const double iron_ohm =
            p->iron_loss_resistance_ohm + p->iron_loss_resistance_slope_ohm_s * fabs(w);
        out.conductance_s = 1.0 / (iron_ohm + out.resistance_ohm);
        out.share = iron_ohm * out.conductance_s;
    }
    return out;
}

bool pmsm_is_resolved(const pmsm_t *machine, double series_resistance_ohm, double step_s)
{
    const pmsm_params_t *p = &machine->params;
    const double resistance_ohm = machine->resistance_ohm + series_resistance_ohm;
    return resistance_ohm * step_s < plant_min(p->d_inductance_h, p->q_inductance_h);
}

/* A rotor that turned more than once within a PWM period could not be controlled, but must not
 * leave its range. */
static inline void turn_rotor(pmsm_state_t *state, const pmsm_step_t *step)
{
    const double turns = step->omega_rad_s * step->duration_s * (1.0 / PLANT_TWO_PI);
    const double whole = turns >= 1.0 || turns <= -1.0 ? trunc(turns) : 0.0;
    state->theta_turn = plant_wrapped_turn(state->theta_turn + (turns - whole));
}

/* The phasor is carried along by products; this takes their rounding off before it can grow. */
static inline void straighten(pmsm_state_t *state)
{
    const double stretch =
        1.5 - 0.5 * (state->axis.cos * state->axis.cos + state->axis.sin * state->axis.sin);
    state->axis.cos *= stretch;
    state->axis.sin *= stretch;
}

static double turn_through_cogs(const pmsm_t *machine, pmsm_state_t *state, const pmsm_step_t *step)
{
    const double turns =
        step->omega_rad_s * step->duration_s / (PLANT_TWO_PI * machine->params.pole_pairs);
    const double out_nms =
        cogging_impulse_nms(&machine->cogging, state->shaft_turn, turns, step->duration_s);
    const double after = state->shaft_turn + turns;
    state->shaft_turn = after - floor(after);
    return out_nms;
}

static inline double cog(const pmsm_t *machine, pmsm_state_t *state, const pmsm_step_t *step)
{
    return machine->cogging.amplitude_nm > 0.0 ? turn_through_cogs(machine, state, step) : 0.0;
}

static inline double turn(const pmsm_t *machine, pmsm_state_t *state, const pmsm_step_t *step)
{
    state->rests = false;
    turn_rotor(state, step);
    straighten(state);
    return cog(machine, state, step);
}

double pmsm_turn(const pmsm_t *machine, pmsm_state_t *state, const pmsm_step_t *step)
{
    return turn(machine, state, step);
}

/* The step of nearly every period: one set, iron that does not saturate, no phase near the
 * opposition's zone. False: it is another one, and nothing has changed. */
static inline bool step_at_once(const equations_t *eq, pmsm_state_t *state, plant_ab_t u,
                                const pmsm_step_t *step, pmsm_flow_t *flow)
{
    if (eq->machine->magnetics.saturates || pmsm_sets(eq, step) > 1) {
        return false;
    }
    const linear_t linear = linear_of(eq, &step->opposition, state, u);
    return linear_holds(&linear) &&
           linear_advance(&linear, state, step->duration_s,
                          plant_small_phasor(0.5 * eq->w * step->duration_s), flow);
}

pmsm_flow_t pmsm_step(const pmsm_t *machine, pmsm_state_t *state, plant_ab_t u,
                      const pmsm_step_t *step)
{
    const equations_t eq = equations_at(machine, step);
    pmsm_flow_t flow;
    if (!step_at_once(&eq, state, u, step, &flow)) {
        const equations_t at_this_speed = eq; /* so that eq itself needs no memory */
        flow = pmsm_step_in_sets(&at_this_speed, state, u, step);
    }
    const double cogging_nms = turn(machine, state, step);

    const double square_a2s = 1.5 * flow.copper_j;
    flow.copper_j = machine->resistance_ohm * square_a2s;
    flow.series_j = step->series_resistance_ohm * square_a2s;
    flow.iron_j *= 1.5 * eq.share * eq.conductance_s;
    flow.torque_nms *= 1.5 * machine->params.pole_pairs;
    flow.torque_nms += cogging_nms;
    flow.source_j = 1.5 * (u.alpha * flow.charge_as.alpha + u.beta * flow.charge_as.beta) -
                    step->opposition.volts * flow.opposed_as;
    return flow;
}

/* i_t after one implicit step of L di/dt = drive - r i - j w L i; drive: all other voltages. */
static plant_dq_t implicit_step(const pmsm_t *machine, const equations_t *eq, plant_dq_t before,
                                double h, double r, plant_dq_t drive)
{
    if (machine->magnetics.saturates) {
        return pmsm_saturated_implicit(machine, eq->w, before, h, r, drive);
    }
    const double a = 1.0 + h * r * machine->magnetics.per_l_d;
    const double d = 1.0 + h * r * machine->magnetics.per_l_q;
    const double b = -h * eq->w * machine->params.q_inductance_h * machine->magnetics.per_l_d;
    const double c = h * eq->w * machine->params.d_inductance_h * machine->magnetics.per_l_q;
    const double right_d = before.d + h * machine->magnetics.per_l_d * drive.d;
    const double right_q = before.q + h * machine->magnetics.per_l_q * drive.q;
    const double per_determinant = 1.0 / (a * d - b * c);
    const plant_dq_t out = {.d = (right_d * d - b * right_q) * per_determinant,
                            .q = (a * right_q - c * right_d) * per_determinant};
    return out;
}

/* The terminal voltage with which no current flows in the wires, and the i_t that belongs to it. */
static plant_dq_t blocking_voltage(const pmsm_t *machine, const equations_t *eq, plant_dq_t before,
                                   double h, plant_dq_t *i_t)
{
    if (eq->conductance_s == 0.0) {
        i_t->d = 0.0;
        i_t->q = 0.0;
        const plant_dq_t flux = magnetics_flux(&machine->magnetics, before);
        const plant_dq_t out = {.d = -flux.d / h, .q = eq->w * machine->flux_wb - flux.q / h};
        return out;
    }
    const double iron_ohm = eq->share / eq->conductance_s;
    const plant_dq_t emf = {.d = 0.0, .q = -eq->w * machine->flux_wb};
    *i_t = implicit_step(machine, eq, before, h, iron_ohm, emf);
    const plant_dq_t out = {.d = -iron_ohm * i_t->d, .q = -iron_ohm * i_t->q};
    return out;
}

static inline bool stands_still(const pmsm_t *machine, const pmsm_state_t *state,
                                const pmsm_step_t *step)
{
    return step->omega_rad_s == 0.0 && state->i_t.d == 0.0 && state->i_t.q == 0.0 &&
           machine->cogging.amplitude_nm <= 0.0;
}

/* What diodes of `ceiling_v` against the current do to it within a step: a resistance z in series
 * with the winding, z |i| = ceiling_v. z |i(z)| rises from zero to the blocking voltage, and
 * ceiling_v / |i(z)| is nearly a straight line: by secants. Of the stage returned, drop_square is
 * that of the iron branch. */
static stage_t opposed_step(const pmsm_t *machine, plant_dq_t before, double ceiling_v,
                            const pmsm_step_t *step, plant_dq_t *i_t)
{
    enum { SECANTS_MOST = 30 };
    const plant_dq_t none = {0.0, 0.0};
    pmsm_step_t opposed = *step;
    stage_t end;
    double z = 0.0, last_z = 0.0, last_apart = 0.0;
    for (int n = 0;; n++) {
        opposed.series_resistance_ohm = step->series_resistance_ohm + z;
        const equations_t eq = equations_at(machine, &opposed);
        const plant_dq_t emf = {.d = 0.0, .q = -eq.w * machine->flux_wb};
        *i_t = implicit_step(machine, &eq, before, step->duration_s, eq.share * eq.resistance_ohm,
                             emf);
        end = straight_stage_at(&eq, none, *i_t);
        const double apart = ceiling_v / hypot(end.terminal.d, end.terminal.q) - z;
        if (n == SECANTS_MOST || fabs(apart) <= 1e-12 * z) {
            end.drop_square *= eq.share * eq.share;
            return end;
        }
        const double slope = n == 0 ? -1.0 : (apart - last_apart) / (z - last_z);
        last_z = z;
        last_apart = apart;
        z = plant_max(z - apart / (slope < 0.0 ? slope : -1.0), 0.0);
    }
}

pmsm_flow_t pmsm_step_rectified(const pmsm_t *machine, pmsm_state_t *state, double ceiling_v,
                                const pmsm_step_t *step)
{
    const bool still = stands_still(machine, state, step);
    if (still && state->rests) {
        const pmsm_flow_t none = {.charge_as = {0.0, 0.0}};
        return none;
    }
    state->rests = still;
    const equations_t eq = equations_at(machine, step);
    const double h = step->duration_s;
    const double magnetic_before_j = pmsm_magnetic_energy_j(machine, state);
    plant_dq_t i_t;
    const plant_dq_t blocking = blocking_voltage(machine, &eq, state->i_t, h, &i_t);
    plant_dq_t terminal = {0.0, 0.0};
    const double wanted_v = hypot(blocking.d, blocking.q);
    double drop_square = wanted_v * wanted_v; /* of v, the voltage across the iron branch */
    if (wanted_v > ceiling_v) {
        const stage_t end = opposed_step(machine, state->i_t, ceiling_v, step, &i_t);
        terminal = end.terminal;
        drop_square = end.drop_square;
    }
    state->i_t = i_t;
    turn_rotor(state, step);
    const double cogging_nms = cog(machine, state, step);
    state->axis = plant_phasor_of_turn(state->theta_turn);
    state->terminal = plant_inverse_park(terminal, state->axis);

    const double square_a2s = h * (terminal.d * terminal.d + terminal.q * terminal.q);
    const double per_iron_ohm = eq.share > 0.0 ? eq.conductance_s / eq.share : 0.0;
    pmsm_flow_t flow = {
        .charge_as = {.alpha = h * state->terminal.alpha, .beta = h * state->terminal.beta},
        .copper_j = 1.5 * machine->resistance_ohm * square_a2s,
        .series_j = 1.5 * step->series_resistance_ohm * square_a2s,
        .iron_j = 1.5 * h * drop_square * per_iron_ohm,
        .torque_nms = h * pmsm_torque_nm(machine, i_t) + cogging_nms,
        .rectified_as = h * plant_rectified_sum(state->terminal),
    };
    const double work_j = flow.torque_nms * step->omega_rad_s / machine->params.pole_pairs;
    flow.source_j = flow.copper_j + flow.series_j + flow.iron_j + work_j +
                    pmsm_magnetic_energy_j(machine, state) - magnetic_before_j;
    return flow;
}

double pmsm_amperes_per_volt(const pmsm_t *machine, const pmsm_state_t *state,
                             const pmsm_step_t *step)
{
    const equations_t eq = equations_at(machine, step);
    double per_l = plant_max(machine->magnetics.per_l_d, machine->magnetics.per_l_q);
    if (machine->magnetics.saturates) {
        const magnetics_slope_t s =
            magnetics_slope(&machine->magnetics, magnetics_flux(&machine->magnetics, state->i_t));
        per_l = 0.5 * (s.dd + s.qq) + hypot(0.5 * (s.dd - s.qq), s.dq); /* the larger eigenvalue */
    }
    return step->duration_s * per_l + eq.conductance_s;
}

double pmsm_magnetic_energy_j(const pmsm_t *machine, const pmsm_state_t *state)
{
    const pmsm_params_t *p = &machine->params;
    const double cogging_j = machine->cogging.amplitude_nm > 0.0
                                 ? cogging_energy_j(&machine->cogging, state->shaft_turn)
                                 : 0.0;
    if (machine->magnetics.saturates) {
        return magnetics_energy_j(&machine->magnetics,
                                  magnetics_flux(&machine->magnetics, state->i_t)) +
               cogging_j;
    }
    const double of_currents_j = 0.75 * (p->d_inductance_h * state->i_t.d * state->i_t.d +
                                         p->q_inductance_h * state->i_t.q * state->i_t.q);
    return of_currents_j + cogging_j;
}

double pmsm_torque_nm(const pmsm_t *machine, plant_dq_t i_t)
{
    const pmsm_params_t *p = &machine->params;
    if (machine->magnetics.saturates) {
        const plant_dq_t flux = magnetics_flux(&machine->magnetics, i_t);
        return 1.5 * p->pole_pairs * ((machine->flux_wb + flux.d) * i_t.q - flux.q * i_t.d);
    }
    const double flux_wb = machine->flux_wb + machine->saliency_h * i_t.d;
    return 1.5 * p->pole_pairs * flux_wb * i_t.q;
}
