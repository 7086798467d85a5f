/* SPDX-License-Identifier: Apache-2.0 */
/* crash.h: the handler of the core's faults and of every interrupt without one, for a port's vector
 * table. */
#ifndef HAL_CORTEX_M_CRASH_H
#define HAL_CORTEX_M_CRASH_H

#include <stdint.h>

/* fault_entry.c. Switches the bridge off, writes the crash record (hal/crash.h) and waits for the
 * watchdog. */
void fault_handler(void);

/* What it calls, on the stack of the record. frame: the stack pointer at entry; exception: number
 * of the active one. */
void crash_of_fault(const uint32_t *frame, uint32_t exception);

#endif
