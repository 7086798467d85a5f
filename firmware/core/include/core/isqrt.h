/* SPDX-License-Identifier: Apache-2.0 */
/*
 * isqrt.h: integer square root for the slow loop. One iteration for each two bits of the argument,
 * no division; not for the PWM-rate path.
 */
#ifndef CORE_ISQRT_H
#define CORE_ISQRT_H

#include <stdint.h>

/* Largest r with r * r <= x. */
uint32_t isqrt64(uint64_t x);

#endif
