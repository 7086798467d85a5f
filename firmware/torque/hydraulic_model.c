/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/hydraulic_model.h"

#include "core/q15.h"

enum { ONE_Q6 = 64, STEPS_PER_S = 1000 };

void hydraulic_model_init(hydraulic_model_t *model)
{
    const hydraulic_model_t at_rest = {.next = 0};
    *model = at_rest;
}

/* The command of some milliseconds ago; 0: the one of this step. No accepted dead time and report
 * delay need the limits; a bit that flips in the configuration's memory does, until it is found. */
static int32_t command_mNm_ago(const hydraulic_model_t *model, int32_t ago_ms)
{
    const int32_t at = model->next - q_clamp(ago_ms, 0, HYDRAULIC_MODEL_COMMANDS - 1);
    return model->commands_mNm[at >= 0 ? at : at + HYDRAULIC_MODEL_COMMANDS];
}

static int32_t lag_step_q6(int32_t torque_q6, int32_t target_mNm, int32_t lag_ms,
                           int32_t largest_q6)
{
    const int32_t left_q6 = target_mNm * ONE_Q6 - torque_q6;
    const int32_t last_q6 = (left_q6 > 0) - (left_q6 < 0); /* of what the division leaves */
    const int32_t share_q6 = left_q6 / q_divisor(lag_ms + 1);
    const int32_t change_q6 = share_q6 != 0 ? share_q6 : last_q6;
    return torque_q6 + q_limit(change_q6, largest_q6);
}

/* A command joins the recent ones, which become those before after a while. */
static void keep_range(hydraulic_model_t *model, int32_t command_mNm, int32_t while_ms)
{
    hydraulic_range_t *recent = &model->recent;
    recent->least_mNm = q_min(recent->least_mNm, command_mNm);
    recent->most_mNm = q_max(recent->most_mNm, command_mNm);
    model->recent_ms++;
    if (model->recent_ms >= while_ms) {
        model->before = *recent;
        recent->least_mNm = recent->most_mNm = command_mNm;
        model->recent_ms = 0;
    }
}

hydraulic_range_t hydraulic_model_commanded(const hydraulic_model_t *model)
{
    const hydraulic_range_t out = {
        .least_mNm = q_min(model->recent.least_mNm, model->before.least_mNm),
        .most_mNm = q_max(model->recent.most_mNm, model->before.most_mNm),
    };
    return out;
}

void hydraulic_model_step(hydraulic_model_t *model, const config_t *config, int32_t command_mNm)
{
    const config_brake_t *brake = &config->brake;
    const int32_t dead_ms = brake->hydraulic_dead_time_ms;
    const int32_t lag_ms = brake->hydraulic_time_constant_ms;
    const int32_t report_ms = brake->hydraulic_report_delay_ms;
    /* Of the lowest rate, 100 mN m/s, it is 6. */
    const int32_t largest_q6 = brake->hydraulic_rate_mNm_s / STEPS_PER_S * ONE_Q6 +
                               brake->hydraulic_rate_mNm_s % STEPS_PER_S * ONE_Q6 / STEPS_PER_S;
    model->next = model->next + 1 < HYDRAULIC_MODEL_COMMANDS ? model->next + 1 : 0;
    model->commands_mNm[model->next] = q_clamp(command_mNm, 0, brake->max_hydraulic_torque_mNm);
    keep_range(model, model->commands_mNm[model->next],
               2 * dead_ms + report_ms + HYDRAULIC_MODEL_BETWEEN_MOST_ms);
    model->torque_q6_mNm =
        lag_step_q6(model->torque_q6_mNm, command_mNm_ago(model, dead_ms), lag_ms, largest_q6);
    model->early_q6_mNm =
        lag_step_q6(model->early_q6_mNm, command_mNm_ago(model, dead_ms / 2 + report_ms),
                    lag_ms / 2, largest_q6);
    model->late_q6_mNm =
        lag_step_q6(model->late_q6_mNm, command_mNm_ago(model, 2 * dead_ms + report_ms), 2 * lag_ms,
                    largest_q6);
}
