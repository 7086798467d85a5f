/* SPDX-License-Identifier: Apache-2.0 */
#include "unit_functions.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "fmi2Functions.h"

const size_t unit_version = 2;
char unit_message[UNIT_MESSAGE_LENGTH];

static void listen(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                   fmi2String category, fmi2String message, ...)
{
    (void)environment;
    (void)name;
    (void)status;
    (void)category;
    va_list arguments;
    va_start(arguments, message);
    vsnprintf(unit_message, sizeof(unit_message), message, arguments);
    va_end(arguments);
}

static const fmi2CallbackFunctions LISTENING = {.logger = listen};
static const fmi2CallbackFunctions DEAF = {.logger = NULL};

void *unit_new(const char *token)
{
    return fmi2Instantiate("a unit", fmi2CoSimulation, token, "file:///nowhere", &LISTENING,
                           fmi2False, fmi2True);
}

void *unit_new_of_another_kind(void)
{
    return fmi2Instantiate("a unit", fmi2ModelExchange, MODEL_TOKEN, NULL, &LISTENING, fmi2False,
                           fmi2True);
}

void *unit_new_without_log(const char *token)
{
    return fmi2Instantiate(NULL, fmi2CoSimulation, token, NULL, &DEAF, fmi2False, fmi2False);
}

void unit_delete(void *unit)
{
    fmi2FreeInstance(unit);
}

bool unit_enter(void *unit, double start_s)
{
    return fmi2SetupExperiment(unit, fmi2False, 0.0, start_s, fmi2False, 0.0) == fmi2OK &&
           fmi2EnterInitializationMode(unit) == fmi2OK;
}

bool unit_exit(void *unit)
{
    return fmi2ExitInitializationMode(unit) == fmi2OK;
}

bool unit_begin(void *unit, double start_s)
{
    return unit_enter(unit, start_s) && unit_exit(unit);
}

bool unit_step(void *unit, double from_s, double step_s)
{
    return fmi2DoStep(unit, from_s, step_s, fmi2False) == fmi2OK;
}

bool unit_terminate(void *unit)
{
    return fmi2Terminate(unit) == fmi2OK;
}

bool unit_reset(void *unit)
{
    return fmi2Reset(unit) == fmi2OK;
}

bool unit_get(void *unit, uint32_t reference, model_type_t type, double *value)
{
    fmi2Real real = 0.0;
    fmi2Integer code = 0;
    fmi2Boolean flag = 0;
    fmi2Status status = fmi2Error;
    switch (type) {
    case MODEL_REAL:
        status = fmi2GetReal(unit, &reference, 1, &real);
        *value = real;
        break;
    case MODEL_CODE:
        status = fmi2GetInteger(unit, &reference, 1, &code);
        *value = code;
        break;
    case MODEL_FLAG:
        status = fmi2GetBoolean(unit, &reference, 1, &flag);
        *value = flag;
        break;
    }
    return status == fmi2OK;
}

bool unit_set(void *unit, uint32_t reference, model_type_t type, double value)
{
    const fmi2Real real = value;
    switch (type) {
    case MODEL_REAL:
        return fmi2SetReal(unit, &reference, 1, &real) == fmi2OK;
    case MODEL_CODE: {
        const fmi2Integer code = (fmi2Integer)value;
        return fmi2SetInteger(unit, &reference, 1, &code) == fmi2OK;
    }
    case MODEL_FLAG: {
        const fmi2Boolean flag = (fmi2Boolean)value;
        return fmi2SetBoolean(unit, &reference, 1, &flag) == fmi2OK;
    }
    }
    return false;
}

bool unit_get_state(void *unit, void **state)
{
    return fmi2GetFMUstate(unit, state) == fmi2OK;
}

bool unit_set_state(void *unit, void *state)
{
    return fmi2SetFMUstate(unit, state) == fmi2OK;
}

void unit_free_state(void *unit, void **state)
{
    fmi2FreeFMUstate(unit, state);
}

size_t unit_state_bytes(void *unit, void *state)
{
    size_t out = 0;
    fmi2SerializedFMUstateSize(unit, state, &out);
    return out;
}

bool unit_to_bytes(void *unit, void *state, unsigned char *bytes, size_t size)
{
    return fmi2SerializeFMUstate(unit, state, (fmi2Byte *)bytes, size) == fmi2OK;
}

bool unit_from_bytes(void *unit, const unsigned char *bytes, size_t size, void **state)
{
    return fmi2DeSerializeFMUstate(unit, (const fmi2Byte *)bytes, size, state) == fmi2OK;
}

const char *unit_offers_too_much(void *unit)
{
    const fmi2ValueReference reference = 1;
    const fmi2Integer order = 1;
    const fmi2Real value = 1.0;
    fmi2Real found = 0.0;
    fmi2Status status = fmi2OK;
    fmi2String text = "";
    if (fmi2GetString(unit, &reference, 1, &text) == fmi2OK) {
        return "fmi2GetString";
    }
    if (fmi2SetString(unit, &reference, 1, &text) == fmi2OK) {
        return "fmi2SetString";
    }
    if (fmi2GetDirectionalDerivative(unit, &reference, 1, &reference, 1, &value, &found) ==
        fmi2OK) {
        return "fmi2GetDirectionalDerivative";
    }
    if (fmi2SetRealInputDerivatives(unit, &reference, 1, &order, &value) == fmi2OK) {
        return "fmi2SetRealInputDerivatives";
    }
    if (fmi2GetRealOutputDerivatives(unit, &reference, 1, &order, &found) == fmi2OK) {
        return "fmi2GetRealOutputDerivatives";
    }
    if (fmi2CancelStep(unit) == fmi2OK) {
        return "fmi2CancelStep";
    }
    if (fmi2GetStatus(unit, fmi2DoStepStatus, &status) == fmi2OK) {
        return "fmi2GetStatus";
    }
    const bool accepts_zero_values = fmi2GetString(unit, NULL, 0, NULL) == fmi2OK &&
                                     fmi2GetReal(unit, NULL, 0, NULL) == fmi2OK &&
                                     fmi2SetDebugLogging(unit, fmi2True, 0, NULL) == fmi2OK;
    const bool known =
        strcmp(fmi2GetVersion(), "2.0") == 0 && strcmp(fmi2GetTypesPlatform(), "default") == 0;
    return accepts_zero_values && known ? NULL : "nothing: it refuses what asks for nothing";
}
