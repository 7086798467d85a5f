/* SPDX-License-Identifier: Apache-2.0 */
/*
 * power.h: the board's own supply, and the pins that the board wants at constant levels.
 */
#ifndef STM32_POWER_H
#define STM32_POWER_H

/* Keeps the supply on and drives the board's constant outputs. First of all after a reset: a short
 * press of the board's switch holds the supply only until here. */
void power_start(void);

#endif
