/*
 * pmsm_stages.h: what the straight and the saturating machine share: the circuit at one speed, the four stages of a step, and
 * what is booked from them. For pmsm.c and pmsm_saturated.c alone.
 */
#ifndef PMSM_STAGES_H
#define PMSM_STAGES_H

#include "plant/pmsm.h"

/* The equations at one speed, ready to be evaluated: with e = u - R i_t, v = share e and i = i_t + conductance e. */
typedef struct {
    double resistance_ohm; /* winding and series */
    double share;          /* R_i / (R_i + R), 1 without iron loss */
    double conductance_s;  /* 1 / (R_i + R), 0 without iron loss */
    double w, w_l_d, w_l_q, w_psi;
    double per_l_d, per_l_q;
    double flux_wb, saliency_h;
} equations_t;

static inline plant_dq_t along(plant_dq_t x, double factor, plant_dq_t y)
{
    const plant_dq_t out = {.d = x.d + factor * y.d, .q = x.q + factor * y.q};
    return out;
}

/* What one stage of the scheme sees. */
typedef struct {
    plant_dq_t slope;    /* di_t/dt; where the iron saturates, of the flux */
    plant_dq_t terminal; /* i */
    double terminal_square, drop_square, torque_per_3_2_p;
} stage_t;

/* The rotor's axis at the ends and in the middle of a step. */
typedef struct {
    plant_phasor_t start, middle, end;
} stage_axes_t;

static inline stage_axes_t stage_axes(plant_phasor_t start, plant_phasor_t half_turn)
{
    const plant_phasor_t middle = plant_turned(start, half_turn);
    const stage_axes_t out = {.start = start, .middle = middle, .end = plant_turned(middle, half_turn)};
    return out;
}

static inline double simpson(double first, double second, double third, double fourth)
{
    return first + 2.0 * (second + third) + fourth;
}

/* What is booked from four stages, in parts small enough to be inlined: here they cost a fifth of what they do as calls. */
static inline void book_currents(const stage_t *s1, plant_dq_t mean, const stage_t *s4, const stage_axes_t *axes,
                                 double sixth, pmsm_state_t *state, pmsm_flow_t *flow)
{
    const plant_ab_t at_start = plant_inverse_park(s1->terminal, axes->start);
    const plant_ab_t at_middle = plant_inverse_park(mean, axes->middle);
    const plant_ab_t at_end = plant_inverse_park(s4->terminal, axes->end);
    state->axis = axes->end;
    state->terminal = at_end;
    flow->charge_as.alpha += sixth * (at_start.alpha + 4.0 * at_middle.alpha + at_end.alpha);
    flow->charge_as.beta += sixth * (at_start.beta + 4.0 * at_middle.beta + at_end.beta);
    flow->rectified_as +=
        sixth * (plant_rectified_sum(at_start) + 4.0 * plant_rectified_sum(at_middle) + plant_rectified_sum(at_end));
}

static inline plant_dq_t between(plant_dq_t x, plant_dq_t y)
{
    const plant_dq_t out = {.d = 0.5 * (x.d + y.d), .q = 0.5 * (x.q + y.q)};
    return out;
}

/* Copper and series heat are told apart by the caller; here both are integral of |i|^2, iron of |e|^2. */
static inline void book_heat_and_torque(const stage_t *s1, const stage_t *s2, const stage_t *s3, const stage_t *s4,
                                        double sixth, pmsm_flow_t *flow)
{
    flow->copper_j +=
        sixth * simpson(s1->terminal_square, s2->terminal_square, s3->terminal_square, s4->terminal_square);
    flow->iron_j += sixth * simpson(s1->drop_square, s2->drop_square, s3->drop_square, s4->drop_square);
    flow->torque_nms +=
        sixth * simpson(s1->torque_per_3_2_p, s2->torque_per_3_2_p, s3->torque_per_3_2_p, s4->torque_per_3_2_p);
}

/* pmsm_saturated.c: one set of four stages; an implicit step of  d(flux)/dt = drive - r i - j w flux  from i_t = before. */
void pmsm_saturated_advance(const pmsm_t *machine, const equations_t *eq, pmsm_state_t *state, plant_ab_t u, double h,
                            plant_phasor_t half_turn, pmsm_flow_t *flow);
plant_dq_t pmsm_saturated_implicit(const pmsm_t *machine, double omega_rad_s, plant_dq_t before, double h, double r,
                                   plant_dq_t drive);

#endif
