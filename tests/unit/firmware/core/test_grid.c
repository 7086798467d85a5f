/* SPDX-License-Identifier: Apache-2.0 */
/* Reading a table: position on the axis and interpolation. */
#include <math.h>

#include "core/grid.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

void test_index_and_fraction_give_every_position_of_the_axis(void)
{
    for (int32_t step_log2 = 0; step_log2 <= 8; step_log2++) {
        const int32_t step = 1 << step_log2;
        for (int32_t x = 0; x < 5 * step; x++) {
            const grid_position_t p = grid_locate(x, 6, step_log2);
            TEST_ASSERT_EQUAL_INT32(x, p.index * step + p.fraction_q20 * step / GRID_WHOLE_Q20);
            TEST_ASSERT_EQUAL_INT32(0, p.fraction_q20 * step %
                                           GRID_WHOLE_Q20); /* nothing was rounded */
            TEST_ASSERT_TRUE(p.index >= 0 && p.index <= 4 && p.fraction_q20 >= 0 &&
                             p.fraction_q20 <= GRID_WHOLE_Q20);
        }
    }
}

void test_position_is_clamped_to_the_ends_of_the_axis(void)
{
    static const int32_t BELOW[] = {INT32_MIN, -1000, -1, 0};
    static const int32_t ABOVE[] = {1792, 1793, 100000, INT32_MAX}; /* 7 intervals of 256 */
    for (unsigned i = 0; i < 4; i++) {
        const grid_position_t low = grid_locate(BELOW[i], 8, 8);
        TEST_ASSERT_EQUAL_INT32(0, low.index);
        TEST_ASSERT_EQUAL_INT32(0, low.fraction_q20);
        const grid_position_t high = grid_locate(ABOVE[i], 8, 8);
        TEST_ASSERT_EQUAL_INT32(6, high.index); /* the last interval, at its far end */
        TEST_ASSERT_EQUAL_INT32(GRID_WHOLE_Q20, high.fraction_q20);
    }
}

void test_largest_grid_locates_the_largest_argument(void)
{
    const grid_position_t p = grid_locate(INT32_MAX, 65, 20);
    TEST_ASSERT_EQUAL_INT32(63, p.index);
    TEST_ASSERT_EQUAL_INT32(GRID_WHOLE_Q20, p.fraction_q20);
}

void test_interpolation_is_the_straight_line_rounded_to_nearest(void)
{
    static const int32_t PAIRS[][2] = {
        {0, 1000}, {1000, 0}, {-7, 9}, {-1000000, -999}, {1 - (1 << 30), (1 << 30) - 1}, {5, 5}};
    for (unsigned i = 0; i < sizeof(PAIRS) / sizeof(PAIRS[0]); i++) {
        /* 2^20 - 1 is a multiple of 75: the last fraction is the whole. */
        for (int32_t fraction_q20 = 1; fraction_q20 <= GRID_WHOLE_Q20; fraction_q20 += 75) {
            const double a = PAIRS[i][0];
            const double b = PAIRS[i][1];
            const double exact =
                a + (b - a) * fraction_q20 / GRID_WHOLE_Q20; /* 53 bits: nothing is rounded */
            const int32_t got = grid_interpolate(PAIRS[i][0], PAIRS[i][1], fraction_q20);
            TEST_ASSERT_TRUE(fabs(got - exact) <= 0.5);
            TEST_ASSERT_TRUE(got >= fmin(a, b) &&
                             got <= fmax(a, b)); /* never leaves its neighbours */
        }
    }
}

void test_the_ends_of_an_interval_are_exact(void)
{
    TEST_ASSERT_EQUAL_INT32(-77, grid_interpolate(-77, 1234567, 0));
    TEST_ASSERT_EQUAL_INT32(1234567, grid_interpolate(-77, 1234567, GRID_WHOLE_Q20));
}

void test_weights_of_a_cell_are_none_negative_and_add_up_to_one(void)
{
    /* 2^20 - 1 = 1023 * 1025: the last x is the whole, the last y zero. */
    for (int32_t x_q20 = 1; x_q20 <= GRID_WHOLE_Q20; x_q20 += 1025) {
        for (int32_t y_q20 = GRID_WHOLE_Q20 - 1; y_q20 >= 0; y_q20 -= 1023) {
            const grid_weights_t w = grid_weights(x_q20, y_q20, 0);
            TEST_ASSERT_TRUE(w.at_00 >= 0 && w.at_10 >= 0 && w.at_01 >= 0 && w.at_11 >= 0);
            TEST_ASSERT_TRUE(w.at_00 + w.at_10 + w.at_01 + w.at_11 == 1 << 16);
        }
    }
}

void test_weighted_corners_are_the_bilinear_surface_rounded_to_nearest(void)
{
    static const int16_t CORNERS[][4] = {
        {0, 1000, -1000, 17}, {5, 5, 5, 5}, {32767, -32767, -32767, 32767}, {1, 0, 0, -1}};
    for (unsigned i = 0; i < sizeof(CORNERS) / sizeof(CORNERS[0]); i++) {
        const int16_t *c = CORNERS[i];
        const int32_t lsb_log2 = i == 3 ? 10 : (int32_t)(5 * i);
        for (int32_t x_q20 = 0; x_q20 <= GRID_WHOLE_Q20; x_q20 += 4096) {
            for (int32_t y_q20 = 0; y_q20 <= GRID_WHOLE_Q20; y_q20 += 4096) {
                const double x = (double)x_q20 / GRID_WHOLE_Q20;
                const double y = (double)y_q20 / GRID_WHOLE_Q20;
                const double exact =
                    (1 << lsb_log2) * ((1.0 - x) * (1.0 - y) * c[0] + x * (1.0 - y) * c[1] +
                                       (1.0 - x) * y * c[2] + x * y * c[3]);
                const grid_weights_t w = grid_weights(x_q20, y_q20, lsb_log2);
                const int32_t got = grid_weighted(&w, c[0], c[1], c[2], c[3]);
                TEST_ASSERT_TRUE(fabs(got - exact) <= 0.5);
            }
        }
    }
}
