/* SPDX-License-Identifier: Apache-2.0 */
/* The root of three in every format, against double precision. */
#include <math.h>

#include "core/sqrt3.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

void test_every_format_is_the_root_rounded_to_nearest(void)
{
    const double root = sqrt(3.0);
    TEST_ASSERT_EQUAL_INT64(llround(ldexp(root, 30)), SQRT3_Q30);
    TEST_ASSERT_EQUAL_INT32(lround(ldexp(root, 10)), SQRT3_Q10);
    TEST_ASSERT_EQUAL_INT32(lround(ldexp(root, 25)), SQRT3_Q25);
    TEST_ASSERT_EQUAL_INT32(lround(ldexp(root / 2.0, 15)), SQRT3_2_Q15);
    TEST_ASSERT_EQUAL_INT32(lround(ldexp(1.0 / root, 15)), INVERSE_SQRT3_Q15);
    TEST_ASSERT_EQUAL_INT32(lround(ldexp(1.0 / root, 16)), INVERSE_SQRT3_Q16);
}
