/* SPDX-License-Identifier: Apache-2.0 */
#include "rotor.h"

#include "absolute_angle.h"
#include "encoder.h"

void rotor_init(rotor_state_t *state, const config_t *config)
{
    absolute_angle_init(&state->absolute);
    state->sensor = config->rotor.sensor;
    hall_init(&state->hall, config);
    hall_init(&state->before_edge, config);
    encoder_init(&state->encoder, config);
}

void rotor_other_step(rotor_state_t *state, const config_t *config, const foc_input_t *in,
                      rotor_out_t *out)
{
    if (state->sensor == CONFIG_ROTOR_ENCODER) {
        encoder_step(&state->encoder, config, &in->encoder);
        out->theta_turn = state->encoder.theta_turn;
        out->speed_q32 = state->encoder.tracker.speed_q32;
        out->faults = state->encoder.faults;
        out->valid = state->encoder.valid;
    } else {
        absolute_angle_step(&state->absolute, config, in->rotor_angle_turn);
        out->theta_turn = (uint16_t)(state->absolute.tracker.theta_q32 >> 16);
        out->speed_q32 = state->absolute.tracker.speed_q32;
        out->faults = state->absolute.faults;
        out->valid = state->absolute.valid;
    }
}
