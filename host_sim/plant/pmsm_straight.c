/* SPDX-License-Identifier: Apache-2.0 */
/* The machine of pmsm.h where its iron does not saturate: a set of four stages, and what an
 * opposition makes of it. */
#include <math.h>
#include <stdbool.h>

#include "pmsm_linear.h"

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

/* The directions of the phases' axes in the rotor's frame, and the voltage there, at one instant.
 */
typedef struct {
    plant_dq_t a, b, c;
    plant_dq_t u;       /* V */
    plant_dq_t at_once; /* current of u through the iron branch, as a share of the zone */
} instant_t;

/* What does not change within a set. */
typedef struct {
    const equations_t *eq;
    double against_v;           /* opposition of a whole share, negative */
    double own_per_zone;        /* 1 - G R, for a share of the zone */
    plant_dq_t against_a_per_s; /* the same as a slope of i_t */
} zone_t;

static zone_t zone_of(const equations_t *eq, const pmsm_opposition_t *opposition)
{
    const double against_v = -opposition->volts;
    const zone_t out = {
        .eq = eq,
        .against_v = against_v,
        .own_per_zone = (1.0 - eq->conductance_s * eq->resistance_ohm) / opposition->zone_a,
        .against_a_per_s = {.d = eq->share * against_v * eq->machine->magnetics.per_l_d,
                            .q = eq->share * against_v * eq->machine->magnetics.per_l_q},
    };
    return out;
}

static inline instant_t instant_of(const equations_t *eq, double per_zone, plant_ab_t u,
                                   plant_phasor_t axis)
{
    const plant_ab_t axis_b = {.alpha = -0.5, .beta = 0.5 * PLANT_SQRT3};
    const plant_dq_t a = {.d = axis.cos, .q = -axis.sin};
    const plant_dq_t b = plant_park(axis_b, axis);
    const plant_dq_t u_dq = plant_park(u, axis);
    const double at_once = eq->conductance_s * per_zone;
    const instant_t out = {
        .a = a,
        .b = b,
        .c = {.d = -a.d - b.d, .q = -a.q - b.q},
        .u = u_dq,
        .at_once = {.d = at_once * u_dq.d, .q = at_once * u_dq.q},
    };
    return out;
}

static inline double dot(plant_dq_t x, plant_dq_t y)
{
    return x.d * y.d + x.q * y.q;
}

/* opposed_share() of the current that would flow without opposition. Every stage waits for this one
 * of the stage before, so it takes few operations after another. */
static inline plant_dq_t share_at(const zone_t *zone, const instant_t *at, plant_dq_t i_t)
{
    const plant_dq_t zones = along(at->at_once, zone->own_per_zone, i_t);
    const double a = 2.0 / 3.0 * plant_clamp(dot(at->a, zones), -1.0, 1.0);
    const double b = 2.0 / 3.0 * plant_clamp(dot(at->b, zones), -1.0, 1.0);
    const double c = 2.0 / 3.0 * plant_clamp(dot(at->c, zones), -1.0, 1.0);
    const plant_dq_t out = {.d = a * at->a.d + b * at->b.d + c * at->c.d,
                            .q = a * at->a.q + b * at->b.q + c * at->c.q};
    return out;
}

/* di_t/dt */
static inline plant_dq_t slope_at(const zone_t *zone, const instant_t *at, plant_dq_t i_t,
                                  plant_dq_t share)
{
    const plant_dq_t free = straight_stage_at(zone->eq, at->u, i_t).slope;
    const plant_dq_t out = {.d = free.d + zone->against_a_per_s.d * share.d,
                            .q = free.q + zone->against_a_per_s.q * share.q};
    return out;
}

static inline stage_t stage_of(const zone_t *zone, const instant_t *at, plant_dq_t i_t,
                               plant_dq_t share)
{
    return straight_stage_at(zone->eq, along(at->u, zone->against_v, share), i_t);
}

/* A set where a phase's current passes through the opposition's zone. */
static void advance_in_zone(const equations_t *eq, const pmsm_opposition_t *opposition,
                            pmsm_state_t *state, plant_ab_t u, double h, plant_phasor_t half_turn,
                            pmsm_flow_t *flow)
{
    const zone_t zone = zone_of(eq, opposition);
    const double per_zone = 1.0 / opposition->zone_a;
    const stage_axes_t axes = stage_axes(state->axis, half_turn);
    const instant_t at_start = instant_of(eq, per_zone, u, axes.start);
    const instant_t at_middle = instant_of(eq, per_zone, u, axes.middle);
    const instant_t at_end = instant_of(eq, per_zone, u, axes.end);

    const plant_dq_t i1 = state->i_t;
    const plant_dq_t share1 = share_at(&zone, &at_start, i1);
    const plant_dq_t slope1 = slope_at(&zone, &at_start, i1, share1);
    const plant_dq_t i2 = along(i1, 0.5 * h, slope1);
    const plant_dq_t slope2 = slope_at(&zone, &at_middle, i2, share_at(&zone, &at_middle, i2));
    const plant_dq_t i3 = along(i1, 0.5 * h, slope2);
    const plant_dq_t slope3 = slope_at(&zone, &at_middle, i3, share_at(&zone, &at_middle, i3));
    const plant_dq_t i4 = along(i1, h, slope3);
    const plant_dq_t slope4 = slope_at(&zone, &at_end, i4, share_at(&zone, &at_end, i4));

    /* Energies by Simpson's rule over the states of the step, its middle by Hermite's cubic: where
     * the zone's slope acts like a large resistance, the stages are too far from them. */
    const double sixth = h * (1.0 / 6.0);
    const plant_dq_t end = {.d = i1.d + sixth * simpson(slope1.d, slope2.d, slope3.d, slope4.d),
                            .q = i1.q + sixth * simpson(slope1.q, slope2.q, slope3.q, slope4.q)};
    const plant_dq_t share_end = share_at(&zone, &at_end, end);
    const plant_dq_t slope_end = slope_at(&zone, &at_end, end, share_end);
    const plant_dq_t middle = {.d = 0.5 * (i1.d + end.d) + 0.125 * h * (slope1.d - slope_end.d),
                               .q = 0.5 * (i1.q + end.q) + 0.125 * h * (slope1.q - slope_end.q)};
    const plant_dq_t share_middle = share_at(&zone, &at_middle, middle);
    const stage_t first = stage_of(&zone, &at_start, i1, share1);
    const stage_t half = stage_of(&zone, &at_middle, middle, share_middle);
    const stage_t last = stage_of(&zone, &at_end, end, share_end);
    const wires_t wires = wires_of(&first, &half, &half, &last, &axes);
    state->i_t = end;
    state->axis = axes.end;
    state->terminal = wires.end;
    book_charge(charge_of(&wires, sixth), flow);
    flow->rectified_as += rectified_of(&wires, sixth);
    flow->opposed_as +=
        integral(sixth, opposed_a(share1, first.terminal), opposed_a(share_middle, half.terminal),
                 opposed_a(share_end, last.terminal));
    book_heat_and_torque(&first, &half, &half, &last, sixth, flow);
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
                           bool try_linear, pmsm_flow_t *flow)
{
    const linear_t linear = linear_of(eq, opposition, state, u);
    const bool is_outside = linear_holds(&linear);
    pmsm_flow_t part;
    if (try_linear && is_outside && linear_advance(&linear, state, h, half_turn, &part)) {
        add(flow, &part);
    } else if (is_outside || !advance_inside(eq, opposition, &linear, state, h, half_turn, flow)) {
        advance_in_zone(eq, opposition, state, u, h, half_turn, flow);
    }
}
