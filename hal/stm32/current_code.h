/* SPDX-License-Identifier: Apache-2.0 */
/*
 * current_code.h: from what a converter reads to hal/analog.h's codes of the phase currents: 0 ..
 * 4095, 2048 = zero current, rising with current into the motor. Pure.
 */
#ifndef STM32_CURRENT_CODE_H
#define STM32_CURRENT_CODE_H

#include <stdbool.h>
#include <stdint.h>

enum { CURRENT_CODE_LARGEST = 4095, CURRENT_CODE_MIDDLE = 2048 };

/* raw: 0 .. 4095, inverted: falling with current into the motor. */
static inline uint16_t current_code(uint32_t raw, bool inverted)
{
    return (uint16_t)(inverted ? CURRENT_CODE_LARGEST - raw : raw);
}

/* The code whose current is minus the sum of the other two, 0 .. 4095. */
static inline uint16_t current_code_third(uint32_t first_code, uint32_t second_code)
{
    const int32_t code = 3 * CURRENT_CODE_MIDDLE - (int32_t)(first_code + second_code);
    return (uint16_t)(code < 0 ? 0 : (code > CURRENT_CODE_LARGEST ? CURRENT_CODE_LARGEST : code));
}

#endif
