/* SPDX-License-Identifier: Apache-2.0 */
/* Faults of the program are injected here, by the bench's own code (bench/injection.c), because
 * they concern the controller's memory and the calls of its steps. */
#include "serve.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "bench/injection.h"
#include "config/bases.h"
#include "controller/controller.h"

/* One wheel's controller with what lies between its two steps. */
typedef struct {
    controller_t controller;
    fast_setpoint_t to_fast;
    injection_t injection;
    fast_output_t next;
    slow_output_t slow;
} wheel_t;

static wheel_t wheels[PIL_WHEELS_MAX];
static pil_memory_t *memory;
static uint32_t done;

static injection_target_t target_of(wheel_t *wheel)
{
    const injection_target_t target = {
        .controller = &wheel->controller, .config = &memory->config, .to_fast = &wheel->to_fast};
    return target;
}

static fault_params_t fault_of(const pil_request_t *request)
{
    fault_params_t fault;
    memset(&fault, 0, sizeof fault);
    int k = 0;
#define OF_NUMBER(name, lowest, highest, unit, text) fault.name = request->fault[k++];
    PROGRAM_FAULT_PARAMETERS(OF_NUMBER)
#undef OF_NUMBER
    return fault;
}

static void begin(uint32_t count)
{
    const config_t *config = &memory->config;
    for (uint32_t k = 0; k < count && k < PIL_WHEELS_MAX; k++) {
        wheel_t *wheel = &wheels[k];
        memset(wheel, 0, sizeof *wheel);
        controller_init(&wheel->controller, config, BASES_MODEL_TIMER_Hz);
        wheel->to_fast = controller_initial_setpoint(config, BASES_MODEL_TIMER_Hz);
        wheel->next.bridge = BRIDGE_OFF;
    }
}

static void fast(const pil_request_t *request, wheel_t *wheel, pil_answer_t *answer)
{
    fast_input_t in;
    {
        const int32_t *raw = request->raw;
        fast_input_t *message = &in;
        int k = 0;
        SIGNALS_FAST_INPUTS(PIL_FROM_RAW)
    }
    if (request->has_fault != 0) {
        const fault_params_t fault = fault_of(request);
        const injection_target_t target = target_of(wheel);
        injection_fast(&fault, &wheel->injection, &target, &in, &wheel->next);
    } else {
        wheel->next =
            *controller_fast_step(&wheel->controller.fast, &memory->config, &wheel->to_fast, &in);
    }
    const fast_output_t *message = &wheel->next;
    int32_t *raw = answer->fast;
    int k = 0;
    SIGNALS_FAST_OUTPUTS(PIL_TO_RAW)
    answer->theta_turn = foc_latest(&wheel->controller.fast.foc)->rotor.theta_turn;
}

static void show_limits(const limit_t *lines, pil_limit_t *shown)
{
    for (int k = 0; k < (int)TORQUE_LINE_COUNT; k++) {
        shown[k].torque_mNm = lines[k].torque_mNm;
        shown[k].reason = (int32_t)lines[k].reason;
    }
}

static void slow(const pil_request_t *request, wheel_t *wheel, pil_answer_t *answer)
{
    slow_input_t in;
    {
        const int32_t *raw = request->raw;
        slow_input_t *message = &in;
        int k = 0;
        SIGNALS_SLOW_INPUTS(PIL_FROM_RAW)
    }
    if (request->has_fault != 0) {
        const fault_params_t fault = fault_of(request);
        const injection_target_t target = target_of(wheel);
        wheel->slow = injection_slow(&fault, &wheel->injection, &target, &in, &wheel->slow);
    } else {
        fast_report_t report;
        controller_fast_report(&wheel->controller.fast, &report);
        wheel->slow = controller_slow_step(&wheel->controller.slow, &memory->config, &report, &in,
                                           &wheel->to_fast);
    }
    const slow_output_t *message = &wheel->slow;
    int32_t *raw = answer->slow;
    int k = 0;
    SIGNALS_SLOW_OUTPUTS(PIL_TO_RAW)
    const torque_limits_t *table = controller_limits(&wheel->controller.slow);
    const wheel_temperatures_t in_use = controller_temperatures(&wheel->controller.slow);
    answer->winding_cC = in_use.winding_cC;
    answer->switch_cC = in_use.switch_cC;
    show_limits(table->driving, answer->driving);
    show_limits(table->braking, answer->braking);
}

static void execute(const pil_request_t *request)
{
    const uint32_t k = request->wheel % PIL_WHEELS_MAX;
    switch (request->operation) {
    case PIL_BEGIN:
        begin(request->wheel);
        break;
    case PIL_FAST:
        fast(request, &wheels[k], &memory->answer[k]);
        break;
    default:
        slow(request, &wheels[k], &memory->answer[k]);
        break;
    }
}

void pil_ready(pil_memory_t *shared)
{
    memory = shared;
    memory->layout = pil_layout();
    atomic_store(&memory->magic, PIL_MAGIC);
}

void pil_serve(void)
{
    while (done != atomic_load(&memory->posted)) {
        execute(&memory->request[done % PIL_REQUESTS]);
        done++;
        atomic_store(&memory->done, done);
    }
}
