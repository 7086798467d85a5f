/* SPDX-License-Identifier: Apache-2.0 */
/* analog_start.h: functions of analog.c for inverter.c. */
#ifndef STM32F405_ANALOG_START_H
#define STM32F405_ANALOG_START_H

#include <stdbool.h>

/* Converters and their trigger. False if a converter did not switch on. */
bool analog_init(void);

/* The interrupt at the end of every triggered sequence. */
void analog_start(void);

#endif
