/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/switching.h"

#include <math.h>
#include <stddef.h>

#include "plant/numbers.h"

enum { EDGES = 4 * PHASES, ENDS_MAX = 6, PIECES_OFF = 20 };

static const double SHORTEST_S = 1e-12;
static const double ZERO_A = 1e-9;

/* Who closes a leg. */
typedef enum { LOW, HIGH, DEAD } gate_t;

/* Which way the current of a leg may flow. */
typedef enum { SWITCH_LOW, SWITCH_HIGH, DIODE_LOW, DIODE_HIGH, FLOATS } path_t;

typedef struct {
    const switching_t *bridge;
    phases_t phases;
    phases_state_t state;
    double bus_v;
    gate_t gate[PHASES];
    path_t path[PHASES];
    const switching_watch_t *watch; /* may be NULL */
    switching_flow_t flow;
} period_t;

switching_t switching_model(const inverter_params_t *params, double switch_temperature_c)
{
    const inverter_t averaged = inverter_model(params, switch_temperature_c);
    const switching_t out = {
        .switch_ohm = averaged.short_resistance_ohm,
        .diode_ohm = params->diode_resistance_ohm,
        .forward_v = params->diode_forward_voltage_v,
        .dead_s = params->dead_time_s,
        .turn_on_j_per_a = 0.5 * params->turn_on_loss_j_per_a,
        .turn_off_j_per_a = 0.5 * params->turn_off_loss_j_per_a,
    };
    return out;
}

static phases_leg_t leg_of(const period_t *p, path_t path)
{
    const switching_t *b = p->bridge;
    phases_leg_t out = {.volts = 0.0, .ohms = b->switch_ohm, .open = false};
    switch (path) {
    case SWITCH_LOW:
        break;
    case SWITCH_HIGH:
        out.volts = p->bus_v;
        break;
    case DIODE_LOW:
        out.volts = -b->forward_v;
        out.ohms = b->diode_ohm;
        break;
    case DIODE_HIGH:
        out.volts = p->bus_v + b->forward_v;
        out.ohms = b->diode_ohm;
        break;
    case FLOATS:
        out.open = true;
        break;
    }
    return out;
}

static void connect(const period_t *p, phases_leg_t legs[PHASES])
{
    for (int x = 0; x < PHASES; x++) {
        legs[x] = leg_of(p, p->path[x]);
    }
}

/* Legs without a closed switch: the sign of the current selects the diode; at zero current the
 * voltage does. */
static void choose_diodes(period_t *p)
{
    phases_leg_t legs[PHASES];
    double current_a[PHASES];
    double end_v[PHASES];
    bool floats = false;
    for (int x = 0; x < PHASES; x++) {
        if (p->gate[x] == DEAD && p->path[x] != DIODE_LOW && p->path[x] != DIODE_HIGH) {
            const double i = p->state.current_a[x];
            p->path[x] = i > ZERO_A ? DIODE_LOW : (i < -ZERO_A ? DIODE_HIGH : FLOATS);
        }
        floats = floats || p->path[x] == FLOATS;
    }
    if (!floats) {
        return;
    }
    connect(p, legs);
    phases_terminals(&p->phases, &p->state, legs, current_a, end_v);
    /* Where no leg conducts, the star point settles so that the span of the windings' voltages
     * lies between the rails, as long as it fits: only then does a pair of diodes begin to conduct.
     */
    const bool all_float = legs[0].open && legs[1].open && legs[2].open;
    const double lowest_v = plant_min(end_v[0], plant_min(end_v[1], end_v[2]));
    const double highest_v = plant_max(end_v[0], plant_max(end_v[1], end_v[2]));
    const double shift_v = all_float ? 0.5 * (p->bus_v - lowest_v - highest_v) : 0.0;
    for (int x = 0; x < PHASES; x++) {
        if (p->path[x] == FLOATS) {
            const double v = end_v[x] + shift_v;
            if (v > p->bus_v + p->bridge->forward_v) {
                p->path[x] = DIODE_HIGH;
            } else if (v < -p->bridge->forward_v) {
                p->path[x] = DIODE_LOW;
            }
        }
    }
}

static void book(period_t *p, const phases_leg_t legs[PHASES], const phases_flow_t *part)
{
    pmsm_flow_t *m = &p->flow.machine;
    inverter_flow_t *b = &p->flow.bridge;
    const plant_abc_t charge = {
        .a = part->charge_as[0], .b = part->charge_as[1], .c = part->charge_as[2]};
    const plant_ab_t charge_ab = plant_clarke(charge);
    m->charge_as.alpha += charge_ab.alpha;
    m->charge_as.beta += charge_ab.beta;
    m->iron_j += part->iron_j;
    m->torque_nms += part->torque_nms;
    b->diode_j += part->open_j;
    for (int x = 0; x < PHASES; x++) {
        m->copper_j += p->phases.machine->resistance_ohm * part->square_a2s[x];
        m->rectified_as += fabs(part->charge_as[x]);
        m->series_j += legs[x].ohms * part->square_a2s[x];
        if (p->path[x] == SWITCH_HIGH || p->path[x] == DIODE_HIGH) {
            b->dc_j += p->bus_v * part->charge_as[x];
        }
        if (p->path[x] == DIODE_LOW || p->path[x] == DIODE_HIGH) {
            b->diode_j += p->bridge->forward_v * fabs(part->charge_as[x]);
        }
    }
}

/* Share of the step after which the first diode's current has ended, 1 when none has; *which: its
 * leg. */
static double first_end(const period_t *p, const double after_a[PHASES], int *which)
{
    const double *before_a = p->state.current_a;
    double out = 1.0;
    for (int x = 0; x < PHASES; x++) {
        const bool ended = (p->path[x] == DIODE_LOW && after_a[x] < 0.0) ||
                           (p->path[x] == DIODE_HIGH && after_a[x] > 0.0);
        if (ended) {
            const double span = before_a[x] - after_a[x];
            const double share = span != 0.0 ? plant_clamp(before_a[x] / span, 0.0, 1.0) : 0.0;
            if (share < out) {
                out = share;
                *which = x;
            }
        }
    }
    return out;
}

/* The shunt of a leg carries what its low side conducts, as a mean of the time. */
static void show(const period_t *p, const double before_a[PHASES], double passed_s)
{
    if (p->watch == NULL || p->watch->shunts == NULL) {
        return;
    }
    for (int x = 0; x < PHASES; x++) {
        const bool low = p->path[x] == SWITCH_LOW || p->path[x] == DIODE_LOW;
        const double mean_a = low ? 0.5 * (before_a[x] + p->state.current_a[x]) : 0.0;
        shunts_follow(p->watch->shunts, x, mean_a, passed_s, p->watch->settling_s);
    }
}

/* A time without edges in which no leg conducts; false: one does, or begins to. */
static bool coast(period_t *p, double duration_s)
{
    phases_flow_t part = {.iron_j = 0.0};
    for (int x = 0; x < PHASES; x++) {
        if (p->gate[x] != DEAD || p->state.current_a[x] != 0.0) {
            return false;
        }
    }
    if (!phases_coast(&p->phases, &p->state, p->bus_v, duration_s, &part)) {
        return false;
    }
    const phases_leg_t none[PHASES] = {{.open = true}, {.open = true}, {.open = true}};
    const double no_current_a[PHASES] = {0.0, 0.0, 0.0};
    book(p, none, &part);
    show(p, no_current_a, duration_s);
    return true;
}

/* A time without edges; diodes may stop and begin to conduct. */
static void pass(period_t *p, double duration_s)
{
    double left_s = duration_s;
    int ends = 0;
    while (left_s > SHORTEST_S && !coast(p, left_s)) {
        choose_diodes(p);
        phases_leg_t legs[PHASES];
        connect(p, legs);
        const bool open = legs[0].open || legs[1].open || legs[2].open;
        double passed_s = open ? plant_min(left_s, PHASES_OPEN_STEP_S) : left_s;
        phases_state_t trial = p->state;
        phases_flow_t part = {.iron_j = 0.0};
        phases_advance(&p->phases, &trial, legs, passed_s, &part);
        int ended = 0;
        const double share = ends < ENDS_MAX ? first_end(p, trial.current_a, &ended) : 1.0;
        if (share < 1.0) {
            passed_s *= share;
            ends++;
            const phases_flow_t empty = {.iron_j = 0.0};
            part = empty;
            trial = p->state;
            phases_advance(&p->phases, &trial, legs, passed_s, &part);
        }
        const double before_a[PHASES] = {p->state.current_a[0], p->state.current_a[1],
                                         p->state.current_a[2]};
        p->state = trial;
        book(p, legs, &part);
        show(p, before_a, passed_s);
        if (share < 1.0) {
            p->path[ended] = FLOATS;
            p->state.current_a[ended] = 0.0;
        }
        left_s -= passed_s;
    }
}

/* Switching loss occurs if the switch starts or ends to conduct, not if its diode conducts. */
static void operate(period_t *p, int x, gate_t gate)
{
    const gate_t before = p->gate[x];
    if (gate == before) {
        return;
    }
    const double i = p->state.current_a[x];
    double loss_j = 0.0;
    if (before == HIGH || before == LOW) {
        const double carried_a = before == HIGH ? i : -i;
        loss_j += p->bridge->turn_off_j_per_a * plant_max(carried_a, 0.0);
    }
    if (gate == HIGH || gate == LOW) {
        const double taken_a = gate == HIGH ? i : -i;
        loss_j += p->bridge->turn_on_j_per_a * plant_max(taken_a, 0.0);
        p->path[x] = gate == HIGH ? SWITCH_HIGH : SWITCH_LOW;
    } else {
        p->path[x] = FLOATS; /* choose_diodes() sees to it */
    }
    p->flow.bridge.switching_j += loss_j;
    p->flow.bridge.dc_j += loss_j;
    p->gate[x] = gate;
}

/* Edges of a leg's command. */
typedef struct {
    double rise_s, fall_s;
} leg_times_t;

static gate_t gate_at(const leg_times_t *t, double dead_s, double time_s)
{
    if (time_s < t->rise_s || time_s >= t->fall_s + dead_s) {
        return LOW;
    }
    return time_s >= t->rise_s + dead_s && time_s < t->fall_s ? HIGH : DEAD;
}

static int sorted_edges(const leg_times_t times[PHASES], double dead_s, double period_s,
                        double edges_s[EDGES])
{
    int count = 0;
    for (int x = 0; x < PHASES; x++) {
        const double own[] = {times[x].rise_s, times[x].rise_s + dead_s, times[x].fall_s,
                              times[x].fall_s + dead_s};
        for (int k = 0; k < 4; k++) {
            if (own[k] <= 0.0 || own[k] >= period_s) {
                continue;
            }
            int to = count++;
            while (to > 0 && edges_s[to - 1] > own[k]) {
                edges_s[to] = edges_s[to - 1];
                to--;
            }
            edges_s[to] = own[k];
        }
    }
    return count;
}

static period_t begin(const switching_t *bridge, const pmsm_t *machine, const pmsm_state_t *rotor,
                      double bus_voltage_v, const pmsm_step_t *step, gate_t gate)
{
    period_t p = {.bridge = bridge,
                  .phases = phases_at(machine, step->omega_rad_s),
                  .bus_v = bus_voltage_v,
                  .watch = NULL};
    p.state = phases_from(&p.phases, rotor);
    p.phases.open_ohm = phases_open_ohm(&p.phases, &p.state, PHASES_OPEN_STEP_S);
    for (int x = 0; x < PHASES; x++) {
        p.gate[x] = gate;
        p.path[x] = gate == DEAD ? FLOATS : SWITCH_LOW;
    }
    return p;
}

static double duration_of(const switching_watch_t *watch, const pmsm_step_t *step)
{
    return watch != NULL && watch->until_s > 0.0 ? plant_min(watch->until_s, step->duration_s)
                                                 : step->duration_s;
}

static switching_flow_t end(period_t *p, pmsm_state_t *rotor, const pmsm_step_t *step)
{
    phases_to(&p->phases, &p->state, rotor);
    p->flow.machine.torque_nms += pmsm_turn(p->phases.machine, rotor, step);
    p->flow.bridge.conduction_j = p->flow.machine.series_j;
    p->flow.machine.source_j =
        p->flow.bridge.dc_j - p->flow.bridge.switching_j - p->flow.bridge.diode_j;
    return p->flow;
}

switching_flow_t switching_pwm(const switching_t *bridge, const pmsm_t *machine,
                               pmsm_state_t *rotor, plant_abc_t duty, double bus_voltage_v,
                               const pmsm_step_t *step, const switching_watch_t *watch)
{
    const double period_s = step->duration_s;
    const double duties[PHASES] = {duty.a, duty.b, duty.c};
    period_t p = begin(bridge, machine, rotor, bus_voltage_v, step, LOW);
    p.watch = watch;
    const double until_s = duration_of(watch, step);
    leg_times_t times[PHASES];
    for (int x = 0; x < PHASES; x++) {
        const double d = plant_clamp(duties[x], 0.0, 1.0);
        times[x].rise_s = d >= 1.0 ? -period_s : 0.5 * period_s * (1.0 - d);
        times[x].fall_s = d >= 1.0 ? 2.0 * period_s : 0.5 * period_s * (1.0 + d);
        if (d <= 0.0) {
            times[x].rise_s = 2.0 * period_s;
            times[x].fall_s = 3.0 * period_s;
        }
        p.gate[x] = d >= 1.0 ? HIGH : LOW;
        p.path[x] = d >= 1.0 ? SWITCH_HIGH : SWITCH_LOW;
    }
    double edges_s[EDGES + 1];
    const int count = sorted_edges(times, bridge->dead_s, period_s, edges_s);
    edges_s[count] = period_s;
    double from_s = 0.0;
    for (int k = 0; k <= count && from_s < until_s; k++) {
        const double middle_s = 0.5 * (from_s + edges_s[k]);
        for (int x = 0; x < PHASES; x++) {
            operate(&p, x, gate_at(&times[x], bridge->dead_s, middle_s));
        }
        pass(&p, plant_min(edges_s[k], until_s) - from_s);
        from_s = edges_s[k];
    }
    return end(&p, rotor, step);
}

switching_flow_t switching_off(const switching_t *bridge, const pmsm_t *machine,
                               pmsm_state_t *rotor, double bus_voltage_v, const pmsm_step_t *step,
                               const switching_watch_t *watch)
{
    period_t p = begin(bridge, machine, rotor, bus_voltage_v, step, DEAD);
    p.watch = watch;
    const double duration_s = duration_of(watch, step);
    const int pieces = coast(&p, duration_s) ? 0 : PIECES_OFF;
    for (int k = 0; k < pieces; k++) {
        pass(&p, duration_s / PIECES_OFF);
    }
    return end(&p, rotor, step);
}

switching_flow_t switching_short(const switching_t *bridge, const pmsm_t *machine,
                                 pmsm_state_t *rotor, double bus_voltage_v, const pmsm_step_t *step,
                                 const switching_watch_t *watch)
{
    period_t p = begin(bridge, machine, rotor, bus_voltage_v, step, LOW);
    p.watch = watch;
    const double half_s = 0.5 * duration_of(watch, step);
    pass(&p, half_s);
    pass(&p, half_s);
    return end(&p, rotor, step);
}
