/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The functions of FMI 2.0 for co-simulation around an instance. The headers are the standard's
 * own; a build from source needs them. Functions of model exchange and input derivatives are not
 * supported and return an error.
 */
#include "fmi2Functions.h"
#include "fmu/instance.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
    instance_t *instance;
    const fmi2CallbackFunctions *callbacks;
    char *name;
} component_t;

static void log_error(void *context, const char *message)
{
    const component_t *component = context;
    const fmi2CallbackFunctions *callbacks = component->callbacks;
    if (callbacks != NULL && callbacks->logger != NULL) {
        callbacks->logger(callbacks->componentEnvironment, component->name, fmi2Error,
                          "logStatusError", "%s", message);
    }
}

static fmi2Status status_of(bool done)
{
    return done ? fmi2OK : fmi2Error;
}

static instance_t *in(fmi2Component c)
{
    return ((component_t *)c)->instance;
}

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories,
                               const fmi2String categories[])
{
    (void)c; /* errors are the only messages, and they are never silent */
    (void)loggingOn;
    (void)nCategories;
    (void)categories;
    return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
                              fmi2String resources, const fmi2CallbackFunctions *functions,
                              fmi2Boolean visible, fmi2Boolean loggingOn)
{
    (void)resources;
    (void)visible;
    (void)loggingOn;
    component_t *component = calloc(1, sizeof(*component));
    if (component == NULL) {
        return NULL;
    }
    const char *name = instanceName != NULL ? instanceName : "";
    component->callbacks = functions;
    component->name = calloc(strlen(name) + 1, 1);
    if (component->name != NULL && fmuType == fmi2CoSimulation) {
        memcpy(component->name, name, strlen(name));
        component->instance = instance_new(fmuGUID, log_error, component);
    }
    if (component->instance == NULL) {
        free(component->name);
        free(component);
        return NULL;
    }
    return component;
}

void fmi2FreeInstance(fmi2Component c)
{
    component_t *component = c;
    if (component != NULL) {
        instance_delete(component->instance);
        free(component->name);
        free(component);
    }
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance,
                               fmi2Real startTime, fmi2Boolean stopTimeDefined, fmi2Real stopTime)
{
    (void)toleranceDefined;
    (void)tolerance;
    (void)stopTimeDefined;
    (void)stopTime;
    return status_of(instance_enter_initialization(in(c), startTime));
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    (void)c; /* entered with fmi2SetupExperiment, which knows the start time */
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    return status_of(instance_exit_initialization(in(c)));
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    return status_of(instance_terminate(in(c)));
}

fmi2Status fmi2Reset(fmi2Component c)
{
    return status_of(instance_reset(in(c)));
}

/* GETTER(name, type of the standard, type of the model) */
#define GETTER(name, ctype, kind)                                                                  \
    fmi2Status fmi2Get##name(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,           \
                             ctype value[])                                                        \
    {                                                                                              \
        for (size_t k = 0; k < nvr; k++) {                                                         \
            double found = 0.0;                                                                    \
            if (!instance_get(in(c), vr[k], kind, &found)) {                                       \
                return fmi2Error;                                                                  \
            }                                                                                      \
            value[k] = (ctype)found;                                                               \
        }                                                                                          \
        return fmi2OK;                                                                             \
    }
#define SETTER(name, ctype, kind)                                                                  \
    fmi2Status fmi2Set##name(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,           \
                             const ctype value[])                                                  \
    {                                                                                              \
        for (size_t k = 0; k < nvr; k++) {                                                         \
            if (!instance_set(in(c), vr[k], kind, (double)value[k])) {                             \
                return fmi2Error;                                                                  \
            }                                                                                      \
        }                                                                                          \
        return fmi2OK;                                                                             \
    }
GETTER(Real, fmi2Real, MODEL_REAL)
GETTER(Integer, fmi2Integer, MODEL_CODE)
GETTER(Boolean, fmi2Boolean, MODEL_FLAG)
SETTER(Real, fmi2Real, MODEL_REAL)
SETTER(Integer, fmi2Integer, MODEL_CODE)
SETTER(Boolean, fmi2Boolean, MODEL_FLAG)

/* Success for zero variables; anything else is not supported. */
static fmi2Status unless_empty(fmi2Component c, size_t count, const char *what)
{
    return count == 0 ? fmi2OK : status_of(instance_refuse(in(c), what));
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                         fmi2String value[])
{
    (void)vr;
    (void)value;
    return unless_empty(c, nvr, "strings");
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                         const fmi2String value[])
{
    (void)vr;
    (void)value;
    return unless_empty(c, nvr, "strings");
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    return status_of(instance_get_state(in(c), (instance_state_t **)FMUstate));
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate)
{
    return status_of(instance_set_state(in(c), FMUstate));
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    (void)c;
    instance_free_state(*FMUstate);
    *FMUstate = NULL;
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size)
{
    (void)c;
    (void)FMUstate;
    *size = instance_state_bytes();
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte serializedState[],
                                 size_t size)
{
    if (size < instance_state_bytes()) {
        return status_of(instance_refuse(in(c), "a state in so few bytes"));
    }
    instance_state_to_bytes(FMUstate, serializedState);
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte serializedState[], size_t size,
                                   fmi2FMUstate *FMUstate)
{
    return status_of(
        instance_state_from_bytes(in(c), serializedState, size, (instance_state_t **)FMUstate));
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference vUnknown_ref[],
                                        size_t nUnknown, const fmi2ValueReference vKnown_ref[],
                                        size_t nKnown, const fmi2Real dvKnown[],
                                        fmi2Real dvUnknown[])
{
    (void)vUnknown_ref;
    (void)nUnknown;
    (void)vKnown_ref;
    (void)nKnown;
    (void)dvKnown;
    (void)dvUnknown;
    return status_of(instance_refuse(in(c), "directional derivatives"));
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                       const fmi2Integer order[], const fmi2Real value[])
{
    (void)vr;
    (void)order;
    (void)value;
    return unless_empty(c, nvr, "derivatives of inputs");
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                        const fmi2Integer order[], fmi2Real value[])
{
    (void)vr;
    (void)order;
    (void)value;
    return unless_empty(c, nvr, "derivatives of outputs");
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint,
                      fmi2Real communicationStepSize, fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    (void)noSetFMUStatePriorToCurrentPoint;
    return status_of(instance_step(in(c), currentCommunicationPoint, communicationStepSize));
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
    return status_of(instance_refuse(in(c), "cancelling a step"));
}

/* Steps are complete when fmi2DoStep returns, so none of these has a status. */
#define STATUS(name, ctype)                                                                        \
    fmi2Status fmi2Get##name(fmi2Component c, const fmi2StatusKind s, ctype *value)                \
    {                                                                                              \
        (void)c;                                                                                   \
        (void)s;                                                                                   \
        (void)value;                                                                               \
        return fmi2Discard;                                                                        \
    }
STATUS(Status, fmi2Status)
STATUS(RealStatus, fmi2Real)
STATUS(IntegerStatus, fmi2Integer)
STATUS(BooleanStatus, fmi2Boolean)
STATUS(StringStatus, fmi2String)
