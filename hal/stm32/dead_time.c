/* SPDX-License-Identifier: Apache-2.0 */
#include "dead_time.h"

static uint32_t divide_up(uint32_t a, uint32_t b)
{
    return (a + b - 1U) / b;
}

bool dead_time_encode(uint32_t dead_time_ns, uint32_t clock_Hz, uint8_t *code)
{
    const uint64_t clocks_wanted = ((uint64_t)dead_time_ns * clock_Hz + 999999999U) / 1000000000U;
    if (clocks_wanted > DEAD_TIME_MAX_CLOCKS) {
        return false;
    }
    const uint32_t clocks = (uint32_t)clocks_wanted;
    if (clocks <= 127U) {
        *code = (uint8_t)clocks;
    } else if (clocks <= 254U) {
        *code = (uint8_t)(0x80U | (divide_up(clocks, 2) - 64U));
    } else if (clocks <= 504U) {
        *code = (uint8_t)(0xC0U | (divide_up(clocks < 256U ? 256U : clocks, 8) - 32U));
    } else {
        *code = (uint8_t)(0xE0U | (divide_up(clocks < 512U ? 512U : clocks, 16) - 32U));
    }
    return true;
}

uint32_t dead_time_clocks(uint8_t code)
{
    if (code < 0x80U) {
        return code;
    }
    if (code < 0xC0U) {
        return 2U * (64U + (code & 0x3FU));
    }
    if (code < 0xE0U) {
        return 8U * (32U + (code & 0x1FU));
    }
    return 16U * (32U + (code & 0x1FU));
}
