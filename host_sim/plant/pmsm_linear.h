/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pmsm_linear.h: a step of the machine whose iron does not saturate while nothing in its circuit
 * changes with a current: the exact solution, and what is booked from it. Inline, because nearly
 * every step of a run is this one. For pmsm.c and pmsm_straight.c alone.
 */
#ifndef PMSM_LINEAR_H
#define PMSM_LINEAR_H

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

/* Of i_t over one step: its end in both frames, and what Simpson's rule adds up, the values at the
 * beginning, four times those of the middle and those of the end. */
typedef struct {
    plant_dq_t end;
    plant_ab_t start_ab, middle_ab, end_ab;
    plant_ab_t sum_ab;
    double sum_square;
    double sum_torque; /* of flux times i_qt, saliency counted */
} solution_t;

/* (1 - exp(-z)) / z for 0 <= z <= 0.5: error below 1e-12 to z = 0.1, 3e-7 at 0.5. Summed in pairs,
 * because everything else waits for it. */
static inline double mean_decay(double z)
{
    const double zz = z * z;
    return (1.0 - z * (1.0 / 2)) + zz * ((1.0 / 6 - z * (1.0 / 24)) +
                                         zz * ((1.0 / 120 - z * (1.0 / 720)) + zz * (1.0 / 5040)));
}

static inline double square(plant_ab_t x)
{
    return x.alpha * x.alpha + x.beta * x.beta;
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
 *
 * Each value is added up as soon as it is there, so that few of them wait in memory.
 */
static inline solution_t solve_round(const equations_t *eq, plant_dq_t start, plant_ab_t u,
                                     double h, plant_phasor_t half_turn, const stage_axes_t *axes)
{
    const double gain = 0.5 * h * eq->share * eq->machine->magnetics.per_l_d;
    const double z = gain * eq->resistance_ohm;
    const double y = 0.5 * h * eq->w;
    const double mean = mean_decay(z);
    const double decay = 1.0 - z * mean;
    const double of_both = z * z + y * y;
    const double flux_a = eq->machine->flux_wb * eq->machine->magnetics.per_l_d;
    const double factor = of_both > 0.0 ? y * flux_a / of_both : 0.0;
    const double x = half_turn.cos - decay;
    const plant_phasor_t emf = {.cos = factor * (y * x - z * half_turn.sin),
                                .sin = factor * (y * half_turn.sin + z * x)};
    const double drive_a_per_v = gain * mean;
    const plant_ab_t drive = {.alpha = drive_a_per_v * u.alpha, .beta = drive_a_per_v * u.beta};

    const plant_ab_t start_ab = plant_inverse_park(start, axes->start);
    const plant_ab_t middle_ab = half_step(decay, start_ab, drive, axes->start, emf);
    const double middle_q = plant_park(middle_ab, axes->middle).q;
    const plant_ab_t sum_ab = {.alpha = start_ab.alpha + 4.0 * middle_ab.alpha,
                               .beta = start_ab.beta + 4.0 * middle_ab.beta};
    const double sum_square = square(start_ab) + 4.0 * square(middle_ab);
    const double sum_q = start.q + 4.0 * middle_q;
    const plant_ab_t end_ab = half_step(decay, middle_ab, drive, axes->middle, emf);
    const plant_dq_t end = plant_park(end_ab, axes->end);
    const solution_t out = {
        .end = end,
        .start_ab = start_ab,
        .middle_ab = middle_ab,
        .end_ab = end_ab,
        .sum_ab = {.alpha = sum_ab.alpha + end_ab.alpha, .beta = sum_ab.beta + end_ab.beta},
        .sum_square = sum_square + square(end_ab),
        .sum_torque = eq->machine->flux_wb * (sum_q + end.q),
    };
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
    const plant_dq_t i_middle = {.d = start.d + eq->machine->magnetics.per_l_d * middle[0],
                                 .q = start.q + eq->machine->magnetics.per_l_q * middle[1]};
    const plant_dq_t i_end = {.d = start.d + eq->machine->magnetics.per_l_d * end[0],
                              .q = start.q + eq->machine->magnetics.per_l_q * end[1]};
    const plant_ab_t start_ab = plant_inverse_park(start, axes->start);
    const plant_ab_t middle_ab = plant_inverse_park(i_middle, axes->middle);
    const plant_ab_t end_ab = plant_inverse_park(i_end, axes->end);
    const solution_t out = {
        .end = i_end,
        .start_ab = start_ab,
        .middle_ab = middle_ab,
        .end_ab = end_ab,
        .sum_ab = {.alpha = start_ab.alpha + 4.0 * middle_ab.alpha + end_ab.alpha,
                   .beta = start_ab.beta + 4.0 * middle_ab.beta + end_ab.beta},
        .sum_square = square(start_ab) + 4.0 * square(middle_ab) + square(end_ab),
        .sum_torque = eq->machine->flux_wb * (start.q + 4.0 * i_middle.q + i_end.q) +
                      eq->machine->saliency_h *
                          (start.d * start.q + 4.0 * i_middle.d * i_middle.q + i_end.d * i_end.q),
    };
    return out;
}

/* Simpson's rule; sixth: of the step. */
static inline double integral(double sixth, double start, double middle, double end)
{
    return sixth * (start + 4.0 * middle + end);
}

/* x + factor y, in the stator's frame. */
static inline plant_ab_t beside(plant_ab_t x, double factor, plant_ab_t y)
{
    const plant_ab_t out = {.alpha = x.alpha + factor * y.alpha, .beta = x.beta + factor * y.beta};
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

static inline double smallest_a(plant_abc_t i)
{
    return plant_min(plant_min(fabs(i.a), fabs(i.b)), fabs(i.c));
}

static inline linear_t linear_of(const equations_t *eq, const pmsm_opposition_t *opposition,
                                 const pmsm_state_t *state, plant_ab_t u)
{
    const linear_t out = {.eq = eq,
                          .u = u,
                          .opposition_v = opposition->volts,
                          .beyond_a = opposition->zone_a,
                          .before_a = plant_inverse_clarke(state->terminal)};
    return out;
}

/* Whether the step begins with all phases outside the opposition's zone, if there is one. */
static inline bool linear_holds(const linear_t *linear)
{
    return linear->opposition_v == 0.0 || smallest_a(linear->before_a) > linear->beyond_a;
}

/*
 * One step in which the opposition's voltage is constant. If the phases do not stay where they
 * were, state and flow are unchanged and the result is false. Energies by Simpson's rule; as
 * i = own i_t + G u, with own = 1 - G R, and e = u - R i_t are sums of i_t and a voltage of
 * constant magnitude, the integrals of |i|^2 and |e|^2 both follow from those of |i_t|^2 and i_t.
 */
static inline bool linear_advance(const linear_t *linear, pmsm_state_t *state, double h,
                                  plant_phasor_t half_turn, pmsm_flow_t *flow)
{
    const equations_t *eq = linear->eq;
    const bool is_opposed = linear->opposition_v != 0.0;
    const plant_abc_t sign = signs_of(linear->before_a);
    const plant_ab_t share = plant_clarke(sign);
    const plant_ab_t u = beside(linear->u, -linear->opposition_v, share);
    const stage_axes_t axes = stage_axes(state->axis, half_turn);
    const solution_t i_t = eq->machine->saliency_h == 0.0
                               ? solve_round(eq, state->i_t, u, h, half_turn, &axes)
                               : solve_salient(eq, state->i_t, u, h, &axes);
    const double r = eq->resistance_ohm;
    const double g = eq->conductance_s;
    const double own = 1.0 - g * r;
    const plant_ab_t iron = {.alpha = g * u.alpha, .beta = g * u.beta};
    const plant_ab_t terminal = beside(iron, own, i_t.end_ab);
    if (is_opposed && distance_a(sign, plant_inverse_clarke(terminal)) <= linear->beyond_a) {
        return false;
    }
    const double sixth = h * (1.0 / 6.0);
    const plant_ab_t i_t_as = {.alpha = sixth * i_t.sum_ab.alpha, .beta = sixth * i_t.sum_ab.beta};
    const plant_ab_t iron_as = {.alpha = h * iron.alpha, .beta = h * iron.beta};
    const plant_ab_t charge_as = beside(iron_as, own, i_t_as);
    double rectified_as = 1.5 * (share.alpha * charge_as.alpha + share.beta * charge_as.beta);
    if (!is_opposed) { /* phases may change their signs */
        rectified_as = integral(sixth, plant_rectified_sum(beside(iron, own, i_t.start_ab)),
                                plant_rectified_sum(beside(iron, own, i_t.middle_ab)),
                                plant_rectified_sum(terminal));
    }
    const double i_t_a2s = sixth * i_t.sum_square;
    const double u_i_t_j = u.alpha * i_t_as.alpha + u.beta * i_t_as.beta;
    const double u_v2s = h * square(u);
    state->i_t = i_t.end;
    state->axis = axes.end;
    state->terminal = terminal;
    flow->charge_as = charge_as;
    flow->rectified_as = rectified_as;
    flow->opposed_as = rectified_as;
    flow->copper_j = own * (own * i_t_a2s + 2.0 * g * u_i_t_j) + g * g * u_v2s;
    flow->iron_j = u_v2s - r * (2.0 * u_i_t_j - r * i_t_a2s);
    flow->torque_nms = sixth * i_t.sum_torque;
    return true;
}

#endif
