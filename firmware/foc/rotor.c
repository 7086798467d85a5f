/* SPDX-License-Identifier: Apache-2.0 */
#include "foc/rotor.h"

void rotor_init(rotor_state_t *state, const config_t *config)
{
    const tracking_t still = {.started = false};
    state->tracking = still;
    hall_init(&state->hall, config);
    encoder_init(&state->encoder, config);
}

rotor_out_t rotor_other_step(rotor_state_t *state, const config_t *config, uint16_t angle_turn,
                             const encoder_input_t *encoder)
{
    rotor_out_t out = {.age_periods = 0, .faults = 0, .valid = true};
    if (config->rotor.sensor == CONFIG_ROTOR_ENCODER) {
        encoder_step(&state->encoder, config, encoder);
        out.theta_turn = state->encoder.theta_turn;
        out.speed_q32 = state->encoder.tracking.speed_q32;
        out.age_periods = state->encoder.age_periods;
        out.faults = state->encoder.faults;
        out.valid = state->encoder.valid;
    } else {
        tracking_step(&state->tracking, config, angle_turn);
        out.theta_turn = (uint16_t)(state->tracking.theta_q32 >> 16);
        out.speed_q32 = state->tracking.speed_q32;
    }
    return out;
}
