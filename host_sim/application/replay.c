/* SPDX-License-Identifier: Apache-2.0 */
/* A controller alone, in the order of steps in which an application called it. */
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "application/steps.h"
#include "config/bases.h"
#include "config/validate.h"
#include "controller/controller.h"
#include "exchange/variables.h"

struct hubsim_replay {
    bool has_config, has_booted;
    config_t next; /* from the next boot on */
    config_t config;
    controller_t controller;
    fast_setpoint_t to_fast;
    fast_report_t from_fast;
};

hubsim_replay_t *hubsim_replay_new(void)
{
    return calloc(1, sizeof(hubsim_replay_t));
}

void hubsim_replay_delete(hubsim_replay_t *replay)
{
    free(replay);
}

int hubsim_replay_config(hubsim_replay_t *replay, const void *image, uint32_t size_bytes)
{
    config_t config;
    memset(&config, 0, sizeof(config));
    memcpy(&config, image, size_bytes < sizeof(config) ? size_bytes : sizeof(config));
    if (config_validate(&config, size_bytes).code != CONFIG_RESULT_OK) {
        return HUBSIM_BAD_CONFIG;
    }
    replay->next = config;
    replay->has_config = true;
    return HUBSIM_OK;
}

/* As app.c starts control. */
static void boot(hubsim_replay_t *replay, const int32_t *values)
{
    const hill_hold_kept_t hold = {
        .direction = (drive_direction_t)values[HUBSIM_BOOT_HOLD_DIRECTION],
        .leaves = values[HUBSIM_BOOT_HOLD_LEAVES] != 0,
    };
    replay->config = replay->next;
    controller_init(&replay->controller, &replay->config, BASES_MODEL_TIMER_Hz);
    controller_start_warm(&replay->controller.slow, values[HUBSIM_BOOT_KEPT_cC]);
    controller_start_hold(&replay->controller.slow, hold);
    replay->to_fast = controller_initial_setpoint(&replay->config, BASES_MODEL_TIMER_Hz);
    controller_fast_report(&replay->controller.fast, &replay->from_fast);
    replay->has_booted = true;
}

static void fast_step(hubsim_replay_t *replay, hubsim_step_t *step)
{
    fast_input_t in;
    memset(&in, 0, sizeof(in));
    variables_to_message(EXCHANGE_PORT_FAST_INPUT, step->values, &in);
    const fast_output_t *out =
        controller_fast_step(&replay->controller.fast, &replay->config, &replay->to_fast, &in);
    variables_from_message(EXCHANGE_PORT_FAST_OUTPUT, out,
                           &step->values[variables_count(EXCHANGE_PORT_FAST_INPUT)]);
    if (step->reports != 0) {
        controller_fast_report(&replay->controller.fast, &replay->from_fast);
    }
}

static void slow_step(hubsim_replay_t *replay, hubsim_step_t *step)
{
    slow_input_t in;
    memset(&in, 0, sizeof(in));
    variables_to_message(EXCHANGE_PORT_SLOW_INPUT, step->values, &in);
    const slow_output_t out = controller_slow_step(&replay->controller.slow, &replay->config,
                                                   &replay->from_fast, &in, &replay->to_fast);
    variables_from_message(EXCHANGE_PORT_SLOW_OUTPUT, &out,
                           &step->values[variables_count(EXCHANGE_PORT_SLOW_INPUT)]);
}

int hubsim_replay_steps(hubsim_replay_t *replay, hubsim_step_t *steps, int count)
{
    for (int k = 0; k < count; k++) {
        const int16_t kind = steps[k].kind;
        if (kind == HUBSIM_STEP_BOOT && replay->has_config) {
            boot(replay, steps[k].values);
        } else if (kind == HUBSIM_STEP_FAST && replay->has_booted) {
            fast_step(replay, &steps[k]);
        } else if (kind == HUBSIM_STEP_SLOW && replay->has_booted) {
            slow_step(replay, &steps[k]);
        } else {
            return HUBSIM_BAD_ORDER;
        }
    }
    return HUBSIM_OK;
}
