/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/brake_sensor.h"

#include <math.h>

static const double ON = 0.5; /* a switch given as a number */

static int milliseconds(double time_s)
{
    return (int)lround(time_s * 1e3);
}

brake_sensor_state_t brake_sensor_init(random_t random)
{
    const brake_sensor_state_t out = {.random = random};
    return out;
}

brake_sensor_report_t brake_sensor_step(const brake_sensor_params_t *params,
                                        brake_sensor_state_t *state, double torque_nm)
{
    const int length = BRAKE_SENSOR_DELAY_MS_MAX + 1;
    state->torques_nm[state->next] = torque_nm;
    const int seen = (state->next + length - milliseconds(params->delay_s)) % length;
    state->next = (state->next + 1) % length;
    if (params->stuck < ON) {
        state->shown_nm = state->torques_nm[seen] * (1.0 + params->gain_error) + params->offset_nm;
    }
    state->report.age_ms++;
    state->due_ms--;
    if (params->fitted > ON && params->silent < ON && state->due_ms <= 0) {
        state->due_ms = milliseconds(params->period_s);
        state->report.torque_nm = state->shown_nm;
        if (params->noise_nm > 0.0 && params->stuck < ON) {
            state->report.torque_nm += params->noise_nm * random_gaussian(&state->random);
        }
        state->report.age_ms = 0;
        state->report.valid = params->invalid < ON;
    }
    return state->report;
}
