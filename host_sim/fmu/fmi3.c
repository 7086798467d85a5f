/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The functions of FMI 3.0 for co-simulation around an instance; those that this unit has no use
 * for are in fmi3_absent.c. The headers are the standard's own; whoever builds the unit from source
 * has them.
 */
#include "fmi3Functions.h"
#include "fmu/fmi3_instance.h"
#include "fmu/instance.h"

#include <stdlib.h>

typedef struct {
    instance_t *instance;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
} unit_t;

static void log_error(void *context, const char *message)
{
    const unit_t *unit = context;
    if (unit->log != NULL) {
        unit->log(unit->environment, fmi3Error, "logStatusError", message);
    }
}

static fmi3Status status_of(bool done)
{
    return done ? fmi3OK : fmi3Error;
}

static instance_t *in(fmi3Instance instance)
{
    return ((unit_t *)instance)->instance;
}

fmi3Status fmi3_refuse(fmi3Instance instance, const char *what)
{
    return status_of(instance_refuse(in(instance), what));
}

const char *fmi3GetVersion(void)
{
    return fmi3Version;
}

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean loggingOn, size_t nCategories,
                               const fmi3String categories[])
{
    (void)instance; /* errors are the only messages, and they are never silent */
    (void)loggingOn;
    (void)nCategories;
    (void)categories;
    return fmi3OK;
}

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath,
    fmi3Boolean visible, fmi3Boolean loggingOn, fmi3Boolean eventModeUsed,
    fmi3Boolean earlyReturnAllowed, const fmi3ValueReference requiredIntermediateVariables[],
    size_t nRequiredIntermediateVariables, fmi3InstanceEnvironment instanceEnvironment,
    fmi3LogMessageCallback logMessage, fmi3IntermediateUpdateCallback intermediateUpdate)
{
    (void)instanceName;
    (void)resourcePath;
    (void)visible;
    (void)loggingOn;
    (void)eventModeUsed;
    (void)earlyReturnAllowed;
    (void)requiredIntermediateVariables;
    (void)nRequiredIntermediateVariables;
    (void)intermediateUpdate;
    unit_t *unit = calloc(1, sizeof(*unit));
    if (unit == NULL) {
        return NULL;
    }
    unit->environment = instanceEnvironment;
    unit->log = logMessage;
    unit->instance = instance_new(instantiationToken, log_error, unit);
    if (unit->instance == NULL) {
        free(unit);
        return NULL;
    }
    return unit;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String instanceName, fmi3String instantiationToken,
                                          fmi3String resourcePath, fmi3Boolean visible,
                                          fmi3Boolean loggingOn,
                                          fmi3InstanceEnvironment instanceEnvironment,
                                          fmi3LogMessageCallback logMessage)
{
    (void)instanceName;
    (void)instantiationToken;
    (void)resourcePath;
    (void)visible;
    (void)loggingOn;
    (void)instanceEnvironment;
    (void)logMessage;
    return NULL;
}

fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath,
    fmi3Boolean visible, fmi3Boolean loggingOn, fmi3InstanceEnvironment instanceEnvironment,
    fmi3LogMessageCallback logMessage, fmi3ClockUpdateCallback clockUpdate,
    fmi3LockPreemptionCallback lockPreemption, fmi3UnlockPreemptionCallback unlockPreemption)
{
    (void)instanceName;
    (void)instantiationToken;
    (void)resourcePath;
    (void)visible;
    (void)loggingOn;
    (void)instanceEnvironment;
    (void)logMessage;
    (void)clockUpdate;
    (void)lockPreemption;
    (void)unlockPreemption;
    return NULL;
}

void fmi3FreeInstance(fmi3Instance instance)
{
    unit_t *unit = instance;
    if (unit != NULL) {
        instance_delete(unit->instance);
        free(unit);
    }
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean toleranceDefined,
                                       fmi3Float64 tolerance, fmi3Float64 startTime,
                                       fmi3Boolean stopTimeDefined, fmi3Float64 stopTime)
{
    (void)toleranceDefined;
    (void)tolerance;
    (void)stopTimeDefined;
    (void)stopTime;
    return status_of(instance_enter_initialization(in(instance), startTime));
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance)
{
    return status_of(instance_exit_initialization(in(instance)));
}

fmi3Status fmi3Terminate(fmi3Instance instance)
{
    return status_of(instance_terminate(in(instance)));
}

fmi3Status fmi3Reset(fmi3Instance instance)
{
    return status_of(instance_reset(in(instance)));
}

/* All variables are scalars: as many values as references. */
#define GETTER(name, ctype, kind)                                                                  \
    fmi3Status fmi3Get##name(fmi3Instance instance, const fmi3ValueReference valueReferences[],    \
                             size_t nValueReferences, ctype values[], size_t nValues)              \
    {                                                                                              \
        if (nValues != nValueReferences) {                                                         \
            return fmi3_refuse(instance, "arrays");                                                \
        }                                                                                          \
        for (size_t k = 0; k < nValues; k++) {                                                     \
            double found = 0.0;                                                                    \
            if (!instance_get(in(instance), valueReferences[k], kind, &found)) {                   \
                return fmi3Error;                                                                  \
            }                                                                                      \
            values[k] = (ctype)found;                                                              \
        }                                                                                          \
        return fmi3OK;                                                                             \
    }
#define SETTER(name, ctype, kind)                                                                  \
    fmi3Status fmi3Set##name(fmi3Instance instance, const fmi3ValueReference valueReferences[],    \
                             size_t nValueReferences, const ctype values[], size_t nValues)        \
    {                                                                                              \
        if (nValues != nValueReferences) {                                                         \
            return fmi3_refuse(instance, "arrays");                                                \
        }                                                                                          \
        for (size_t k = 0; k < nValues; k++) {                                                     \
            if (!instance_set(in(instance), valueReferences[k], kind, (double)values[k])) {        \
                return fmi3Error;                                                                  \
            }                                                                                      \
        }                                                                                          \
        return fmi3OK;                                                                             \
    }
/* A code is an Int32, or an Enumeration, whose values the standard passes as Int64. */
GETTER(Float64, fmi3Float64, MODEL_REAL)
GETTER(Int32, fmi3Int32, MODEL_CODE)
GETTER(Int64, fmi3Int64, MODEL_CODE)
GETTER(Boolean, fmi3Boolean, MODEL_FLAG)
SETTER(Float64, fmi3Float64, MODEL_REAL)
SETTER(Int32, fmi3Int32, MODEL_CODE)
SETTER(Int64, fmi3Int64, MODEL_CODE)
SETTER(Boolean, fmi3Boolean, MODEL_FLAG)

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *FMUState)
{
    return status_of(instance_get_state(in(instance), (instance_state_t **)FMUState));
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState FMUState)
{
    return status_of(instance_set_state(in(instance), FMUState));
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *FMUState)
{
    (void)instance;
    instance_free_state(*FMUState);
    *FMUState = NULL;
    return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState FMUState, size_t *size)
{
    (void)instance;
    (void)FMUState;
    *size = instance_state_bytes();
    return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState FMUState,
                                 fmi3Byte serializedState[], size_t size)
{
    if (size < instance_state_bytes()) {
        return fmi3_refuse(instance, "a state in so few bytes");
    }
    instance_state_to_bytes(FMUState, serializedState);
    return fmi3OK;
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte serializedState[],
                                   size_t size, fmi3FMUState *FMUState)
{
    return status_of(instance_state_from_bytes(in(instance), serializedState, size,
                                               (instance_state_t **)FMUState));
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 currentCommunicationPoint,
                      fmi3Float64 communicationStepSize,
                      fmi3Boolean noSetFMUStatePriorToCurrentPoint,
                      fmi3Boolean *eventHandlingNeeded, fmi3Boolean *terminateSimulation,
                      fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime)
{
    (void)noSetFMUStatePriorToCurrentPoint;
    const bool done = instance_step(in(instance), currentCommunicationPoint, communicationStepSize);
    *eventHandlingNeeded = fmi3False;
    *terminateSimulation = fmi3False;
    *earlyReturn = fmi3False;
    *lastSuccessfulTime =
        done ? currentCommunicationPoint + communicationStepSize : currentCommunicationPoint;
    return status_of(done);
}
