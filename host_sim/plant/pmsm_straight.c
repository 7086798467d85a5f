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

/* i_t in the middle and at the end of a step, in both frames. */
typedef struct {
    plant_ab_t middle_ab, end_ab;
    plant_dq_t middle, end;
} solution_t;

/* (1 - exp(-z)) / z for 0 <= z <= 0.5: error below 1e-12 to z = 0.1, 3e-7 at 0.5. */
static inline double mean_decay(double z)
{
    return 1.0 + z * (-1.0 / 2 +
                      z * (1.0 / 6 + z * (-1.0 / 24 +
                                          z * (1.0 / 120 + z * (-1.0 / 720 + z * (1.0 / 5040))))));
}

static inline plant_ab_t half_step(double decay, plant_ab_t from, plant_ab_t drive,
                                   plant_phasor_t axis, plant_phasor_t emf)
{
    const plant_phasor_t turned = plant_turned(axis, emf);
    const plant_ab_t out = {.alpha = decay * from.alpha + drive.alpha - turned.cos,
                            .beta = decay * from.beta + drive.beta - turned.sin};
    return out;
}

/*
 * The exact solution of a machine with L_d = L_q = L while the voltage is constant and the rotor
 * turns, half a step after another. In the stator's frame, with z = share R/L h/2 and y = w h/2,
 * half a step leaves
 *
 *     i_t exp(-z)
 *         + u share/L h/2 (1 - exp(-z))/z
 *         - psi/L exp(j theta) j y (exp(j y) - exp(-z))/(z + j y)
 */
static inline solution_t solve_round(const equations_t *eq, plant_ab_t start, plant_ab_t u,
                                     double h, plant_phasor_t half_turn, const stage_axes_t *axes)
{
    const double gain = 0.5 * h * eq->share * eq->machine->magnetics.per_l_d;
    const double z = gain * eq->resistance_ohm;
    const double y = 0.5 * h * eq->w;
    const double mean = mean_decay(z);
    const double decay = 1.0 - z * mean;
    const double square = z * z + y * y;
    const double per_square =
        square > 0.0 ? eq->machine->flux_wb * eq->machine->magnetics.per_l_d / square : 0.0;
    const double yy = y * y * per_square;
    const double yz = y * z * per_square;
    const double x = half_turn.cos - decay;
    const plant_phasor_t emf = {.cos = yy * x - yz * half_turn.sin,
                                .sin = yy * half_turn.sin + yz * x};
    const plant_ab_t drive = {.alpha = gain * mean * u.alpha, .beta = gain * mean * u.beta};
    solution_t out;
    out.middle_ab = half_step(decay, start, drive, axes->start, emf);
    out.end_ab = half_step(decay, out.middle_ab, drive, axes->middle, emf);
    out.middle = plant_park(out.middle_ab, axes->middle);
    out.end = plant_park(out.end_ab, axes->end);
    return out;
}

/*
 * Where L_d and L_q differ: with the fluxes y = L i_t and the voltage f = share u, which turns
 * backwards in the rotor's frame,
 *
 *     y_d' = -share R/L_d y_d + w y_q + f_d               f_d' =  w f_q
 *     y_q' = -share R/L_q y_q - w y_d + f_q - w psi       f_q' = -w f_d
 *
 * are linear, so every derivative follows from the one before, and the series in time is cut where
 * its terms no longer count: below 1e-12 of the current at the end for w h = 0.1, the largest turn
 * of a set, and 1e-9 in the middle, which only the energies are worked out from.
 */
static inline solution_t solve_salient(const equations_t *eq, plant_dq_t start, plant_ab_t u,
                                       double h, const stage_axes_t *axes)
{
    static const double END[] = {1.0, 1.0 / 2, 1.0 / 6, 1.0 / 24, 1.0 / 120, 1.0 / 720, 1.0 / 5040};
    static const double MIDDLE[] = {1.0 / 2, 1.0 / 8, 1.0 / 48, 1.0 / 384, 1.0 / 3840};
    enum {
        AXES = 2,
        END_TERMS = sizeof(END) / sizeof(END[0]),
        MIDDLE_TERMS = sizeof(MIDDLE) / sizeof(MIDDLE[0])
    };
    const plant_dq_t u_dq = plant_park(u, axes->start);
    const double turn[AXES] = {eq->w * h, -eq->w * h};
    const double share_s = h * eq->share;
    const double decay_ohm_s = share_s * eq->resistance_ohm;
    const double decay[AXES] = {-decay_ohm_s * eq->machine->magnetics.per_l_d,
                                -decay_ohm_s * eq->machine->magnetics.per_l_q};
    double f[AXES] = {share_s * u_dq.d, share_s * u_dq.q};
    /* h^k times the k-th derivative, k = 1; both axes alike, so that the compiler pairs them */
    double y[AXES] = {
        turn[0] * eq->machine->params.q_inductance_h * start.q - decay_ohm_s * start.d + f[0],
        turn[1] * (eq->machine->params.d_inductance_h * start.d + eq->machine->flux_wb) -
            decay_ohm_s * start.q + f[1]};
    double end[AXES] = {y[0], y[1]};
    double middle[AXES] = {MIDDLE[0] * y[0], MIDDLE[0] * y[1]};
    for (int k = 1; k < (int)END_TERMS; k++) {
        const double f_other[AXES] = {f[1], f[0]};
        const double y_other[AXES] = {y[1], y[0]};
        for (int x = 0; x < (int)AXES; x++) {
            f[x] = turn[x] * f_other[x];
            y[x] = decay[x] * y[x] + turn[x] * y_other[x] + f[x];
            end[x] += END[k] * y[x];
        }
        for (int x = 0; x < (int)AXES && k < (int)MIDDLE_TERMS; x++) {
            middle[x] += MIDDLE[k] * y[x];
        }
    }
    solution_t out = {
        .middle = {.d = start.d + eq->machine->magnetics.per_l_d * middle[0],
                   .q = start.q + eq->machine->magnetics.per_l_q * middle[1]},
        .end = {.d = start.d + eq->machine->magnetics.per_l_d * end[0],
                .q = start.q + eq->machine->magnetics.per_l_q * end[1]},
    };
    out.middle_ab = plant_inverse_park(out.middle, axes->middle);
    out.end_ab = plant_inverse_park(out.end, axes->end);
    return out;
}

/* Simpson's rule; sixth: of the step. */
static inline double integral(double sixth, double start, double middle, double end)
{
    return sixth * (start + 4.0 * middle + end);
}

static inline plant_ab_t integral_ab(double sixth, plant_ab_t start, plant_ab_t middle,
                                     plant_ab_t end)
{
    const plant_ab_t out = {.alpha = integral(sixth, start.alpha, middle.alpha, end.alpha),
                            .beta = integral(sixth, start.beta, middle.beta, end.beta)};
    return out;
}

static inline double square(plant_dq_t x)
{
    return x.d * x.d + x.q * x.q;
}

/* i = i_t + G (u - R i_t), in the stator's frame; own: 1 - G R. */
static inline plant_ab_t wires_at(const equations_t *eq, double own, plant_ab_t i_t, plant_ab_t u)
{
    const plant_ab_t out = {.alpha = own * i_t.alpha + eq->conductance_s * u.alpha,
                            .beta = own * i_t.beta + eq->conductance_s * u.beta};
    return out;
}

/* The circuit of a step in which the opposition does not change, and where its phases must stay. */
typedef struct {
    const equations_t *eq;
    plant_ab_t u;        /* V */
    double opposition_v; /* constant, against the sign of each phase's current */
    double beyond_a;     /* all phases stay beyond it, on the sides where they were */
    plant_abc_t before_a;
} linear_t;

/*
 * One step in which the opposition's voltage is constant. If the phases do not stay where they
 * were, the state is unchanged and the result is false. Energies by Simpson's rule; as i and e = u
 * - R i_t are sums of i_t and a voltage of constant magnitude, the integrals of |i|^2 and |e|^2
 * both follow from those of |i_t|^2 and i_t.
 */
static inline bool advance(const linear_t *linear, pmsm_state_t *state, double h,
                           plant_phasor_t half_turn, pmsm_flow_t *flow)
{
    const equations_t *eq = linear->eq;
    const double r = eq->resistance_ohm;
    const double g = eq->conductance_s;
    const double own = 1.0 - g * r;
    const bool is_opposed = linear->opposition_v != 0.0;
    const plant_abc_t sign = signs_of(linear->before_a);
    const plant_ab_t share = plant_clarke(sign);
    const plant_ab_t u = {.alpha = linear->u.alpha - linear->opposition_v * share.alpha,
                          .beta = linear->u.beta - linear->opposition_v * share.beta};
    const stage_axes_t axes = stage_axes(state->axis, half_turn);
    const plant_dq_t start = state->i_t;
    const plant_ab_t start_ab = plant_inverse_park(start, axes.start);
    const solution_t i_t = eq->machine->saliency_h == 0.0
                               ? solve_round(eq, start_ab, u, h, half_turn, &axes)
                               : solve_salient(eq, start, u, h, &axes);
    const plant_ab_t terminal = wires_at(eq, own, i_t.end_ab, u);
    if (is_opposed && distance_a(sign, plant_inverse_clarke(terminal)) <= linear->beyond_a) {
        return false;
    }
    const double sixth = h * (1.0 / 6.0);
    const plant_ab_t i_t_as = integral_ab(sixth, start_ab, i_t.middle_ab, i_t.end_ab);
    const plant_ab_t u_vs = {.alpha = h * u.alpha, .beta = h * u.beta};
    const plant_ab_t charge_as = wires_at(eq, own, i_t_as, u_vs);
    double rectified_as = 1.5 * (share.alpha * charge_as.alpha + share.beta * charge_as.beta);
    if (!is_opposed) { /* phases may change their signs */
        rectified_as = integral(sixth, plant_rectified_sum(wires_at(eq, own, start_ab, u)),
                                plant_rectified_sum(wires_at(eq, own, i_t.middle_ab, u)),
                                plant_rectified_sum(terminal));
    }
    const double i_t_a2s = integral(sixth, square(start), square(i_t.middle), square(i_t.end));
    const double u_i_t_j = u.alpha * i_t_as.alpha + u.beta * i_t_as.beta;
    const double u_v2s = u.alpha * u_vs.alpha + u.beta * u_vs.beta;
    state->i_t = i_t.end;
    state->axis = axes.end;
    state->terminal = terminal;
    book_charge(charge_as, flow);
    flow->rectified_as += rectified_as;
    flow->opposed_as += rectified_as;
    flow->copper_j += own * (own * i_t_a2s + 2.0 * g * u_i_t_j) + g * g * u_v2s;
    flow->iron_j += u_v2s - r * (2.0 * u_i_t_j - r * i_t_a2s);
    flow->torque_nms +=
        eq->machine->flux_wb * integral(sixth, start.q, i_t.middle.q, i_t.end.q) +
        eq->machine->saliency_h *
            integral(sixth, start.d * start.q, i_t.middle.d * i_t.middle.q, i_t.end.d * i_t.end.q);
    return true;
}

static inline double largest_a(plant_abc_t i)
{
    return plant_max(plant_max(fabs(i.a), fabs(i.b)), fabs(i.c));
}

static inline double smallest_a(plant_abc_t i)
{
    return plant_min(plant_min(fabs(i.a), fabs(i.b)), fabs(i.c));
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

void pmsm_straight_advance(const equations_t *eq, const pmsm_opposition_t *opposition,
                           pmsm_state_t *state, plant_ab_t u, double h, plant_phasor_t half_turn,
                           pmsm_flow_t *flow)
{
    linear_t linear = {.eq = eq,
                       .u = u,
                       .opposition_v = opposition->volts,
                       .beyond_a = opposition->zone_a,
                       .before_a = plant_inverse_clarke(state->terminal)};
    inside_t inside;
    pmsm_state_t state_before;
    pmsm_flow_t flow_before;
    const bool is_opposed = opposition->volts != 0.0;
    const bool is_outside = !is_opposed || smallest_a(linear.before_a) > opposition->zone_a;
    bool is_inside = false;
    if (!is_outside && largest_a(linear.before_a) <= 0.5 * opposition->zone_a) {
        inside = inside_of(eq, opposition);
        is_inside = largest_a(linear.before_a) <= 0.5 * inside.limit_a;
    }
    if (is_inside) {
        linear.eq = &inside.eq;
        linear.u.alpha *= inside.left;
        linear.u.beta *= inside.left;
        linear.opposition_v = 0.0;
        state_before = *state;
        flow_before = *flow;
    }
    /* The zone is as wide as the current that its voltage moves in a step: within it currents decay
     * by half or more, which Simpson's rule resolves in two parts. One call for both, so that it is
     * inlined: on its own it takes a quarter longer. */
    const int parts = is_inside ? 2 : 1;
    const double part_s = is_inside ? 0.5 * h : h;
    const plant_phasor_t part_turn = is_inside ? plant_small_phasor(0.25 * eq->w * h) : half_turn;
    bool is_done = is_outside || is_inside;
    for (int k = 0; k < parts && is_done; k++) {
        is_done = advance(&linear, state, part_s, part_turn, flow);
    }
    if (is_inside) {
        is_done = largest_a(plant_inverse_clarke(state->terminal)) <= inside.limit_a;
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
