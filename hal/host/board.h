/* SPDX-License-Identifier: Apache-2.0 */
/* board.h: functions between the two halves of the simulated board. */
#ifndef HOST_BOARD_H
#define HOST_BOARD_H

#include <stdint.h>

void board_reset_memory(const void *configuration, uint32_t size_bytes); /* memory.c */
void board_reset_lines(void);                                            /* lines.c */
void board_watchdog_tick(void); /* lines.c: one millisecond has passed */

#endif
