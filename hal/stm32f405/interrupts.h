/* SPDX-License-Identifier: Apache-2.0 */
/* interrupts.h: the interrupts that are used, RM0090 table 62. */
#ifndef STM32F405_INTERRUPTS_H
#define STM32F405_INTERRUPTS_H

#include "priorities.h"

enum {
    INTERRUPT_SUPPLY = 1,
    INTERRUPT_ADC = 18,
    INTERRUPT_PINS_5_TO_9 = 23,
    INTERRUPT_PINS_10_TO_15 = 40,
    INTERRUPT_COUNT = 82
};
/* Of the vector table (startup.c): number and handler. */
#define INTERRUPT_HANDLERS(X)                                                                      \
    X(INTERRUPT_ADC, adc_handler)                                                                  \
    X(INTERRUPT_PINS_5_TO_9, driver_fault_handler)                                                 \
    X(INTERRUPT_PINS_10_TO_15, driver_fault_handler)
/* The crystal stops (clock security system). */
#define INTERRUPT_NMI_HANDLER fault_handler

#endif
