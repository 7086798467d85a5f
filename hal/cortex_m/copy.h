/* SPDX-License-Identifier: Apache-2.0 */
/*
 * copy.h: the C library's memcpy() and memset(), which the compiler calls for structures, in 140
 * bytes instead of 470. Where all places are multiples of four, eight bytes go at once. Any
 * context.
 */
#ifndef HAL_CORTEX_M_COPY_H
#define HAL_CORTEX_M_COPY_H

#include <stddef.h>

/* On the target the functions have the names that the compiler calls. */
#ifdef __arm__
#define COPY_NAME(name) __asm__(name)
#else
#define COPY_NAME(name)
#endif

/* Copies size_bytes from source to destination, which do not overlap. Returns destination. */
void *copy_bytes(void *destination, const void *source, size_t size_bytes) COPY_NAME("memcpy");

/* Sets size_bytes from destination on to the lowest eight bits of value. Returns destination. */
void *fill_bytes(void *destination, int value, size_t size_bytes) COPY_NAME("memset");

#endif
