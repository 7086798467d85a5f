/* SPDX-License-Identifier: Apache-2.0 */
/*
 * gate_driver.h: the TI DRV8301 by its serial bus (data sheet SLOS719), or the DRV8302, which has
 * pins only, or one without a line to the controller, which cannot report a fault. README, Gate
 * driver.
 */
#ifndef STM32F405_GATE_DRIVER_H
#define STM32F405_GATE_DRIVER_H

#include <stdbool.h>
#include <stdint.h>

#include "board.h"

enum { GATE_DRIVER_IS_WIRED = BOARD_DRIVER_KIND != BOARD_DRIVER_NONE };

/* Enables the driver, waits until it takes commands (10 ms), writes its control registers and reads
 * them back. False if they are not as written: the bridge must stay off. Background context, once.
 */
bool gate_driver_start(void);

/* From now on the falling edge of the fault pin calls driver_fault_handler(), with the highest
 * priority. Background context, once. */
void gate_driver_watch(void);

/* For that handler. */
void gate_driver_acknowledge(void);

/* Reads the status registers into `status` (bits of hal/inverter.h), releases the driver's latch
 * and writes and compares its control registers again. False if they are not as written. Only with
 * the timer's outputs off. Background context; 0.2 ms. */
bool gate_driver_recover(uint32_t *status);

/* Releases the latch of a DRV8302 that reports a fault; a DRV8301's is released by
 * gate_driver_recover(). Only with the timer's outputs off; the fault pin rises later, if the cause
 * is gone. Context of the millisecond, once in each at most; interrupts wait for at most 10 us. */
void gate_driver_release(void);

/* The driver reports a fault now. Any context. */
static inline bool gate_driver_pulls_fault(void)
{
    return GATE_DRIVER_IS_WIRED &&
           (BOARD_DRIVER_FAULT.port->IDR & (1U << BOARD_DRIVER_FAULT.number)) == 0;
}

#endif
