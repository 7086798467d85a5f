/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pmsm.h: a permanent-magnet synchronous machine with an iron-loss branch, in the rotor frame.
 *
 *     i = i_t + v / R_i        v = u - R i
 *     R = winding resistance + series resistance of the supply
 *     L_d di_dt/dt = v_d + w L_q i_qt             L_q di_qt/dt = v_q - w (L_d i_dt + psi)
 *     T = 3/2 p [psi + (L_d - L_q) i_dt] i_qt
 *     R_i = a0 + a1 |w|, across the voltage v, after the drop on the resistance
 *
 * i is what the wires carry; only i_t, left over from the iron-loss branch, is flux and torque.
 * Peak phase quantities, w electrical, motor signs (T > 0 drives forward, u . i > 0 flows into the
 * machine). Sources: Urasaki et al. 2000; Lu et al. 2013 eqs (1) to (7). Both iron-loss parameters
 * zero: no iron loss.
 *
 * pmsm_step() takes one PWM period in which the stator voltage is constant and the rotor turns: the
 * equations are linear then, and the currents are their exact solution (README, Step of the
 * machine). Energies are integrated by Simpson's rule over that solution, so the balance
 *
 *     source = copper + series + iron + torque * speed + change of magnetic energy
 *
 * closes to 1e-9 of the energy turned over at 1 kHz electrical and 20 kHz PWM. Where an opposition
 * changes with a phase's current, and in iron that saturates, four stages of Runge and Kutta take
 * the solution's place: 1e-5 of what flows then. Speed and temperature are constant during a step.
 * Valid for R * step < L (pmsm_is_resolved()), any speed: fast rotors take more than one set.
 *
 * Iron that saturates (magnetics.h) takes the place of L i_t where a saturation current or an
 * energy map is given; the torque then is 3/2 p [(psi + x) i_qt - y i_dt], and the stages integrate
 * the fluxes. Cogging (cogging.h) adds its torque to the airgap's; its energy is counted with the
 * magnetic one, so the balance stays what it is.
 */
#ifndef PLANT_PMSM_H
#define PLANT_PMSM_H

#include <stdbool.h>

#include "plant/cogging.h"
#include "plant/magnetics.h"
#include "plant/parameter.h"
#include "plant/vectors.h"

/* clang-format off */
#define PMSM_PARAMETERS(X) \
    X(pole_pairs,                                1.0,   200.0, "1", \
      "electrical turns in a mechanical turn") \
    X(phase_resistance_ohm,                      1e-6,  1e3,   "ohm", \
      "one phase, at reference_temperature_c") \
    X(reference_temperature_c,                  -100.0, 300.0, "degC", \
      "where resistance and flux hold") \
    X(resistance_temperature_coefficient_per_k,  0.0,   0.1,   "1/K",   "copper 0.00393") \
    X(d_inductance_h,                            1e-8,  10.0,  "H",     "direct axis") \
    X(q_inductance_h,                            1e-8,  10.0,  "H",     "quadrature axis") \
    X(flux_linkage_wb,                           0.0,   100.0, "Wb", \
      "peak phase flux linkage of the magnets") \
    X(flux_temperature_coefficient_per_k,       -0.1,   0.1,   "1/K", \
      "NdFeB -0.0011; 0: constant flux") \
    X(iron_loss_resistance_ohm,                  0.0,   1e9,   "ohm", \
      "a0 of R_i = a0 + a1 |omega_e|") \
    X(iron_loss_resistance_slope_ohm_s,          0.0,   1e6,   "ohm s", \
      "a1 of R_i = a0 + a1 |omega_e|") \
    X(friction_torque_nm,                        0.0,   1e4,   "N m", \
      "Coulomb friction of bearings and seals") \
    X(viscous_friction_nm_s,                     0.0,   1e4,   "N m s", \
      "friction proportional to mechanical speed") \
    X(d_saturation_current_a,                    0.0,   1e5,   "A", \
      "d current with half the flux of L_d i_d; 0: never saturates") \
    X(q_saturation_current_a,                    0.0,   1e5,   "A",     "q current, likewise") \
    X(cross_saturation,                          0.0,   1.0,   "1", \
      "1: both axes share their iron, 0: each has its own") \
    X(magnet_bias_current_a,                     0.0,   1e5,   "A", \
      "d current that fills the iron as the magnets do") \
    X(cogging_torque_nm,                         0.0,   1e4,   "N m", \
      "amplitude; 0: no cogging") \
    X(cogging_per_turn,                          0.0,   1e4,   "1", \
      "whole periods of it in a mechanical turn") \
    X(cogging_deg,                               0.0,   360.0, "deg", \
      "of a period, phase where the shaft's angle is 0")
/* clang-format on */

typedef struct {
    PMSM_PARAMETERS(PLANT_PARAMETER_MEMBER)
    /* What the iron adds to the inductances, over the flux beside flux_linkage_wb at
     * reference_temperature_c; NULL: nothing. Without saturation currents. */
    const energy_map_t *energy_map;
} pmsm_params_t;

/* The machine at one winding temperature. */
typedef struct {
    pmsm_params_t params;
    double resistance_ohm;
    double flux_wb;
    double saliency_h; /* L_d - L_q */
    magnetics_t magnetics;
    cogging_t cogging;
} pmsm_t;

typedef struct {
    plant_dq_t i_t;      /* A, the torque-producing current, after the iron-loss branch */
    plant_ab_t terminal; /* A, terminal current at this instant, as measured by a current sensor */
    double theta_turn;   /* electrical, 0 <= theta < 1 */
    plant_phasor_t axis; /* exp(j theta) */
    double shaft_turn;   /* mechanical, 0 <= angle < 1; kept up where there is cogging */
    bool rests;          /* the last step was on diodes and found neither motion nor current */
} pmsm_state_t;

/* Something that takes a voltage of each phase against its current: all of it from zone_a on,
 * proportionally less below. */
typedef struct {
    double volts;  /* 0: none */
    double zone_a; /* above 0 */
} pmsm_opposition_t;

typedef struct {
    double omega_rad_s; /* electrical, constant during the step */
    double duration_s;
    double series_resistance_ohm; /* a phase, of what feeds the machine */
    pmsm_opposition_t opposition; /* in front of that resistance */
} pmsm_step_t;

/* What flowed during a step. */
typedef struct {
    plant_ab_t charge_as; /* integral of the terminal current */
    double source_j;   /* delivered by the source, in front of its series resistance, the opposition
                          taken off */
    double opposed_as; /* integral of the currents that the opposition stood against, all phases, as
                          shares of its volts */
    double copper_j;
    double series_j; /* heat in the series resistance */
    double iron_j;
    double torque_nms;   /* integral of the airgap torque */
    double rectified_as; /* integral of |i_a| + |i_b| + |i_c| */
} pmsm_flow_t;

/* Why there is no such machine, in one line; NULL: there is. */
const char *pmsm_objection(const pmsm_params_t *params);

pmsm_t pmsm_at_temperature(const pmsm_params_t *params, double winding_temperature_c);

pmsm_state_t pmsm_at_rest(double theta_turn);

/* One stage set resolves R/L up to this step; a drive that fails is refused by the bench. */
bool pmsm_is_resolved(const pmsm_t *machine, double series_resistance_ohm, double step_s);

/* Stator voltage u (ab, V) in front of opposition and series resistance, constant over the step.
 * Advances currents and angle. The opposition is constant over a step in which all phases stay
 * outside its zone, and follows their currents in every stage where one does not; such a step costs
 * half as much again. */
pmsm_flow_t pmsm_step(const pmsm_t *machine, pmsm_state_t *state, plant_ab_t u,
                      const pmsm_step_t *step);

/*
 * Fed by diodes: the source voltage is against the terminal current, up to the magnitude
 * `ceiling_v` (peak phase); while that suffices, the terminal current is zero. First-order
 * implicit, unconditionally stable; energy the scheme would lose is credited to the source, where
 * the diodes would have carried it. While neither rotor nor current moves, the second step and all
 * after it cost a few comparisons.
 */
pmsm_flow_t pmsm_step_rectified(const pmsm_t *machine, pmsm_state_t *state, double ceiling_v,
                                const pmsm_step_t *step);

/* Terminal current that a volt moves within a step: through the smaller inductance of this state,
 * and at once through the iron branch. */
double pmsm_amperes_per_volt(const pmsm_t *machine, const pmsm_state_t *state,
                             const pmsm_step_t *step);

/* The rotor's angle after a step; whoever integrates the currents himself turns it with this.
 * Returns the impulse of the cogging torque on the way, N m s, which belongs to the airgap's. */
double pmsm_turn(const pmsm_t *machine, pmsm_state_t *state, const pmsm_step_t *step);

/* Currents that have died out, below 1e-30 A, become 0: at rest they would go on shrinking until
 * they are subnormal numbers, which take a processor a hundred times as long. Once a millisecond.
 */
void pmsm_rest(pmsm_state_t *state);

/* Of currents and cogging. */
double pmsm_magnetic_energy_j(const pmsm_t *machine, const pmsm_state_t *state);

/* Without cogging. */
double pmsm_torque_nm(const pmsm_t *machine, plant_dq_t i_t);

#endif
