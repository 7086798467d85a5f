/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pwm_period.h: from the hardware's inputs to the bridge. PWM interrupt, once per period.
 */
#ifndef APP_PWM_PERIOD_H
#define APP_PWM_PERIOD_H

#include "controller/controller.h"

/*
 * Reads currents, bus voltage, the power stage's fault and the configuration's rotor sensor into
 * `in`, makes the fast step and gives its compare values to the bridge. What other rotor sensors
 * have in `in` stays as it is. Returns what the bridge was given, until the next call.
 */
const fast_output_t *pwm_period_step(controller_fast_t *fast, const config_t *config,
                                     const fast_setpoint_t *setpoint, fast_input_t *in);

#endif
