/* SPDX-License-Identifier: Apache-2.0 */
#include "unit_functions.h"

#include <string.h>

#include "fmi3Functions.h"

const size_t unit_version = 3;
char unit_message[UNIT_MESSAGE_LENGTH];

static void listen(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category,
                   fmi3String message)
{
    (void)environment;
    (void)status;
    (void)category;
    strncpy(unit_message, message, sizeof(unit_message) - 1);
}

static void *instantiate(const char *name, const char *token, fmi3LogMessageCallback log)
{
    return fmi3InstantiateCoSimulation(name, token, NULL, fmi3False, log != NULL, fmi3False,
                                       fmi3False, NULL, 0, NULL, log, NULL);
}

void *unit_new(const char *token)
{
    return instantiate("a unit", token, listen);
}

void *unit_new_of_another_kind(void)
{
    void *const scheduled = fmi3InstantiateScheduledExecution(
        "a unit", MODEL_TOKEN, NULL, fmi3False, fmi3True, NULL, listen, NULL, NULL, NULL);
    return scheduled != NULL ? scheduled
                             : fmi3InstantiateModelExchange("a unit", MODEL_TOKEN, NULL, fmi3False,
                                                            fmi3True, NULL, listen);
}

void *unit_new_without_log(const char *token)
{
    return instantiate(NULL, token, NULL);
}

void unit_delete(void *unit)
{
    fmi3FreeInstance(unit);
}

bool unit_enter(void *unit, double start_s)
{
    return fmi3EnterInitializationMode(unit, fmi3False, 0.0, start_s, fmi3False, 0.0) == fmi3OK;
}

bool unit_exit(void *unit)
{
    return fmi3ExitInitializationMode(unit) == fmi3OK;
}

bool unit_begin(void *unit, double start_s)
{
    return unit_enter(unit, start_s) && unit_exit(unit);
}

bool unit_step(void *unit, double from_s, double step_s)
{
    fmi3Boolean event = fmi3True;
    fmi3Boolean ends = fmi3True;
    fmi3Boolean early = fmi3True;
    fmi3Float64 reached_s = -1.0;
    const bool out =
        fmi3DoStep(unit, from_s, step_s, fmi3True, &event, &ends, &early, &reached_s) == fmi3OK;
    return out && !event && !ends && !early && reached_s == from_s + step_s;
}

bool unit_terminate(void *unit)
{
    return fmi3Terminate(unit) == fmi3OK;
}

bool unit_reset(void *unit)
{
    return fmi3Reset(unit) == fmi3OK;
}

bool unit_get(void *unit, uint32_t reference, model_type_t type, double *value)
{
    fmi3Float64 real = 0.0;
    fmi3Int32 code = 0;
    fmi3Int64 enumerated = 0;
    fmi3Boolean flag = fmi3False;
    fmi3Status status = fmi3Error;
    switch (type) {
    case MODEL_REAL:
        status = fmi3GetFloat64(unit, &reference, 1, &real, 1);
        *value = real;
        break;
    case MODEL_CODE:
        status = fmi3GetInt32(unit, &reference, 1, &code, 1);
        *value = code;
        /* As an enumeration it is the same value in 64 bits. */
        if (fmi3GetInt64(unit, &reference, 1, &enumerated, 1) != status ||
            (status == fmi3OK && enumerated != code)) {
            status = fmi3Fatal;
        }
        break;
    case MODEL_FLAG:
        status = fmi3GetBoolean(unit, &reference, 1, &flag, 1);
        *value = flag;
        break;
    }
    return status == fmi3OK;
}

bool unit_set(void *unit, uint32_t reference, model_type_t type, double value)
{
    const fmi3Float64 real = value;
    switch (type) {
    case MODEL_REAL:
        return fmi3SetFloat64(unit, &reference, 1, &real, 1) == fmi3OK;
    case MODEL_CODE: {
        const fmi3Int32 code = (fmi3Int32)value;
        const fmi3Int64 enumerated = code;
        return fmi3SetInt32(unit, &reference, 1, &code, 1) == fmi3OK &&
               fmi3SetInt64(unit, &reference, 1, &enumerated, 1) == fmi3OK;
    }
    case MODEL_FLAG: {
        const fmi3Boolean flag = value != 0.0;
        return fmi3SetBoolean(unit, &reference, 1, &flag, 1) == fmi3OK;
    }
    }
    return false;
}

bool unit_get_state(void *unit, void **state)
{
    return fmi3GetFMUState(unit, state) == fmi3OK;
}

bool unit_set_state(void *unit, void *state)
{
    return fmi3SetFMUState(unit, state) == fmi3OK;
}

void unit_free_state(void *unit, void **state)
{
    fmi3FreeFMUState(unit, state);
}

size_t unit_state_bytes(void *unit, void *state)
{
    size_t out = 0;
    fmi3SerializedFMUStateSize(unit, state, &out);
    return out;
}

bool unit_to_bytes(void *unit, void *state, unsigned char *bytes, size_t size)
{
    return fmi3SerializeFMUState(unit, state, bytes, size) == fmi3OK;
}

bool unit_from_bytes(void *unit, const unsigned char *bytes, size_t size, void **state)
{
    return fmi3DeserializeFMUState(unit, bytes, size, state) == fmi3OK;
}

const char *unit_offers_too_much(void *unit)
{
    const fmi3ValueReference reference = 1;
    const fmi3Float64 value = 1.0;
    fmi3Float64 found[2] = {0.0, 0.0};
    fmi3String text = "";
    size_t count = 0;
    if (fmi3GetString(unit, &reference, 1, &text, 1) == fmi3OK) {
        return "fmi3GetString";
    }
    if (fmi3GetFloat64(unit, &reference, 1, found, 2) == fmi3OK) {
        return "fmi3GetFloat64 of an array";
    }
    if (fmi3SetFloat64(unit, &reference, 1, found, 2) == fmi3OK) {
        return "fmi3SetFloat64 of an array";
    }
    if (fmi3EnterEventMode(unit) == fmi3OK) {
        return "fmi3EnterEventMode";
    }
    if (fmi3GetNumberOfVariableDependencies(unit, reference, &count) == fmi3OK) {
        return "fmi3GetNumberOfVariableDependencies";
    }
    if (fmi3GetDirectionalDerivative(unit, &reference, 1, &reference, 1, &value, 1, found, 1) ==
        fmi3OK) {
        return "fmi3GetDirectionalDerivative";
    }
    if (fmi3GetOutputDerivatives(unit, &reference, 1, (const fmi3Int32[]){1}, found, 1) == fmi3OK) {
        return "fmi3GetOutputDerivatives";
    }
    if (fmi3GetContinuousStates(unit, found, 1) == fmi3OK) {
        return "fmi3GetContinuousStates";
    }
    const bool accepts_zero_values = fmi3GetString(unit, NULL, 0, NULL, 0) == fmi3OK &&
                                     fmi3GetFloat64(unit, NULL, 0, NULL, 0) == fmi3OK &&
                                     fmi3SetDebugLogging(unit, fmi3True, 0, NULL) == fmi3OK;
    return accepts_zero_values && strcmp(fmi3GetVersion(), "3.0") == 0
               ? NULL
               : "nothing: it refuses what asks for nothing";
}
