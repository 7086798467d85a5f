/* SPDX-License-Identifier: Apache-2.0 */
/*
 * motor.h: a permanent-magnet motor on an averaged inverter, small enough to run beside the
 * firmware on the emulated core, so that the instructions are counted on inputs that the
 * controller's own outputs bring about.
 *
 * Rotor frame, peak phase quantities (amplitude-invariant):
 *
 *     L_d di_d/dt = u_d - R i_d + w L_q i_q          L_q di_q/dt = u_q - R i_q - w L_d i_d - w psi
 *
 * Parameters from the controller's own configuration; speed is set from outside, as on a test bench
 * with a load machine. Not counted, so it may use double.
 */
#ifndef BENCHMARK_MOTOR_H
#define BENCHMARK_MOTOR_H

#include <stdint.h>

#include "controller/controller.h"

typedef struct {
    double theta_rad; /* electrical */
    double i_d_A, i_q_A;
    int32_t turns; /* whole mechanical ones, at the latest sample */
    uint32_t random;
} motor_t;

/* Codes as the board's converters give them, with a noise of one code either way; all three rotor
 * sensors. */
fast_input_t motor_sample(motor_t *motor, const config_t *config, double bus_V);

/* One PWM period at this electrical speed under this output. */
void motor_step(motor_t *motor, const config_t *config, const fast_output_t *out, double bus_V,
                double w_rad_s);

#endif
