/* SPDX-License-Identifier: Apache-2.0 */
/*
 * phases.h: the machine of pmsm.h as three windings on three legs, each leg with its own voltage
 * and resistance, or open.
 *
 *     v_x = d(lambda_x)/dt        i_x = i_tx + w_x / R_i        e_x - (r_x + R) i_x - v_n = v_x,
 *     sum v_x = 0
 *     i_t = L(theta)^-1 (lambda - psi),        psi_x = psi cos(theta - 0, 120, 240 deg)
 *     T = p (lambda x i_t)
 *
 * The flux linkages of the three windings are the state, in the stator; the star point v_n floats.
 * R_i is known for the flux that turns with the rotor, so its voltage is that of the turning flux,
 * w = j omega lambda: in the steady state that is v, and what edges of the bridge do to v in
 * between is not iron loss of this kind. With iron_sees_ripple it is v at every instant, the
 * exact circuit of pmsm.h; both then agree wherever all legs have the same resistance.
 *
 * A leg that does not conduct carries no current: its winding follows the rotating flux while its
 * remaining current decays within microseconds; the energy of that current is open_j. Four-stage
 * Runge-Kutta, energies by the same stages.
 */
#ifndef PLANT_PHASES_H
#define PLANT_PHASES_H

#include "plant/pmsm.h"

enum { PHASES = 3 };

/* How a leg is connected. */
typedef struct {
    double volts; /* e_x, to the negative rail */
    double ohms;  /* r_x */
    bool open;
} phases_leg_t;

typedef struct {
    const pmsm_t *machine;
    double omega_rad_s; /* electrical */
    double iron_s;      /* 1 / R_i, 0 without iron loss */
    double open_ohm;    /* across an open winding */
    bool iron_sees_ripple;
    double per_l_sum, per_l_difference; /* (1/L_d + 1/L_q) / 2, (1/L_d - 1/L_q) / 2 */
} phases_t;

typedef struct {
    double flux_wb[PHASES];
    plant_phasor_t axis;
    double current_a[PHASES]; /* in the wires, with the legs as they were connected last */
} phases_state_t;

/* Integrals over a time, each winding's or leg's own where there are three. */
typedef struct {
    double charge_as[PHASES];
    double square_a2s[PHASES]; /* of the current in the wire */
    double iron_j;
    double open_j; /* of currents that die in the windings of open legs */
    double torque_nms;
} phases_flow_t;

/* A step with an open leg may be this long. */
extern const double PHASES_OPEN_STEP_S;

phases_t phases_at(const pmsm_t *machine, double omega_rad_s);

phases_state_t phases_from(const phases_t *phases, const pmsm_state_t *rotor);

/* open_ohm for this state and steps of step_s: the current of the smaller inductance, and of
 * saturated iron, decays faster, too fast for a long step. */
double phases_open_ohm(const phases_t *phases, const phases_state_t *state, double step_s);

/* Back to the rotor's frame; the angle is the caller's to advance. */
void phases_to(const phases_t *phases, const phases_state_t *state, pmsm_state_t *rotor);

/* Advance by h with the legs as they are and add to flow. */
void phases_advance(const phases_t *phases, phases_state_t *state, const phases_leg_t legs[PHASES],
                    double h, phases_flow_t *flow);

/*
 * The same with all legs open, at once, where nothing but the angle changes: what flows in the
 * windings has died out but for the iron's share, the line EMF sqrt(3) omega |lambda| is below
 * most_v, V, so no diode begins to conduct, and the rotor turns by at most half a radian. The flux
 * turns with it, and the torque is the iron's drag. False: it is not so, and nothing has changed.
 */
bool phases_coast(const phases_t *phases, phases_state_t *state, double most_v, double h,
                  phases_flow_t *flow);

/* Wire currents and the voltages of the legs' ends against the negative rail, now, with the legs as
 * they are. */
void phases_terminals(const phases_t *phases, const phases_state_t *state,
                      const phases_leg_t legs[PHASES], double current_a[PHASES],
                      double end_v[PHASES]);

#endif
