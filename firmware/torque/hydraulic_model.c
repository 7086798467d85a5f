/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/hydraulic_model.h"

#include "core/q15.h"

enum { ONE_Q6 = 64, STEPS_PER_S = 1000 };

void hydraulic_model_init(hydraulic_model_t *model)
{
    const hydraulic_model_t at_rest = {.next = 0};
    *model = at_rest;
}

/* The command at the end of its dead time. */
static int32_t arrived_mNm(hydraulic_model_t *model, int32_t dead_time_ms, int32_t command_mNm)
{
    const int32_t length = q_clamp(dead_time_ms, 0, HYDRAULIC_MODEL_DEAD_TIME_MOST_ms) + 1;
    model->commands_mNm[model->next] = command_mNm;
    model->next = model->next + 1 < length ? model->next + 1 : 0;
    return model->commands_mNm[model->next];
}

void hydraulic_model_step(hydraulic_model_t *model, const config_t *config, int32_t command_mNm)
{
    const config_brake_t *brake = &config->brake;
    const int32_t most_mNm = q_clamp(command_mNm, 0, brake->max_hydraulic_torque_mNm);
    const int32_t target_q6 = arrived_mNm(model, brake->hydraulic_dead_time_ms, most_mNm) * ONE_Q6;
    const int32_t largest_q6 =
        q_max(brake->hydraulic_rate_mNm_s / STEPS_PER_S * ONE_Q6 +
                  brake->hydraulic_rate_mNm_s % STEPS_PER_S * ONE_Q6 / STEPS_PER_S,
              1);
    const int32_t change_q6 =
        (target_q6 - model->torque_q6_mNm) / (brake->hydraulic_time_constant_ms + 1);
    model->torque_q6_mNm += q_clamp(change_q6, -largest_q6, largest_q6);
}
