/* SPDX-License-Identifier: Apache-2.0 */
/* The published test vectors of SipHash-2-4: key 00 01 .. 0f. */
#include "comms/mac.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

/* Message 00 01 .. 07 gives the bytes 62 24 93 9a 79 f5 f5 93. */
void test_the_vector_of_eight_bytes(void)
{
    static const uint32_t KEY[MAC_KEY_WORDS] = {0x03020100, 0x07060504, 0x0B0A0908, 0x0F0E0D0C};
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0x93F5F5799A932462),
                            mac_of(KEY, UINT64_C(0x0706050403020100)));
}

/* Of a function that no one can tell from chance, a changed bit changes half of the 64. */
void test_every_bit_of_key_and_message_counts(void)
{
    uint32_t key[MAC_KEY_WORDS] = {1, 2, 3, 4};
    const uint64_t message = UINT64_C(0x123456789ABCDEF0);
    const uint64_t reference = mac_of(key, message);
    for (uint32_t bit = 0; bit < 128U; bit++) {
        key[bit / 32U] ^= UINT32_C(1) << bit % 32U;
        TEST_ASSERT_NOT_EQUAL(reference, mac_of(key, message));
        key[bit / 32U] ^= UINT32_C(1) << bit % 32U;
    }
    for (uint32_t bit = 0; bit < 64U; bit++) {
        TEST_ASSERT_NOT_EQUAL(reference, mac_of(key, message ^ UINT64_C(1) << bit));
    }
}
