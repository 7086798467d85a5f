/* SPDX-License-Identifier: Apache-2.0 */
/* The three frames are three types, so that a vector of one is not accepted as one of another; the
 * assertions are of the compiler. */
#include "core/frames.h"
#include "unity.h"

#define IS(type, expression) _Generic((expression), type : 1, default : 0)

_Static_assert(IS(ab_t, (ab_t){0}) && !IS(ab_t, (dq_t){0}) && !IS(ab_t, (abc_t){0}),
               "alpha-beta is its own type");
_Static_assert(IS(dq_t, (dq_t){0}) && !IS(dq_t, (ab_t){0}) && !IS(dq_t, (abc_t){0}),
               "dq is its own type");
_Static_assert(IS(abc_t, (abc_t){0}) && !IS(abc_t, (ab_t){0}) && !IS(abc_t, (dq_t){0}),
               "abc is its own type");
_Static_assert(IS(int32_t, ((abc_t){0}).a) && IS(int32_t, ((ab_t){0}).alpha) &&
                   IS(int32_t, ((dq_t){0}).q),
               "components are the 32-bit intermediates of the fast loop");

void setUp(void) {}

void tearDown(void) {}

void test_frames_have_no_padding(void)
{
    TEST_ASSERT_EQUAL_UINT(3 * sizeof(int32_t), sizeof(abc_t));
    TEST_ASSERT_EQUAL_UINT(2 * sizeof(int32_t), sizeof(ab_t));
    TEST_ASSERT_EQUAL_UINT(2 * sizeof(int32_t), sizeof(dq_t));
}

void test_packed_vectors_saturate_each_component_by_itself(void)
{
    static const int32_t VALUES[][2] = {{0, 0},           {32767, 32767},   {32768, 32767},
                                        {-32768, -32768}, {-32769, -32768}, {-70000, -32768}};
    for (int k = 0; k < 6; k++) {
        const ab_t ab = {.alpha = VALUES[k][0], .beta = 5};
        const dq_t dq = {.d = -5, .q = VALUES[k][0]};
        TEST_ASSERT_EQUAL_INT32(VALUES[k][1], q_pair_x(ab16_saturated(ab).v));
        TEST_ASSERT_EQUAL_INT32(5, q_pair_y(ab16_saturated(ab).v));
        TEST_ASSERT_EQUAL_INT32(-5, q_pair_x(dq16_saturated(dq).v));
        TEST_ASSERT_EQUAL_INT32(VALUES[k][1], q_pair_y(dq16_saturated(dq).v));
    }
}
