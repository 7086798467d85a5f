/* SPDX-License-Identifier: Apache-2.0 */
/*
 * rotor.h: electrical angle and speed of the rotor, once per PWM period, from one of three inputs:
 *   - three hall sensors (hall.h);
 *   - an incremental encoder with index (encoder.h);
 *   - an absolute electrical angle (resolver, or the ideal angle of a simulation), smoothed by a
 * tracking loop (tracking.h).
 */
#ifndef FOC_ROTOR_H
#define FOC_ROTOR_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "foc/encoder.h"
#include "foc/hall.h"
#include "foc/tracking.h"

typedef struct {
    hall_t hall;
    encoder_t encoder;
    tracking_t tracking; /* of an absolute angle */
} rotor_state_t;

typedef struct {
    uint16_t theta_turn;
    int32_t speed_q32;   /* electrical turns per PWM period, forward positive */
    int32_t age_periods; /* since the last hall edge or encoder count, at most 65 535; 0 for an
                            absolute angle */
    uint16_t faults;     /* wrapping count of what a healthy sensor does not do */
    bool valid;          /* the angle may be used for torque, and the speed is that of the angle */
} rotor_out_t;

void rotor_init(rotor_state_t *state, const config_t *config);

/* The sensors that are not halls. */
rotor_out_t rotor_other_step(rotor_state_t *state, const config_t *config, uint16_t angle_turn,
                             const encoder_input_t *encoder);

/* hall_state (bit 0 A, 1 B, 2 C) is read with CONFIG_ROTOR_HALL, encoder with CONFIG_ROTOR_ENCODER,
 * angle_turn with CONFIG_ROTOR_ANGLE. out: always the same structure; what did not change is not
 * written. */
static inline void rotor_step(rotor_state_t *state, const config_t *config, uint16_t angle_turn,
                              uint8_t hall_state, const encoder_input_t *encoder, rotor_out_t *out)
{
    if (config->rotor.sensor != CONFIG_ROTOR_HALL) {
        *out = rotor_other_step(state, config, angle_turn, encoder);
        return;
    }
    const hall_t *hall = &state->hall;
    if (hall_step(&state->hall, config, hall_state)) {
        out->speed_q32 = hall->speed_q32;
        out->faults = hall->lost_edges;
        out->valid = hall->valid;
    }
    out->theta_turn = (uint16_t)(hall->theta_q32 >> 16);
    out->age_periods = hall->periods_since_edge;
}

#endif
