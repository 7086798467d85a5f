/* SPDX-License-Identifier: Apache-2.0 */
/*
 * inverter.h: a two-level three-phase bridge, averaged over a PWM period.
 *
 * Each leg gives v_dc times its duty, less what dead time and devices take:
 *
 *     v_x = d_x v_dc - s_x t_d f_s v_dc  -  s_x V_f delta  -  [R_ds (1 - delta) + R_ak delta] i_x
 *     delta = 2 t_d f_s
 *
 * s_x is the sign of the phase current. The second term is a shift of the switching instant (it
 * moves energy on neither side), the third and fourth are heat. Hard switching adds (k_on + k_off)
 * f_s |i_x|/2 a phase on the DC side only. Over a sinusoid these are the paper's eqs (8) to (14):
 * 3/2 I^2 R + 6/pi V_f delta I + 3 (k_on + k_off) f_s I/pi. So with what flowed through the machine
 * during a period
 *
 *     DC energy = terminal energy + conduction + diode + switching
 *
 * exactly. A current that ends within the dead time, which moves it by t_d (v_dc + 2 V_f)/L and a
 * share in the iron branch, loses its diode on the way: within that zone (inverter_zone_a()) s_x is
 * proportional to the current, so it is continuous, every stage of the integration includes it, and
 * a leg with zero current is clamped without a limit cycle. Ripple that changes a current's sign
 * between the two edges of a period, and so undoes the loss, is left to switching.h: it is worth a
 * hundredth of a per cent of a stop's kinetic energy at 1 A and zero at 10 A.
 *
 * Off: the diodes rectify. Terminal current flows only where the line EMF exceeds v_dc + 2 V_f; the
 * fundamental of the bridge's voltage is then (v_dc + 2 V_f)/sqrt 3 against the current: exact at
 * the threshold, 10 % low in the continuous conduction of a fast rotor on a stiff bus (2/pi instead
 * of 1/sqrt 3). Short: the three low-side switches conduct all the time; no current flows on the DC
 * side.
 */
#ifndef PLANT_INVERTER_H
#define PLANT_INVERTER_H

#include "plant/parameter.h"
#include "plant/pmsm.h"
#include "plant/vectors.h"

/* clang-format off */
#define INVERTER_PARAMETERS(X) \
    X(switch_resistance_ohm,    0.0, 100.0, "ohm", "R_ds, one switch, conducting") \
    X(diode_forward_voltage_v,  0.0, 10.0,  "V",   "V_f, diode drop at zero current") \
    X(diode_resistance_ohm,     0.0, 100.0, "ohm", "R_ak, slope of the diode drop") \
    X(dead_time_s,              0.0, 1e-4,  "s",   "t_d, between the two switches of a leg") \
    X(pwm_frequency_hz,         1e3, 1e6,   "Hz",  "f_s") \
    X(turn_on_loss_j_per_a,     0.0, 1.0,   "J/A", "k_on") \
    X(turn_off_loss_j_per_a,    0.0, 1.0,   "J/A", "k_off") \
    X(switch_resistance_temperature_coefficient_per_k, 0.0, 0.1, "1/K", \
      "of R_ds, from the reference temperature") \
    X(switch_reference_temperature_c, -60.0, 300.0, "degC", "where R_ds holds") \
    X(switching,                0.0, 1.0,   "", \
      "1: every edge by itself (switching.h), 0: averaged over the period")
/* clang-format on */

typedef struct {
    INVERTER_PARAMETERS(PLANT_PARAMETER_MEMBER)
} inverter_params_t;

/* Worked out once. */
typedef struct {
    double period_s;
    double dead_share;              /* delta */
    double pwm_resistance_ohm;      /* a phase, while switching */
    double short_resistance_ohm;    /* a phase, low sides on */
    double diode_resistance_ohm;    /* a phase, off */
    double forward_voltage_v;       /* V_f */
    double switching_loss_j_per_as; /* (k_on + k_off) f_s / 2 */
} inverter_t;

/* What the bridge puts in front of the machine in one period: legs, less the opposition, before the
 * series resistance. */
typedef struct {
    plant_ab_t legs;              /* V, duties times bus voltage */
    pmsm_opposition_t opposition; /* dead time and diodes: the sum of the next two */
    double shifted_v;             /* V a phase, what the dead time shifts, which stays on the bus */
    double drop_v;                /* V a phase, what the diodes take, which is heat */
} inverter_drive_t;

/* Energy of one period. DC energy is positive out of the battery. */
typedef struct {
    double dc_j;
    double conduction_j;
    double diode_j;
    double switching_j;
} inverter_flow_t;

inverter_t inverter_model(const inverter_params_t *params, double switch_temperature_c);

/* Current that the whole error voltage of dead time and diodes moves within a PWM period: the
 * opposition's zone. amperes_per_volt: of what the bridge feeds, see pmsm_amperes_per_volt(). */
double inverter_zone_a(const inverter_t *inverter, double bus_voltage_v, double amperes_per_volt);

/* duty: high-side share of each leg, 0 .. 1. */
inverter_drive_t inverter_drive(const inverter_t *inverter, plant_abc_t duty, double bus_voltage_v,
                                double zone_a);

inverter_flow_t inverter_pwm_flow(const inverter_t *inverter, const inverter_drive_t *drive,
                                  const pmsm_flow_t *flow);

/* Largest voltage (peak phase) with which the diodes of a bridge that is off oppose the current. */
double inverter_rectifier_ceiling_v(const inverter_t *inverter, double bus_voltage_v);

inverter_flow_t inverter_rectifier_flow(const inverter_t *inverter, double bus_voltage_v,
                                        const pmsm_flow_t *flow);

inverter_flow_t inverter_short_flow(const pmsm_flow_t *flow);

#endif
