/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Flux maps of the largest entries and rises: a position a unit beside is seen in flux and
 * inductance. Beside the map in double precision. With steps of 2^14 mA every second milliampere is
 * a position, and only roundings down are left.
 */
#include <string.h>

#include "motor/flux_map.h"
#include "paper_vehicle.h"
#include "random_values.h"
#include "reference_flux_map.h"
#include "unity.h"

enum { MOST_lsb = 32767, UNITS = 8192 /* of a position and an entry */ };

static config_t config;

void setUp(void)
{
    config = paper_vehicle();
    memset(&config.flux_map, 0, sizeof config.flux_map);
    config.motor.reference_temperature_cC = 2500;
}

void tearDown(void) {}

/* Rising rows and columns between the ends of the format; psi_q zero without i_q. */
static void steep_map(uint64_t seed, int32_t step_mA, int32_t lsb_log2)
{
    enum { ROWS = 4, COLUMNS = 3 };
    config_flux_map_t *map = &config.flux_map;
    random_t random = random_seeded(seed);
    map->d_points = ROWS;
    map->d_negative_points = 2;
    map->d_step_mA = step_mA;
    map->q_points = COLUMNS;
    map->q_step_mA = step_mA;
    map->lsb_log2 = lsb_log2;
    for (int d = 0; d < ROWS; d++) {
        for (int q = 0; q < COLUMNS; q++) {
            const int32_t lowest = d > 0 ? map->psi_d_lsb[(d - 1) * COLUMNS + q] + 1 : -MOST_lsb;
            const int32_t before = q > 0 ? map->psi_q_lsb[d * COLUMNS + q - 1] + 1 : 0;
            map->psi_d_lsb[d * COLUMNS + q] =
                (int16_t)random_between(&random, lowest, MOST_lsb - ROWS + d);
            map->psi_q_lsb[d * COLUMNS + q] =
                (int16_t)(q > 0 ? random_between(&random, before, MOST_lsb - COLUMNS + q) : 0);
        }
    }
}

/* Of either sign the same. */
static double in_32_bits(double x)
{
    return reference_clamp(x, -2147483647.0, 2147483647.0);
}

/* A flux is rounded down twice, of a unit and of a nanoweber, an inductance by a unit of either of
 * two fluxes and by its reciprocal step. */
static void assert_exact(int32_t i_d_mA, int32_t i_q_mA)
{
    const config_flux_map_t *map = &config.flux_map;
    const flux_map_point_t at = flux_map_at(&config, i_d_mA, i_q_mA);
    const reference_flux_t want = reference_flux(map, i_d_mA, i_q_mA);
    const double unit_nWb = ldexp(1.0 / UNITS, map->lsb_log2);
    const double by_reciprocal = map->d_step_mA / (1000.0 * 0x1p21);
    const double unit_nH = 1.0 + unit_nWb * 1000.0 / map->d_step_mA;
    TEST_ASSERT_DOUBLE_WITHIN(unit_nWb + 1.0, in_32_bits(want.d_nWb), at.d_nWb);
    TEST_ASSERT_DOUBLE_WITHIN(unit_nWb + 1.0, in_32_bits(want.q_nWb), at.q_nWb);
    TEST_ASSERT_DOUBLE_WITHIN(unit_nH + by_reciprocal * fabs(want.d_nH), in_32_bits(want.d_nH),
                              at.d_nH);
    TEST_ASSERT_DOUBLE_WITHIN(unit_nH + by_reciprocal * fabs(want.q_nH), in_32_bits(want.q_nH),
                              at.q_nH);
    TEST_ASSERT_DOUBLE_WITHIN(unit_nH + by_reciprocal * fabs(want.cross_nH),
                              in_32_bits(want.cross_nH), at.cross_nH);
}

void test_every_second_milliampere_is_exact_and_far_ones_end_half_a_step_beyond_the_map(void)
{
    random_t random = random_seeded(21);
    for (uint64_t seed = 0; seed < 100; seed++) {
        steep_map(seed, 1 << 14, seed % 2 == 0 ? 16 : 0);
        for (int n = 0; n < 100; n++) {
            assert_exact(2 * random_between(&random, -30000, 25000),
                         2 * random_between(&random, -25000, 25000));
        }
        /* At a point, between two and around zero. */
        for (int32_t i_q_mA = -32768; i_q_mA <= 32768; i_q_mA += 1 << 13) {
            assert_exact(0, i_q_mA);
            assert_exact(-(1 << 13), i_q_mA + 2);
            assert_exact(1 << 13, i_q_mA - 2);
        }
    }
}

void test_any_currents_beside_any_step_end_within_32_bits(void)
{
    random_t random = random_seeded(22);
    for (uint64_t seed = 0; seed < 100; seed++) {
        steep_map(seed, 1 << (seed % 14), 16);
        for (int n = 0; n < 20; n++) {
            assert_exact(random_wild(&random), random_wild(&random));
        }
        for (int n = -3; n <= 3; n++) {
            assert_exact(0, n);
            assert_exact(n, 1);
        }
    }
}

/* Twice 32 767 entries of 2^16 nWb over a milliampere, of either sign. */
void test_an_inductance_beyond_32_bits_is_the_largest_number_of_either_sign(void)
{
    config_flux_map_t *map = &config.flux_map;
    steep_map(1, 1, 16);
    for (int k = 0; k < map->d_points * map->q_points; k++) {
        map->psi_d_lsb[k] = (int16_t)(k % map->q_points % 2 == 0 ? MOST_lsb : -MOST_lsb);
    }
    TEST_ASSERT_EQUAL_INT32(-INT32_MAX, flux_map_at(&config, 0, 0).cross_nH);
    TEST_ASSERT_EQUAL_INT32(-INT32_MAX, flux_map_at(&config, 0, -1000).cross_nH);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, flux_map_at(&config, 0, 1000).cross_nH);
}

/* One steep cell behind 63 flat ones, in steps that divide 2^32 - 1: a position to the nearest of
 * 8192 in a step, half of one of 32 704 entries. */
void test_positions_are_the_nearest_ones(void)
{
    static const int32_t STEPS_mA[] = {257, 65535};
    config_flux_map_t *map = &config.flux_map;
    random_t random = random_seeded(23);
    for (int along_d = 0; along_d < 2; along_d++) {
        for (int k = 0; k < 2; k++) {
            map->d_points = along_d != 0 ? 65 : 4;
            map->d_negative_points = 1;
            map->q_points = along_d != 0 ? 4 : 65;
            map->d_step_mA = STEPS_mA[k];
            map->q_step_mA = STEPS_mA[k];
            map->lsb_log2 = 16;
            for (int n = 0; n < 4 * 65; n++) {
                const int d = n / map->q_points;
                const int q = n % map->q_points;
                map->psi_d_lsb[n] = (int16_t)(d < 64 ? d : MOST_lsb);
                map->psi_q_lsb[n] = (int16_t)(q < 64 ? q : MOST_lsb);
            }
            for (int n = 0; n < 400; n++) {
                const int32_t in_cell_mA =
                    random_between(&random, 63 * STEPS_mA[k], 64 * STEPS_mA[k]);
                const int32_t i_d_mA = along_d != 0 ? in_cell_mA - STEPS_mA[k] : 0;
                const int32_t i_q_mA = along_d != 0 ? 0 : in_cell_mA;
                const flux_map_point_t at = flux_map_at(&config, i_d_mA, i_q_mA);
                const reference_flux_t want = reference_flux(map, i_d_mA, i_q_mA);
                const double half_nWb = 0.505 / UNITS * MOST_lsb * 65536.0;
                TEST_ASSERT_DOUBLE_WITHIN(half_nWb, want.d_nWb, at.d_nWb);
                TEST_ASSERT_DOUBLE_WITHIN(half_nWb, want.q_nWb, at.q_nWb);
            }
        }
    }
}

/* ---- temperature of the magnets ---- */

/* psi_d along i_d at i_q = 0: the i_d with a flux, in entries; half a step beyond the ends. */
static double current_of_entries(double wanted_lsb)
{
    const config_flux_map_t *map = &config.flux_map;
    int d = 0;
    while (d < map->d_points - 2 && map->psi_d_lsb[(d + 1) * map->q_points] < wanted_lsb) {
        d++;
    }
    const double low = map->psi_d_lsb[d * map->q_points];
    const double rise = map->psi_d_lsb[(d + 1) * map->q_points] - low;
    const double share = reference_clamp((wanted_lsb - low) / rise, -0.5, 1.5);
    return (d - map->d_negative_points + share) * map->d_step_mA;
}

/* Strong magnets beside rises that are small, so that 1/8192 of the flux is a large share. */
static void weak_rises(uint64_t seed, int32_t magnets_lsb, int32_t least_rise, int32_t most_rise)
{
    enum { ROWS = 20, COLUMNS = 2, BELOW = 15 };
    config_flux_map_t *map = &config.flux_map;
    random_t random = random_seeded(seed);
    map->d_points = ROWS;
    map->d_negative_points = BELOW;
    map->d_step_mA = 10000;
    map->q_points = COLUMNS;
    map->q_step_mA = 10000;
    map->lsb_log2 = 4;
    map->psi_d_lsb[BELOW * COLUMNS] = (int16_t)magnets_lsb;
    for (int d = BELOW - 1; d >= 0; d--) {
        map->psi_d_lsb[d * COLUMNS] = (int16_t)(map->psi_d_lsb[(d + 1) * COLUMNS] -
                                                random_between(&random, least_rise, most_rise));
    }
    for (int d = BELOW + 1; d < ROWS; d++) {
        map->psi_d_lsb[d * COLUMNS] = (int16_t)(map->psi_d_lsb[(d - 1) * COLUMNS] +
                                                random_between(&random, least_rise, most_rise));
    }
}

/* The change of the magnets is a share of 16 fraction bits. */
void test_the_shift_of_the_magnets_is_the_current_with_their_flux_to_16_bits(void)
{
    random_t random = random_seeded(24);
    config.motor.flux_coefficient_ppm_K = -1000;
    for (uint64_t seed = 0; seed < 100; seed++) {
        weak_rises(seed, 30000, 60, 300);
        for (int n = 0; n < 200; n++) {
            const int32_t winding_cC = random_between(&random, 0, 12000);
            const double magnets = 30000.0 * (1.0 - 1e-5 * (winding_cC - 2500));
            /* At most 16 bits of the share, 1e-6 of the change, a milliampere. */
            const double off_lsb = 30000.0 * (0x1p-16 + 1e-7);
            const double low_mA = current_of_entries(magnets - off_lsb) - 1.5;
            const double high_mA = current_of_entries(magnets) + 1.5;
            const int32_t shift_mA = flux_map_shift_mA(&config, winding_cC);
            TEST_ASSERT_TRUE(shift_mA >= low_mA && shift_mA <= high_mA);
        }
    }
}

/* 200 K above at 1 %/K none would be left. */
void test_magnets_keep_a_tenth_of_their_flux(void)
{
    config.motor.flux_coefficient_ppm_K = -10000;
    for (uint64_t seed = 0; seed < 20; seed++) {
        weak_rises(seed, 3000, 190, 240);
        TEST_ASSERT_DOUBLE_WITHIN(2.0, current_of_entries(300.0),
                                  flux_map_shift_mA(&config, 22500));
        TEST_ASSERT_DOUBLE_WITHIN(2.0, current_of_entries(300.0),
                                  flux_map_shift_mA(&config, INT32_MAX));
    }
}

/* 1000 K below they would have eleven times their flux, more than 32 bits of a unit hold. */
void test_cold_magnets_end_half_a_step_beyond_the_map(void)
{
    config.motor.flux_coefficient_ppm_K = -10000;
    weak_rises(1, 30000, 60, 300);
    TEST_ASSERT_EQUAL_INT32(4 * 10000 + 5000, flux_map_shift_mA(&config, INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(4 * 10000 + 5000, flux_map_shift_mA(&config, 2500 - 100000));
}

void test_magnets_that_no_temperature_changes_do_not_move_the_map(void)
{
    config.motor.flux_coefficient_ppm_K = 0;
    for (uint64_t seed = 0; seed < 50; seed++) {
        weak_rises(seed, 30000, 1, 450);
        for (int32_t winding_cC = -4000; winding_cC <= 20000; winding_cC += 6000) {
            TEST_ASSERT_EQUAL_INT32(0, flux_map_shift_mA(&config, winding_cC));
        }
    }
}

/* Entries that flipped in memory, until the check of the image finds them. */
void test_a_flat_map_moves_by_no_more_than_half_a_step_beyond_it(void)
{
    config.motor.flux_coefficient_ppm_K = -1000;
    weak_rises(1, 30000, 0, 0);
    for (int32_t winding_cC = 0; winding_cC <= 5000; winding_cC += 2500) {
        const int32_t shift_mA = flux_map_shift_mA(&config, winding_cC);
        TEST_ASSERT_TRUE(shift_mA >= -155000 && shift_mA <= 45000);
    }
}

void test_a_map_without_points_is_absent(void)
{
    config.motor.flux_coefficient_ppm_K = -1000;
    weak_rises(1, 30000, 60, 300);
    config.flux_map.d_points = 1;
    TEST_ASSERT_TRUE(flux_map_present(&config));
    config.flux_map.d_points = 0;
    TEST_ASSERT_FALSE(flux_map_present(&config));
    TEST_ASSERT_EQUAL_INT32(0, flux_map_shift_mA(&config, 12500));
}
