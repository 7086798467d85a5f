/* SPDX-License-Identifier: Apache-2.0 */
/* Thermal network: exact exponentials, steady states, conservation of heat, disabled nodes. */
#include "plant/thermal.h"

#include <math.h>

#include "unity.h"

static const double STEP_S = 1e-3;

void setUp(void) {}

void tearDown(void) {}

static thermal_t row(double c1, double r1, double c2, double r2, double temperature_c)
{
    const thermal_row_t built = {
        .inner_j_per_k = c1, .inner_k_per_w = r1, .outer_j_per_k = c2, .outer_k_per_w = r2};
    return thermal_init(&built, temperature_c, STEP_S);
}

static void heat(thermal_t *thermal, int steps, double inner_w, double outer_w, double ambient_c)
{
    for (int k = 0; k < steps; k++) {
        thermal_step(thermal, inner_w * STEP_S, outer_w * STEP_S, ambient_c);
    }
}

void test_a_heated_node_approaches_power_times_resistance_exponentially(void)
{
    thermal_t lump = row(200.0, 0.5, 0.0, 0.0, 25.0); /* 100 s */
    heat(&lump, 100000, 80.0, 0.0, 25.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 25.0 + 40.0 * (1.0 - exp(-1.0)), lump.temperature_c);
    heat(&lump, 2000000, 80.0, 0.0, 25.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 65.0, lump.temperature_c);
}

void test_without_an_outer_node_its_resistance_is_in_series(void)
{
    thermal_t lump = row(200.0, 0.3, 0.0, 0.2, 25.0);
    heat(&lump, 100000, 80.0, 1000.0, 25.0); /* heat of the disabled outer node */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 25.0 + 40.0 * (1.0 - exp(-1.0)), lump.temperature_c);
}

void test_an_insulated_node_stores_all_heat(void)
{
    thermal_t lump = row(200.0, 0.0, 0.0, 0.0, 20.0);
    heat(&lump, 5000, 100.0, 0.0, -40.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 22.5, lump.temperature_c);
}

void test_two_insulated_nodes_store_all_heat_and_reach_one_temperature(void)
{
    thermal_t lumps = row(100.0, 0.5, 300.0, 0.0, 20.0);
    heat(&lumps, 3000, 100.0, 50.0, -40.0);
    TEST_ASSERT_DOUBLE_WITHIN(
        1e-7, 450.0, 100.0 * (lumps.temperature_c - 20.0) + 300.0 * (lumps.outer_c - 20.0));
    TEST_ASSERT_TRUE(lumps.temperature_c > lumps.outer_c + 1.0);
    heat(&lumps, 2000000, 0.0, 0.0, -40.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 20.0 + 450.0 / 400.0, lumps.temperature_c);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 20.0 + 450.0 / 400.0, lumps.outer_c);
}

void test_the_steady_state_of_two_nodes_follows_from_the_resistances(void)
{
    thermal_t lumps = row(10.0, 0.5, 50.0, 0.4, 25.0);
    heat(&lumps, 1000000, 60.0, 20.0, 10.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 10.0 + 0.4 * 80.0, lumps.outer_c);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 10.0 + 0.4 * 80.0 + 0.5 * 60.0, lumps.temperature_c);
}

/* Reference: integration of the differential equations with steps a thousand times shorter. */
void test_two_nodes_follow_their_differential_equations_for_any_time_constants(void)
{
    const double inner_j_per_k[] = {100.0, 0.002}; /* the second: 1 ms against a step of 1 ms */
    for (int n = 0; n < 2; n++) {
        const double c1 = inner_j_per_k[n];
        const double power_w = n == 0 ? 500.0 : 2.0;
        thermal_t lumps = row(c1, 0.5, 30.0 * c1, 0.2, 25.0);
        double t1 = 25.0;
        double t2 = 25.0;
        const double h = STEP_S / 1000.0;
        for (int k = 0; k < 20 * 1000; k++) {
            /* Midpoint rule */
            const double d1 = (power_w - (t1 - t2) / 0.5) / c1;
            const double d2 = ((t1 - t2) / 0.5 - (t2 - 15.0) / 0.2) / (30.0 * c1);
            const double m1 = t1 + 0.5 * h * d1;
            const double m2 = t2 + 0.5 * h * d2;
            t1 += h * (power_w - (m1 - m2) / 0.5) / c1;
            t2 += h * ((m1 - m2) / 0.5 - (m2 - 15.0) / 0.2) / (30.0 * c1);
        }
        heat(&lumps, 20, power_w, 0.0, 15.0);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, t1, lumps.temperature_c);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, t2, lumps.outer_c);
    }
}

void test_without_a_heat_capacity_the_temperature_is_constant(void)
{
    thermal_t lump = row(0.0, 0.5, 10.0, 1.0, 120.0);
    thermal_step(&lump, 1e6, 1e6, 25.0);
    TEST_ASSERT_EQUAL_DOUBLE(120.0, lump.temperature_c);
}
