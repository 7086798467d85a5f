/* SPDX-License-Identifier: Apache-2.0 */
#include "steps.h"

/* The linker (--wrap) makes each call of a step one of __wrap_..., and of __real_... one of the
 * step. */
const fast_output_t *__real_controller_fast_step(controller_fast_t *fast, const config_t *config,
                                                 const fast_setpoint_t *setpoint,
                                                 const fast_input_t *in);
const fast_output_t *__wrap_controller_fast_step(controller_fast_t *fast, const config_t *config,
                                                 const fast_setpoint_t *setpoint,
                                                 const fast_input_t *in);
slow_output_t __real_controller_slow_step(controller_slow_t *slow, const config_t *config,
                                          const fast_report_t *report, const slow_input_t *in,
                                          fast_setpoint_t *setpoint);
slow_output_t __wrap_controller_slow_step(controller_slow_t *slow, const config_t *config,
                                          const fast_report_t *report, const slow_input_t *in,
                                          fast_setpoint_t *setpoint);

const fast_output_t *__wrap_controller_fast_step(controller_fast_t *fast, const config_t *config,
                                                 const fast_setpoint_t *setpoint,
                                                 const fast_input_t *in)
{
    const fast_output_t *output = __real_controller_fast_step(fast, config, setpoint, in);
    oracle_fast(fast, output);
    return output;
}

slow_output_t __wrap_controller_slow_step(controller_slow_t *slow, const config_t *config,
                                          const fast_report_t *report, const slow_input_t *in,
                                          fast_setpoint_t *setpoint)
{
    const slow_output_t output = __real_controller_slow_step(slow, config, report, in, setpoint);
    oracle_slow(slow, report, &output, setpoint, controller_limits(slow));
    return output;
}
