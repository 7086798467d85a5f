/* SPDX-License-Identifier: Apache-2.0 */
/* Frames: transforms are inverse to each other, power is invariant, the short phasor is exact. */
#include "plant/vectors.h"

#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

void test_forward_and_inverse_transform_cancel(void)
{
    const plant_ab_t x = {.alpha = 3.0, .beta = -7.0};
    const plant_ab_t back = plant_clarke(plant_inverse_clarke(x));
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, x.alpha, back.alpha);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, x.beta, back.beta);
    const plant_phasor_t axis = plant_phasor_of_turn(0.37);
    const plant_ab_t again = plant_inverse_park(plant_park(x, axis), axis);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, x.alpha, again.alpha);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, x.beta, again.beta);
}

void test_transform_keeps_amplitude_and_rejects_the_common_mode(void)
{
    for (int k = 0; k < 24; k++) {
        const double angle = PLANT_TWO_PI * k / 24.0;
        const plant_abc_t phases = {.a = 5.0 * cos(angle) + 2.0,
                                    .b = 5.0 * cos(angle - PLANT_TWO_PI / 3.0) + 2.0,
                                    .c = 5.0 * cos(angle + PLANT_TWO_PI / 3.0) + 2.0};
        const plant_dq_t x = plant_park(plant_clarke(phases), plant_phasor_of_turn(k / 24.0));
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 5.0, x.d);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, x.q);
    }
}

void test_power_is_three_halves_of_the_scalar_product(void)
{
    const plant_ab_t u = {.alpha = 4.0, .beta = 1.0};
    const plant_ab_t i = {.alpha = -2.0, .beta = 3.0};
    const plant_abc_t ux = plant_inverse_clarke(u);
    const plant_abc_t ix = plant_inverse_clarke(i);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, ux.a * ix.a + ux.b * ix.b + ux.c * ix.c,
                              1.5 * (u.alpha * i.alpha + u.beta * i.beta));
}

void test_the_short_phasor_is_sine_and_cosine_over_its_range(void)
{
    for (int k = -100; k <= 100; k++) {
        const double x = 0.0025 * k;
        const plant_phasor_t short_one = plant_small_phasor(x);
        TEST_ASSERT_DOUBLE_WITHIN(1e-14, cos(x), short_one.cos);
        TEST_ASSERT_DOUBLE_WITHIN(1e-14, sin(x), short_one.sin);
    }
}

void test_the_rectified_sum_is_twice_the_largest_phase(void)
{
    const plant_ab_t x = {.alpha = 1.0, .beta = 0.0}; /* 1, -1/2, -1/2 */
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 2.0, plant_rectified_sum(x));
    const plant_ab_t y = {.alpha = 0.0, .beta = 1.0}; /* 0, sqrt(3)/2, -sqrt(3)/2 */
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, sqrt(3.0), plant_rectified_sum(y));
}
