/* SPDX-License-Identifier: Apache-2.0 */
/* analog.h: voltages at the chip's pins, and its operational amplifiers and comparators. */
#ifndef CHIP_ANALOG_H
#define CHIP_ANALOG_H

#include "parts.h"

enum { ANALOG_REFERENCE_uV = 3300000, ANALOG_CODES = 4096 };

/* Volts at a pin that the board drives, or that an amplifier of the chip does. */
double analog_pin_V(const chip_t *chip, char port, unsigned pin);

/* amplifiers.c: what an operational amplifier (1 to 3) puts on its output pin; 0 while it is off.
 */
double amplifier_V(const chip_t *chip, unsigned number);

/* comparators.c */
void comparators_reset(chip_t *chip);
bool comparators_write(chip_t *chip, uint32_t address, uint32_t value);
uint32_t comparators_read(chip_t *chip, uint32_t address);
/* TIM1's second break input (28.3.17): its flag when it has been active for its filter's time. */
uint32_t comparators_break(chip_t *chip);
/* When it will have been; CHIP_NEVER: not by itself. */
chip_ticks_t comparators_next(chip_t *chip);

#endif
