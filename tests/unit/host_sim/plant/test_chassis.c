/* SPDX-License-Identifier: Apache-2.0 */
/* Wheel loads against statics computed by hand. */
#include "plant/chassis.h"

#include <math.h>

#include "unity.h"

static const double MASS_KG = 660.0;
static const double G = 9.81;
static const double STEP_S = 50e-6;
static chassis_params_t params;

void setUp(void)
{
    const chassis_params_t car = {.wheel_inertia_kg_m2 = 0.7,
                                  .wheelbase_m = 2.0,
                                  .centre_of_gravity_height_m = 0.5,
                                  .front_load_share = 0.6,
                                  .wheels_per_axle = 2.0};
    params = car;
}

void tearDown(void) {}

static double load_n(int wheel, double acceleration_m_per_s2, double angle_rad)
{
    const double weight_n = MASS_KG * G;
    const chassis_t chassis = chassis_on_road(&params, MASS_KG, weight_n * cos(angle_rad),
                                              weight_n * sin(angle_rad), STEP_S);
    chassis_state_t state = {.filtered_m_per_s2 = 0.0};
    chassis_step(&chassis, &state, acceleration_m_per_s2);
    return chassis_load_n(&chassis, &state, wheel);
}

void test_at_standstill_the_axle_loads_sum_to_the_weight(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.3 * MASS_KG * G, load_n(0, 0.0, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.3 * MASS_KG * G, load_n(1, 0.0, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.2 * MASS_KG * G, load_n(2, 0.0, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.2 * MASS_KG * G, load_n(3, 0.0, 0.0));
}

void test_load_transfer_is_mass_times_deceleration_times_height_over_wheelbase(void)
{
    const double moved_n = MASS_KG * 4.0 * 0.5 / 2.0;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.3 * MASS_KG * G + 0.5 * moved_n, load_n(0, -4.0, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.2 * MASS_KG * G - 0.5 * moved_n, load_n(2, -4.0, 0.0));
}

void test_at_standstill_on_a_slope_the_moments_about_both_axles_are_zero(void)
{
    const double angle = 0.2; /* uphill: the rear carries more */
    const double front_n = 2.0 * load_n(0, 0.0, angle);
    const double rear_n = 2.0 * load_n(2, 0.0, angle);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, MASS_KG * G * cos(angle), front_n + rear_n);
    /* About the rear contact: weight at 0.6 * 2 m in front of it and 0.5 m high. */
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, MASS_KG * G * (cos(angle) * 1.2 - sin(angle) * 0.5),
                              front_n * 2.0);
}

void test_lifting_axle_has_zero_load_and_the_other_the_whole_weight(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(0.0, load_n(2, -30.0, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.5 * MASS_KG * G, load_n(0, -30.0, 0.0));
}

void test_the_load_follows_the_acceleration_with_the_springs_time_constant(void)
{
    params.pitch_time_constant_s = 0.1;
    const chassis_t chassis = chassis_on_road(&params, MASS_KG, MASS_KG * G, 0.0, STEP_S);
    chassis_state_t state = {.filtered_m_per_s2 = 0.0};
    for (int k = 0; k < 2000; k++) {
        chassis_step(&chassis, &state, -4.0);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -4.0 * (1.0 - exp(-1.0)), state.filtered_m_per_s2);
}

void test_driven_wheels_are_on_the_configured_axle(void)
{
    params.rear_driven = 1.0;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.2 * MASS_KG * G, load_n(0, 0.0, 0.0));
    params.wheels_per_axle = 1.0;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.4 * MASS_KG * G, load_n(0, 0.0, 0.0));
}
