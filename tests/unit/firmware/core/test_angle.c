/* SPDX-License-Identifier: Apache-2.0 */
/* Sine, cosine and angle differences at all 65 536 angles. */
#include <math.h>
#include <stdlib.h>

#include "core/angle.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

static const long double TURN = 6.283185307179586476925286766559L;

void test_half_a_turn_in_radians_is_rounded_to_nearest(void)
{
    TEST_ASSERT_EQUAL_INT64(llroundl(ldexpl(TURN / 2.0L, 24)), ANGLE_PI_Q24);
}

void test_sine_and_cosine_are_within_one_lsb_of_the_exact_value_at_every_angle(void)
{
    for (uint32_t theta = 0; theta < 65536U; theta++) {
        const long double angle = TURN * (long double)theta / 65536.0L;
        const sincos_t out = angle_sincos((uint16_t)theta);
        TEST_ASSERT_TRUE(fabsl((long double)out.sin - 32768.0L * sinl(angle)) <= 1.0L);
        TEST_ASSERT_TRUE(fabsl((long double)out.cos - 32768.0L * cosl(angle)) <= 1.0L);
    }
}

void test_sine_and_cosine_are_exact_at_quarter_turns_and_plus_one_saturates(void)
{
    static const int32_t EXPECTED[4][2] = {
        {0, 32767}, {32767, 0}, {0, -32768}, {-32768, 0}}; /* sin, cos */
    for (uint16_t quarter = 0; quarter < 4; quarter++) {
        const sincos_t out = angle_sincos((uint16_t)(quarter * ANGLE_QUARTER_TURN));
        TEST_ASSERT_EQUAL_INT32(EXPECTED[quarter][0], out.sin);
        TEST_ASSERT_EQUAL_INT32(EXPECTED[quarter][1], out.cos);
    }
}

void test_sine_and_cosine_always_lie_on_the_unit_circle(void)
{
    /* Each component is within 1 LSB, so the radius within sqrt 2. */
    for (uint32_t theta = 0; theta < 65536U; theta++) {
        const sincos_t out = angle_sincos((uint16_t)theta);
        const double radius = hypot(out.sin, out.cos);
        TEST_ASSERT_DOUBLE_WITHIN(1.4143, 32768.0, radius);
    }
}

void test_sum_of_sine_and_cosine_magnitudes_is_at_most_sqrt_2(void)
{
    /* |sin| + |cos| <= sqrt 2 and 1 LSB each: the proofs of the rotations (tests/proofs) rely on
     * it. */
    for (uint32_t theta = 0; theta < 65536U; theta++) {
        const sincos_t out = angle_sincos((uint16_t)theta);
        TEST_ASSERT_TRUE(abs(out.sin) <= 32768 && abs(out.cos) <= 32768);
        TEST_ASSERT_LESS_OR_EQUAL(46342, abs(out.sin) + abs(out.cos));
    }
}

void test_the_table_holds_cosine_and_sine_rounded_down(void)
{
    for (int k = 0; k < ANGLE_TABLE_POINTS; k++) {
        const long double angle = TURN * ((long double)k + 0.5L) / ANGLE_TABLE_POINTS;
        TEST_ASSERT_EQUAL_INT(floorl(32768.0L * cosl(angle)), q_pair_x(ANGLE_TABLE[k]));
        TEST_ASSERT_EQUAL_INT(floorl(32768.0L * sinl(angle)), q_pair_y(ANGLE_TABLE[k]));
    }
}

void test_difference_of_two_angles_is_within_half_a_turn(void)
{
    TEST_ASSERT_EQUAL_INT16(0, angle_difference(1234, 1234));
    TEST_ASSERT_EQUAL_INT16(2, angle_difference(1, 65535)); /* forward across zero */
    TEST_ASSERT_EQUAL_INT16(-2, angle_difference(65535, 1));
    TEST_ASSERT_EQUAL_INT16(32767, angle_difference(32767, 0));
    TEST_ASSERT_EQUAL_INT16(
        -32768, angle_difference(32768, 0)); /* half a turn has no short way: the negative one */
}

void test_angle_plus_difference_is_the_other_angle_for_every_pair_on_a_grid(void)
{
    for (uint32_t a = 0; a < 65536U; a += 257U) {
        for (uint32_t b = 0; b < 65536U; b += 251U) {
            const int16_t difference = angle_difference((uint16_t)b, (uint16_t)a);
            TEST_ASSERT_EQUAL_UINT16(b, (uint16_t)((int32_t)a + difference));
        }
    }
}
