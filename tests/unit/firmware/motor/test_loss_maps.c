/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stddef.h>

#include "motor/loss_maps.h"
#include "paper_vehicle.h"
#include "random_values.h"
#include "reference_motor.h"
#include "torque_model.h"
#include "unity.h"

static config_t config;

void setUp(void)
{
    config = paper_vehicle();
}

void tearDown(void) {}

/* Any torque up to 33.5 kNm. */
enum { TORQUE_LSB_mNm = 1 << 10 };

/* A map of random torques on a grid of 5 speeds by 4 temperatures: steps of 2^10 mrad/s, and of
 * 2^8 hundredths of a degree from -10 degC. */
static void random_map(uint64_t seed)
{
    random_t random = random_seeded(seed);
    config.regen_map.speed_points = 5;
    config.regen_map.speed_step_log2 = 10;
    config.regen_map.temperature_points = 4;
    config.regen_map.temperature_step_log2 = 8;
    config.regen_map.temperature_origin_cC = -1000;
    for (int k = 0; k < 20; k++) {
        config.regen_map.torque_lsb[k] = (int16_t)random_between(&random, 0, INT16_MAX);
    }
    config.regen_map.lsb_log2 = 10;
}

static int32_t point_mNm(int32_t k)
{
    return config.regen_map.torque_lsb[k] * TORQUE_LSB_mNm;
}

/* Bilinear interpolation by weights, at the point clamped to the grid. */
static long double bilinear(double speed_mrad_s, double temperature_cC)
{
    const long double s = fminl(fmaxl(fabsl((long double)speed_mrad_s) / 1024.0L, 0.0L), 4.0L);
    const long double t =
        fminl(fmaxl(((long double)temperature_cC + 1000.0L) / 256.0L, 0.0L), 3.0L);
    const int column = s >= 4.0L ? 3 : (int)s;
    const int row = t >= 3.0L ? 2 : (int)t;
    const long double x = s - column;
    const long double y = t - row;
    const int16_t *map = config.regen_map.torque_lsb;
    return TORQUE_LSB_mNm *
           ((1.0L - x) * (1.0L - y) * map[row * 5 + column] +
            x * (1.0L - y) * map[row * 5 + column + 1] +
            (1.0L - x) * y * map[(row + 1) * 5 + column] + x * y * map[(row + 1) * 5 + column + 1]);
}

void test_map_is_bilinear_between_its_points(void)
{
    random_map(1);
    random_t random = random_seeded(2);
    for (int n = 0; n < 100000; n++) {
        const int32_t speed_mrad_s = random_between(&random, -6000, 6000);
        const int32_t temperature_cC = random_between(&random, -2000, 1000);
        /* One rounding to the nearest millinewton-metre. The product of the two fractions is within
         * 2^-17 and weighs a sum of differences of at most 2^16 entries: half an entry. */
        TEST_ASSERT_DOUBLE_WITHIN(0.5 + 0.5 * TORQUE_LSB_mNm,
                                  (double)bilinear(speed_mrad_s, temperature_cC),
                                  loss_maps_torque_mNm(&config, speed_mrad_s, temperature_cC));
    }
}

void test_map_equals_the_stored_torque_at_its_points(void)
{
    random_map(3);
    for (int32_t t = 0; t < 4; t++) {
        for (int32_t s = 0; s < 5; s++) {
            TEST_ASSERT_EQUAL_INT32(point_mNm(t * 5 + s),
                                    loss_maps_torque_mNm(&config, s * 1024, -1000 + t * 256));
        }
    }
}

void test_map_is_clamped_to_its_edges(void)
{
    random_map(4);
    TEST_ASSERT_EQUAL_INT32(point_mNm(0), loss_maps_torque_mNm(&config, 0, -5000));
    TEST_ASSERT_EQUAL_INT32(point_mNm(4), loss_maps_torque_mNm(&config, 1000000, -5000));
    TEST_ASSERT_EQUAL_INT32(point_mNm(15), loss_maps_torque_mNm(&config, 0, 30000));
    TEST_ASSERT_EQUAL_INT32(point_mNm(19), loss_maps_torque_mNm(&config, INT32_MAX, 30000));
    TEST_ASSERT_EQUAL_INT32(point_mNm(19), loss_maps_torque_mNm(&config, INT32_MIN, INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(point_mNm(4), loss_maps_torque_mNm(&config, INT32_MAX, INT32_MIN));
}

void test_negative_torque_of_the_interpolation_counts_as_zero(void)
{
    /* Regeneration begins in the middle of the first cell: -10 Nm at standstill, 10 Nm at the first
     * point. */
    random_map(9);
    config.regen_map.lsb_log2 = 0;
    for (int32_t t = 0; t < 4; t++) {
        int16_t *row = &config.regen_map.torque_lsb[(size_t)t * 5U];
        row[0] = -10000;
        row[1] = 10000;
    }
    TEST_ASSERT_EQUAL_INT32(0, loss_maps_torque_mNm(&config, 0, -500));
    TEST_ASSERT_EQUAL_INT32(0, loss_maps_torque_mNm(&config, 511, -500));
    TEST_ASSERT_EQUAL_INT32(5000, loss_maps_torque_mNm(&config, 768, -500));
    TEST_ASSERT_EQUAL_INT32(5000, loss_maps_torque_mNm(&config, -768, -500));
}

void test_map_is_symmetric_in_the_direction_of_rotation(void)
{
    random_map(5);
    random_t random = random_seeded(6);
    for (int n = 0; n < 10000; n++) {
        const int32_t speed_mrad_s = random_between(&random, 0, 6000);
        const int32_t temperature_cC = random_between(&random, -2000, 1000);
        TEST_ASSERT_EQUAL_INT32(loss_maps_torque_mNm(&config, speed_mrad_s, temperature_cC),
                                loss_maps_torque_mNm(&config, -speed_mrad_s, temperature_cC));
    }
}

void test_torque_is_zero_up_to_the_zero_crossing_between_two_points(void)
{
    random_map(9);
    for (int k = 0; k < 20; k += 5) {
        config.regen_map.torque_lsb[k] = -1; /* 1024 mNm */
        config.regen_map.torque_lsb[k + 1] = 1;
    }
    for (int32_t speed_mrad_s = 0; speed_mrad_s <= 1024; speed_mrad_s++) {
        const int32_t line_mNm = 2 * speed_mrad_s - 1024;
        TEST_ASSERT_EQUAL_INT32(line_mNm > 0 ? line_mNm : 0,
                                loss_maps_torque_mNm(&config, speed_mrad_s, -1000));
    }
}

void test_map_stays_within_the_range_of_its_points(void)
{
    random_map(7);
    int32_t lowest = INT32_MAX;
    int32_t highest = INT32_MIN;
    for (int k = 0; k < 20; k++) {
        lowest = point_mNm(k) < lowest ? point_mNm(k) : lowest;
        highest = point_mNm(k) > highest ? point_mNm(k) : highest;
    }
    random_t random = random_seeded(8);
    for (int n = 0; n < 100000; n++) {
        const int32_t torque_mNm = loss_maps_torque_mNm(&config, (int32_t)random_u64(&random),
                                                        (int32_t)random_u64(&random));
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(lowest, torque_mNm);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(highest, torque_mNm);
    }
}

/*
 * The stored points of the paper's vehicle against physics section 3, i_d = 0, in power-invariant
 * quantities:
 *
 *     delta = 2 t_d f_s
 *     c1 = sqrt(2/3) [(6/pi) V_f delta + 3 (k_on + k_off) f_s / pi]
 *     c2 = R_ak delta + R_ds (1 - delta)
 *     A = R + R_i a^2/(1 + a^2) + c2
 *     B = w psi/(1 + a^2)
 *     i_opt = -(B - c1)/(2 A)
 *
 * Inverter of tools/motors/lu2013.toml: R_ds 3.3 mOhm, V_f 0.8 V, R_ak 5 mOhm, t_d 1 us, f_s
 * 20 kHz, k 5 uJ/A each.
 */
static double optimal_torque_nm(const reference_motor_t *m)
{
    const double pi = 3.14159265358979323846;
    const double dead = 2.0 * 1e-6 * 20e3;
    const double c1 = sqrt(2.0 / 3.0) * (6.0 / pi * 0.8 * dead + 3.0 * 10e-6 * 20e3 / pi);
    const double c2 = 0.005 * dead + 0.0033 * (1.0 - dead);
    const double psi = sqrt(1.5) * m->psi_wb;
    const double iron_ohm = 1.0 / m->iron_siemens;
    const double a2 =
        m->w_rad_s * m->w_rad_s * m->l_d_h * m->l_q_h * m->iron_siemens * m->iron_siemens;
    const double a = m->resistance_ohm + iron_ohm * a2 / (1.0 + a2) + c2;
    const double b = m->w_rad_s * psi / (1.0 + a2);
    const double i_qt = (-(b - c1) / (2.0 * a) - m->w_rad_s * psi * m->iron_siemens) / (1.0 + a2);
    return -m->pole_pairs * psi * i_qt; /* L_d = L_q */
}

void test_stored_optimum_of_the_paper_s_vehicle_matches_the_closed_form_at_every_point(void)
{
    /* The stored optimum is for the i_d of least loss, the closed form for i_d = 0. This i_d, far
     * smaller than i_q, returns up to 0.5 % more power and moves the optimal torque by less than
     * 0.03 %. Half an entry more is its rounding. */
    const double half_mNm = 0.5 * (1 << config.regen_map.lsb_log2);
    for (int32_t t = 0; t < config.regen_map.temperature_points; t++) {
        const int32_t temperature_cC = config.regen_map.temperature_origin_cC +
                                       t * (1 << config.regen_map.temperature_step_log2);
        for (int32_t s = 1; s < config.regen_map.speed_points; s++) {
            const int32_t speed_mrad_s = s * (1 << config.regen_map.speed_step_log2);
            const reference_motor_t motor = reference_motor(&config, speed_mrad_s, temperature_cC);
            const double expected_mNm = 1e3 * optimal_torque_nm(&motor);
            TEST_ASSERT_DOUBLE_WITHIN(0.5 + half_mNm + 3e-4 * expected_mNm, expected_mNm,
                                      loss_maps_torque_mNm(&config, speed_mrad_s, temperature_cC));
        }
        TEST_ASSERT_EQUAL_INT32(0, loss_maps_torque_mNm(&config, 0, temperature_cC));
    }
}

void test_closed_form_gives_the_published_figures_of_the_vehicle(void)
{
    /* physics section 6, 25 degC: checks the closed form above, not the map. */
    const double rpm[] = {25.0, 50.0, 100.0, 150.0, 300.0};
    const double torque_nm[] = {11.32, 24.19, 49.60, 74.71, 148.7};
    for (int k = 0; k < 5; k++) {
        const reference_motor_t motor = reference_motor(&config, mrad_s_of_rpm(rpm[k]), 2500);
        TEST_ASSERT_DOUBLE_WITHIN(0.05, torque_nm[k], optimal_torque_nm(&motor));
    }
}

/* ---- minimum-loss d-current map ---- */

enum { TORQUE_POINTS = 7, SPEED_POINTS = 4, LAYERS = 3 };
enum {
    TORQUE_STEP_mNm = 512,
    SPEED_STEP_mrad_s = 1024,
    TEMPERATURE_STEP_cC = 4096,
    ORIGIN_cC = -2000,
    CURRENT_LSB_mA = 1 << 6 /* any i_d up to 2097 A */
};

/* Any values: from -1536 to 1536 mNm, up to 3072 mrad/s, from -20 to 61.92 degC. */
static void random_d_map(uint64_t seed, int32_t layers)
{
    random_t random = random_seeded(seed);
    config.current_map.temperature_points = layers;
    config.current_map.temperature_step_log2 = 12;
    config.current_map.temperature_origin_cC = ORIGIN_cC;
    config.current_map.torque_points = TORQUE_POINTS;
    config.current_map.torque_step_log2 = 9;
    config.current_map.speed_points = SPEED_POINTS;
    config.current_map.speed_step_log2 = 10;
    config.current_map.lsb_log2 = 6;
    for (int k = 0; k < TORQUE_POINTS * SPEED_POINTS * layers; k++) {
        config.current_map.current_d_lsb[k] = (int16_t)random_between(&random, -32767, 32767);
    }
}

static int32_t entry(int32_t w, int32_t s, int32_t t)
{
    return CURRENT_LSB_mA *
           config.current_map.current_d_lsb[(w * SPEED_POINTS + s) * TORQUE_POINTS + t];
}

/* One layer, one temperature, in double precision: speed forward, torque positive along it. */
static double bilinear_d(int32_t layer, int32_t speed_mrad_s, int32_t along_mNm)
{
    const double t =
        fmin(fmax(((double)along_mNm + 1536.0) / TORQUE_STEP_mNm, 0.0), TORQUE_POINTS - 1.0);
    const double s = fmin((double)speed_mrad_s / SPEED_STEP_mrad_s, SPEED_POINTS - 1.0);
    const int32_t column = t >= TORQUE_POINTS - 1 ? TORQUE_POINTS - 2 : (int32_t)t;
    const int32_t row = s >= SPEED_POINTS - 1 ? SPEED_POINTS - 2 : (int32_t)s;
    const double x = t - column;
    const double y = s - row;
    return (1.0 - x) * (1.0 - y) * entry(layer, row, column) +
           x * (1.0 - y) * entry(layer, row, column + 1) +
           (1.0 - x) * y * entry(layer, row + 1, column) +
           x * y * entry(layer, row + 1, column + 1);
}

/* Linear between two layers, clamped to the coldest and the hottest one. */
static double trilinear(int32_t speed_mrad_s, int32_t temperature_cC, int32_t along_mNm)
{
    const double w =
        fmin(fmax(((double)temperature_cC - ORIGIN_cC) / TEMPERATURE_STEP_cC, 0.0), LAYERS - 1.0);
    const int32_t cold = w >= LAYERS - 1 ? LAYERS - 2 : (int32_t)w;
    return (1.0 - (w - cold)) * bilinear_d(cold, speed_mrad_s, along_mNm) +
           (w - cold) * bilinear_d(cold + 1, speed_mrad_s, along_mNm);
}

void test_d_current_map_is_linear_between_its_points_along_every_axis(void)
{
    random_d_map(1, LAYERS);
    random_t random = random_seeded(2);
    for (int n = 0; n < 100000; n++) {
        const int32_t speed_mrad_s = random_between(&random, 0, 4000);
        const int32_t temperature_cC = random_between(&random, -4000, 9000);
        const int32_t torque_mNm = random_between(&random, -2000, 2000);
        /* Up to two roundings to the nearest milliampere, one after the other, and 2^-17 of the
         * product of two fractions, which weighs a sum of differences of at most 2^17 entries. */
        TEST_ASSERT_DOUBLE_WITHIN(1.0 + CURRENT_LSB_mA,
                                  trilinear(speed_mrad_s, temperature_cC, torque_mNm),
                                  map_d_mA(&config, speed_mrad_s, temperature_cC, torque_mNm));
    }
}

void test_d_current_map_equals_the_stored_current_at_its_points(void)
{
    random_d_map(3, LAYERS);
    for (int32_t w = 0; w < LAYERS; w++) {
        for (int32_t s = 0; s < SPEED_POINTS; s++) {
            for (int32_t t = 0; t < TORQUE_POINTS; t++) {
                TEST_ASSERT_EQUAL_INT32(entry(w, s, t),
                                        map_d_mA(&config, s * SPEED_STEP_mrad_s,
                                                 ORIGIN_cC + w * TEMPERATURE_STEP_cC,
                                                 (t - TORQUE_POINTS / 2) * TORQUE_STEP_mNm));
            }
        }
    }
}

void test_single_layer_applies_at_any_temperature(void)
{
    random_d_map(7, 1);
    random_t random = random_seeded(8);
    for (int n = 0; n < 10000; n++) {
        const int32_t speed_mrad_s = random_between(&random, 0, 4000);
        const int32_t torque_mNm = random_between(&random, -2000, 2000);
        const int32_t found_mA = map_d_mA(&config, speed_mrad_s, random_wild(&random), torque_mNm);
        TEST_ASSERT_DOUBLE_WITHIN(1.5, bilinear_d(0, speed_mrad_s, torque_mNm), found_mA);
    }
}

void test_d_current_map_is_symmetric_in_the_direction_of_rotation(void)
{
    random_d_map(4, LAYERS);
    random_t random = random_seeded(5);
    for (int n = 0; n < 10000; n++) {
        const int32_t speed_mrad_s = random_between(&random, 1, 4000);
        const int32_t temperature_cC = random_between(&random, -4000, 9000);
        const int32_t torque_mNm = random_between(&random, -2000, 2000);
        TEST_ASSERT_EQUAL_INT32(map_d_mA(&config, speed_mrad_s, temperature_cC, torque_mNm),
                                map_d_mA(&config, -speed_mrad_s, temperature_cC, -torque_mNm));
    }
}

void test_d_current_map_is_clamped_to_its_edges(void)
{
    random_d_map(6, LAYERS);
    TEST_ASSERT_EQUAL_INT32(entry(0, 0, 0), map_d_mA(&config, 0, INT32_MIN, INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(entry(0, 0, 6), map_d_mA(&config, 0, INT32_MIN, INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(entry(0, 3, 6), map_d_mA(&config, INT32_MAX, INT32_MIN, INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(entry(2, 3, 0), map_d_mA(&config, INT32_MAX, INT32_MAX, INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(entry(2, 3, 6), map_d_mA(&config, INT32_MIN, INT32_MAX, INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(entry(2, 3, 0), map_d_mA(&config, INT32_MIN, INT32_MAX, INT32_MAX));
}

/* The rise over the step in which the torque lies, the last point's as that of the step before it,
 * and none beyond the ends. */
void test_rise_over_a_step_of_torque_is_the_difference_of_its_points(void)
{
    random_d_map(9, LAYERS);
    for (int32_t w = 0; w < LAYERS; w++) {
        const loss_maps_row_t row =
            loss_maps_row_at(&config, SPEED_STEP_mrad_s, ORIGIN_cC + w * TEMPERATURE_STEP_cC);
        for (int32_t t = 0; t + 1 < TORQUE_POINTS; t++) {
            const int32_t from_mNm = (t - TORQUE_POINTS / 2) * TORQUE_STEP_mNm;
            const int32_t rise_mA = entry(w, 1, t + 1) - entry(w, 1, t);
            TEST_ASSERT_EQUAL_INT32(rise_mA, loss_maps_row_rise_mA(&row, from_mNm));
            TEST_ASSERT_EQUAL_INT32(rise_mA,
                                    loss_maps_row_rise_mA(&row, from_mNm + TORQUE_STEP_mNm - 1));
        }
        TEST_ASSERT_EQUAL_INT32(entry(w, 1, 6) - entry(w, 1, 5),
                                loss_maps_row_rise_mA(&row, 3 * TORQUE_STEP_mNm));
        TEST_ASSERT_EQUAL_INT32(0, loss_maps_row_rise_mA(&row, 3 * TORQUE_STEP_mNm + 1));
        TEST_ASSERT_EQUAL_INT32(0, loss_maps_row_rise_mA(&row, -3 * TORQUE_STEP_mNm - 1));
    }
}

void test_single_layer_is_the_coldest_and_the_hottest_one(void)
{
    random_d_map(10, 1);
    const loss_maps_row_t row = loss_maps_row_at(&config, SPEED_STEP_mrad_s, 5000);
    TEST_ASSERT_EQUAL_PTR(&config.current_map.current_d_lsb[TORQUE_POINTS], row.cold_lsb);
    TEST_ASSERT_EQUAL_PTR(row.cold_lsb, row.hot_lsb);
}

void test_largest_valid_grid_is_read_up_to_its_last_point(void)
{
    /* 15 torques each way, 19 speeds, 2 temperatures: all the 1178 points there are. */
    config.current_map.torque_points = 31;
    config.current_map.torque_step_log2 = 20;
    config.current_map.speed_points = 19;
    config.current_map.speed_step_log2 = 20;
    config.current_map.temperature_points = 2;
    config.current_map.temperature_step_log2 = 15;
    config.current_map.temperature_origin_cC = -10000;
    config.current_map.lsb_log2 = 0;
    for (int k = 0; k < CONFIG_CURRENT_MAP_POINTS_MAX; k++) {
        config.current_map.current_d_lsb[k] = (int16_t)k;
    }
    const int32_t hot_cC = -10000 + (1 << 15);
    const int32_t top_mrad_s = 18 * (1 << 20);
    const int32_t most_mNm = 15 * (1 << 20);
    TEST_ASSERT_EQUAL_INT32(1177, map_d_mA(&config, top_mrad_s, hot_cC, most_mNm));
    TEST_ASSERT_EQUAL_INT32(1177 - 30, map_d_mA(&config, top_mrad_s, hot_cC, -most_mNm));
    TEST_ASSERT_EQUAL_INT32(588, map_d_mA(&config, top_mrad_s, -10000, most_mNm));
    TEST_ASSERT_EQUAL_INT32(15, map_d_mA(&config, 0, -10000, 0));
    TEST_ASSERT_EQUAL_INT32(31, map_d_mA(&config, 1 << 20, -10000, -most_mNm));
}

/* Everything in both maps is the same, so everything read from them is. */
static void assert_within_the_maps(void)
{
    static const int32_t SPEEDS_mrad_s[] = {0, 1 << 14, 1 << 20, INT32_MAX};
    static const int32_t TEMPERATURES_cC[] = {-INT32_MAX, 2500, 1 << 17, INT32_MAX};
    for (int s = 0; s < 4; s++) {
        for (int t = 0; t < 4; t++) {
            TEST_ASSERT_EQUAL_INT32(
                5 * TORQUE_LSB_mNm,
                loss_maps_torque_mNm(&config, SPEEDS_mrad_s[s], TEMPERATURES_cC[t]));
            for (int32_t along_mNm = -(1 << 30); along_mNm <= 1 << 29; along_mNm += 1 << 29) {
                TEST_ASSERT_EQUAL_INT32(
                    -7, map_d_mA(&config, SPEEDS_mrad_s[s], TEMPERATURES_cC[t], along_mNm));
            }
        }
    }
}

/* Until the check of the image finds it: whatever the number says, on the finest grid, whose
 * positions are the largest. */
void test_a_number_of_points_that_flips_reads_nothing_beside_the_maps(void)
{
    int32_t *const points[] = {
        &config.regen_map.speed_points,         &config.regen_map.temperature_points,
        &config.current_map.torque_points,      &config.current_map.speed_points,
        &config.current_map.temperature_points,
    };
    random_map(1);
    config.regen_map.speed_step_log2 = 6;
    config.regen_map.temperature_step_log2 = 6;
    config.current_map.speed_step_log2 = 6;
    config.current_map.temperature_step_log2 = 6;
    config.current_map.lsb_log2 = 0;
    for (int k = 0; k < CONFIG_REGEN_POINTS_MAX; k++) {
        config.regen_map.torque_lsb[k] = 5;
    }
    for (int k = 0; k < CONFIG_CURRENT_MAP_POINTS_MAX; k++) {
        config.current_map.current_d_lsb[k] = -7;
    }
    for (int field = 0; field < 5; field++) {
        const int32_t is = *points[field];
        for (int32_t value = -1; value <= 1; value++) {
            *points[field] = value;
            assert_within_the_maps();
        }
        for (uint32_t bit = 0; bit < 32; bit++) {
            *points[field] = (int32_t)((uint32_t)is ^ UINT32_C(1) << bit);
            assert_within_the_maps();
        }
        *points[field] = is;
    }
}

/* On fine grids, so that every position of the axes is met. */
static void flip(int32_t *points, int32_t value)
{
    random_map(1);
    random_d_map(2, LAYERS);
    config.regen_map.speed_step_log2 = 6;
    config.regen_map.temperature_step_log2 = 6;
    config.current_map.speed_step_log2 = 6;
    config.current_map.temperature_step_log2 = 6;
    random_t random = random_seeded(3);
    for (int k = 0; k < CONFIG_REGEN_POINTS_MAX; k++) {
        config.regen_map.torque_lsb[k] = (int16_t)random_between(&random, 0, INT16_MAX);
    }
    for (int k = 0; k < CONFIG_CURRENT_MAP_POINTS_MAX; k++) {
        config.current_map.current_d_lsb[k] = (int16_t)random_between(&random, -32767, 32767);
    }
    *points = value;
}

/* The currents and the torque of a number of points are those of another number. */
static void assert_as(int32_t *points, int32_t value, int32_t other)
{
    for (int32_t at = 0; at <= 70; at += 7) {
        const int32_t speed_mrad_s = at * 64 + 16;
        const int32_t winding_cC = at * 64 - 1000 - 32;
        flip(points, value);
        const int32_t torque_mNm = loss_maps_torque_mNm(&config, speed_mrad_s, winding_cC);
        const int32_t d_mA = map_d_mA(&config, speed_mrad_s, winding_cC, at * 30 - 1000);
        flip(points, other);
        TEST_ASSERT_EQUAL_INT32(loss_maps_torque_mNm(&config, speed_mrad_s, winding_cC),
                                torque_mNm);
        TEST_ASSERT_EQUAL_INT32(map_d_mA(&config, speed_mrad_s, winding_cC, at * 30 - 1000), d_mA);
    }
}

/* Of the five axes the temperatures of the d-current map may be a single one. */
void test_a_number_of_points_beyond_an_axis_is_the_nearest_that_an_axis_has(void)
{
    int32_t *const points[] = {
        &config.regen_map.speed_points,         &config.regen_map.temperature_points,
        &config.current_map.torque_points,      &config.current_map.speed_points,
        &config.current_map.temperature_points,
    };
    for (int field = 0; field < 5; field++) {
        assert_as(points[field], INT32_MAX, 65);
        assert_as(points[field], 66, 65);
        if (field < 4) {
            assert_as(points[field], INT32_MIN, 2);
            assert_as(points[field], 0, 2);
            assert_as(points[field], 1, 2);
        }
    }
}

void test_two_points_are_the_fewest_along_an_axis(void)
{
    random_map(11);
    config.regen_map.speed_points = 2;
    config.regen_map.temperature_points = 2;
    for (int32_t t = 0; t < 2; t++) {
        for (int32_t s = 0; s < 2; s++) {
            TEST_ASSERT_EQUAL_INT32(
                point_mNm(2 * t + s),
                loss_maps_torque_mNm(&config, s * 5000, t == 0 ? INT32_MIN : INT32_MAX));
        }
    }
}

static void assert_last_torque(int32_t speed_points, int32_t temperature_points)
{
    config.regen_map.speed_points = speed_points;
    config.regen_map.temperature_points = temperature_points;
    TEST_ASSERT_EQUAL_INT32(point_mNm(CONFIG_REGEN_POINTS_MAX - 1),
                            loss_maps_torque_mNm(&config, INT32_MAX, INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(point_mNm(CONFIG_REGEN_POINTS_MAX - 1),
                            loss_maps_torque_mNm(&config, INT32_MAX, 63 * 64 - 1000));
    TEST_ASSERT_EQUAL_INT32(point_mNm(CONFIG_REGEN_POINTS_MAX - 2),
                            loss_maps_torque_mNm(&config, 0, INT32_MAX));
}

/* More points than there is room for: beyond the room its last cell counts. */
void test_a_grid_beyond_the_room_of_its_map_ends_with_the_last_cell_of_the_room(void)
{
    flip(&config.current_map.torque_points, 65);
    assert_last_torque(65, 65);
    assert_last_torque(65, 1000);
    config.current_map.speed_points = 65;
    for (int32_t layers = 1; layers <= 65; layers += 64) {
        config.current_map.temperature_points = layers;
        const int16_t *lsb = config.current_map.current_d_lsb;
        const int32_t last = CONFIG_CURRENT_MAP_POINTS_MAX - 1;
        TEST_ASSERT_EQUAL_INT32(lsb[last] * CURRENT_LSB_mA,
                                map_d_mA(&config, INT32_MAX, INT32_MAX, INT32_MAX));
        TEST_ASSERT_EQUAL_INT32(lsb[last - 64] * CURRENT_LSB_mA,
                                map_d_mA(&config, INT32_MAX, INT32_MAX, -INT32_MAX));
    }
}

void test_d_current_of_the_paper_s_vehicle_is_that_of_least_iron_and_copper_loss(void)
{
    /* L_d = L_q: i_d makes no torque. Without inverter the least of 3/2 R i_d^2 + 3/2 w^2 (L i_d +
     * psi)^2 / R_i is at i_d = -w^2 L psi / (R R_i + w^2 L^2); the inverter's resistance, 3.3 mOhm,
     * stands beside R = 36.5 mOhm of 70 degC. What is neglected (the linear part of its loss, the
     * iron current in the copper) is less than a quarter. */
    const double w = 50.0 * 23.0;
    const double iron_ohm = 1.5 + 0.006 * w;
    const double r_ohm = 0.0365 + 0.0033;
    const double expected_a = -w * w * 76e-6 * 0.0204 / (r_ohm * iron_ohm + w * w * 76e-6 * 76e-6);
    TEST_ASSERT_DOUBLE_WITHIN(0.25 * fabs(expected_a) * 1e3, expected_a * 1e3,
                              map_d_mA(&config, 50000, 7000, -20000));
    TEST_ASSERT_INT32_WITHIN(10, 0, map_d_mA(&config, 0, 7000, 40000));
}
