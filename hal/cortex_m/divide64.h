/* SPDX-License-Identifier: Apache-2.0 */
/*
 * divide64.h: the 64-bit division behind the operators / and %, in a third of the 700 bytes that
 * the compiler's run-time library has. For cores with a 32-bit division and a count of leading
 * zeros. Any context.
 */
#ifndef HAL_CORTEX_M_DIVIDE64_H
#define HAL_CORTEX_M_DIVIDE64_H

#include <stdint.h>

/* On the target the function has the name that the run-time library calls. */
#ifdef __arm__
#define DIVIDE64_NAME(name) __asm__(name)
#else
#define DIVIDE64_NAME(name)
#endif

/* n / d, rounded down; d > 0. rest: receives n % d. About 80 instructions for a quotient of up to
 * 26 digits. */
uint64_t divide64(uint64_t n, uint64_t d, uint64_t *rest) DIVIDE64_NAME("__udivmoddi4");

#endif
