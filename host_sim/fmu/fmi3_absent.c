/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Functions that FMI 3.0 requires and this FMU does not support: each logs the missing feature and
 * returns an error. Reading or writing zero variables succeeds.
 */
#include "fmi3Functions.h"
#include "fmu/fmi3_instance.h"

/* All the functions have all the parameters of the standard, and use none but the first. */
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

#define ABSENT(name, what, ...)                                                                    \
    fmi3Status name(fmi3Instance instance, __VA_ARGS__)                                            \
    {                                                                                              \
        return fmi3_refuse(instance, what);                                                        \
    }
#define ABSENT_ALONE(name, what)                                                                   \
    fmi3Status name(fmi3Instance instance)                                                         \
    {                                                                                              \
        return fmi3_refuse(instance, what);                                                        \
    }
/* Types that none of the unit's variables has. */
#define NO_VARIABLE(name, what, ...)                                                               \
    fmi3Status name(fmi3Instance instance, const fmi3ValueReference references[], size_t count,    \
                    __VA_ARGS__)                                                                   \
    {                                                                                              \
        return count == 0 ? fmi3OK : fmi3_refuse(instance, what);                                  \
    }

NO_VARIABLE(fmi3GetFloat32, "variables of this type", fmi3Float32 values[], size_t nValues)
NO_VARIABLE(fmi3GetInt8, "variables of this type", fmi3Int8 values[], size_t nValues)
NO_VARIABLE(fmi3GetUInt8, "variables of this type", fmi3UInt8 values[], size_t nValues)
NO_VARIABLE(fmi3GetInt16, "variables of this type", fmi3Int16 values[], size_t nValues)
NO_VARIABLE(fmi3GetUInt16, "variables of this type", fmi3UInt16 values[], size_t nValues)
NO_VARIABLE(fmi3GetUInt32, "variables of this type", fmi3UInt32 values[], size_t nValues)
NO_VARIABLE(fmi3GetUInt64, "variables of this type", fmi3UInt64 values[], size_t nValues)
NO_VARIABLE(fmi3GetString, "variables of this type", fmi3String values[], size_t nValues)
NO_VARIABLE(fmi3GetBinary, "variables of this type", size_t valueSizes[], fmi3Binary values[],
            size_t nValues)
NO_VARIABLE(fmi3GetClock, "variables of this type", fmi3Clock values[])
NO_VARIABLE(fmi3SetFloat32, "variables of this type", const fmi3Float32 values[], size_t nValues)
NO_VARIABLE(fmi3SetInt8, "variables of this type", const fmi3Int8 values[], size_t nValues)
NO_VARIABLE(fmi3SetUInt8, "variables of this type", const fmi3UInt8 values[], size_t nValues)
NO_VARIABLE(fmi3SetInt16, "variables of this type", const fmi3Int16 values[], size_t nValues)
NO_VARIABLE(fmi3SetUInt16, "variables of this type", const fmi3UInt16 values[], size_t nValues)
NO_VARIABLE(fmi3SetUInt32, "variables of this type", const fmi3UInt32 values[], size_t nValues)
NO_VARIABLE(fmi3SetUInt64, "variables of this type", const fmi3UInt64 values[], size_t nValues)
NO_VARIABLE(fmi3SetString, "variables of this type", const fmi3String values[], size_t nValues)
NO_VARIABLE(fmi3SetBinary, "variables of this type", const size_t valueSizes[],
            const fmi3Binary values[], size_t nValues)
NO_VARIABLE(fmi3SetClock, "variables of this type", const fmi3Clock values[])

ABSENT_ALONE(fmi3EnterEventMode, "event mode")
ABSENT(fmi3GetNumberOfVariableDependencies, "dependencies at run time",
       fmi3ValueReference valueReference, size_t *nDependencies)
ABSENT(fmi3GetVariableDependencies, "dependencies at run time", fmi3ValueReference dependent,
       size_t elementIndicesOfDependent[], fmi3ValueReference independents[],
       size_t elementIndicesOfIndependents[], fmi3DependencyKind dependencyKinds[],
       size_t nDependencies)
ABSENT(fmi3GetDirectionalDerivative, "directional derivatives", const fmi3ValueReference unknowns[],
       size_t nUnknowns, const fmi3ValueReference knowns[], size_t nKnowns,
       const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity)
ABSENT(fmi3GetAdjointDerivative, "adjoint derivatives", const fmi3ValueReference unknowns[],
       size_t nUnknowns, const fmi3ValueReference knowns[], size_t nKnowns,
       const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity)
ABSENT_ALONE(fmi3EnterConfigurationMode, "configuration mode")
ABSENT_ALONE(fmi3ExitConfigurationMode, "configuration mode")
ABSENT(fmi3GetIntervalDecimal, "clocks", const fmi3ValueReference valueReferences[],
       size_t nValueReferences, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
ABSENT(fmi3GetIntervalFraction, "clocks", const fmi3ValueReference valueReferences[],
       size_t nValueReferences, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
       fmi3IntervalQualifier qualifiers[])
ABSENT(fmi3GetShiftDecimal, "clocks", const fmi3ValueReference valueReferences[],
       size_t nValueReferences, fmi3Float64 shifts[])
ABSENT(fmi3GetShiftFraction, "clocks", const fmi3ValueReference valueReferences[],
       size_t nValueReferences, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
ABSENT(fmi3SetIntervalDecimal, "clocks", const fmi3ValueReference valueReferences[],
       size_t nValueReferences, const fmi3Float64 intervals[])
ABSENT(fmi3SetIntervalFraction, "clocks", const fmi3ValueReference valueReferences[],
       size_t nValueReferences, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
ABSENT(fmi3SetShiftDecimal, "clocks", const fmi3ValueReference valueReferences[],
       size_t nValueReferences, const fmi3Float64 shifts[])
ABSENT(fmi3SetShiftFraction, "clocks", const fmi3ValueReference valueReferences[],
       size_t nValueReferences, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
ABSENT_ALONE(fmi3EvaluateDiscreteStates, "event mode")
ABSENT(fmi3UpdateDiscreteStates, "event mode", fmi3Boolean *discreteStatesNeedUpdate,
       fmi3Boolean *terminateSimulation, fmi3Boolean *nominalsOfContinuousStatesChanged,
       fmi3Boolean *valuesOfContinuousStatesChanged, fmi3Boolean *nextEventTimeDefined,
       fmi3Float64 *nextEventTime)
ABSENT_ALONE(fmi3EnterContinuousTimeMode, "model exchange")
ABSENT(fmi3CompletedIntegratorStep, "model exchange", fmi3Boolean noSetFMUStatePriorToCurrentPoint,
       fmi3Boolean *enterEventMode, fmi3Boolean *terminateSimulation)
ABSENT(fmi3SetTime, "model exchange", fmi3Float64 time)
ABSENT(fmi3SetContinuousStates, "model exchange", const fmi3Float64 continuousStates[],
       size_t nContinuousStates)
ABSENT(fmi3GetContinuousStateDerivatives, "model exchange", fmi3Float64 derivatives[],
       size_t nContinuousStates)
ABSENT(fmi3GetEventIndicators, "model exchange", fmi3Float64 eventIndicators[],
       size_t nEventIndicators)
ABSENT(fmi3GetContinuousStates, "model exchange", fmi3Float64 continuousStates[],
       size_t nContinuousStates)
ABSENT(fmi3GetNominalsOfContinuousStates, "model exchange", fmi3Float64 nominals[],
       size_t nContinuousStates)
ABSENT(fmi3GetNumberOfEventIndicators, "model exchange", size_t *nEventIndicators)
ABSENT(fmi3GetNumberOfContinuousStates, "model exchange", size_t *nContinuousStates)
ABSENT_ALONE(fmi3EnterStepMode, "event mode")
ABSENT(fmi3GetOutputDerivatives, "derivatives of outputs",
       const fmi3ValueReference valueReferences[], size_t nValueReferences,
       const fmi3Int32 orders[], fmi3Float64 values[], size_t nValues)
ABSENT(fmi3ActivateModelPartition, "scheduled execution", fmi3ValueReference clockReference,
       fmi3Float64 activationTime)
