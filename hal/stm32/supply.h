/* SPDX-License-Identifier: Apache-2.0 */
/*
 * supply.h: the chip's own supply. At 168 MHz with five wait states the flash needs 2.7 V (RM0090
 * table 10), but as delivered the chip resets itself only near 1.7 V (brown-out reset off, 5.2.2):
 * in between the core may do anything, with the bridge switching. The voltage detector (5.2.3) acts
 * before that, at 2.8 V nominally.
 */
#ifndef STM32_SUPPLY_H
#define STM32_SUPPLY_H

#include <stdbool.h>

/* From now on a supply that falls ends in fault_handler(): bridge off until the watchdog, not fed
 * any more, restarts the core. Once, when the watchdog runs. */
void supply_watch(void);

/* Is it too low now? False before supply_watch(). */
bool supply_low(void);

#endif
