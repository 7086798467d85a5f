#include "plant/pmsm.h"

#include "plant/numbers.h"

/* Largest turn of the rotor in one stage set, rad: the scheme's error is then below 1e-8 of the current per period. */
static const double LARGEST_TURN_RAD = 0.1;
/* Coldest and hottest windings of a broken scenario still have copper in them. */
static const double LEAST_SHARE = 0.05;

pmsm_t pmsm_at_temperature(const pmsm_params_t *params, double winding_temperature_c)
{
    const double rise_k = winding_temperature_c - params->reference_temperature_c;
    const double resistance_share = 1.0 + params->resistance_temperature_coefficient_per_k * rise_k;
    const double flux_share = 1.0 + params->flux_temperature_coefficient_per_k * rise_k;
    const pmsm_t out = {
        .params = *params,
        .resistance_ohm = params->phase_resistance_ohm * plant_max(resistance_share, LEAST_SHARE),
        .flux_wb = params->flux_linkage_wb * plant_max(flux_share, LEAST_SHARE),
    };
    return out;
}

pmsm_state_t pmsm_at_rest(double theta_turn)
{
    const double within = theta_turn - floor(theta_turn);
    const pmsm_state_t out = {
        .i_t = {0.0, 0.0}, .terminal = {0.0, 0.0}, .theta_turn = within, .axis = plant_phasor_of_turn(within)};
    return out;
}

/* The equations at one speed, ready to be evaluated: with e = u - R i_t, v = share e and i = i_t + conductance e. */
typedef struct {
    double resistance_ohm; /* winding and series */
    double share;          /* R_i / (R_i + R), 1 without iron loss */
    double conductance_s;  /* 1 / (R_i + R), 0 without iron loss */
    double w, w_l_d, w_l_q, w_psi;
    double per_l_d, per_l_q;
    double flux_wb, saliency_h;
} equations_t;

static equations_t equations_at(const pmsm_t *machine, const pmsm_step_t *step)
{
    const pmsm_params_t *p = &machine->params;
    const double w = step->omega_rad_s;
    equations_t out = {
        .resistance_ohm = machine->resistance_ohm + step->series_resistance_ohm,
        .share = 1.0,
        .conductance_s = 0.0,
        .w = w,
        .w_l_d = w * p->d_inductance_h,
        .w_l_q = w * p->q_inductance_h,
        .w_psi = w * machine->flux_wb,
        .per_l_d = 1.0 / p->d_inductance_h,
        .per_l_q = 1.0 / p->q_inductance_h,
        .flux_wb = machine->flux_wb,
        .saliency_h = p->d_inductance_h - p->q_inductance_h,
    };
    if (p->iron_loss_resistance_ohm + p->iron_loss_resistance_slope_ohm_s > 0.0) {
        const double iron_ohm = p->iron_loss_resistance_ohm + p->iron_loss_resistance_slope_ohm_s * fabs(w);
        out.conductance_s = 1.0 / (iron_ohm + out.resistance_ohm);
        out.share = iron_ohm * out.conductance_s;
    }
    return out;
}

static inline plant_dq_t along(plant_dq_t x, double factor, plant_dq_t y)
{
    const plant_dq_t out = {.d = x.d + factor * y.d, .q = x.q + factor * y.q};
    return out;
}

/* What one stage of the scheme sees. */
typedef struct {
    plant_dq_t slope;    /* di_t/dt */
    plant_dq_t terminal; /* i */
    double terminal_square, drop_square, torque_per_3_2_p;
} stage_t;

static inline stage_t stage_at(const equations_t *eq, plant_dq_t u, plant_dq_t i_t)
{
    const plant_dq_t e = along(u, -eq->resistance_ohm, i_t);
    const plant_dq_t i = along(i_t, eq->conductance_s, e);
    const stage_t out = {
        .slope = {.d = (eq->share * e.d + eq->w_l_q * i_t.q) * eq->per_l_d,
                  .q = (eq->share * e.q - eq->w_l_d * i_t.d - eq->w_psi) * eq->per_l_q},
        .terminal = i,
        .terminal_square = i.d * i.d + i.q * i.q,
        .drop_square = e.d * e.d + e.q * e.q,
        .torque_per_3_2_p = (eq->flux_wb + eq->saliency_h * i_t.d) * i_t.q,
    };
    return out;
}

static inline double simpson(double first, double second, double third, double fourth)
{
    return first + 2.0 * (second + third) + fourth;
}

bool pmsm_is_resolved(const pmsm_t *machine, double series_resistance_ohm, double step_s)
{
    const pmsm_params_t *p = &machine->params;
    const double resistance_ohm = machine->resistance_ohm + series_resistance_ohm;
    return resistance_ohm * step_s < plant_min(p->d_inductance_h, p->q_inductance_h);
}

/* One set of four stages. */
static void advance(const equations_t *eq, pmsm_state_t *state, plant_ab_t u_ab, double h, pmsm_flow_t *flow)
{
    const plant_phasor_t half_turn = plant_small_phasor(0.5 * eq->w * h);
    const plant_phasor_t start = state->axis;
    const plant_phasor_t middle = plant_turned(start, half_turn);
    const plant_phasor_t end = plant_turned(middle, half_turn);
    const plant_dq_t u_start = plant_park(u_ab, start);
    const plant_dq_t u_middle = plant_park(u_ab, middle);
    const plant_dq_t u_end = plant_park(u_ab, end);

    const plant_dq_t i_t = state->i_t;
    const stage_t s1 = stage_at(eq, u_start, i_t);
    const stage_t s2 = stage_at(eq, u_middle, along(i_t, 0.5 * h, s1.slope));
    const stage_t s3 = stage_at(eq, u_middle, along(i_t, 0.5 * h, s2.slope));
    const stage_t s4 = stage_at(eq, u_end, along(i_t, h, s3.slope));
    const double sixth = h / 6.0;
    state->i_t.d = i_t.d + sixth * simpson(s1.slope.d, s2.slope.d, s3.slope.d, s4.slope.d);
    state->i_t.q = i_t.q + sixth * simpson(s1.slope.q, s2.slope.q, s3.slope.q, s4.slope.q);
    state->axis = end;

    const plant_dq_t mean = {.d = 0.5 * (s2.terminal.d + s3.terminal.d), .q = 0.5 * (s2.terminal.q + s3.terminal.q)};
    const plant_ab_t at_start = plant_inverse_park(s1.terminal, start);
    const plant_ab_t at_middle = plant_inverse_park(mean, middle);
    const plant_ab_t at_end = plant_inverse_park(s4.terminal, end);
    state->terminal = at_end;
    flow->charge_as.alpha += sixth * (at_start.alpha + 4.0 * at_middle.alpha + at_end.alpha);
    flow->charge_as.beta += sixth * (at_start.beta + 4.0 * at_middle.beta + at_end.beta);
    flow->rectified_as +=
        sixth * (plant_rectified_sum(at_start) + 4.0 * plant_rectified_sum(at_middle) + plant_rectified_sum(at_end));
    /* Copper and series heat are told apart by the caller; here both are integral of |i|^2, iron of |e|^2. */
    flow->copper_j += sixth * simpson(s1.terminal_square, s2.terminal_square, s3.terminal_square, s4.terminal_square);
    flow->iron_j += sixth * simpson(s1.drop_square, s2.drop_square, s3.drop_square, s4.drop_square);
    flow->torque_nms +=
        sixth * simpson(s1.torque_per_3_2_p, s2.torque_per_3_2_p, s3.torque_per_3_2_p, s4.torque_per_3_2_p);
}

/* A rotor that turned more than once within a PWM period could not be controlled, but must not leave its range. */
static void turn_rotor(pmsm_state_t *state, const pmsm_step_t *step)
{
    const double turns = step->omega_rad_s * step->duration_s * (1.0 / PLANT_TWO_PI);
    const double whole = turns >= 1.0 || turns <= -1.0 ? trunc(turns) : 0.0;
    state->theta_turn = plant_wrapped_turn(state->theta_turn + (turns - whole));
}

/* The phasor is carried along by products; this takes their rounding off before it can grow. */
static void straighten(pmsm_state_t *state)
{
    const double stretch = 1.5 - 0.5 * (state->axis.cos * state->axis.cos + state->axis.sin * state->axis.sin);
    state->axis.cos *= stretch;
    state->axis.sin *= stretch;
}

void pmsm_turn(pmsm_state_t *state, const pmsm_step_t *step)
{
    turn_rotor(state, step);
    straighten(state);
}

pmsm_flow_t pmsm_step(const pmsm_t *machine, pmsm_state_t *state, plant_ab_t u, const pmsm_step_t *step)
{
    const equations_t eq = equations_at(machine, step);
    pmsm_flow_t flow = {.charge_as = {0.0, 0.0}};
    const double turn_rad = fabs(eq.w) * step->duration_s;
    const int sets = turn_rad <= LARGEST_TURN_RAD ? 1 : (int)ceil(turn_rad / LARGEST_TURN_RAD);
    const double h = step->duration_s / sets;
    for (int k = 0; k < sets; k++) {
        advance(&eq, state, u, h, &flow);
    }
    pmsm_turn(state, step);

    const double square_a2s = flow.copper_j;
    flow.copper_j = 1.5 * machine->resistance_ohm * square_a2s;
    flow.series_j = 1.5 * step->series_resistance_ohm * square_a2s;
    flow.iron_j *= 1.5 * eq.share * eq.conductance_s;
    flow.torque_nms *= 1.5 * machine->params.pole_pairs;
    flow.source_j = 1.5 * (u.alpha * flow.charge_as.alpha + u.beta * flow.charge_as.beta);
    return flow;
}

/* i_t after an implicit step of  L di/dt = drive - r i - j w L i,  drive holding everything else. */
static plant_dq_t implicit_step(const equations_t *eq, plant_dq_t before, double h, double r, plant_dq_t drive)
{
    const double a = 1.0 + h * r * eq->per_l_d;
    const double d = 1.0 + h * r * eq->per_l_q;
    const double b = -h * eq->w_l_q * eq->per_l_d;
    const double c = h * eq->w_l_d * eq->per_l_q;
    const double right_d = before.d + h * eq->per_l_d * drive.d;
    const double right_q = before.q + h * eq->per_l_q * drive.q;
    const double per_determinant = 1.0 / (a * d - b * c);
    const plant_dq_t out = {.d = (right_d * d - b * right_q) * per_determinant,
                            .q = (a * right_q - c * right_d) * per_determinant};
    return out;
}

/* The terminal voltage that lets no current through the wires, and the i_t that belongs to it. */
static plant_dq_t blocking_voltage(const equations_t *eq, plant_dq_t before, double h, plant_dq_t *i_t)
{
    if (eq->conductance_s == 0.0) {
        i_t->d = 0.0;
        i_t->q = 0.0;
        const plant_dq_t out = {.d = -before.d / (h * eq->per_l_d), .q = eq->w_psi - before.q / (h * eq->per_l_q)};
        return out;
    }
    const double iron_ohm = eq->share / eq->conductance_s;
    const plant_dq_t emf = {.d = 0.0, .q = -eq->w_psi};
    *i_t = implicit_step(eq, before, h, iron_ohm, emf);
    const plant_dq_t out = {.d = -iron_ohm * i_t->d, .q = -iron_ohm * i_t->q};
    return out;
}

pmsm_flow_t pmsm_step_rectified(const pmsm_t *machine, pmsm_state_t *state, double ceiling_v, const pmsm_step_t *step)
{
    const equations_t eq = equations_at(machine, step);
    const double h = step->duration_s;
    const double magnetic_before_j = pmsm_magnetic_energy_j(machine, state);
    plant_dq_t i_t;
    plant_dq_t u = blocking_voltage(&eq, state->i_t, h, &i_t);
    plant_dq_t terminal = {0.0, 0.0};
    double drop_square = 0.0; /* of v, the voltage across the iron branch */
    const double wanted_v = hypot(u.d, u.q);
    if (wanted_v > ceiling_v) {
        u.d *= ceiling_v / wanted_v;
        u.q *= ceiling_v / wanted_v;
        const plant_dq_t drive = {.d = eq.share * u.d, .q = eq.share * u.q - eq.w_psi};
        i_t = implicit_step(&eq, state->i_t, h, eq.share * eq.resistance_ohm, drive);
        const stage_t end = stage_at(&eq, u, i_t);
        terminal = end.terminal;
        drop_square = eq.share * eq.share * end.drop_square;
    } else {
        drop_square = wanted_v * wanted_v;
    }
    state->i_t = i_t;
    turn_rotor(state, step);
    state->axis = plant_phasor_of_turn(state->theta_turn);
    state->terminal = plant_inverse_park(terminal, state->axis);

    const double square_a2s = h * (terminal.d * terminal.d + terminal.q * terminal.q);
    const double per_iron_ohm = eq.share > 0.0 ? eq.conductance_s / eq.share : 0.0;
    pmsm_flow_t flow = {
        .charge_as = {.alpha = h * state->terminal.alpha, .beta = h * state->terminal.beta},
        .copper_j = 1.5 * machine->resistance_ohm * square_a2s,
        .series_j = 1.5 * step->series_resistance_ohm * square_a2s,
        .iron_j = 1.5 * h * drop_square * per_iron_ohm,
        .torque_nms = h * pmsm_torque_nm(machine, i_t),
        .rectified_as = h * plant_rectified_sum(state->terminal),
    };
    const double work_j = flow.torque_nms * step->omega_rad_s / machine->params.pole_pairs;
    flow.source_j = flow.copper_j + flow.series_j + flow.iron_j + work_j + pmsm_magnetic_energy_j(machine, state) -
                    magnetic_before_j;
    return flow;
}

double pmsm_amperes_per_volt(const pmsm_t *machine, const pmsm_step_t *step)
{
    const equations_t eq = equations_at(machine, step);
    return step->duration_s * plant_max(eq.per_l_d, eq.per_l_q) + eq.conductance_s;
}

double pmsm_magnetic_energy_j(const pmsm_t *machine, const pmsm_state_t *state)
{
    const pmsm_params_t *p = &machine->params;
    return 0.75 * (p->d_inductance_h * state->i_t.d * state->i_t.d + p->q_inductance_h * state->i_t.q * state->i_t.q);
}

double pmsm_torque_nm(const pmsm_t *machine, plant_dq_t i_t)
{
    const pmsm_params_t *p = &machine->params;
    const double flux_wb = machine->flux_wb + (p->d_inductance_h - p->q_inductance_h) * i_t.d;
    return 1.5 * p->pole_pairs * flux_wb * i_t.q;
}
