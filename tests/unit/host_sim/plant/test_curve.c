/* SPDX-License-Identifier: Apache-2.0 */
/* Linear interpolation between points, clamped outside. */
#include "plant/curve.h"

#include <math.h>

#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

void test_values_are_interpolated_linearly_and_clamped_at_the_ends(void)
{
    const double x[] = {0.0, 1.0, 3.0};
    const double y[] = {10.0, 20.0, 0.0};
    curve_t curve = curve_constant(0.0);
    TEST_ASSERT_TRUE(curve_set(&curve, x, y, 3));
    TEST_ASSERT_EQUAL_DOUBLE(10.0, curve_at(&curve, -5.0));
    TEST_ASSERT_EQUAL_DOUBLE(12.5, curve_at(&curve, 0.25));
    TEST_ASSERT_EQUAL_DOUBLE(20.0, curve_at(&curve, 1.0));
    TEST_ASSERT_EQUAL_DOUBLE(5.0, curve_at(&curve, 2.5));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, curve_at(&curve, 99.0));
}

void test_a_constant_has_the_same_value_for_any_argument(void)
{
    const curve_t curve = curve_constant(53.0);
    TEST_ASSERT_EQUAL_DOUBLE(53.0, curve_at(&curve, -1.0));
    TEST_ASSERT_EQUAL_DOUBLE(53.0, curve_at(&curve, 1.0));
}

void test_points_that_do_not_increase_are_refused_and_the_curve_is_unchanged(void)
{
    curve_t curve = curve_constant(7.0);
    const double equal[] = {0.0, 0.0};
    const double falling[] = {1.0, 0.0};
    const double nan_in_it[] = {0.0, NAN};
    const double y[] = {1.0, 2.0};
    TEST_ASSERT_FALSE(curve_set(&curve, equal, y, 2));
    TEST_ASSERT_FALSE(curve_set(&curve, falling, y, 2));
    TEST_ASSERT_FALSE(curve_set(&curve, nan_in_it, y, 2));
    TEST_ASSERT_FALSE(curve_set(&curve, y, y, 0));
    TEST_ASSERT_FALSE(curve_set(&curve, y, y, CURVE_POINTS_MAX + 1));
    TEST_ASSERT_EQUAL_DOUBLE(7.0, curve_at(&curve, 0.5));
}
