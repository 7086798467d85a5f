/* SPDX-License-Identifier: Apache-2.0 */
/* The remaining component of a vector on a circle, by table: every component, many radii. */
#include <math.h>
#include <stdlib.h>

#include "core/circle.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

static double true_other(double radius, double x)
{
    return sqrt(fmax(radius * radius - x * x, 0.0));
}

void test_result_exceeds_the_circle_by_at_most_the_rounding_of_the_table(void)
{
    for (int32_t x = -32768; x <= 32768; x++) {
        const double y = circle_other_q15(x);
        TEST_ASSERT_TRUE(y >= 0.0 && y <= 32768.0);
        TEST_ASSERT_TRUE(y <= true_other(32768.0, x) + 1.0);
        TEST_ASSERT_TRUE((double)x * x + y * y <= 32768.0 * 32768.0);
    }
}

void test_result_is_below_the_circle_by_at_most_the_documented_share(void)
{
    for (int32_t x = -31784; x <= 31784; x++) { /* |x| < 0.97 */
        const double exact = true_other(32768.0, x);
        TEST_ASSERT_TRUE(circle_other_q15(x) >= exact * (1.0 - 0.008) - 1.0);
    }
}

void test_result_is_even_and_falls_with_the_magnitude(void)
{
    for (int32_t x = 0; x < INT16_MAX; x++) {
        TEST_ASSERT_EQUAL_INT32(circle_other_q15(x), circle_other_q15(-x));
        TEST_ASSERT_TRUE(circle_other_q15(x + 1) <= circle_other_q15(x));
    }
}

void test_result_is_zero_at_both_ends_and_full_scale_at_zero(void)
{
    TEST_ASSERT_EQUAL_INT32(0, circle_other_q15(INT16_MIN));
    TEST_ASSERT_LESS_OR_EQUAL(256, circle_other_q15(INT16_MAX)); /* sqrt(2 * 2^-15) = 256 LSB */
    TEST_ASSERT_GREATER_OR_EQUAL(32765, circle_other_q15(0));
}

static long root(int k)
{
    const long exact =
        (long)floorl(32768.0L * sqrtl(1.0L - (long double)k / CIRCLE_TABLE_SEGMENTS));
    return exact > 32767 ? 32767 : exact;
}

void test_the_table_holds_the_square_root_rounded_down_and_twice_its_step(void)
{
    for (int k = 0; k <= CIRCLE_TABLE_SEGMENTS; k++) {
        const long step = k < CIRCLE_TABLE_SEGMENTS ? root(k + 1) - root(k) : 0;
        TEST_ASSERT_EQUAL_INT(root(k) * 65536 + 2 * step, CIRCLE_TABLE[k]);
    }
}

void test_a_vector_limited_to_a_circle_of_any_radius_stays_inside_for_every_component(void)
{
    for (int32_t radius = 164; radius <= Q15_ONE; radius += radius < 2000 ? 1 : 97) {
        const circle_t circle = circle_init(radius);
        for (int32_t x = -radius; x <= radius; x++) {
            const double y = circle_other(&circle, x);
            if (y < 0.0 || hypot(x, y) > radius + 1.0) { /* the rounding of the table */
                TEST_FAIL_MESSAGE("outside the circle");
            }
        }
    }
}

void test_limited_vector_uses_the_circle_within_1_percent(void)
{
    /* 0.8 % of the interpolation, 4 LSB of the share (its reciprocal and its rounding), which the
     * slope of the circle x/y turns into y, and 2 LSB of the product. */
    for (int32_t radius = 164; radius <= Q15_ONE; radius += 331) {
        const circle_t circle = circle_init(radius);
        for (int32_t x = -radius * 97 / 100; x <= radius * 97 / 100; x++) {
            const double exact = true_other(radius, x);
            const double slope = abs(x) / exact;
            const double least = exact * (1.0 - 0.008) - 2.0 - slope * 4.0;
            if (circle_other(&circle, x) < least) {
                TEST_FAIL_MESSAGE("too little of the circle is used");
            }
        }
    }
}

void test_circle_stores_its_radius_exactly(void)
{
    /* Every radius that a configuration may hold (config.h), from half a per cent up. */
    for (int32_t radius = 164; radius <= Q15_ONE; radius++) {
        TEST_ASSERT_EQUAL_INT32(radius, circle_init(radius).radius_q15);
    }
    TEST_ASSERT_EQUAL_INT32(Q15_ONE, circle_init(40000).radius_q15);
    TEST_ASSERT_TRUE(circle_init(-5).radius_q15 > 0);
    TEST_ASSERT_TRUE(circle_init(0).radius_q15 > 0);
}
