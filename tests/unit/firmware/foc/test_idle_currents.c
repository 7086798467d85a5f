/* SPDX-License-Identifier: Apache-2.0 */
/* Sums and quadrant transitions of the current while the bridge does not switch. */
#include "idle_currents.h"

#include "unity.h"

static idle_currents_t idle;

void setUp(void)
{
    const idle_currents_t fresh = {.quadrant = 0};
    idle = fresh;
}

void tearDown(void) {}

static void sample(int32_t alpha, int32_t beta, uint32_t step_count)
{
    const ab16_t i = {.v = q_pair(alpha, beta)};
    idle_currents_step(&idle, i, step_count);
}

/* An axis belongs to the quadrant that follows it in the upper half plane, and the negative beta
 * axis to the last one. */
void test_quadrants_are_counted_from_the_alpha_axis(void)
{
    static const int32_t VECTORS[][3] = {{0, 0, 0},  {5, 1, 0},   {0, 5, 0},  {-1, 5, 1},
                                         {-1, 0, 1}, {-5, -1, 2}, {0, -1, 3}, {1, -1, 3},
                                         {1, 0, 0},  {1, 1, 0}};
    for (unsigned k = 0; k < sizeof VECTORS / sizeof VECTORS[0]; k++) {
        sample(VECTORS[k][0], VECTORS[k][1], k);
        TEST_ASSERT_EQUAL_UINT32(VECTORS[k][2], idle.quadrant);
    }
}

/* Quadrant, what it adds, and the period of the latest transition. */
void test_forward_transition_counts_up_backward_down_and_one_across_two_does_not(void)
{
    static const int32_t STEPS[][4] = {{-5, 5, 1, 1},  {-5, -5, 2, 2}, {5, 5, 2, 2},
                                       {5, -5, 1, 4},  {5, 5, 2, 5},   {5, -5, 1, 6},
                                       {-5, -5, 0, 7}, {-5, 5, -1, 8}, {-6, 5, -1, 8}};
    for (int32_t k = 0; k < 9; k++) {
        sample(STEPS[k][0], STEPS[k][1], (uint32_t)k + 1U);
        TEST_ASSERT_EQUAL_UINT16((uint16_t)STEPS[k][2], idle.quadrant_transitions);
        TEST_ASSERT_EQUAL_UINT16(STEPS[k][3], idle.quadrant_step);
    }
    sample(5, 5, 65536 + 9);
    sample(-5, 5, 65536 + 10);
    TEST_ASSERT_EQUAL_UINT16(10, idle.quadrant_step);
}

void test_sums_are_those_of_the_components(void)
{
    sample(-800, 1847, 1);
    sample(-32768, 32767, 2);
    TEST_ASSERT_EQUAL_INT32(-33568, (int32_t)idle.alpha_pu);
    TEST_ASSERT_EQUAL_INT32(34614, (int32_t)idle.beta_pu);
}
