/* SPDX-License-Identifier: Apache-2.0 */
#include "app/selftest.h"

#include "config/validate.h"

/* Differs in many bits between neighbours and between addresses a power of two apart: golden-ratio
 * multiples. */
static uint32_t pattern(uint32_t index)
{
    return (index + 1U) * 0x9E3779B9U;
}

static bool replace(volatile uint32_t *word, uint32_t expected, uint32_t next)
{
    const bool good = *word == expected;
    *word = next;
    return good;
}

bool selftest_ram(volatile uint32_t *begin, uint32_t words)
{
    bool good = true;
    for (uint32_t i = 0; i < words; i++) {
        begin[i] = pattern(i);
    }
    for (uint32_t i = 0; i < words; i++) {
        good = replace(&begin[i], pattern(i), ~pattern(i)) && good;
    }
    for (uint32_t i = 0; i < words; i++) {
        good = replace(&begin[i], ~pattern(i), pattern(i)) && good;
    }
    for (uint32_t i = words; i-- > 0;) {
        good = replace(&begin[i], pattern(i), ~pattern(i)) && good;
    }
    for (uint32_t i = words; i-- > 0;) {
        good = replace(&begin[i], ~pattern(i), pattern(i)) && good;
    }
    for (uint32_t i = words; i-- > 0;) {
        good = begin[i] == pattern(i) && good;
    }
    return good;
}

bool selftest_firmware(const void *image, uint32_t size_bytes, uint32_t crc32)
{
    static const char CHECK_TEXT[] =
        "123456789"; /* the published check value of this CRC is 0xCBF43926 */
    return config_crc32(CHECK_TEXT, 9) == 0xCBF43926U && config_crc32(image, size_bytes) == crc32;
}
