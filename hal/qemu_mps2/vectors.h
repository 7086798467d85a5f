/* SPDX-License-Identifier: Apache-2.0 */
/* vectors.h: the handlers that the vector table (startup.c) names. */
#ifndef QEMU_MPS2_VECTORS_H
#define QEMU_MPS2_VECTORS_H

void reset_handler(void);    /* startup.c */
void fault_handler(void);    /* cortex_m/crash.c; in programs without it startup.c: fails the run */
void systick_handler(void);  /* port.c */
void timer0_handler(void);   /* system.c */
void watchdog_handler(void); /* system.c: NMI */

#endif
