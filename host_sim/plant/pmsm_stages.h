/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pmsm_stages.h: what the straight and the saturating machine share: the circuit at one speed, the
 * four stages of a step, and what is booked from them. For the files pmsm*.c alone.
 */
#ifndef PMSM_STAGES_H
#define PMSM_STAGES_H

#include <stdbool.h>

#include "plant/numbers.h"
#include "plant/pmsm.h"

/* The equations at one speed, ready to be evaluated: with e = u - R i_t, v = share e and i = i_t +
 * conductance e. */
typedef struct {
    double resistance_ohm; /* winding and series */
    double share;          /* R_i / (R_i + R), 1 without iron loss */
    double conductance_s;  /* 1 / (R_i + R), 0 without iron loss */
    double w;
    const pmsm_t *machine;
} equations_t;

/* Stage sets of a step: in none of them the rotor turns by more than LARGEST_TURN_RAD, so that the
 * scheme's error is below 1e-8 of the current per period. */
static inline int pmsm_sets(const equations_t *eq, const pmsm_step_t *step)
{
    static const double LARGEST_TURN_RAD = 0.1;
    const double turn_rad = fabs(eq->w) * step->duration_s;
    return turn_rad <= LARGEST_TURN_RAD ? 1 : (int)ceil(turn_rad / LARGEST_TURN_RAD);
}

static inline plant_dq_t along(plant_dq_t x, double factor, plant_dq_t y)
{
    const plant_dq_t out = {.d = x.d + factor * y.d, .q = x.q + factor * y.q};
    return out;
}

/* Inputs of one stage of the scheme. */
typedef struct {
    plant_dq_t slope;    /* di_t/dt; where the iron saturates, of the flux */
    plant_dq_t terminal; /* i */
    double terminal_square, drop_square, torque_per_3_2_p;
} stage_t;

/* Of the machine whose iron does not saturate. */
static inline stage_t straight_stage_at(const equations_t *eq, plant_dq_t u, plant_dq_t i_t)
{
    const plant_dq_t e = along(u, -eq->resistance_ohm, i_t);
    const plant_dq_t i = along(i_t, eq->conductance_s, e);
    const stage_t out = {
        .slope = {.d = (eq->share * e.d + eq->w * eq->machine->params.q_inductance_h * i_t.q) *
                       eq->machine->magnetics.per_l_d,
                  .q = (eq->share * e.q - eq->w * (eq->machine->params.d_inductance_h * i_t.d +
                                                   eq->machine->flux_wb)) *
                       eq->machine->magnetics.per_l_q},
        .terminal = i,
        .terminal_square = i.d * i.d + i.q * i.q,
        .drop_square = e.d * e.d + e.q * e.q,
        .torque_per_3_2_p = (eq->machine->flux_wb + eq->machine->saliency_h * i_t.d) * i_t.q,
    };
    return out;
}

/* The rotor's axis at the ends and in the middle of a step. */
typedef struct {
    plant_phasor_t start, middle, end;
} stage_axes_t;

static inline stage_axes_t stage_axes(plant_phasor_t start, plant_phasor_t half_turn)
{
    const plant_phasor_t middle = plant_turned(start, half_turn);
    const stage_axes_t out = {
        .start = start, .middle = middle, .end = plant_turned(middle, half_turn)};
    return out;
}

static inline double simpson(double first, double second, double third, double fourth)
{
    return first + 2.0 * (second + third) + fourth;
}

/* What the wires carry at the ends and, as the mean of both of its stages, in the middle of a step.
 */
typedef struct {
    plant_ab_t start, middle, end;
} wires_t;

static inline wires_t wires_of(const stage_t *s1, const stage_t *s2, const stage_t *s3,
                               const stage_t *s4, const stage_axes_t *axes)
{
    const plant_dq_t middle = {.d = 0.5 * (s2->terminal.d + s3->terminal.d),
                               .q = 0.5 * (s2->terminal.q + s3->terminal.q)};
    const wires_t out = {.start = plant_inverse_park(s1->terminal, axes->start),
                         .middle = plant_inverse_park(middle, axes->middle),
                         .end = plant_inverse_park(s4->terminal, axes->end)};
    return out;
}

/* What is integrated, after four stages. */
static inline plant_dq_t after(plant_dq_t before, double sixth, const stage_t *s1,
                               const stage_t *s2, const stage_t *s3, const stage_t *s4)
{
    const plant_dq_t out = {
        .d = before.d + sixth * simpson(s1->slope.d, s2->slope.d, s3->slope.d, s4->slope.d),
        .q = before.q + sixth * simpson(s1->slope.q, s2->slope.q, s3->slope.q, s4->slope.q)};
    return out;
}

/* What is booked from four stages, in parts small enough to be inlined: here they cost a fifth of
 * what they do as calls. */
static inline plant_ab_t charge_of(const wires_t *wires, double sixth)
{
    const plant_ab_t out = {
        .alpha = sixth * (wires->start.alpha + 4.0 * wires->middle.alpha + wires->end.alpha),
        .beta = sixth * (wires->start.beta + 4.0 * wires->middle.beta + wires->end.beta)};
    return out;
}

/* Integral of |i_a| + |i_b| + |i_c|. */
static inline double rectified_of(const wires_t *wires, double sixth)
{
    return sixth * (plant_rectified_sum(wires->start) + 4.0 * plant_rectified_sum(wires->middle) +
                    plant_rectified_sum(wires->end));
}

static inline void book_charge(plant_ab_t charge_as, pmsm_flow_t *flow)
{
    flow->charge_as.alpha += charge_as.alpha;
    flow->charge_as.beta += charge_as.beta;
}

/* Copper and series heat are separated by the caller; here both are integral of |i|^2, iron of
 * |e|^2. */
static inline void book_heat_and_torque(const stage_t *s1, const stage_t *s2, const stage_t *s3,
                                        const stage_t *s4, double sixth, pmsm_flow_t *flow)
{
    flow->copper_j += sixth * simpson(s1->terminal_square, s2->terminal_square, s3->terminal_square,
                                      s4->terminal_square);
    flow->iron_j +=
        sixth * simpson(s1->drop_square, s2->drop_square, s3->drop_square, s4->drop_square);
    flow->torque_nms += sixth * simpson(s1->torque_per_3_2_p, s2->torque_per_3_2_p,
                                        s3->torque_per_3_2_p, s4->torque_per_3_2_p);
}

/* The opposition's voltage as a share of its whole, decided by the current that would flow without
 * it: what the opposition itself takes out of the iron branch at once is part of its zone
 * (inverter.h). */
static inline plant_dq_t opposed_share(double per_zone, plant_dq_t current, plant_phasor_t axis)
{
    const plant_abc_t phase = plant_inverse_clarke(plant_inverse_park(current, axis));
    const plant_abc_t share = {.a = plant_clamp(phase.a * per_zone, -1.0, 1.0),
                               .b = plant_clamp(phase.b * per_zone, -1.0, 1.0),
                               .c = plant_clamp(phase.c * per_zone, -1.0, 1.0)};
    return plant_park(plant_clarke(share), axis);
}

/* Current that it opposes: the sum of share times current of all phases. */
static inline double opposed_a(plant_dq_t share, plant_dq_t terminal)
{
    return 1.5 * (share.d * terminal.d + share.q * terminal.q);
}

/* pmsm_sets.c: a whole step, but for what pmsm_step() does with the sums: copper_j, iron_j and
 * torque_nms are integrals of |i|^2, |e|^2 and torque_per_3_2_p. */
pmsm_flow_t pmsm_step_in_sets(const equations_t *eq, pmsm_state_t *state, plant_ab_t u,
                              const pmsm_step_t *step);

/* pmsm_straight.c: one set. try_linear: false where the linear step is known to leave its bounds.
 */
void pmsm_straight_advance(const equations_t *eq, const pmsm_opposition_t *opposition,
                           pmsm_state_t *state, plant_ab_t u, double h, plant_phasor_t half_turn,
                           bool try_linear, pmsm_flow_t *flow);

/* pmsm_saturated.c: one set of four stages.
 *
 * pmsm_saturated_implicit(): one implicit step from i_t = before of
 *
 *     d(flux)/dt = drive - r i - j w flux
 */
void pmsm_saturated_advance(const pmsm_t *machine, const equations_t *eq,
                            const pmsm_opposition_t *opposition, pmsm_state_t *state, plant_ab_t u,
                            double h, plant_phasor_t half_turn, pmsm_flow_t *flow);
plant_dq_t pmsm_saturated_implicit(const pmsm_t *machine, double omega_rad_s, plant_dq_t before,
                                   double h, double r, plant_dq_t drive);

#endif
