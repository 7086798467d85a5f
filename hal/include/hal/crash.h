/* SPDX-License-Identifier: Apache-2.0 */
/*
 * crash.h: why the program stopped, in words that a reset keeps as long as the supply stays.
 *
 * A fault of the core, an interrupt without a handler, and a failed check switch the bridge off,
 * write the record and wait for the watchdog. The latest one is kept.
 */
#ifndef HAL_CRASH_H
#define HAL_CRASH_H

#include <stdint.h>

/* Values of CRASH_CAUSE below 256 are exception numbers of the core (Arm DDI 0403, B1.5.2): 2 NMI,
 * 3 hard fault, 4 memory management, 5 bus, 6 usage, 16 and above: interrupt 0 and above. */
enum {
    CRASH_CAUSE_STACK = 256, /* the stack left its memory */
    CRASH_CAUSE_CHECK = 257  /* failed check; CRASH_PC holds module << 16 | number */
};

/* Indices of the values. Of a fault: the registers at the instruction that caused it, or all ones
 * where they could not be stored; then the core's own description (B3.2.15). */
typedef enum {
    CRASH_R0,
    CRASH_R1,
    CRASH_R2,
    CRASH_R3,
    CRASH_R12,
    CRASH_LR,
    CRASH_PC,
    CRASH_PSR,
    CRASH_SP,
    CRASH_CFSR,
    CRASH_HFSR,
    CRASH_ADDRESS, /* that could not be accessed; all ones: unknown */
    CRASH_CAUSE,
    CRASH_COUNT, /* crashes since the supply came */
    CRASH_VALUES
} crash_value_t;

typedef struct {
    uint32_t value[CRASH_VALUES];
    uint32_t check; /* inverted sum of the values */
} crash_record_t;

/* The latest crash since the supply came; NULL: none. Any context. */
const crash_record_t *crash_record(void);

/* Records a failed check. Precondition: the bridge is off; the caller does not return. */
void crash_of_check(uint32_t module, uint32_t number);

#endif
