/* SPDX-License-Identifier: Apache-2.0 */
/*
 * time.h: core clock, millisecond tick and cycle counter.
 */
#ifndef HAL_TIME_H
#define HAL_TIME_H

#include <stdbool.h>
#include <stdint.h>

/* Brings the core to its full clock. False if a clock did not start in time: the core then runs on
 * its internal oscillator, the serial line works, and control must not be started. Background
 * context, first. */
bool time_init(void);

/* Starts app_millisecond_isr(). */
void time_start_tick(void);

/* Milliseconds since time_start_tick(); wraps after 49 days, so use differences only. Any context.
 */
uint32_t time_ms(void);

/* Core clock cycles, free running, wraps; constantly 0 where the core cannot count them. Any
 * context. */
uint32_t time_cycles(void);

/* False when the program must end: never on a board; on the emulator and on the host
 * after the requested time. */
bool time_running(void);

#endif
