/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "paper_vehicle.h"
#include "random_values.h"
#include "torque/current_map.h"
#include "unity.h"

static config_t config;

void setUp(void)
{
    config = paper_vehicle();
}

void tearDown(void) {}

enum { TORQUE_POINTS = 7, SPEED_POINTS = 4, LAYERS = 3 };
enum {
    TORQUE_STEP_mNm = 512,
    SPEED_STEP_mrad_s = 1024,
    TEMPERATURE_STEP_cC = 4096,
    ORIGIN_cC = -2000
};

/* Any values: from -1536 to 1536 mNm, up to 3072 mrad/s, from -20 to 61.92 degC. */
static void random_map(uint64_t seed, int32_t layers)
{
    random_t random = random_seeded(seed);
    config.current_map.temperature_points = layers;
    config.current_map.temperature_step_log2 = 12;
    config.current_map.temperature_origin_cC = ORIGIN_cC;
    config.current_map.torque_points = TORQUE_POINTS;
    config.current_map.torque_step_log2 = 9;
    config.current_map.speed_points = SPEED_POINTS;
    config.current_map.speed_step_log2 = 10;
    for (int k = 0; k < TORQUE_POINTS * SPEED_POINTS * layers; k++) {
        config.current_map.current_d_mA[k] = random_between(&random, -3000000, 3000000);
    }
}

static int32_t entry(int32_t w, int32_t s, int32_t t)
{
    return config.current_map.current_d_mA[(w * SPEED_POINTS + s) * TORQUE_POINTS + t];
}

/* The definition, in double: speed forward, torque along it, one layer. */
static double bilinear(int32_t layer, int32_t speed_mrad_s, int32_t along_mNm)
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

/* Between two layers, or on the coldest or the hottest one. */
static double trilinear(int32_t speed_mrad_s, int32_t temperature_cC, int32_t along_mNm)
{
    const double w =
        fmin(fmax(((double)temperature_cC - ORIGIN_cC) / TEMPERATURE_STEP_cC, 0.0), LAYERS - 1.0);
    const int32_t cold = w >= LAYERS - 1 ? LAYERS - 2 : (int32_t)w;
    return (1.0 - (w - cold)) * bilinear(cold, speed_mrad_s, along_mNm) +
           (w - cold) * bilinear(cold + 1, speed_mrad_s, along_mNm);
}

void test_between_the_points_the_map_is_linear_along_every_axis(void)
{
    random_map(1, LAYERS);
    random_t random = random_seeded(2);
    for (int n = 0; n < 100000; n++) {
        const int32_t speed_mrad_s = random_between(&random, 0, 4000);
        const int32_t temperature_cC = random_between(&random, -4000, 9000);
        const int32_t torque_mNm = random_between(&random, -2000, 2000);
        /* Up to four roundings to the nearest milliampere, one after the other. */
        TEST_ASSERT_DOUBLE_WITHIN(
            2.0, trilinear(speed_mrad_s, temperature_cC, torque_mNm),
            current_map_d_mA(&config, speed_mrad_s, temperature_cC, torque_mNm));
    }
}

void test_at_its_points_the_map_says_exactly_what_is_stored(void)
{
    random_map(3, LAYERS);
    for (int32_t w = 0; w < LAYERS; w++) {
        for (int32_t s = 0; s < SPEED_POINTS; s++) {
            for (int32_t t = 0; t < TORQUE_POINTS; t++) {
                TEST_ASSERT_EQUAL_INT32(
                    entry(w, s, t), current_map_d_mA(&config, s * SPEED_STEP_mrad_s,
                                                     ORIGIN_cC + w * TEMPERATURE_STEP_cC,
                                                     (t - TORQUE_POINTS / 2) * TORQUE_STEP_mNm));
            }
        }
    }
}

void test_a_single_layer_holds_at_any_temperature(void)
{
    random_map(7, 1);
    random_t random = random_seeded(8);
    for (int n = 0; n < 10000; n++) {
        const int32_t speed_mrad_s = random_between(&random, 0, 4000);
        const int32_t torque_mNm = random_between(&random, -2000, 2000);
        const int32_t found_mA =
            current_map_d_mA(&config, speed_mrad_s, random_wild(&random), torque_mNm);
        TEST_ASSERT_DOUBLE_WITHIN(1.5, bilinear(0, speed_mrad_s, torque_mNm), found_mA);
    }
}

void test_torque_counts_along_the_rotation_whichever_way_it_goes(void)
{
    random_map(4, LAYERS);
    random_t random = random_seeded(5);
    for (int n = 0; n < 10000; n++) {
        const int32_t speed_mrad_s = random_between(&random, 1, 4000);
        const int32_t temperature_cC = random_between(&random, -4000, 9000);
        const int32_t torque_mNm = random_between(&random, -2000, 2000);
        TEST_ASSERT_EQUAL_INT32(
            current_map_d_mA(&config, speed_mrad_s, temperature_cC, torque_mNm),
            current_map_d_mA(&config, -speed_mrad_s, temperature_cC, -torque_mNm));
    }
}

void test_beyond_the_edges_the_nearest_edge_counts(void)
{
    random_map(6, LAYERS);
    TEST_ASSERT_EQUAL_INT32(entry(0, 0, 0), current_map_d_mA(&config, 0, INT32_MIN, INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(entry(0, 0, 6), current_map_d_mA(&config, 0, INT32_MIN, INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(entry(0, 3, 6),
                            current_map_d_mA(&config, INT32_MAX, INT32_MIN, INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(entry(2, 3, 0),
                            current_map_d_mA(&config, INT32_MAX, INT32_MAX, INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(entry(2, 3, 6),
                            current_map_d_mA(&config, INT32_MIN, INT32_MAX, INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(entry(2, 3, 0),
                            current_map_d_mA(&config, INT32_MIN, INT32_MAX, INT32_MAX));
}

void test_the_widest_grid_the_validator_accepts_is_read_to_its_last_point(void)
{
    /* 16 torques each way, 19 speeds, 2 temperatures: 1254 of the 1280 points there are. */
    config.current_map.torque_points = 33;
    config.current_map.torque_step_log2 = 20;
    config.current_map.speed_points = 19;
    config.current_map.speed_step_log2 = 20;
    config.current_map.temperature_points = 2;
    config.current_map.temperature_step_log2 = 15;
    config.current_map.temperature_origin_cC = -10000;
    for (int k = 0; k < CONFIG_CURRENT_MAP_POINTS_MAX; k++) {
        config.current_map.current_d_mA[k] = k;
    }
    const int32_t hot_cC = -10000 + (1 << 15);
    const int32_t top_mrad_s = 18 * (1 << 20);
    const int32_t most_mNm = 16 * (1 << 20);
    TEST_ASSERT_EQUAL_INT32(1253, current_map_d_mA(&config, top_mrad_s, hot_cC, most_mNm));
    TEST_ASSERT_EQUAL_INT32(1253 - 32, current_map_d_mA(&config, top_mrad_s, hot_cC, -most_mNm));
    TEST_ASSERT_EQUAL_INT32(626, current_map_d_mA(&config, top_mrad_s, -10000, most_mNm));
    TEST_ASSERT_EQUAL_INT32(16, current_map_d_mA(&config, 0, -10000, 0));
    TEST_ASSERT_EQUAL_INT32(33, current_map_d_mA(&config, 1 << 20, -10000, -most_mNm));
}

void test_the_paper_s_vehicle_demagnetises_where_that_saves_iron_loss(void)
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
                              current_map_d_mA(&config, 50000, 7000, -20000));
    TEST_ASSERT_INT32_WITHIN(10, 0, current_map_d_mA(&config, 0, 7000, 40000));
}
