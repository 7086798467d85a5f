/* SPDX-License-Identifier: Apache-2.0 */
/*
 * selftest.h: power-up checks of RAM and flash. Background context, before interrupts are enabled.
 */
#ifndef APP_SELFTEST_H
#define APP_SELFTEST_H

#include <stdbool.h>
#include <stdint.h>

/* March C- (van de Goor 1991) over a window of RAM, with a pattern that differs from word to word:
 * finds stuck, coupled and wrongly addressed cells. The window's content is lost. No interrupt may
 * use it meanwhile. True if no fault was found. */
bool selftest_ram(volatile uint32_t *begin, uint32_t words);

/* CRC-32 of the firmware in flash against the value that the build stored there. Also checks the
 * CRC routine itself against a published value, because the same routine checks the configuration.
 * True if both agree. */
bool selftest_firmware(const void *image, uint32_t size_bytes, uint32_t crc32);

#endif
