/* SPDX-License-Identifier: Apache-2.0 */
/* vectors.h: the handlers that the vector table (startup.c) names; each is defined by the module it
 * belongs to. */
#ifndef STM32_VECTORS_H
#define STM32_VECTORS_H

/* NMI, hard, memory, bus and usage fault, and every unexpected interrupt: fault_handler(). */
#include "../cortex_m/crash.h"

void reset_handler(void);        /* startup.c */
void driver_fault_handler(void); /* inverter.c: the gate driver's fault pin falls */
void systick_handler(void);      /* time.c */
void adc_handler(void);          /* analog.c */

#endif
