/* SPDX-License-Identifier: Apache-2.0 */
/* Pairs of 16 bits: ends of the range, and the products of complex numbers. */
#include "core/pair.h"

#include <math.h>

#include "unity.h"

static const int32_t VALUES[] = {-32768, -32767, -12345, -1, 0, 1, 7, 23170, 32766, 32767};
enum { VALUE_COUNT = sizeof(VALUES) / sizeof(VALUES[0]) };

void setUp(void) {}

void tearDown(void) {}

static void assert_pair(int32_t x, int32_t y, q_pair_t pair)
{
    TEST_ASSERT_EQUAL_INT32(x, q_pair_x(pair));
    TEST_ASSERT_EQUAL_INT32(y, q_pair_y(pair));
}

static int32_t saturated(int32_t x)
{
    return x > 32767 ? 32767 : (x < -32768 ? -32768 : x);
}

static void check(int32_t ax, int32_t ay, int32_t bx, int32_t by)
{
    const q_pair_t a = q_pair(ax, ay);
    const q_pair_t b = q_pair(bx, by);
    assert_pair(ax, ay, a);
    assert_pair(saturated(ax - bx), saturated(ay - by), q_pair_subtract(a, b));
    const int64_t dot = (int64_t)ax * bx + (int64_t)ay * by;
    const int64_t im = (int64_t)ax * by + (int64_t)ay * bx;
    if (dot <= INT32_MAX) {
        TEST_ASSERT_EQUAL_INT32(dot, q_pair_dot(a, b));
    }
    if (im <= INT32_MAX) {
        TEST_ASSERT_EQUAL_INT32(im, q_pair_im(a, b));
    }
    TEST_ASSERT_EQUAL_INT32(ax * bx - ay * by, q_pair_re(a, b));
    TEST_ASSERT_EQUAL_INT32(ax * by - ay * bx, q_pair_cross(a, b));
    TEST_ASSERT_EQUAL_UINT32((uint32_t)(ax * ax) + (uint32_t)(ay * ay), q_pair_square(a));
    TEST_ASSERT_EQUAL_INT32(1000 + ax * bx, q_pair_mac_x(1000, a, b));
    const int32_t factor_q16 = 2 * (by & 32767) + 1;
    assert_pair((int32_t)floor(factor_q16 * ax / 65536.0),
                (int32_t)floor(factor_q16 * ay / 65536.0), q_pair_scale(a, factor_q16));
    TEST_ASSERT_EQUAL_INT32(ax + (int32_t)floor(ay * (double)factor_q16 / 131072.0),
                            q_mac_q17(ax, ay, factor_q16));
    TEST_ASSERT_EQUAL_INT32(-1000 + ay * by, q_pair_mac_y(-1000, a, b));
}

void test_operations_at_every_combination_of_ends_and_middles(void)
{
    for (int ax = 0; ax < VALUE_COUNT; ax++) {
        for (int ay = 0; ay < VALUE_COUNT; ay++) {
            for (int bx = 0; bx < VALUE_COUNT; bx++) {
                for (int by = 0; by < VALUE_COUNT; by++) {
                    check(VALUES[ax], VALUES[ay], VALUES[bx], VALUES[by]);
                }
            }
        }
    }
}

void test_sums_and_differences_are_exact_inside_the_range(void)
{
    assert_pair(32767, -32768, q_pair_add(q_pair(32000, -32000), q_pair(767, -768)));
    assert_pair(-32768, 32767, q_pair_difference(q_pair(-32000, 32000), q_pair(768, -767)));
}

void test_pair_of_shifted_words_has_their_upper_halves(void)
{
    assert_pair(-3, 2, Q_PAIR_SHIFTED(-(5 << 21) - 1 + (3 << 21), 21, 2 * 65536 + 65535));
    assert_pair(-1, -1, Q_PAIR_SHIFTED(-1, 22, -1));
}

void test_a_number_in_q25_is_rounded_down_to_q15(void)
{
    assert_pair(-32768, 32767, q_pair_of_q25(-32768, (1 << 25) - 1));
    assert_pair(5, -32768, q_pair_of_q25(5, -(1 << 25)));
    assert_pair(-1, -1, q_pair_of_q25(-1, -1));
    assert_pair(0, 0, q_pair_of_q25(0, 1023));
}

void test_a_constant_pair_has_its_components(void)
{
    static const q_pair_t pair = Q_PAIR_INIT(-32768, 32767);
    assert_pair(-32768, 32767, pair);
}

void test_product_of_the_lower_halves_is_signed(void)
{
    TEST_ASSERT_EQUAL_INT32(10 - 6, q_mac_lower(10, 0x7FFF0002, (int32_t)0x8000FFFDU));
}
