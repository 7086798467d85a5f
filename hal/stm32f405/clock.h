/* SPDX-License-Identifier: Apache-2.0 */
/*
 * clock.h: the frequencies that time_init() arrived at: 168 MHz from the crystal, or the 16 MHz
 * internal oscillator.
 */
#ifndef STM32F405_CLOCK_H
#define STM32F405_CLOCK_H

#include <stdint.h>

enum {
    CLOCK_INTERNAL_Hz = 16000000,
    CLOCK_CORE_Hz = 168000000,
    CLOCK_APB1_DIVIDER = 4,
    CLOCK_APB2_DIVIDER = 2,
    CLOCK_TIMER1_Hz =
        CLOCK_CORE_Hz /* timers on a divided bus run at twice the bus clock: 2 x 84 MHz */
};

uint32_t clock_core_Hz(void);
uint32_t clock_apb1_Hz(void);

#endif
