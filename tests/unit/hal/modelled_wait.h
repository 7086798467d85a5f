/* SPDX-License-Identifier: Apache-2.0 */
/*
 * modelled_wait.h: included before every file of the port under test in place of its wait.h: while
 * the port waits for hardware, the model of the hardware advances. The debugger's registers are not
 * at the chip's address, because the address sanitizer uses that range.
 */
#ifndef STM32_WAIT_H
#define STM32_WAIT_H

#include <stdbool.h>
#include <stdint.h>

#include "registers/iwdg.h"

#undef DBGMCU
#define DBGMCU (&modelled_debugger)
extern dbgmcu_registers_t modelled_debugger;

bool wait_for(const volatile uint32_t *reg, uint32_t mask, uint32_t value, uint32_t polls);

#endif
