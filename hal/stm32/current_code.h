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

/* The same of an amplifier whose output without current is `zero`, beside the middle. An end of the
 * range stays one, so that a converter which cannot follow is seen, whatever its current is. */
static inline uint16_t current_code_about(uint32_t raw, uint32_t zero, bool inverted)
{
    const uint32_t clips_itself = /* raw 0 ends beyond the codes */
        inverted ? CURRENT_CODE_LARGEST - CURRENT_CODE_MIDDLE : CURRENT_CODE_MIDDLE;
    if (raw >= CURRENT_CODE_LARGEST) {
        return inverted ? 0 : CURRENT_CODE_LARGEST;
    }
    if (raw == 0 && zero < clips_itself) {
        return inverted ? CURRENT_CODE_LARGEST : 0;
    }
    const int32_t beside = (int32_t)raw - (int32_t)zero;
    const int32_t code = CURRENT_CODE_MIDDLE + (inverted ? -beside : beside);
    return (uint16_t)(code < 0 ? 0 : (code > CURRENT_CODE_LARGEST ? CURRENT_CODE_LARGEST : code));
}

/* The code whose current is minus the sum of the other two, 0 .. 4095. */
static inline uint16_t current_code_third(uint32_t first_code, uint32_t second_code)
{
    const int32_t code = 3 * CURRENT_CODE_MIDDLE - (int32_t)(first_code + second_code);
    return (uint16_t)(code < 0 ? 0 : (code > CURRENT_CODE_LARGEST ? CURRENT_CODE_LARGEST : code));
}

#endif
