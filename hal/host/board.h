/* SPDX-License-Identifier: Apache-2.0 */
/* board.h: functions between the two halves of the simulated board. */
#ifndef HOST_BOARD_H
#define HOST_BOARD_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/watchdog.h"

void board_reset_memory(const void *configuration, uint32_t size_bytes); /* memory.c */
void board_forget(void);                                                 /* memory.c */
void board_reset_lines(void);                                            /* lines.c */
void board_restart_lines(reset_cause_t cause);                           /* lines.c */
void board_reset_packets(void);                                          /* packets.c */
void board_watchdog_tick(void); /* lines.c: one millisecond has passed */

bool board_bridge_on(void); /* bridge.c: the bridge switches */

#endif
