/* SPDX-License-Identifier: Apache-2.0 */
/* rotor_sensor_sample.h: function of rotor_sensor.c for analog.c. */
#ifndef STM32_ROTOR_SENSOR_SAMPLE_H
#define STM32_ROTOR_SENSOR_SAMPLE_H

/* First of the two samples of the halls in a PWM period, at the beginning of its interrupt; the
 * second is rotor_sensor_hall_state(). */
void rotor_sensor_sample(void);

#endif
