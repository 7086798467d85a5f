/* SPDX-License-Identifier: Apache-2.0 */
/*
 * wheel.h: a simplified wheel for comparing host and emulated core, not an accurate one: three
 * windings that follow the compare values like a resistance with an inductance, a back-EMF that
 * turns with the rotor, all in integers, so that both compute the same. It closes the loop, so that
 * the controllers and limits act as on a vehicle.
 */
#ifndef TARGET_WHEEL_H
#define TARGET_WHEEL_H

#include <stdint.h>

#include "controller/controller.h"

typedef struct {
    uint32_t random;
    uint32_t angle_q32;
    uint32_t turns;             /* electrical, forward less backward, wrapping */
    int32_t speed_q32;          /* electrical turns per PWM period */
    int32_t winding_code_q8[2]; /* currents a and b in converter codes */
    uint16_t bus_code;
    uint16_t noise_codes; /* peak to peak */
} wheel_t;

/* Uniform 16 bits; Numerical Recipes' generator. */
uint32_t wheel_random(wheel_t *wheel);

/* Measurements of the present period. */
fast_input_t wheel_sample(wheel_t *wheel);

/* One PWM period with this output. */
void wheel_step(wheel_t *wheel, const config_t *config, const fast_output_t *out);

#endif
