/* SPDX-License-Identifier: Apache-2.0 */
/*
 * rotor.h: electrical angle and speed, once per PWM period, from the configured sensor: three hall
 * sensors (hall.h), an incremental encoder with index (encoder.h), or an absolute angle (resolver,
 * simulation) through a tracking loop (absolute_angle.h).
 */
#ifndef FOC_ROTOR_H
#define FOC_ROTOR_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "emf_observer.h"
#include "foc/input.h"
#include "foc/state.h"
#include "hall.h"

void rotor_init(rotor_state_t *state, const config_t *config);

/* Encoder or absolute angle. */
void rotor_other_step(rotor_state_t *state, const config_t *config, const foc_input_t *in,
                      rotor_out_t *out);

/* In a period in which the hall sensors have changed; false without them. */
static inline bool rotor_at_hall_edge(const rotor_state_t *state)
{
    return state->sensor == CONFIG_ROTOR_HALL && state->hall.periods_since_edge == 0;
}

/* out: always the same structure; unchanged fields are not written. The sensor is looked up only
 * in a period with an event; without hall sensors that is every period, because hall_init() leaves
 * an edge overdue. */
static inline void rotor_step(rotor_state_t *state, const config_t *config, const foc_input_t *in,
                              const emf_observer_t *observer, const observer_tuning_t *tuning,
                              rotor_out_t *out)
{
    hall_t *hall = &state->hall;
    if (!hall_extrapolate(hall, in->hall_state)) {
        if (state->sensor != CONFIG_ROTOR_HALL) {
            rotor_other_step(state, config, in, out);
            return;
        }
        const hall_observed_t observed = {
            .theta_turn = emf_observer_rotor_turn(observer, tuning),
            .known = emf_observer_acquired(observer),
        };
        hall_t *before = &state->before_edge;
        if (!hall_process_reading(hall, before, config, in->hall_state, observed)) {
            out->theta_turn = (uint16_t)((before->theta_q32 + (uint32_t)before->speed_q32) >> 16);
            return;
        }
        out->speed_q32 = hall->speed_q32;
        out->faults = hall->faults;
        out->valid = hall->valid;
    }
    out->theta_turn = (uint16_t)(hall->theta_q32 >> 16);
}

#endif
