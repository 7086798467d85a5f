/* SPDX-License-Identifier: Apache-2.0 */
/* What the fast loop counts as its winding where there is no map: the configuration's gains. */
#include "foc/observer_design.h"
#include "unity.h"
#include "winding.h"

static config_t config;

void setUp(void)
{
    config = (config_t){.motor = {.q_inductance_nH = 123456, .flux_linkage_nWb = 1000000},
                        .drive = {.current_full_scale_mA = 50000},
                        .current_loop = {.proportional_d_pu_q16 = 11,
                                         .proportional_q_pu_q16 = 12,
                                         .integral_d_pu_q24 = 13,
                                         .integral_q_pu_q24 = 14,
                                         .inductance_d_pu_q16 = 5000,
                                         .inductance_q_pu_q16 = 6000,
                                         .flux_pu_q16 = 7000}};
}

void tearDown(void) {}

static void expect_axis(const winding_axis_t *expected, const winding_axis_t *axis)
{
    TEST_ASSERT_EQUAL_INT32(expected->proportional_pu_q16, axis->proportional_pu_q16);
    TEST_ASSERT_EQUAL_INT32(expected->integral_pu_q24, axis->integral_pu_q24);
    TEST_ASSERT_EQUAL_INT32(expected->inductance_pu_q16, axis->inductance_pu_q16);
    TEST_ASSERT_EQUAL_INT32(expected->flux_pu_q16, axis->flux_pu_q16);
    TEST_ASSERT_EQUAL_INT32(expected->anti_windup_q28, axis->anti_windup_q28);
}

void test_each_axis_has_its_own_gains_and_the_magnets_are_on_the_d_axis(void)
{
    const winding_t winding = winding_constants(&config);
    /* k_i/k_p: Q24 over Q16 is Q8, in Q28 to nearest. */
    const winding_axis_t d = {11, 13, 5000, 7000, (13 * (1 << 20) + 5) / 11};
    const winding_axis_t q = {12, 14, 6000, 0, (14 * (1 << 20) + 6) / 12};
    expect_axis(&d, &winding.d);
    expect_axis(&q, &winding.q);
}

void test_the_observer_has_the_inductance_that_its_design_has(void)
{
    TEST_ASSERT_EQUAL_INT32(observer_design_inductance_q15(&config),
                            winding_constants(&config).chord_q_q15);
}
