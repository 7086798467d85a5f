/* SPDX-License-Identifier: Apache-2.0 */
#include "application/recording.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "controller/controller.h"
#include "core/signals.h"

enum { FIRST_CAPACITY = 1024 };

static recording_t steps;

_Static_assert((int)SIGNALS_FAST_INPUT_COUNT + (int)SIGNALS_FAST_OUTPUT_COUNT <=
                       (int)HUBSIM_STEP_VALUES &&
                   (int)SIGNALS_SLOW_INPUT_COUNT + (int)SIGNALS_SLOW_OUTPUT_COUNT <=
                       (int)HUBSIM_STEP_VALUES,
               "a step's values are too few");

recording_t *recording(void)
{
    return &steps;
}

/* Before the first millisecond a vehicle may have been brought to a speed for seconds. */
static bool has_space(void)
{
    if (steps.count < steps.capacity) {
        return true;
    }
    const uint32_t capacity = steps.capacity > 0 ? 2 * steps.capacity : FIRST_CAPACITY;
    hubsim_step_t *grown = realloc(steps.step, capacity * sizeof *grown);
    if (grown == NULL) {
        steps.lost = true;
        return false;
    }
    steps.step = grown;
    steps.capacity = capacity;
    return true;
}

/* NULL: nobody records. */
static hubsim_step_t *next(int16_t kind)
{
    if (!steps.on || !has_space()) {
        return NULL;
    }
    hubsim_step_t *step = &steps.step[steps.count];
    steps.count++;
    memset(step, 0, sizeof *step);
    step->kind = kind;
    return step;
}

/* The latest step if it is of this kind. */
static hubsim_step_t *latest(int16_t kind)
{
    hubsim_step_t *step = steps.count > 0 ? &steps.step[steps.count - 1] : NULL;
    return steps.on && step != NULL && step->kind == kind ? step : NULL;
}

/* Names that the linker prescribes: a call of NAME comes to __wrap_NAME, which finds the function
 * itself as __real_NAME. NOLINTBEGIN(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp) */
void __real_controller_init(controller_t *controller, const config_t *config, int32_t timer_Hz);
void __wrap_controller_init(controller_t *controller, const config_t *config, int32_t timer_Hz);
void __real_controller_start_warm(controller_slow_t *slow, int32_t warmest_cC);
void __wrap_controller_start_warm(controller_slow_t *slow, int32_t warmest_cC);
void __real_controller_start_hold(controller_slow_t *slow, hill_hold_kept_t kept);
void __wrap_controller_start_hold(controller_slow_t *slow, hill_hold_kept_t kept);
void __real_controller_fast_report_copy(const controller_fast_t *fast, fast_report_t *report);
void __wrap_controller_fast_report_copy(const controller_fast_t *fast, fast_report_t *report);
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

void __wrap_controller_init(controller_t *controller, const config_t *config, int32_t timer_Hz)
{
    hubsim_step_t *step = next(HUBSIM_STEP_BOOT);
    if (step != NULL) {
        step->values[HUBSIM_BOOT_KEPT_cC] = TEMPERATURE_NONE_cC;
        step->values[HUBSIM_BOOT_HOLD_DIRECTION] = DRIVE_DIRECTION_NEUTRAL;
        steps.config = *config;
    }
    __real_controller_init(controller, config, timer_Hz);
}

void __wrap_controller_start_warm(controller_slow_t *slow, int32_t warmest_cC)
{
    hubsim_step_t *step = latest(HUBSIM_STEP_BOOT);
    if (step != NULL) {
        step->values[HUBSIM_BOOT_KEPT_cC] = warmest_cC;
    }
    __real_controller_start_warm(slow, warmest_cC);
}

void __wrap_controller_start_hold(controller_slow_t *slow, hill_hold_kept_t kept)
{
    hubsim_step_t *step = latest(HUBSIM_STEP_BOOT);
    if (step != NULL) {
        step->values[HUBSIM_BOOT_HOLD_DIRECTION] = kept.direction;
        step->values[HUBSIM_BOOT_HOLD_LEAVES] = kept.leaves;
    }
    __real_controller_start_hold(slow, kept);
}

#define STORE_INPUT(name, raw, member, ...) *value++ = (int32_t)in->member;
#define STORE_OUTPUT(name, raw, member, ...) *value++ = (int32_t)out->member;

static void store_fast(int32_t *value, const fast_input_t *in, const fast_output_t *out)
{
    SIGNALS_FAST_INPUTS(STORE_INPUT)
    SIGNALS_FAST_OUTPUTS(STORE_OUTPUT)
}

static void store_slow(int32_t *value, const slow_input_t *in, const slow_output_t *out)
{
    SIGNALS_SLOW_INPUTS(STORE_INPUT)
    SIGNALS_SLOW_OUTPUTS(STORE_OUTPUT)
}

const fast_output_t *__wrap_controller_fast_step(controller_fast_t *fast, const config_t *config,
                                                 const fast_setpoint_t *setpoint,
                                                 const fast_input_t *in)
{
    const fast_output_t *out = __real_controller_fast_step(fast, config, setpoint, in);
    hubsim_step_t *step = next(HUBSIM_STEP_FAST);
    if (step != NULL) {
        store_fast(step->values, in, out);
    }
    return out;
}

void __wrap_controller_fast_report_copy(const controller_fast_t *fast, fast_report_t *report)
{
    hubsim_step_t *step = latest(HUBSIM_STEP_FAST);
    if (step != NULL) {
        step->reports = 1;
    }
    __real_controller_fast_report_copy(fast, report);
}

slow_output_t __wrap_controller_slow_step(controller_slow_t *slow, const config_t *config,
                                          const fast_report_t *report, const slow_input_t *in,
                                          fast_setpoint_t *setpoint)
{
    const slow_output_t out = __real_controller_slow_step(slow, config, report, in, setpoint);
    hubsim_step_t *step = next(HUBSIM_STEP_SLOW);
    if (step != NULL) {
        store_slow(step->values, in, &out);
    }
    return out;
}
/* NOLINTEND(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp) */
