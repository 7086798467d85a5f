/* SPDX-License-Identifier: Apache-2.0 */
/* string.h: of the C library, what the core of 32 bits uses (core32.c). */
#ifndef FREESTANDING_STRING_H
#define FREESTANDING_STRING_H

#include <stddef.h>

void *memcpy(void *to, const void *from, size_t bytes);
void *memset(void *to, int value, size_t bytes);

#endif
