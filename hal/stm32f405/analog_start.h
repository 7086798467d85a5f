/* SPDX-License-Identifier: Apache-2.0 */
/* analog_start.h: functions of analog.c for inverter.c. */
#ifndef STM32F405_ANALOG_START_H
#define STM32F405_ANALOG_START_H

#include <stdbool.h>

/* From the trigger to the moment at which the converters hold the currents: latency of an injected
 * conversion (data sheet table 67: three cycles) and sampling, in cycles of 21 MHz; of 168 MHz. */
enum {
    ANALOG_LATENCY_CYCLES = 3,
    ANALOG_SAMPLING_CYCLES = 15,
    ANALOG_SAMPLING_ns = 15 * 1000 / 21,
    ANALOG_HOLD_CLOCKS = (ANALOG_LATENCY_CYCLES + ANALOG_SAMPLING_CYCLES) * 168 / 21
};

/* Converters and their trigger. False if a converter did not switch on. */
bool analog_init(void);

/* The interrupt at the end of every triggered sequence. */
void analog_start(void);

#endif
