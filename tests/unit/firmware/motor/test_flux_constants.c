/* SPDX-License-Identifier: Apache-2.0 */
/* Fluxes of a motor without a map: psi + L_d i_d and L_q i_q, without cross-saturation. */
#include "flux_constants.h"

#include "unity.h"

/* 0.1 mWb and 1 mH, 2 mH: an ampere makes 1 and 2 mWb. */
static const config_motor_t MOTOR = {
    .flux_linkage_nWb = 100000, .d_inductance_nH = 1000000, .q_inductance_nH = 2000000};

void setUp(void) {}
void tearDown(void) {}

void test_fluxes_are_those_of_the_inductances(void)
{
    const flux_map_point_t at = flux_map_of_constants(&MOTOR, -1000, 3000);
    TEST_ASSERT_EQUAL_INT32(100000 - 1000000, at.d_nWb);
    TEST_ASSERT_EQUAL_INT32(6000000, at.q_nWb);
    TEST_ASSERT_EQUAL_INT32(1000000, at.d_nH);
    TEST_ASSERT_EQUAL_INT32(2000000, at.q_nH);
    TEST_ASSERT_EQUAL_INT32(0, at.cross_nH);
}

void test_fluxes_beyond_their_format_saturate(void)
{
    const flux_map_point_t at = flux_map_of_constants(&MOTOR, INT32_MAX, -INT32_MAX);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, at.d_nWb);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, at.q_nWb);
}
