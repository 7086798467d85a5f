/* SPDX-License-Identifier: Apache-2.0 */
/* print.h: a line on standard output, the same bytes from the host (stdio) and from the emulated
 * core (semihosting). */
#ifndef TARGET_PRINT_H
#define TARGET_PRINT_H

#include <stdint.h>

#include "core/operating_mode.h"

enum { PRINT_MODES = MODE_FAULT + 1 };

void print(const char *text);

/* "CRC  name, MODE steps, ...": the digest in hexadecimal, and the modes that were reached. */
void print_trace(uint32_t crc, const char *name, const uint32_t mode_steps[PRINT_MODES]);

#endif
