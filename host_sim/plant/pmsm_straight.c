/* SPDX-License-Identifier: Apache-2.0 */
/* The machine of pmsm.h where its iron does not saturate: a set of four stages, and what an
 * opposition makes of it. */
#include <math.h>
#include <stdbool.h>

#include "pmsm_stages.h"

/* Signs of the phases' currents. */
static inline plant_abc_t signs_of(plant_abc_t i)
{
    const plant_abc_t out = {
        .a = copysign(1.0, i.a), .b = copysign(1.0, i.b), .c = copysign(1.0, i.c)};
    return out;
}

/* By how much the phase that is nearest to it is still on the side of its sign. */
static inline double distance_a(plant_abc_t sign, plant_abc_t i)
{
    return plant_min(plant_min(sign.a * i.a, sign.b * i.b), sign.c * i.c);
}

/* The current in the wires with the i_t that a set has come to: its last stage's is one order less
 * exact, but belongs to the balance. */
static inline plant_dq_t terminal_at(const equations_t *eq, plant_dq_t u, plant_dq_t i_t)
{
    return along(i_t, eq->conductance_s, along(u, -eq->resistance_ohm, i_t));
}

/* The circuit that a set without a turning opposition is integrated in, and where its phases must
 * stay. */
typedef struct {
    const equations_t *eq;
    plant_ab_t u;        /* V */
    double opposition_v; /* stands still, against the sign of each phase's current */
    double beyond_a;     /* all phases stay beyond it, on the sides where they were */
} held_t;

/* One set of four stages in which the opposition's voltage stands still. If the phases do not stay
 * where they must, nothing is done, and the answer is false. */
static inline bool advance(const held_t *held, pmsm_state_t *state, double h,
                           plant_phasor_t half_turn, pmsm_flow_t *flow)
{
    const equations_t *eq = held->eq;
    const plant_abc_t before = plant_inverse_clarke(state->terminal);
    const plant_abc_t sign = signs_of(before);
    const bool is_opposed = held->opposition_v != 0.0;
    if (is_opposed && distance_a(sign, before) <= held->beyond_a) {
        return false;
    }
    const plant_ab_t share = plant_clarke(sign);
    const plant_ab_t u_ab = {.alpha = held->u.alpha - held->opposition_v * share.alpha,
                             .beta = held->u.beta - held->opposition_v * share.beta};
    const stage_axes_t axes = stage_axes(state->axis, half_turn);
    const plant_dq_t u_start = plant_park(u_ab, axes.start);
    const plant_dq_t u_middle = plant_park(u_ab, axes.middle);
    const plant_dq_t u_end = plant_park(u_ab, axes.end);

    const plant_dq_t i_t = state->i_t;
    const stage_t s1 = straight_stage_at(eq, u_start, i_t);
    const stage_t s2 = straight_stage_at(eq, u_middle, along(i_t, 0.5 * h, s1.slope));
    const stage_t s3 = straight_stage_at(eq, u_middle, along(i_t, 0.5 * h, s2.slope));
    const stage_t s4 = straight_stage_at(eq, u_end, along(i_t, h, s3.slope));
    const wires_t wires = wires_of(&s1, &s2, &s3, &s4, &axes);
    if (is_opposed && distance_a(sign, plant_inverse_clarke(wires.end)) <= held->beyond_a) {
        return false;
    }
    const double sixth = h / 6.0;
    const plant_dq_t end = after(i_t, sixth, &s1, &s2, &s3, &s4);
    state->i_t = end;
    const plant_ab_t charge_as = charge_of(&wires, sixth);
    /* No phase changes its sign: share . i is |i_a| + |i_b| + |i_c|. */
    const double rectified_as =
        is_opposed ? 1.5 * (share.alpha * charge_as.alpha + share.beta * charge_as.beta)
                   : rectified_of(&wires, sixth);
    book_charge(charge_as, flow);
    flow->rectified_as += rectified_as;
    flow->opposed_as += rectified_as;
    state->axis = axes.end;
    state->terminal = plant_inverse_park(terminal_at(eq, u_end, end), axes.end);
    book_heat_and_torque(&s1, &s2, &s3, &s4, sixth, flow);
    return true;
}

static inline double largest_a(plant_ab_t current)
{
    const plant_abc_t i = plant_inverse_clarke(current);
    return plant_max(plant_max(fabs(i.a), fabs(i.b)), fabs(i.c));
}

/*
 * Where all phases are and stay inside the zone, as they do at standstill, the opposition is k =
 * volts/zone a phase times the current i0 = share i_t + G u that would flow without it, so the
 * circuit is the same with other numbers,
 *
 *     e = u - k i0 - R i_t = (1 - k G) u - (R + k share) i_t         i = i_t + G e = (1 - k G) i0
 */
typedef struct {
    equations_t eq;
    double left;    /* 1 - k G */
    double limit_a; /* of i, where i0 is at the zone's end */
} inside_t;

static inside_t inside_of(const equations_t *eq, const pmsm_opposition_t *opposition)
{
    const double k_ohm = opposition->volts / opposition->zone_a;
    const double left = 1.0 - k_ohm * eq->conductance_s;
    inside_t out = {.eq = *eq, .left = left, .limit_a = left * opposition->zone_a};
    out.eq.resistance_ohm += k_ohm * eq->share;
    return out;
}

/* opposed_share() as one function: structs of two numbers travel in registers, inlined five times
 * it would not be. */
static plant_dq_t share_at(double per_zone, plant_dq_t current, plant_phasor_t axis)
{
    return opposed_share(per_zone, current, axis);
}

/* A set where a phase's current passes through the opposition's zone. */
static void advance_in_zone(const equations_t *eq, const pmsm_opposition_t *opposition,
                            pmsm_state_t *state, plant_ab_t u, double h, plant_phasor_t half_turn,
                            pmsm_flow_t *flow)
{
    const double per_zone = 1.0 / opposition->zone_a;
    const double against_v = -opposition->volts;
    const stage_axes_t axes = stage_axes(state->axis, half_turn);
    const plant_dq_t u_start = plant_park(u, axes.start);
    const plant_dq_t u_middle = plant_park(u, axes.middle);
    const plant_dq_t u_end = plant_park(u, axes.end);

    const plant_dq_t i1 = state->i_t;
    const plant_dq_t share1 = share_at(per_zone, terminal_at(eq, u_start, i1), axes.start);
    const stage_t s1 = straight_stage_at(eq, along(u_start, against_v, share1), i1);
    const plant_dq_t i2 = along(i1, 0.5 * h, s1.slope);
    const plant_dq_t share2 = share_at(per_zone, terminal_at(eq, u_middle, i2), axes.middle);
    const stage_t s2 = straight_stage_at(eq, along(u_middle, against_v, share2), i2);
    const plant_dq_t i3 = along(i1, 0.5 * h, s2.slope);
    const plant_dq_t share3 = share_at(per_zone, terminal_at(eq, u_middle, i3), axes.middle);
    const stage_t s3 = straight_stage_at(eq, along(u_middle, against_v, share3), i3);
    const plant_dq_t i4 = along(i1, h, s3.slope);
    const plant_dq_t share4 = share_at(per_zone, terminal_at(eq, u_end, i4), axes.end);
    const stage_t s4 = straight_stage_at(eq, along(u_end, against_v, share4), i4);

    const double sixth = h / 6.0;
    const plant_dq_t end = after(i1, sixth, &s1, &s2, &s3, &s4);
    const plant_dq_t share = share_at(per_zone, terminal_at(eq, u_end, end), axes.end);
    const wires_t wires = wires_of(&s1, &s2, &s3, &s4, &axes);
    state->i_t = end;
    state->axis = axes.end;
    state->terminal =
        plant_inverse_park(terminal_at(eq, along(u_end, against_v, share), end), axes.end);
    book_charge(charge_of(&wires, sixth), flow);
    flow->rectified_as += rectified_of(&wires, sixth);
    flow->opposed_as +=
        sixth * simpson(opposed_a(share1, s1.terminal), opposed_a(share2, s2.terminal),
                        opposed_a(share3, s3.terminal), opposed_a(share4, s4.terminal));
    book_heat_and_torque(&s1, &s2, &s3, &s4, sixth, flow);
}

void pmsm_straight_advance(const equations_t *eq, const pmsm_opposition_t *opposition,
                           pmsm_state_t *state, plant_ab_t u, double h, plant_phasor_t half_turn,
                           pmsm_flow_t *flow)
{
    held_t held = {
        .eq = eq, .u = u, .opposition_v = opposition->volts, .beyond_a = opposition->zone_a};
    inside_t inside;
    pmsm_state_t state_before;
    pmsm_flow_t flow_before;
    bool is_inside = false;
    if (held.opposition_v != 0.0 && largest_a(state->terminal) <= 0.5 * held.beyond_a) {
        inside = inside_of(eq, opposition);
        is_inside = largest_a(state->terminal) <= 0.5 * inside.limit_a;
    }
    if (is_inside) {
        held.eq = &inside.eq;
        held.u.alpha *= inside.left;
        held.u.beta *= inside.left;
        held.opposition_v = 0.0;
        state_before = *state;
        flow_before = *flow;
    }
    /* One call for both, so that it is inlined: on its own it takes a quarter longer. */
    bool is_done = advance(&held, state, h, half_turn, flow);
    if (is_inside) {
        is_done = largest_a(state->terminal) <= inside.limit_a;
        if (is_done) { /* share . i = i^2 / limit */
            flow->opposed_as = flow_before.opposed_as +
                               1.5 * (flow->copper_j - flow_before.copper_j) / inside.limit_a;
        } else {
            *state = state_before;
            *flow = flow_before;
        }
    }
    if (!is_done) {
        advance_in_zone(eq, opposition, state, u, h, half_turn, flow);
    }
}
