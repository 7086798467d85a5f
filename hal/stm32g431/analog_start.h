/* SPDX-License-Identifier: Apache-2.0 */
/* analog_start.h: functions of analog.c for inverter.c. */
#ifndef STM32G431_ANALOG_START_H
#define STM32G431_ANALOG_START_H

#include <stdbool.h>

/* From the trigger to the moment at which the converters hold the currents, at a quarter of the
 * core's 170 MHz: latency of an injected conversion (data sheet, t_LATRINJ for that clock: 2.125
 * cycles) and sampling, in clocks of the core (README, Sampling). */
enum {
    ANALOG_SAMPLING_HALF_CYCLES = 25,
    ANALOG_LATENCY_CLOCKS = 9, /* 8.5 */
    ANALOG_SAMPLING_ns = ANALOG_SAMPLING_HALF_CYCLES * 2000 / 170,
    ANALOG_HOLD_CLOCKS = ANALOG_LATENCY_CLOCKS + ANALOG_SAMPLING_HALF_CYCLES * 2
};

/* Amplifiers, converters and their trigger. False if a converter did not switch on. */
bool analog_init(void);

/* The interrupt at the end of every triggered sequence. */
void analog_start(void);

#endif
