/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fault.h: how a code of the table of faults (reason.h) ends, and what the driver is to be told.
 * Any context.
 */
#ifndef CORE_FAULT_H
#define CORE_FAULT_H

#include <stdbool.h>
#include <stdint.h>

#include "core/reason.h"

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

#define FAULT_CLEARING_ENUM(identifier, text) FAULT_CLEARING_##identifier,
#define FAULT_DRIVER_ENUM(identifier, text) FAULT_DRIVER_##identifier,
typedef enum { FAULT_CLEARING_LIST(FAULT_CLEARING_ENUM) } fault_clearing_t;
typedef enum { FAULT_DRIVER_LIST(FAULT_DRIVER_ENUM) } fault_driver_t;
#undef FAULT_CLEARING_ENUM
#undef FAULT_DRIVER_ENUM

/* True, with its code, if there is a row `place` from 0 on, in the order of the list. */
bool fault_listed(uint32_t place, reason_t *reason);

/* Clearing of a code. A number that is not in the table, which only a damaged memory can hold,
 * counts as RESTART. */
fault_clearing_t fault_clearing(reason_t reason);

/* What the driver is to be told of a code; SERVICE for a number that is not in the table. */
fault_driver_t fault_driver(reason_t reason);

/* The words of the lists above. Never NULL. */
const char *fault_clearing_text(fault_clearing_t clearing);
const char *fault_driver_text(fault_driver_t driver);

#endif
