/* SPDX-License-Identifier: Apache-2.0 */
/* The flux map beside bilinear interpolation in double precision. */
#include <string.h>

#include "motor/flux_map.h"
#include "paper_vehicle.h"
#include "random_values.h"
#include "reference_flux_map.h"
#include "unity.h"

static config_t config;

void setUp(void)
{
    config = paper_vehicle();
}

void tearDown(void) {}

enum { ROWS = 7, BELOW = 4, COLUMNS = 6, D_STEP_mA = 12345, Q_STEP_mA = 23456, LSB_nWb = 1 << 8 };

/* Rising along both axes by random steps; psi_q zero without i_q. */
static void random_map(uint64_t seed)
{
    random_t random = random_seeded(seed);
    config_flux_map_t *map = &config.flux_map;
    memset(map, 0, sizeof *map);
    map->d_points = ROWS;
    map->d_negative_points = BELOW;
    map->d_step_mA = D_STEP_mA;
    map->q_points = COLUMNS;
    map->q_step_mA = Q_STEP_mA;
    map->lsb_log2 = 8;
    for (int d = 0; d < ROWS; d++) {
        for (int q = 0; q < COLUMNS; q++) {
            const int32_t below = d > 0 ? map->psi_d_lsb[(d - 1) * COLUMNS + q] : 1000;
            const int32_t before = q > 0 ? map->psi_q_lsb[d * COLUMNS + q - 1] : 0;
            map->psi_d_lsb[d * COLUMNS + q] = (int16_t)(below + random_between(&random, 100, 4000));
            map->psi_q_lsb[d * COLUMNS + q] =
                (int16_t)(q > 0 ? before + random_between(&random, 100, 4000) : 0);
        }
    }
}

void test_fluxes_and_inductances_are_those_of_bilinear_interpolation(void)
{
    /* A position has 13 fraction bits: of steps of at most 4000 entries half an entry each axis. */
    const double flux_nWb = 2.0 * LSB_nWb;
    const double relative = 1e-3;
    const double most_nH = 4000.0 * LSB_nWb * 1000.0 / D_STEP_mA;
    random_t random = random_seeded(20);
    for (uint64_t seed = 0; seed < 200; seed++) {
        random_map(seed);
        for (int n = 0; n < 50; n++) {
            const int32_t i_d_mA = random_between(&random, -70000, 45000);
            const int32_t i_q_mA = random_between(&random, -150000, 150000);
            const flux_map_point_t at = flux_map_at(&config, i_d_mA, i_q_mA);
            const reference_flux_t want = reference_flux(&config.flux_map, i_d_mA, i_q_mA);
            TEST_ASSERT_DOUBLE_WITHIN(flux_nWb, want.d_nWb, at.d_nWb);
            TEST_ASSERT_DOUBLE_WITHIN(flux_nWb, want.q_nWb, at.q_nWb);
            TEST_ASSERT_DOUBLE_WITHIN(relative * most_nH, want.d_nH, at.d_nH);
            TEST_ASSERT_DOUBLE_WITHIN(relative * most_nH, want.q_nH, at.q_nH);
            TEST_ASSERT_DOUBLE_WITHIN(2.0 * relative * most_nH, want.cross_nH, at.cross_nH);
        }
    }
}

void test_points_themselves_are_exact(void)
{
    random_map(1);
    for (int d = 0; d < ROWS; d++) {
        for (int q = 0; q < COLUMNS; q++) {
            const flux_map_point_t at =
                flux_map_at(&config, (d - BELOW) * D_STEP_mA, q * Q_STEP_mA);
            const int k = d * COLUMNS + q;
            TEST_ASSERT_INT32_WITHIN(LSB_nWb, config.flux_map.psi_d_lsb[k] * LSB_nWb, at.d_nWb);
            TEST_ASSERT_INT32_WITHIN(LSB_nWb, config.flux_map.psi_q_lsb[k] * LSB_nWb, at.q_nWb);
        }
    }
}

void test_any_currents_give_the_fluxes_at_the_ends(void)
{
    random_map(2);
    const flux_map_point_t far = flux_map_at(&config, INT32_MIN, INT32_MAX);
    const flux_map_point_t end = flux_map_at(&config, -BELOW * D_STEP_mA - D_STEP_mA / 2,
                                             (COLUMNS - 1) * Q_STEP_mA + Q_STEP_mA / 2 + 1);
    TEST_ASSERT_INT32_WITHIN(LSB_nWb, end.d_nWb, far.d_nWb);
    TEST_ASSERT_INT32_WITHIN(LSB_nWb, end.q_nWb, far.q_nWb);
    TEST_ASSERT_EQUAL_INT32(end.d_nH, far.d_nH);
    const flux_map_point_t other = flux_map_at(&config, INT32_MAX, INT32_MIN);
    TEST_ASSERT_LESS_THAN_INT32(0, other.q_nWb);
    TEST_ASSERT_GREATER_THAN_INT32(far.d_nWb, other.d_nWb);
}

void test_without_a_map_the_constants_are_the_motor(void)
{
    config.motor.type = CONFIG_MOTOR_IPMSM;
    config.motor.flux_linkage_nWb = 90000000;
    config.motor.d_inductance_nH = 250000;
    config.motor.q_inductance_nH = 650000;
    /* 90 mWb - 0.25 mH 40 A = 80 mWb; 0.65 mH (-20 A) = -13 mWb */
    const flux_map_point_t at = flux_map_at(&config, -40000, -20000);
    TEST_ASSERT_EQUAL_INT32(80000000, at.d_nWb);
    TEST_ASSERT_EQUAL_INT32(-13000000, at.q_nWb);
    TEST_ASSERT_EQUAL_INT32(250000, at.d_nH);
    TEST_ASSERT_EQUAL_INT32(650000, at.q_nH);
    TEST_ASSERT_EQUAL_INT32(0, at.cross_nH);
    TEST_ASSERT_EQUAL_INT32(0, flux_map_shift_mA(&config, 15000));
}

/* psi_d at i_q = 0 and the shift is that of the magnets, which fall by 0.11 % a kelvin. */
void test_magnets_act_as_the_d_current_with_their_flux(void)
{
    config.motor.reference_temperature_cC = 2500;
    config.motor.flux_coefficient_ppm_K = -1100;
    for (uint64_t seed = 0; seed < 100; seed++) {
        random_map(seed);
        const double cold_nWb = config.flux_map.psi_d_lsb[BELOW * COLUMNS] * LSB_nWb;
        for (int32_t winding_cC = -4000; winding_cC <= 18000; winding_cC += 550) {
            const int32_t shift_mA = flux_map_shift_mA(&config, winding_cC);
            const double magnets_nWb = cold_nWb * (1.0 - 1.1e-3 * (winding_cC - 2500) / 100.0);
            TEST_ASSERT_DOUBLE_WITHIN(2e-4 * cold_nWb + LSB_nWb, magnets_nWb,
                                      flux_map_at(&config, shift_mA, 0).d_nWb);
            TEST_ASSERT_TRUE(winding_cC <= 2500 ? shift_mA >= -1 : shift_mA < 0);
        }
    }
    config.motor.flux_coefficient_ppm_K = 0;
    TEST_ASSERT_EQUAL_INT32(0, flux_map_shift_mA(&config, 15000));
}

/* A broken thermistor shows any temperature; the shift stays inside the map, and half a step. */
void test_shift_is_bounded_at_any_temperature(void)
{
    random_map(3);
    config.motor.flux_coefficient_ppm_K = -10000;
    const int32_t hot_mA = flux_map_shift_mA(&config, INT32_MAX);
    const int32_t cold_mA = flux_map_shift_mA(&config, INT32_MIN);
    TEST_ASSERT_EQUAL_INT32(-BELOW * D_STEP_mA - D_STEP_mA / 2 - 1, hot_mA);
    TEST_ASSERT_INT32_WITHIN(1, (ROWS - BELOW - 1) * D_STEP_mA + D_STEP_mA / 2, cold_mA);
}
