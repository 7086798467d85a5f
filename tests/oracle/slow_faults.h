/* SPDX-License-Identifier: Apache-2.0 */
/*
 * slow_faults.h: what goes wrong in the random lives of the slow step: with the wheel and its fast
 * loop (surrogate.h), and with what the vehicle sends.
 */
#ifndef ORACLE_SLOW_FAULTS_H
#define ORACLE_SLOW_FAULTS_H

#include "core/slow_messages.h"
#include "surrogate.h"

enum {
    FAULT_CURRENT_GAIN, /* of all current sensors */
    FAULT_OPEN_PHASE,   /* or nearly */
    FAULT_NO_CURRENT,   /* whatever the setpoint */
    FAULT_EXTRA_TORQUE, /* current that is not in the setpoint */
    FAULT_NAMED_SENSOR, /* a current sensor that the fast loop names */
    FAULT_UNDETERMINED, /* a wrong sum that no single sensor explains */
    FAULT_CURRENT_SUM,
    FAULT_ROTOR_INVALID,
    FAULT_ROTOR_FAULTS, /* now and then */
    FAULT_ROTOR_SLIPPED,
    FAULT_ROTOR_FROZEN,
    FAULT_ROTOR_REVERSED,
    FAULT_OBSERVER_LOST,
    FAULT_OBSERVER_WRONG, /* another speed */
    FAULT_BUS_SENSOR,     /* a gain error */
    FAULT_BUS_VOLTAGE,    /* the bus itself */
    FAULT_BUS_SWINGS,
    FAULT_CONTACTOR,        /* open, with its message */
    FAULT_CONTACTOR_SILENT, /* open, without it */
    FAULT_FLUX,             /* weak or strong magnets */
    FAULT_TRIP,
    FAULT_TRIP_DAMAGED, /* any number */
    FAULT_PERIODS,      /* fast steps that are missing or too many */
    FAULT_WINDING_SENSOR,
    FAULT_WINDING_HOT,
    FAULT_SWITCH_SENSOR,
    FAULT_SWITCH_HOT,
    FAULT_SLOW_SENSORS, /* of temperature: they show a part of what the load warms */
    FAULT_OFFSETS,      /* that a calibration finds */
    FAULT_SELFTEST,
    FAULT_CONFIGURATION,
    FAULT_BRAKE_GAIN,
    FAULT_BRAKE_DEAD,
    FAULT_BRAKE_STUCK,
    FAULT_BRAKE_LATE,
    FAULT_REPORT_LOST, /* of the hydraulic brake */
    FAULT_REPORT_WRONG,
    FAULT_DEMAND_LOST,
    FAULT_DEMAND_REASON, /* as pedals give it */
    FAULT_ANTI_LOCK,
    FAULT_BATTERY_FULL,
    FAULT_BATTERY_EMPTY,
    FAULT_BATTERY_CURRENT,
    FAULT_WILD_REPORT, /* any numbers */
    FAULT_WILD_INPUT,  /* any numbers */
    FAULT_KINDS
};

typedef struct {
    int32_t kind;       /* FAULT_... */
    int32_t begin, end; /* steps */
    double amount;      /* -1 .. 1 */
    int32_t number;
} fault_t;

bool fault_is_present(const fault_t *fault, int32_t step);

/* At the wheel, in this step of the life. */
void fault_of_wheel(const fault_t *fault, int32_t step, surrogate_fault_t *now);

/* In messages and sensors of the slow step itself. */
void fault_of_inputs(const fault_t *fault, int32_t step, const config_t *config, slow_input_t *in);

#endif
