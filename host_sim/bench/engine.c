/* SPDX-License-Identifier: Apache-2.0 */
#include "bench/engine.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/handle.h"
#include "bench/signals.h"
#include "config/validate.h"

static const double CLOCK_ROUNDING_S = 1e-9;
static const char NOT_THE_FIRMWARE[] =
    "after hubsim_external_take the vehicle goes on with hubsim_external_step only";
static const char ONLY_ALIKE[] = "accepted: with front and rear drives that are alike";
static const char ELSEWHERE[] =
    "hubsim_save and hubsim_restore: accepted where the engine has the controllers' state, without "
    "hubsim_processor and hubsim_application";

hubsim_t *hubsim_new(void)
{
    hubsim_t *sim = calloc(1, sizeof(*sim));
    if (sim != NULL) {
        sim->params.battery.open_circuit_voltage_v = curve_constant(0.0);
    }
    return sim;
}

int handle_after_period(hubsim_t *sim)
{
    const bench_t *bench = &sim->bench;
    if (sim->has_processor) {
        const char *objection = sim->processor.objection(sim->processor.context);
        if (objection != NULL) {
            return handle_fail(sim, HUBSIM_FAILED, "%s", objection);
        }
    }
    if (bench->battery.collapsed || bench->bus.collapsed) {
        return handle_fail(sim, HUBSIM_FAILED,
                           "the %s cannot give the power that was drawn at %.3f s: its voltage "
                           "collapsed",
                           bench->battery.collapsed ? "battery" : "bus", bench->time_s);
    }
    return HUBSIM_OK;
}

void hubsim_delete(hubsim_t *sim)
{
    if (sim != NULL) {
        if (sim->has_processor) {
            sim->processor.close(sim->processor.context);
        }
        if (sim->has_application) {
            sim->application.close(sim->application.context);
        }
        hubsim_delete(sim->rear);
        free(sim->trace_memory);
        free(sim->energy_memory);
        free(sim);
    }
}

const char *hubsim_error(const hubsim_t *sim)
{
    return sim->error;
}

int handle_fail(hubsim_t *sim, int code, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(sim->error, sizeof(sim->error), format, arguments);
    va_end(arguments);
    return code;
}

/* Faults that need the whole application, or that it cannot have. NULL: none of them. */
static const char *misplaced_fault(const hubsim_t *sim, const fault_params_t *fault)
{
    if (!sim->has_application && (fault->can_unsent > 0.0 || fault->can_load > 0.0)) {
        return "fault.can_unsent and fault.can_load: accepted: 0 without the whole application";
    }
    if (sim->has_application && (fault->slow_late > 0.0 || fault->fast_late > 0.0 ||
                                 fault->state_bit > 0.0 || fault->config_bit > 0.0)) {
        return "fault.slow_late, fast_late, state_bit and config_bit: accepted: 0 with the whole "
               "application";
    }
    if (sim->rear != NULL && fault->config_bit > 0.0) {
        return "fault.config_bit: accepted: 0 with front and rear drives that differ";
    }
    return NULL;
}

int hubsim_set(hubsim_t *sim, const char *name, double value)
{
    const int index = parameters_find(name);
    if (index < 0) {
        return handle_fail(sim, HUBSIM_BAD_NAME, "%s: no such parameter", name);
    }
    bench_params_t changed = sim->has_started ? sim->bench.params : sim->params;
    if (!parameters_set(&changed, index, value)) {
        const parameter_info_t info = parameters_info(index);
        return handle_fail(sim, HUBSIM_BAD_VALUE, "%s: %g %s, accepted: %g to %g", name, value,
                           info.unit, info.lowest, info.highest);
    }
    if (!sim->has_started) {
        sim->params = changed;
        return HUBSIM_OK;
    }
    const char *objection = misplaced_fault(sim, &changed.fault);
    if (objection == NULL) {
        objection = bench_objection(&sim->bench, &changed);
    }
    if (objection != NULL) {
        return handle_fail(sim, HUBSIM_BAD_ORDER, "%s", objection);
    }
    sim->bench.params = changed;
    if (sim->rear != NULL) {
        (void)parameters_set(&sim->bench.rear_params, index, value);
    }
    if (index == parameters_find("battery.initial_soc")) {
        sim->bench.battery.soc = value;
    }
    bench_refresh(&sim->bench);
    return HUBSIM_OK;
}

int hubsim_get(const hubsim_t *sim, const char *name, double *value)
{
    const int index = parameters_find(name);
    if (index < 0) {
        return HUBSIM_BAD_NAME;
    }
    *value = parameters_get(sim->has_started ? &sim->bench.params : &sim->params, index);
    return HUBSIM_OK;
}

int hubsim_set_voltage_curve(hubsim_t *sim, const double *soc, const double *voltage_v, int points)
{
    curve_t curve = curve_constant(0.0);
    if (!curve_set(&curve, soc, voltage_v, points)) {
        return handle_fail(sim, HUBSIM_BAD_VALUE,
                           "open-circuit voltage: %d points, accepted: 1 to %d with rising soc",
                           points, CURVE_POINTS_MAX);
    }
    for (int k = 0; k < points; k++) {
        if (!(voltage_v[k] > 0.0)) {
            return handle_fail(sim, HUBSIM_BAD_VALUE,
                               "open-circuit voltage: %g V, accepted: more than 0 V", voltage_v[k]);
        }
    }
    sim->params.battery.open_circuit_voltage_v = curve;
    if (sim->has_started) {
        sim->bench.params.battery.open_circuit_voltage_v = curve;
    }
    return HUBSIM_OK;
}

static bool is_axis(const energy_axis_t *axis)
{
    return axis->cells >= 1 && axis->cells <= (int)ENERGY_MAP_CELLS_MAX && axis->step_wb > 0.0 &&
           isfinite(axis->first_wb) && isfinite(axis->step_wb);
}

int hubsim_set_energy_map(hubsim_t *sim, const hubsim_energy_map_t *map)
{
    if (sim->has_started) {
        return handle_fail(sim, HUBSIM_BAD_ORDER, "the energy map cannot be changed during a run");
    }
    const energy_map_t found = {
        .d = {.first_wb = map->d_first_wb, .step_wb = map->d_step_wb, .cells = map->d_cells},
        .q = {.first_wb = map->q_first_wb, .step_wb = map->q_step_wb, .cells = map->q_cells},
    };
    if (!is_axis(&found.d) || !is_axis(&found.q)) {
        return handle_fail(sim, HUBSIM_BAD_VALUE,
                           "energy map: accepted: 1 to %d cells an axis, steps above 0",
                           (int)ENERGY_MAP_CELLS_MAX);
    }
    const size_t count = (size_t)(found.d.cells + (int)ENERGY_MAP_MORE) *
                         (size_t)(found.q.cells + (int)ENERGY_MAP_MORE);
    double *memory = malloc(sizeof(double) * count);
    if (memory == NULL) {
        return handle_fail(sim, HUBSIM_FAILED, "no memory for an energy map of %zu numbers", count);
    }
    memcpy(memory, map->coefficient_j, sizeof(double) * count);
    free(sim->energy_memory);
    sim->energy_memory = memory;
    sim->energy_map = found;
    sim->energy_map.coefficient_j = memory;
    sim->params.motor.energy_map = &sim->energy_map;
    return HUBSIM_OK;
}

static bool is_rising_from_zero(const double *time_s, int points)
{
    if (points < 1 || !(time_s[0] >= 0.0)) {
        return false;
    }
    for (int k = 1; k < points; k++) {
        if (!(time_s[k] > time_s[k - 1])) {
            return false;
        }
    }
    return true;
}

int hubsim_set_trace(hubsim_t *sim, const double *time_s, const double *speed_m_per_s, int points)
{
    if (sim->has_started) {
        return handle_fail(sim, HUBSIM_BAD_ORDER, "the speed trace cannot be changed during a run");
    }
    if (!is_rising_from_zero(time_s, points)) {
        return handle_fail(sim, HUBSIM_BAD_VALUE,
                           "speed trace: accepted: at least one point, times rising from 0");
    }
    double *memory = malloc(2U * sizeof(double) * (size_t)points);
    if (memory == NULL) {
        return handle_fail(sim, HUBSIM_FAILED, "no memory for a speed trace of %d points", points);
    }
    memcpy(memory, time_s, sizeof(double) * (size_t)points);
    memcpy(memory + points, speed_m_per_s, sizeof(double) * (size_t)points);
    free(sim->trace_memory);
    sim->trace_memory = memory;
    sim->trace.time_s = memory;
    sim->trace.speed_m_per_s = memory + points;
    sim->trace.points = points;
    return HUBSIM_OK;
}

static int refused(hubsim_t *sim, const config_result_t *result)
{
    if (result->code == CONFIG_RESULT_RANGE) {
        return handle_fail(sim, HUBSIM_BAD_CONFIG,
                           "configuration refused: %s%s: %ld, accepted: %ld to %ld",
                           result->section, result->field, (long)result->value,
                           (long)result->lowest, (long)result->highest);
    }
    return handle_fail(sim, HUBSIM_BAD_CONFIG, "configuration refused: %s%s%s%s%s",
                       CONFIG_RESULT_TEXTS(result));
}

int hubsim_load_config(hubsim_t *sim, const void *image, uint32_t size_bytes)
{
    if (sim->has_started) {
        return handle_fail(sim, HUBSIM_BAD_ORDER,
                           "the configuration cannot be changed during a run");
    }
    config_t config;
    memset(&config, 0, sizeof(config));
    memcpy(&config, image, size_bytes < sizeof(config) ? size_bytes : sizeof(config));
    const config_result_t result = config_validate(&config, size_bytes);
    if (result.code != CONFIG_RESULT_OK) {
        return refused(sim, &result);
    }
    sim->config = config;
    sim->has_config = true;
    return HUBSIM_OK;
}

static int check_params(hubsim_t *sim)
{
    for (int k = 0; k < parameters_count(); k++) {
        const parameter_info_t info = parameters_info(k);
        const double value = parameters_get(&sim->params, k);
        if (!(value >= info.lowest && value <= info.highest)) {
            return handle_fail(sim, HUBSIM_BAD_ORDER, "%s: never set, accepted: %g to %g %s",
                               info.name, info.lowest, info.highest, info.unit);
        }
    }
    if (sim->params.battery.open_circuit_voltage_v.y[0] <= 0.0) {
        return handle_fail(sim, HUBSIM_BAD_ORDER, "open-circuit voltage: never set");
    }
    if (sim->params.bus.contactor_open > 0.0) {
        return handle_fail(sim, HUBSIM_BAD_ORDER,
                           "bus.contactor_open: accepted: 0 when a run begins");
    }
    if (sim->params.inverter.switching > 0.5 && sim->params.run.pieces > 1.0) {
        return handle_fail(sim, HUBSIM_BAD_ORDER,
                           "run.pieces: accepted: 0 or 1 while inverter.switching is 1");
    }
    const char *objection = misplaced_fault(sim, &sim->params.fault);
    if (objection == NULL) {
        objection = bench_world_objection(&sim->params);
    }
    if (objection != NULL) {
        return handle_fail(sim, HUBSIM_BAD_ORDER, "%s", objection);
    }
    return HUBSIM_OK;
}

static int not_run(hubsim_t *sim)
{
    for (int k = 0; k < sim->bench.wheels; k++) {
        const wheel_t *wheel = &sim->bench.wheel[k];
        if (wheel->slow.mode != MODE_RUN) {
            return handle_fail(sim, HUBSIM_FAILED,
                               "the controller of wheel %d stays in %s before the run begins: %s",
                               k, operating_mode_text(wheel->slow.mode),
                               reason_text(wheel->slow.fault_reason));
        }
    }
    return handle_fail(sim, HUBSIM_FAILED, "the controllers do not run");
}

int hubsim_set_rear(hubsim_t *sim, hubsim_t *rear)
{
    if (sim->has_started || sim->rear != NULL || rear == sim || rear->has_started ||
        rear->rear != NULL || !rear->has_config) {
        return handle_fail(sim, HUBSIM_BAD_ORDER,
                           "hubsim_set_rear: accepted: once, before hubsim_start, a handle with a "
                           "configuration that was not started");
    }
    sim->rear = rear;
    return HUBSIM_OK;
}

/* What is wrong with the rear drives, noted; HUBSIM_OK: nothing, or there are none. */
static int check_rear(hubsim_t *sim)
{
    if (sim->rear == NULL) {
        return HUBSIM_OK;
    }
    if (sim->has_processor) {
        return handle_fail(sim, HUBSIM_BAD_ORDER, "hubsim_processor: %s", ONLY_ALIKE);
    }
    const int checked = check_params(sim->rear);
    if (checked != HUBSIM_OK) {
        return handle_fail(sim, checked, "rear drives: %s", sim->rear->error);
    }
    const char *objection = bench_rear_objection(&sim->params, &sim->rear->params);
    return objection == NULL ? HUBSIM_OK : handle_fail(sim, HUBSIM_BAD_ORDER, "%s", objection);
}

/* Who is in the place of the engine's own controllers. NULL, or what is wrong. */
static const char *take_controllers(hubsim_t *sim)
{
    if (sim->has_processor) {
        bench_use_processor(&sim->bench, &sim->processor);
    }
    return sim->has_application ? sim->application.start(sim->application.context, &sim->bench)
                                : NULL;
}

int hubsim_start(hubsim_t *sim)
{
    if (!sim->has_config) {
        return handle_fail(sim, HUBSIM_BAD_ORDER, "no configuration was loaded");
    }
    int checked = check_params(sim);
    checked = checked == HUBSIM_OK ? check_rear(sim) : checked;
    if (checked != HUBSIM_OK) {
        return checked;
    }
    bench_init(&sim->bench, &sim->params, &sim->config, &sim->trace);
    if (sim->rear != NULL) {
        bench_set_rear(&sim->bench, &sim->rear->params, &sim->rear->config);
    }
    sim->has_started = true;
    const char *objection = take_controllers(sim);
    if (objection != NULL) {
        return handle_fail(sim, HUBSIM_FAILED, "the application: %s", objection);
    }
    switch (bench_start(&sim->bench)) {
    case BENCH_READY:
        break;
    case BENCH_NOT_RUN:
        return handle_after_period(sim) == HUBSIM_OK ? not_run(sim) : HUBSIM_FAILED;
    case BENCH_UNRESOLVED:
        return handle_fail(
            sim, HUBSIM_FAILED,
            "the windings' time constant L/R is shorter than a PWM period: raise the "
            "inductance or the frequency");
    }
    recorder_begin(&sim->recorder, &sim->bench);
    return HUBSIM_OK;
}

int hubsim_signal_count(const hubsim_t *sim)
{
    return sim->has_started ? signals_count(&sim->bench) : 0;
}

int hubsim_signal_name(const hubsim_t *sim, int index, char *name, int size)
{
    if (index < 0 || index >= hubsim_signal_count(sim) || size < 1) {
        return HUBSIM_BAD_NAME;
    }
    signals_name(&sim->bench, index, name, (size_t)size);
    return HUBSIM_OK;
}

static bool is_signal(const hubsim_t *sim, int index)
{
    return index >= 0 && index < hubsim_signal_count(sim);
}

const char *hubsim_signal_unit(const hubsim_t *sim, int index)
{
    return is_signal(sim, index) ? signals_unit(&sim->bench, index) : NULL;
}

const char *hubsim_signal_text(const hubsim_t *sim, int index)
{
    return is_signal(sim, index) ? signals_text(&sim->bench, index) : NULL;
}

int hubsim_choose(hubsim_t *sim, const int *indices, int count)
{
    if (!sim->has_started) {
        return handle_fail(sim, HUBSIM_BAD_ORDER, "signals are known after hubsim_start");
    }
    if (!recorder_choose(&sim->recorder, &sim->bench, indices, count)) {
        return handle_fail(sim, HUBSIM_BAD_NAME,
                           "%d signals: accepted: up to %d, each from 0 to %d", count,
                           RECORDER_SIGNALS_MAX, signals_count(&sim->bench) - 1);
    }
    recorder_begin(&sim->recorder, &sim->bench);
    return HUBSIM_OK;
}

static int one_period(hubsim_t *sim)
{
    bench_period(&sim->bench);
    return handle_after_period(sim);
}

int hubsim_run(hubsim_t *sim, double duration_s, double *rows, int64_t capacity, int64_t *written,
               double *remaining_s)
{
    *written = 0;
    *remaining_s = duration_s;
    if (!sim->has_started) {
        return handle_fail(sim, HUBSIM_BAD_ORDER, "hubsim_start comes first");
    }
    if (sim->external.at_work) {
        return handle_fail(sim, HUBSIM_BAD_ORDER, "%s", NOT_THE_FIRMWARE);
    }
    bench_t *bench = &sim->bench;
    const double until_s = bench->time_s + duration_s - CLOCK_ROUNDING_S;
    for (;;) {
        if (recorder_is_due(&sim->recorder, bench)) {
            if (*written == capacity) {
                *remaining_s = until_s + CLOCK_ROUNDING_S - bench->time_s;
                return HUBSIM_FULL;
            }
            recorder_write(&sim->recorder, bench, rows + *written * sim->recorder.signals);
            (*written)++;
        }
        const bool ended = bench_has_ended(bench);
        if (ended || bench->time_s >= until_s) {
            *remaining_s = 0.0;
            return ended ? HUBSIM_ENDED : HUBSIM_OK;
        }
        const int status = one_period(sim);
        if (status != HUBSIM_OK) {
            return status;
        }
    }
}

int hubsim_advance(hubsim_t *sim, double until_s)
{
    if (!sim->has_started) {
        return handle_fail(sim, HUBSIM_BAD_ORDER, "hubsim_start comes first");
    }
    if (sim->external.at_work) {
        return handle_fail(sim, HUBSIM_BAD_ORDER, "%s", NOT_THE_FIRMWARE);
    }
    int status = HUBSIM_OK;
    while (status == HUBSIM_OK && sim->bench.time_s < until_s - CLOCK_ROUNDING_S) {
        status = bench_has_ended(&sim->bench) ? HUBSIM_ENDED : one_period(sim);
    }
    return status;
}

int hubsim_sample(hubsim_t *sim, double *row)
{
    if (!sim->has_started) {
        return handle_fail(sim, HUBSIM_BAD_ORDER, "hubsim_start comes first");
    }
    recorder_write(&sim->recorder, &sim->bench, row);
    return HUBSIM_OK;
}

/* What changes while a vehicle runs. The speed trace stays with the handle. */
typedef struct {
    recorder_t recorder;
    bench_t bench;
} snapshot_t;

uint32_t hubsim_state_bytes(void)
{
    return (uint32_t)sizeof(snapshot_t);
}

int hubsim_save(hubsim_t *sim, void *state)
{
    if (sim->external.at_work) {
        return handle_fail(sim, HUBSIM_BAD_ORDER, "%s", NOT_THE_FIRMWARE);
    }
    if (!sim->has_started) {
        return handle_fail(sim, HUBSIM_BAD_ORDER, "hubsim_start comes first");
    }
    if (sim->has_processor || sim->has_application) {
        return handle_fail(sim, HUBSIM_BAD_ORDER, "%s", ELSEWHERE);
    }
    memcpy(state, &sim->recorder, sizeof(sim->recorder));
    memcpy((unsigned char *)state + offsetof(snapshot_t, bench), &sim->bench, sizeof(sim->bench));
    return HUBSIM_OK;
}

int hubsim_restore(hubsim_t *sim, const void *state)
{
    if (sim->external.at_work) {
        return handle_fail(sim, HUBSIM_BAD_ORDER, "%s", NOT_THE_FIRMWARE);
    }
    if (!sim->has_started) {
        return handle_fail(sim, HUBSIM_BAD_ORDER, "hubsim_start comes first");
    }
    if (sim->has_processor || sim->has_application) {
        return handle_fail(sim, HUBSIM_BAD_ORDER, "%s", ELSEWHERE);
    }
    memcpy(&sim->recorder, state, sizeof(sim->recorder));
    memcpy(&sim->bench, (const unsigned char *)state + offsetof(snapshot_t, bench),
           sizeof(sim->bench));
    sim->bench.trace = sim->trace;
    sim->bench.params.motor.energy_map = sim->params.motor.energy_map;
    if (sim->rear != NULL) {
        sim->bench.rear_params.motor.energy_map = sim->rear->params.motor.energy_map;
    }
    bench_refresh(&sim->bench);
    return HUBSIM_OK;
}

int hubsim_value(const hubsim_t *sim, const char *name, double *value)
{
    const int index = sim->has_started ? signals_find(&sim->bench, name) : -1;
    if (index < 0) {
        return HUBSIM_BAD_NAME;
    }
    *value = signals_read(&sim->bench, index);
    return HUBSIM_OK;
}
