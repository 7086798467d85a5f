/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fault.h: what the table of faults (reason.h) says about one code. Any context.
 *
 * modes acts by two of these columns: a warning whose reaction is NONE leaves the mode alone, a
 * latched fault is acknowledged or not by its clearing. The other words say what monitor, torque
 * and controller do; test_fault_rows.c compares each row with it. The reason that a monitor gives
 * as its fault must be one that stays until it is acknowledged or until a restart.
 */
#ifndef CORE_FAULT_H
#define CORE_FAULT_H

#include "core/reason.h"

/* X(identifier, text): what happens to the motor's torque once the fault is qualified. Where there
 * is less of it the hydraulic brake has the rest of a braking demand. */
#define FAULT_REACTION_LIST(X)                                                                     \
    X(NONE, "none, it is only reported")                                                           \
    X(LIMIT, "less driving torque, whole braking torque")                                          \
    X(LIMIT_OR_OFF, "less driving torque; none at an impossible value")                            \
    X(LEAST, "less driving torque; the bridge that brakes least")                                  \
    X(HAND_OVER, "no driving torque; the brake system takes over")                                 \
    X(RAMP, "torque ramps to zero, then safe state")                                               \
    X(SAFE_STATE, "freewheel at once, or short circuit if safer")                                  \
    X(TRIP, "freewheel at once, or short circuit on a stuck side")

/* X(identifier, text): how it ends. */
#define FAULT_CLEARING_LIST(X)                                                                     \
    X(HEALS, "by itself, after its heal time")                                                     \
    X(SHOWN, "by itself; shown after a lost demand until acknowledged")                            \
    X(ACKNOWLEDGED, "latched until acknowledged at standstill without a torque demand")            \
    X(RESTART, "latched until the controller is restarted")

/* X(identifier, text): what the driver is to be told. */
#define FAULT_DRIVER_LIST(X)                                                                       \
    X(REDUCED, "reduced power")                                                                    \
    X(NO_MOTOR, "motor off, brakes work; stop and acknowledge")                                    \
    X(SERVICE, "have it repaired")

#define FAULT_REACTION_ENUM(identifier, text) FAULT_REACTION_##identifier,
#define FAULT_CLEARING_ENUM(identifier, text) FAULT_CLEARING_##identifier,
#define FAULT_DRIVER_ENUM(identifier, text) FAULT_DRIVER_##identifier,
typedef enum { FAULT_REACTION_LIST(FAULT_REACTION_ENUM) } fault_reaction_t;
typedef enum { FAULT_CLEARING_LIST(FAULT_CLEARING_ENUM) } fault_clearing_t;
typedef enum { FAULT_DRIVER_LIST(FAULT_DRIVER_ENUM) } fault_driver_t;
#undef FAULT_REACTION_ENUM
#undef FAULT_CLEARING_ENUM
#undef FAULT_DRIVER_ENUM

/* The row of one code. */
typedef struct {
    const char *qualify; /* configuration fields joined by " + ", or words such as "9 ms" */
    const char *heal;    /* likewise; "never" if it is latched */
    reason_t reason;
    fault_reaction_t reaction;
    fault_clearing_t clearing;
    fault_driver_t driver;
} fault_t;

/* Row `number` from 0, in the order of the list; NULL if there is none. */
const fault_t *fault_row(unsigned number);

/* Clearing of a code. A number that is not in the table, which only a damaged memory can hold,
 * counts as RESTART. */
fault_clearing_t fault_clearing(reason_t reason);

/* Reaction of a code; SAFE_STATE for a number that is not in the table. */
fault_reaction_t fault_reaction(reason_t reason);

/* The words of the lists above. Never NULL. */
const char *fault_reaction_text(fault_reaction_t reaction);
const char *fault_clearing_text(fault_clearing_t clearing);
const char *fault_driver_text(fault_driver_t driver);

#endif
