/* SPDX-License-Identifier: Apache-2.0 */
/* Saturating fixed point against arithmetic in a wider type. */
#include "core/q15.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

/* The ends, their neighbours, zero, halves and a few others. */
static const int16_t CORNERS[] = {-32768, -32767, -32766, -16385, -16384, -16383, -12345, -257,
                                  -2,     -1,     0,      1,      2,      3,      255,    9999,
                                  16383,  16384,  16385,  32765,  32766,  32767};
enum { CORNER_COUNT = sizeof(CORNERS) / sizeof(CORNERS[0]) };

static int64_t clamped(int64_t x, int64_t lowest, int64_t highest)
{
    return x < lowest ? lowest : (x > highest ? highest : x);
}

void test_saturation_keeps_every_value_of_the_range_and_clamps_every_other_to_the_nearest_end(void)
{
    for (int32_t x = -70000; x <= 70000; x++) {
        TEST_ASSERT_EQUAL_INT64(clamped(x, -32768, 32767), q15_saturate(x));
    }
    TEST_ASSERT_EQUAL_INT16(-32768, q15_saturate(INT32_MIN));
    TEST_ASSERT_EQUAL_INT16(32767, q15_saturate(INT32_MAX));
}

void test_a_limit_is_the_clamp_between_a_number_and_its_negative(void)
{
    static const int32_t MOST[] = {0, 1, 2, 255, 32767, 32768, 1 << 30, INT32_MAX};
    static const int32_t X[] = {
        INT32_MIN, INT32_MIN + 1, -(1 << 30), -32769, -32768, -256,  -255,    -2,       -1, 0, 1,
        2,         255,           256,        32767,  32768,  32769, 1 << 30, INT32_MAX};
    for (unsigned m = 0; m < sizeof(MOST) / sizeof(MOST[0]); m++) {
        for (unsigned k = 0; k < sizeof(X) / sizeof(X[0]); k++) {
            TEST_ASSERT_EQUAL_INT64(clamped(X[k], -(int64_t)MOST[m], MOST[m]),
                                    q_limit(X[k], MOST[m]));
        }
    }
}

void test_other_saturations_keep_their_bits(void)
{
    static const int64_t X[] = {INT32_MIN, -1073741825, -1073741824, -131073,  -131072,
                                -65537,    -65536,      -4097,       -4096,    0,
                                4095,      4096,        65535,       65536,    131071,
                                131072,    1073741823,  1073741824,  INT32_MAX};
    for (unsigned k = 0; k < sizeof(X) / sizeof(X[0]); k++) {
        TEST_ASSERT_EQUAL_INT64(clamped(X[k], -4096, 4095), q_saturate13((int32_t)X[k]));
        TEST_ASSERT_EQUAL_INT64(clamped(X[k], -65536, 65535), q_saturate17((int32_t)X[k]));
        TEST_ASSERT_EQUAL_INT64(clamped(X[k], -131072, 131071), q_saturate18((int32_t)X[k]));
        TEST_ASSERT_EQUAL_INT64(clamped(X[k], -33554432, 33554431), q_saturate26((int32_t)X[k]));
        TEST_ASSERT_EQUAL_INT64(clamped(X[k], -67108864, 67108863), q_saturate27((int32_t)X[k]));
        TEST_ASSERT_EQUAL_INT64(clamped(X[k], -1073741824, 1073741823),
                                q_saturate31((int32_t)X[k]));
    }
}

void test_positive_and_negative_part_add_up_to_the_number(void)
{
    static const int32_t X[] = {INT32_MIN, INT32_MIN + 1, -32768, -1, 0, 1, 32767, INT32_MAX};
    for (unsigned k = 0; k < sizeof(X) / sizeof(X[0]); k++) {
        TEST_ASSERT_EQUAL_INT32(X[k] > 0 ? X[k] : 0, q_positive(X[k]));
        TEST_ASSERT_EQUAL_INT32(X[k] < 0 ? X[k] : 0, q_negative(X[k]));
    }
}

void test_clamp_minimum_and_maximum_work_at_the_ends_of_int32(void)
{
    TEST_ASSERT_EQUAL_INT32(-5, q_clamp(INT32_MIN, -5, 7));
    TEST_ASSERT_EQUAL_INT32(7, q_clamp(INT32_MAX, -5, 7));
    TEST_ASSERT_EQUAL_INT32(3, q_clamp(3, -5, 7));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, q_min(INT32_MIN, INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, q_max(INT32_MIN, INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(-1, q_min(-1, 0));
    TEST_ASSERT_EQUAL_INT32(0, q_max(-1, 0));
}

void test_the_magnitude_of_the_most_negative_number_saturates(void)
{
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, q_abs(INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, q_abs(INT32_MIN + 1));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, q_abs(INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(0, q_abs(0));
    TEST_ASSERT_EQUAL_INT32(1, q_abs(-1));
}

void test_share_of_a_quantity_is_rounded_towards_zero(void)
{
    static const int32_t VALUES[] = {INT32_MIN, -1000000, -32769, -3,       -1,       0,
                                     1,         2,        40000,  16777217, INT32_MAX};
    for (unsigned v = 0; v < sizeof(VALUES) / sizeof(VALUES[0]); v++) {
        for (int i = 0; i < CORNER_COUNT; i++) {
            const int64_t exact = (int64_t)VALUES[v] * CORNERS[i];
            const int64_t expected =
                clamped(exact / 32768, INT32_MIN, INT32_MAX); /* C division rounds towards zero */
            const int32_t share = q15_share_of(VALUES[v], CORNERS[i]);
            TEST_ASSERT_EQUAL_INT64(expected, share);
            TEST_ASSERT_TRUE(q_abs(share) <= q_abs(VALUES[v]));
        }
    }
}

void test_scaling_uses_a_64_bit_product_and_saturates(void)
{
    TEST_ASSERT_EQUAL_INT32(123456789, q_scale(123456789, 2000000000, 2000000000));
    TEST_ASSERT_EQUAL_INT32(-3, q_scale(7, -1, 2)); /* -3.5 towards zero */
    TEST_ASSERT_EQUAL_INT32(3, q_scale(-7, -1, 2));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, q_scale(INT32_MAX, INT32_MAX, 1));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, q_scale(INT32_MIN, INT32_MAX, 1));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, q_scale(INT32_MIN, INT32_MIN, 1));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, q_scale(INT32_MIN, 1, -1));
}

void test_64_bit_values_saturate_to_32_bits(void)
{
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, q_saturate64(INT64_MAX));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, q_saturate64(INT64_MIN));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, q_saturate64((int64_t)INT32_MAX + 1));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, q_saturate64((int64_t)INT32_MIN - 1));
    TEST_ASSERT_EQUAL_INT32(-1, q_saturate64(-1));
}

void test_sums_and_differences_saturate(void)
{
    static const int32_t VALUES[] = {INT32_MIN, INT32_MIN + 1, -1,       0, 1,
                                     7,         INT32_MAX - 1, INT32_MAX};
    for (unsigned a = 0; a < sizeof VALUES / sizeof VALUES[0]; a++) {
        for (unsigned b = 0; b < sizeof VALUES / sizeof VALUES[0]; b++) {
            const int64_t sum = (int64_t)VALUES[a] + VALUES[b];
            const int64_t difference = (int64_t)VALUES[a] - VALUES[b];
            TEST_ASSERT_EQUAL_INT64(clamped(sum, INT32_MIN, INT32_MAX),
                                    q_add(VALUES[a], VALUES[b]));
            TEST_ASSERT_EQUAL_INT64(clamped(difference, INT32_MIN, INT32_MAX),
                                    q_subtract(VALUES[a], VALUES[b]));
        }
    }
}
