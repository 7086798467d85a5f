/* SPDX-License-Identifier: Apache-2.0 */
/* print.h: a line on standard output, the same bytes from the host (stdio) and from the emulated
 * core (semihosting). */
#ifndef TARGET_PRINT_H
#define TARGET_PRINT_H

void print(const char *text);

#endif
