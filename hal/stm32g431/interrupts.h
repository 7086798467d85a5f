/* SPDX-License-Identifier: Apache-2.0 */
/* interrupts.h: the interrupts that are used, RM0440 table 97. */
#ifndef STM32G431_INTERRUPTS_H
#define STM32G431_INTERRUPTS_H

#include "priorities.h"

enum {
    INTERRUPT_SUPPLY = 1,
    INTERRUPT_ADC = 18, /* ADC1 and ADC2 */
    INTERRUPT_COUNT = 102
};

/* Of the vector table (startup.c): number and handler. */
#define INTERRUPT_HANDLERS(X) X(INTERRUPT_ADC, adc_handler)
/* The crystal stops, or a word of the flash cannot be read. */
#define INTERRUPT_NMI_HANDLER flash_error_handler
void flash_error_handler(void); /* flash_error.c */

#endif
