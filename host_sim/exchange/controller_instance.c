/* SPDX-License-Identifier: Apache-2.0 */
#include "exchange/controller_instance.h"
#include "config/bases.h"

#include <string.h>

void controller_instance_init(controller_instance_t *instance, const config_t *config)
{
    memset(instance, 0, sizeof(*instance)); /* padding too: the whole value is read when saved */
    instance->config = *config;
    controller_init(&instance->controller, &instance->config, BASES_MODEL_TIMER_Hz);
    instance->to_fast = controller_initial_setpoint(&instance->config, BASES_MODEL_TIMER_Hz);
}

void controller_instance_fast_step(controller_instance_t *instance, const int32_t *in, int32_t *out)
{
    fast_input_t sampled;
    variables_to_message(EXCHANGE_PORT_FAST_INPUT, in, &sampled);
    const fast_output_t output = *controller_fast_step(
        &instance->controller.fast, &instance->config, &instance->to_fast, &sampled);
    variables_from_message(EXCHANGE_PORT_FAST_OUTPUT, &output, out);
}

void controller_instance_slow_step(controller_instance_t *instance, const int32_t *in, int32_t *out)
{
    slow_input_t input = {.demand = {.reason = REASON_NONE}}; /* no variable of the port */
    variables_to_message(EXCHANGE_PORT_SLOW_INPUT, in, &input);
    fast_report_t report;
    controller_fast_report(&instance->controller.fast, &report);
    const slow_output_t output = controller_slow_step(&instance->controller.slow, &instance->config,
                                                      &report, &input, &instance->to_fast);
    variables_from_message(EXCHANGE_PORT_SLOW_OUTPUT, &output, out);
}
