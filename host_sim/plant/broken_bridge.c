/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/broken_bridge.h"

#include <math.h>
#include <stddef.h>

#include "plant/numbers.h"

enum { STEPS = 20, RELEASE_PERIODS = 2 };
static const double ZERO_A = 1e-9;
/* What leaves a pair of joined wires that floats, a share of what circulates in it: the third
 * winding's current decays a little late. */
static const double JOINED_ZERO_A = 1.0, JOINED_SHARE = 0.02;

typedef struct {
    double high, low, diode; /* shares of the period, their sum 1 */
} shares_t;

typedef struct {
    const inverter_t *inverter;
    double bus_v;
    double zone_a; /* in which a diode that is chopped blocks */
    shares_t shares[PHASES];
    phases_leg_t legs[PHASES];
    bool floats[PHASES];        /* diodes alone that block */
    double diode_share[PHASES]; /* of the present step */
    double heat_ohm[PHASES];    /* of legs[].ohms, what heats */
} period_t;

bool broken_bridge_present(const fault_params_t *p)
{
#define PRESENT(name, lowest, highest, unit, text) || p->name != 0.0
    return false BRIDGE_FAULT_PARAMETERS(PRESENT);
#undef PRESENT
}

static bool has(double mask, int leg)
{
    return ((unsigned)mask >> (unsigned)leg & 1U) != 0U;
}

/* Legs that a fault ties to a rail, as the command does not know. */
static bool shoots_through(const fault_params_t *p, const broken_bridge_command_t *command,
                           const double duty[PHASES])
{
    for (int x = 0; x < PHASES; x++) {
        const bool low_commanded = command->mode == BROKEN_BRIDGE_SHORT_LOW ||
                                   (command->mode == BROKEN_BRIDGE_PWM && duty[x] < 1.0);
        const bool high_commanded = command->mode == BROKEN_BRIDGE_SHORT_HIGH ||
                                    (command->mode == BROKEN_BRIDGE_PWM && duty[x] > 0.0);
        if ((has(p->high_switch_closed, x) && low_commanded && !has(p->low_switch_open, x)) ||
            (has(p->low_switch_closed, x) && high_commanded && !has(p->high_switch_open, x))) {
            return true;
        }
    }
    return false;
}

/* The two legs that are joined. */
static void joined(const fault_params_t *p, int *first, int *second)
{
    *first = (int)p->phase_short - 1;
    *second = (*first + 1) % PHASES;
}

static bool is_driven_apart(const fault_params_t *p, const broken_bridge_command_t *command,
                            const double duty[PHASES], double period_s)
{
    if (p->phase_short < 1.0 || command->mode != BROKEN_BRIDGE_PWM) {
        return false;
    }
    int x;
    int y;
    joined(p, &x, &y);
    /* Two equal pulses, one each side of the middle. */
    return 0.5 * fabs(duty[x] - duty[y]) * period_s > p->blanking_s;
}

static void protect(const fault_params_t *p, broken_bridge_t *state,
                    const broken_bridge_command_t *command, const double duty[PHASES],
                    double period_s)
{
    state->quiet_periods = command->mode == BROKEN_BRIDGE_PWM ? 0 : state->quiet_periods + 1;
    if (shoots_through(p, command, duty) || is_driven_apart(p, command, duty, period_s)) {
        state->desaturated = true;
        state->quiet_periods = 0;
    } else if (state->quiet_periods >= RELEASE_PERIODS) {
        state->desaturated = false;
    }
}

static shares_t shares_of(const fault_params_t *p, const broken_bridge_command_t *command,
                          bool open, int x, double duty)
{
    shares_t out = {.high = 0.0, .low = 0.0, .diode = 1.0};
    if (!open && command->mode == BROKEN_BRIDGE_PWM) {
        out.high = duty;
        out.low = 1.0 - duty;
    } else if (!open && command->mode == BROKEN_BRIDGE_SHORT_LOW) {
        out.low = 1.0;
    } else if (!open && command->mode == BROKEN_BRIDGE_SHORT_HIGH) {
        out.high = 1.0;
    }
    out.high = has(p->high_switch_open, x) ? 0.0 : out.high;
    out.low = has(p->low_switch_open, x) ? 0.0 : out.low;
    if (has(p->high_switch_closed, x) || has(p->leg_high, x)) {
        out.high = 1.0;
        out.low = 0.0;
    } else if (has(p->low_switch_closed, x) || has(p->leg_low, x)) {
        out.high = 0.0;
        out.low = 1.0;
    }
    out.diode = plant_max(1.0 - out.high - out.low, 0.0);
    return out;
}

/* A leg of which a share of the period belongs to the diodes. With the current's sign they are a
 * voltage; around zero a line in between, which a chopped leg needs to block. */
static void diode_leg(period_t *p, int x, double i)
{
    const inverter_t *inverter = p->inverter;
    const double share = p->shares[x].diode;
    const double middle_v = 0.5 * p->bus_v;
    const double span_v = middle_v + inverter->forward_voltage_v;
    const bool in_zone = fabs(i) < p->zone_a;
    const double sign = i > 0.0 ? 1.0 : -1.0;
    p->legs[x].volts += share * (in_zone ? middle_v : middle_v - sign * span_v);
    p->legs[x].ohms += share * (in_zone ? span_v / p->zone_a : inverter->diode_resistance_ohm);
    p->heat_ohm[x] += in_zone ? 0.0 : share * inverter->diode_resistance_ohm;
    p->diode_share[x] += share * plant_min(fabs(i) / p->zone_a, 1.0);
}

static void connect(period_t *p, const fault_params_t *fault, const phases_state_t *state)
{
    const inverter_t *inverter = p->inverter;
    for (int x = 0; x < PHASES; x++) {
        const shares_t *s = &p->shares[x];
        const double i = state->current_a[x];
        const bool chops = s->high > 0.0 && s->low > 0.0;
        /* Dead time moves a little of the chopped share to the diode that carries the current. */
        const double dead =
            chops ? inverter->dead_share * plant_clamp(i / p->zone_a, -1.0, 1.0) : 0.0;
        p->diode_share[x] = fabs(dead);
        p->legs[x].volts = p->bus_v * (s->high - 0.5 * dead) - inverter->forward_voltage_v * dead;
        p->legs[x].ohms = (s->high + s->low) *
                          (chops ? inverter->pwm_resistance_ohm : inverter->short_resistance_ohm);
        p->heat_ohm[x] = p->legs[x].ohms;
        p->legs[x].open = has(fault->phase_open, x) || p->floats[x];
        if (s->diode > 0.0) {
            diode_leg(p, x, i);
        }
    }
}

/* Legs of diodes alone that are open begin to conduct where their terminal leaves the rails. */
static void let_conduct(period_t *p, const fault_params_t *fault, const phases_t *phases,
                        const phases_state_t *state)
{
    double current_a[PHASES];
    double end_v[PHASES];
    phases_terminals(phases, state, p->legs, current_a, end_v);
    const bool all_float = p->legs[0].open && p->legs[1].open && p->legs[2].open;
    const double lowest_v = plant_min(end_v[0], plant_min(end_v[1], end_v[2]));
    const double highest_v = plant_max(end_v[0], plant_max(end_v[1], end_v[2]));
    const double shift_v = all_float ? 0.5 * (p->bus_v - lowest_v - highest_v) : 0.0;
    for (int x = 0; x < PHASES; x++) {
        if (!p->floats[x] || has(fault->phase_open, x)) {
            continue;
        }
        const double v = end_v[x] + shift_v;
        const double beyond_v = v > p->bus_v + p->inverter->forward_voltage_v ? 1.0
                                : v < -p->inverter->forward_voltage_v         ? -1.0
                                                                              : 0.0;
        if (beyond_v != 0.0) {
            p->floats[x] = false;
            p->legs[x].open = false;
            p->legs[x].ohms = p->heat_ohm[x] = p->inverter->diode_resistance_ohm;
            p->diode_share[x] = 1.0;
            p->legs[x].volts = beyond_v > 0.0 ? p->bus_v + p->inverter->forward_voltage_v
                                              : -p->inverter->forward_voltage_v;
        }
    }
}

/* Two legs of resistance r, their ends joined by R_s: the mean of both voltages, and a difference
 * divided by the joint; what the other leg's current drops comes from the step before. */
static void join(period_t *p, const fault_params_t *fault, const phases_state_t *state)
{
    int x;
    int y;
    joined(fault, &x, &y);
    phases_leg_t *a = &p->legs[x];
    phases_leg_t *b = &p->legs[y];
    const double joint_ohm = fault->phase_short_ohm;
    if (a->open && b->open) {
        const phases_leg_t half = {.volts = 0.5 * p->bus_v, .ohms = 0.5 * joint_ohm};
        *a = half; /* they float together: only what circulates between them flows */
        *b = half;
        p->heat_ohm[x] = p->heat_ohm[y] = half.ohms;
        p->diode_share[x] = p->diode_share[y] = 0.0;
        return;
    }
    const double r = 0.5 * (a->ohms + b->ohms);
    const double k = joint_ohm > 0.0 ? joint_ohm / (joint_ohm + 2.0 * r) : 0.0;
    const double mean_v = 0.5 * (a->volts + b->volts);
    const double apart_v = 0.5 * k * (a->volts - b->volts);
    const double cross_ohm = 0.5 * r * (1.0 - k);
    a->volts = mean_v + apart_v - cross_ohm * state->current_a[y];
    b->volts = mean_v - apart_v - cross_ohm * state->current_a[x];
    a->ohms = b->ohms = 0.5 * r * (1.0 + k);
    p->heat_ohm[x] = p->heat_ohm[y] = a->ohms;
}

static void book(const period_t *p, const phases_t *phases, const phases_flow_t *part,
                 broken_bridge_flow_t *out)
{
    const plant_abc_t charge = {
        .a = part->charge_as[0], .b = part->charge_as[1], .c = part->charge_as[2]};
    const plant_ab_t charge_ab = plant_clarke(charge);
    out->machine.charge_as.alpha += charge_ab.alpha;
    out->machine.charge_as.beta += charge_ab.beta;
    out->machine.iron_j += part->iron_j;
    out->machine.torque_nms += part->torque_nms;
    out->bridge.diode_j += part->open_j;
    for (int x = 0; x < PHASES; x++) {
        const double charge_x = part->charge_as[x];
        const double switching_j = p->shares[x].high > 0.0 && p->shares[x].low > 0.0
                                       ? p->inverter->switching_loss_j_per_as * fabs(charge_x)
                                       : 0.0;
        out->machine.copper_j += phases->machine->resistance_ohm * part->square_a2s[x];
        out->machine.rectified_as += fabs(charge_x);
        out->machine.series_j += p->heat_ohm[x] * part->square_a2s[x];
        out->machine.source_j +=
            p->legs[x].volts * charge_x - (p->legs[x].ohms - p->heat_ohm[x]) * part->square_a2s[x];
        out->bridge.switching_j += switching_j;
        out->bridge.diode_j += p->inverter->forward_voltage_v * p->diode_share[x] * fabs(charge_x);
    }
}

broken_bridge_flow_t broken_bridge_step(const fault_params_t *params, broken_bridge_t *state,
                                        const inverter_t *inverter, const pmsm_t *machine,
                                        pmsm_state_t *rotor, const broken_bridge_command_t *command,
                                        const pmsm_step_t *step)
{
    const double duty[PHASES] = {plant_clamp(command->duty.a, 0.0, 1.0),
                                 plant_clamp(command->duty.b, 0.0, 1.0),
                                 plant_clamp(command->duty.c, 0.0, 1.0)};
    protect(params, state, command, duty, inverter->period_s);
    phases_t phases = phases_at(machine, step->omega_rad_s);
    phases_state_t windings = phases_from(&phases, rotor);
    const double h = step->duration_s / STEPS;
    phases.open_ohm = phases_open_ohm(&phases, &windings, h);
    const double inductance_h =
        plant_min(machine->params.d_inductance_h, machine->params.q_inductance_h);
    period_t p = {
        .inverter = inverter,
        .bus_v = command->bus_voltage_v,
        .zone_a =
            2.0 * h / inductance_h * (0.5 * command->bus_voltage_v + inverter->forward_voltage_v),
    };
    for (int x = 0; x < PHASES; x++) {
        p.shares[x] = shares_of(params, command, state->desaturated, x, duty[x]);
        p.floats[x] = p.shares[x].diode >= 1.0 && fabs(windings.current_a[x]) <= ZERO_A;
    }
    if (params->phase_short >= 1.0) {
        int x;
        int y;
        joined(params, &x, &y);
        const double into_a = windings.current_a[x] + windings.current_a[y];
        p.floats[x] = p.floats[y] =
            p.shares[x].diode >= 1.0 && p.shares[y].diode >= 1.0 &&
            fabs(into_a) <= JOINED_ZERO_A + JOINED_SHARE * fabs(windings.current_a[x]);
    }
    broken_bridge_flow_t out = {.bridge = {.dc_j = 0.0}};
    for (int k = 0; k < STEPS; k++) {
        connect(&p, params, &windings);
        if (params->phase_short < 1.0) {
            let_conduct(&p, params, &phases, &windings);
        } else {
            join(&p, params, &windings);
        }
        phases_flow_t part = {.iron_j = 0.0};
        double before_a[PHASES];
        for (int x = 0; x < PHASES; x++) {
            before_a[x] = windings.current_a[x];
        }
        phases_advance(&phases, &windings, p.legs, h, &part);
        book(&p, &phases, &part, &out);
        for (int x = 0; x < PHASES; x++) {
            const bool ended =
                p.shares[x].diode >= 1.0 && before_a[x] * windings.current_a[x] < 0.0;
            p.floats[x] = p.floats[x] || ended;
        }
    }
    phases_to(&phases, &windings, rotor);
    out.machine.torque_nms += pmsm_turn(machine, rotor, step);
    out.bridge.conduction_j = out.machine.series_j;
    out.bridge.dc_j = out.machine.source_j + out.bridge.switching_j + out.bridge.diode_j;
    return out;
}
