/* SPDX-License-Identifier: Apache-2.0 */
/* The machine of pmsm.h where its iron does not saturate: a set of four stages, and what an
 * opposition makes of it. */
#include <math.h>
#include <stdbool.h>

#include "pmsm_linear.h"

/* The current in the wires with the i_t that a set has come to: its last stage's is one order less
 * exact, but belongs to the balance. */
static inline plant_dq_t terminal_at(const equations_t *eq, plant_dq_t u, plant_dq_t i_t)
{
    return along(i_t, eq->conductance_s, along(u, -eq->resistance_ohm, i_t));
}

static inline double largest_a(plant_abc_t i)
{
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

    /* Energies by Simpson's rule over the states of the step, its middle by Hermite's cubic: where
     * the zone's slope acts like a large resistance, the stages are too far from them. */
    const double sixth = h * (1.0 / 6.0);
    const plant_dq_t end = after(i1, sixth, &s1, &s2, &s3, &s4);
    const plant_dq_t share_end = share_at(per_zone, terminal_at(eq, u_end, end), axes.end);
    const stage_t last = straight_stage_at(eq, along(u_end, against_v, share_end), end);
    const plant_dq_t middle = {.d = 0.5 * (i1.d + end.d) + 0.125 * h * (s1.slope.d - last.slope.d),
                               .q = 0.5 * (i1.q + end.q) + 0.125 * h * (s1.slope.q - last.slope.q)};
    const plant_dq_t share_middle =
        share_at(per_zone, terminal_at(eq, u_middle, middle), axes.middle);
    const stage_t half = straight_stage_at(eq, along(u_middle, against_v, share_middle), middle);
    const wires_t wires = wires_of(&s1, &half, &half, &last, &axes);
    state->i_t = end;
    state->axis = axes.end;
    state->terminal = wires.end;
    book_charge(charge_of(&wires, sixth), flow);
    flow->rectified_as += rectified_of(&wires, sixth);
    flow->opposed_as +=
        integral(sixth, opposed_a(share1, s1.terminal), opposed_a(share_middle, half.terminal),
                 opposed_a(share_end, last.terminal));
    book_heat_and_torque(&s1, &half, &half, &last, sixth, flow);
}

static void add(pmsm_flow_t *flow, const pmsm_flow_t *part)
{
    book_charge(part->charge_as, flow);
    flow->rectified_as += part->rectified_as;
    flow->opposed_as += part->opposed_as;
    flow->copper_j += part->copper_j;
    flow->iron_j += part->iron_j;
    flow->torque_nms += part->torque_nms;
}

/* The zone is as wide as the current that its voltage moves in a step: within it currents decay by
 * half or more, which Simpson's rule resolves in two parts. */
static bool advance_inside(const equations_t *eq, const pmsm_opposition_t *opposition,
                           const linear_t *outside, pmsm_state_t *state, double h,
                           plant_phasor_t half_turn, pmsm_flow_t *flow)
{
    enum { PARTS = 2 };
    const inside_t inside = inside_of(eq, opposition);
    if (largest_a(outside->before_a) > 0.5 * inside.limit_a) {
        return false;
    }
    const linear_t linear = {
        .eq = &inside.eq,
        .u = {.alpha = inside.left * outside->u.alpha, .beta = inside.left * outside->u.beta}};
    const plant_phasor_t quarter_turn = plant_half_angle(half_turn);
    pmsm_state_t after_parts = *state;
    pmsm_flow_t sum = {.charge_as = {0.0, 0.0}};
    for (int k = 0; k < (int)PARTS; k++) {
        pmsm_flow_t part;
        (void)linear_advance(&linear, &after_parts, h / PARTS, quarter_turn, &part);
        add(&sum, &part);
    }
    if (largest_a(plant_inverse_clarke(after_parts.terminal)) > inside.limit_a) {
        return false;
    }
    *state = after_parts;
    sum.opposed_as = 1.5 * sum.copper_j / inside.limit_a; /* share . i = i^2 / limit */
    add(flow, &sum);
    return true;
}

void pmsm_straight_advance(const equations_t *eq, const pmsm_opposition_t *opposition,
                           pmsm_state_t *state, plant_ab_t u, double h, plant_phasor_t half_turn,
                           pmsm_flow_t *flow)
{
    const linear_t linear = linear_of(eq, opposition, state, u);
    const bool is_outside = linear_holds(&linear);
    pmsm_flow_t part;
    if (is_outside && linear_advance(&linear, state, h, half_turn, &part)) {
        add(flow, &part);
    } else if (is_outside || !advance_inside(eq, opposition, &linear, state, h, half_turn, flow)) {
        advance_in_zone(eq, opposition, state, u, h, half_turn, flow);
    }
}
