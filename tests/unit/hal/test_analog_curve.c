/* SPDX-License-Identifier: Apache-2.0 */
#include "hal/analog_curve.h"

#include "unity.h"

enum { POINTS = 64 };

static int16_t point_cC[POINTS];
static analog_curve_t curve;

/* T = 20000 cC - 7 cC times the code, which is whole at every point. */
void setUp(void)
{
    for (int k = 0; k < POINTS; k++) {
        point_cC[k] = (int16_t)(20000 - 7 * 64 * k);
    }
    curve = (analog_curve_t){point_cC, 100, 3929};
}

void tearDown(void) {}

void test_a_straight_line_is_met_at_every_code_of_a_whole_sensor(void)
{
    for (int32_t code = 100; code <= 3929; code++) {
        TEST_ASSERT_EQUAL_INT32(20000 - 7 * code, analog_curve_cC(&curve, code));
    }
}

void test_every_code_beyond_both_ends_is_a_broken_sensor_s(void)
{
    for (int32_t code = -10; code <= 65536; code++) {
        if (code < 100 || code > 3929) {
            TEST_ASSERT_EQUAL_INT32(29999, analog_curve_cC(&curve, code));
        }
    }
}

void test_a_sensor_that_is_not_fitted_is_broken_at_every_code(void)
{
    curve.lowest_code = 1;
    curve.highest_code = 0;
    for (int32_t code = 0; code < 4096; code++) {
        TEST_ASSERT_EQUAL_INT32(ANALOG_TEMPERATURE_BROKEN_cC, analog_curve_cC(&curve, code));
    }
}
