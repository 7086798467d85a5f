/* SPDX-License-Identifier: Apache-2.0 */
/*
 * power.h: the board's own supply, where a push button switches it on and the controller keeps it
 * on; the chip's own bootloader. The port keeps the supply from the first instructions on.
 */
#ifndef HAL_POWER_H
#define HAL_POWER_H

#include <stdbool.h>

/* Lets the supply go: it falls as its capacitors empty, unless the button is pressed. False: this
 * board cannot. Only with the bridge off and the motor at rest. Background context. */
bool power_off(void);

/* The next reset starts the bootloader that the chip's maker put into it instead of the program;
 * the one after that the program. False: this chip has none. Only with the bridge off and the motor
 * at rest. Background context. */
bool power_request_bootloader(void);

#endif
