/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_emf.h: does the rotor's angle agree with the back-EMF? 1 kHz, from one period's voltage
 * and current.
 *
 * In the estimated frame, w L_d i_d and w L_q i_q taken off with the configuration's numbers,
 *
 *     e_d = u_d - R i_d + w L_q i_q        e_q = u_q - R i_q - w L_d i_d
 *
 * is the EMF: (0, w psi) when the angle is right, turned by as much as the angle is wrong. An angle
 * more than 45 degrees beside it is wrong, and so is one whose e_q has the other sign than the
 * speed.
 *
 * What may be wrong with e itself is U = R/2 |i| + w L/4 |i| + 2/3 t_d f v_dc: a hot winding and a
 * bridge, a saturated or badly known inductance, and half of the voltage of the dead time (a vector
 * of 4/3 of the volts lost in a leg), the other half being compensated. It is judged only where w
 * psi >= 4 U. There U turns e by 15 degrees at most, so that an angle 60 degrees beside the truth
 * is seen for certain; with 30 % less flux than configured by 21 degrees, so that one up to 24
 * degrees beside the truth is never blamed. For the paper's motor this is above 57 r/min without
 * current and above 172 r/min with 60 A.
 *
 * Nor is it judged while the voltage stands at its limit: a motor that is not connected drives it
 * there, too.
 *
 * A wrong look counts up, a right one down; MONITOR_EMF_STEPS make a fault. A constant offset takes
 * as many milliseconds. A sense of rotation taken for the other one makes e turn at twice the speed
 * and be wrong in three looks of four: twice as many.
 */
#ifndef MONITOR_MONITOR_EMF_H
#define MONITOR_MONITOR_EMF_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"

enum { MONITOR_EMF_STEPS = 20 };

typedef struct {
    uint16_t level;
} monitor_emf_state_t;

/* Of the same PWM period, in the estimated frame: peak phase quantities, terminal voltage as
 * realised. */
typedef struct {
    int32_t u_d_mV, u_q_mV;
    int32_t i_d_mA, i_q_mA;
    int32_t bus_voltage_mV;
    int32_t speed_mrad_s; /* mechanical, signed, as estimated */
    bool switching;       /* the voltage was applied */
    bool voltage_limited; /* a current that does not follow drives the voltage to its limit: no sign
                             of an EMF */
    bool rotor_valid;     /* an angle that is known to be wrong is not blamed again */
} monitor_emf_input_t;

/* True while the angle must be taken for wrong. */
bool monitor_emf_step(monitor_emf_state_t *state, const config_t *config,
                      const monitor_emf_input_t *in);

#endif
