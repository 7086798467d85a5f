/* SPDX-License-Identifier: Apache-2.0 */
/* The validator on the flux map. */
#include <string.h>

#include "refusal.h"
#include "unity.h"

/* 75 A: four steps of 20 A below zero, five along i_q. */
void setUp(void)
{
    config = CONFIG_LU2013;
    config_flux_map_t *map = &config.flux_map;
    map->d_points = 6;
    map->d_negative_points = 4;
    map->d_step_mA = 20000;
    map->q_points = 5;
    map->q_step_mA = 20000;
    map->lsb_log2 = 10;
    for (int d = 0; d < 6; d++) {
        for (int q = 0; q < 5; q++) {
            map->psi_d_lsb[d * 5 + q] = (int16_t)(20000 + 1500 * (d - 4) - 10 * q);
            map->psi_q_lsb[d * 5 + q] = (int16_t)(1400 * q);
        }
    }
}

void tearDown(void) {}

void test_map_is_accepted_and_none_too(void)
{
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
    memset(&config.flux_map, 0, sizeof config.flux_map);
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
}

void test_points_must_fit_the_table(void)
{
    config.flux_map.d_points = 2;
    assert_relation("flux_map.d_points at least 3");
    setUp();
    config.flux_map.q_points = 1;
    assert_relation("flux_map.d_points at least 3");
    setUp();
    config.flux_map.d_points = 59;
    assert_relation("their product within the table");
}

void test_zero_current_must_be_a_point_between_others(void)
{
    config.flux_map.d_negative_points = 0;
    assert_relation("flux_map.d_negative_points above 0");
    setUp();
    config.flux_map.d_negative_points = 5;
    assert_relation("flux_map.d_negative_points above 0");
}

void test_map_must_hold_the_current_circle(void)
{
    config.flux_map.d_step_mA = 75000 / 4;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
    config.flux_map.d_step_mA--;
    assert_relation("flux_map covers motor.max_phase_current_mA");
    setUp();
    config.flux_map.q_step_mA = 75000 / 4;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
    config.flux_map.q_step_mA--;
    assert_relation("flux_map covers motor.max_phase_current_mA");
}

void test_q_flux_must_be_zero_without_q_current(void)
{
    config.flux_map.psi_q_lsb[5 * 5] = -1;
    assert_relation("flux_map.psi_q_lsb zero at i_q = 0");
}

void test_fluxes_must_rise_with_the_current_of_their_axis(void)
{
    config_flux_map_t *map = &config.flux_map;
    map->psi_d_lsb[5 * 5 + 4] = map->psi_d_lsb[4 * 5 + 4];
    assert_relation("flux_map.psi_d_lsb rises");
    setUp();
    map->psi_d_lsb[5 * 5 + 4] = (int16_t)(map->psi_d_lsb[4 * 5 + 4] + 1);
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
    map->psi_q_lsb[5 * 5 + 4] = map->psi_q_lsb[5 * 5 + 3];
    assert_relation("flux_map.psi_d_lsb rises");
}

void test_magnets_must_be_along_the_d_axis(void)
{
    for (int k = 0; k < 30; k++) {
        config.flux_map.psi_d_lsb[k] = (int16_t)(config.flux_map.psi_d_lsb[k] - 20000);
    }
    assert_relation("flux_map.psi_d_lsb above zero without current");
    setUp();
    for (int k = 0; k < 30; k++) {
        config.flux_map.psi_d_lsb[k] = (int16_t)(config.flux_map.psi_d_lsb[k] - 19999);
    }
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
}
