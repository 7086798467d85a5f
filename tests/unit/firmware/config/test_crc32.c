/* SPDX-License-Identifier: Apache-2.0 */
/* The checksum of the configuration image: the published check value and an independent,
 * table-driven implementation. */
#include <stdlib.h>
#include <string.h>

#include "config/validate.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

void test_the_check_value_of_crc_32_iso_hdlc(void)
{
    TEST_ASSERT_EQUAL_HEX32(0xCBF43926, config_crc32("123456789", 9));
}

void test_no_bytes_give_zero(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, config_crc32("", 0));
}

/* Most significant bit first over reflected bytes: the same code word by the other of the two usual
 * algorithms. */
static uint32_t reflected(uint32_t x, unsigned bits)
{
    uint32_t out = 0;
    for (unsigned i = 0; i < bits; i++) {
        out |= ((x >> i) & 1U) << (bits - 1U - i);
    }
    return out;
}

static uint32_t crc32_msb_first(const uint8_t *bytes, size_t size)
{
    uint32_t table[256];
    for (uint32_t i = 0; i < 256U; i++) {
        uint32_t c = i << 24;
        for (int k = 0; k < 8; k++) {
            c = (c << 1) ^ ((c & 0x80000000U) != 0U ? 0x04C11DB7U : 0U);
        }
        table[i] = c;
    }
    uint32_t crc = UINT32_MAX;
    for (size_t i = 0; i < size; i++) {
        crc = (crc << 8) ^ table[(crc >> 24) ^ reflected(bytes[i], 8)];
    }
    return reflected(crc, 32) ^ UINT32_MAX;
}

void test_crc_equals_an_independent_implementation_at_every_length_up_to_a_page(void)
{
    uint8_t bytes[300];
    uint32_t x = 12345;
    for (size_t i = 0; i < sizeof(bytes); i++) {
        x = x * 1664525U + 1013904223U;
        bytes[i] = (uint8_t)(x >> 24);
    }
    for (uint32_t size = 0; size <= sizeof(bytes); size++) {
        TEST_ASSERT_EQUAL_HEX32(crc32_msb_first(bytes, size), config_crc32(bytes, size));
    }
}

void test_every_single_bit_error_changes_the_checksum(void)
{
    uint8_t bytes[64] = {0};
    const uint32_t good = config_crc32(bytes, sizeof(bytes));
    for (unsigned bit = 0; bit < 8U * sizeof(bytes); bit++) {
        bytes[bit / 8U] ^= (uint8_t)(1U << (bit % 8U));
        TEST_ASSERT_NOT_EQUAL(good, config_crc32(bytes, sizeof(bytes)));
        bytes[bit / 8U] ^= (uint8_t)(1U << (bit % 8U));
    }
}
