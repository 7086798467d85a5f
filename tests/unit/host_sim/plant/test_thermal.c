/* A lump of heat capacity: exact exponential, right end, and off means off. */
#include "plant/thermal.h"

#include <math.h>

#include "unity.h"

static const double STEP_S = 1e-3;

void setUp(void) {}

void tearDown(void) {}

void test_a_heated_lump_rises_exponentially_to_power_times_resistance(void)
{
    thermal_lump_t lump = thermal_init(200.0, 0.5, 25.0, STEP_S); /* 100 s */
    for (int k = 0; k < 100000; k++) {
        thermal_step(&lump, 80.0 * STEP_S, 25.0);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 25.0 + 40.0 * (1.0 - exp(-1.0)), lump.temperature_c);
    for (int k = 0; k < 2000000; k++) {
        thermal_step(&lump, 80.0 * STEP_S, 25.0);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 65.0, lump.temperature_c);
}

void test_an_insulated_lump_keeps_every_joule(void)
{
    thermal_lump_t lump = thermal_init(200.0, 0.0, 20.0, STEP_S);
    for (int k = 0; k < 5000; k++) {
        thermal_step(&lump, 100.0 * STEP_S, -40.0);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 22.5, lump.temperature_c);
}

void test_without_a_heat_capacity_the_temperature_stays(void)
{
    thermal_lump_t lump = thermal_init(0.0, 0.5, 120.0, STEP_S);
    thermal_step(&lump, 1e6, 25.0);
    TEST_ASSERT_EQUAL_DOUBLE(120.0, lump.temperature_c);
}
