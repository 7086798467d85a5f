/* SPDX-License-Identifier: Apache-2.0 */
/* The driver model: speed trace, feed-forward of the road load, feedback, limits of the pedals. */
#include "bench/driver.h"

#include <math.h>

#include "unity.h"

static const double STEP_S = 1e-3;
enum { WHEELS = 4 };
static driver_params_t params;
static driver_state_t state;
static vehicle_t vehicle;

void setUp(void)
{
    const driver_params_t usual = {.follow_trace = 1.0,
                                   .bandwidth_rad_per_s = 1.0,
                                   .preview_s = 0.4,
                                   .most_drive_nm = 40.0,
                                   .most_brake_nm = 340.0};
    const vehicle_params_t car = {.mass_kg = 660.0,
                                  .wheel_radius_m = 0.25,
                                  .frontal_area_m2 = 1.4,
                                  .drag_coefficient = 0.4,
                                  .rolling_resistance = 0.014,
                                  .driven_wheels = WHEELS};
    const road_params_t flat = {
        .air_density_kg_per_m3 = 1.2, .gravity_m_per_s2 = 9.81, .slope = 0.0};
    params = usual;
    vehicle = vehicle_on_road(&car, &flat);
    state = driver_init();
}

void tearDown(void) {}

static driver_demand_t ask(const driver_trace_t *trace, double speed, double time_s)
{
    return driver_step(&params, &state, trace, &vehicle, WHEELS, speed, time_s, STEP_S);
}

void test_a_driver_acknowledges_in_the_first_half_of_each_period_or_never(void)
{
    params.fault_reset_every_s = 0.5;
    TEST_ASSERT_TRUE(driver_resets(&params, 0.0));
    TEST_ASSERT_TRUE(driver_resets(&params, 10.24));
    TEST_ASSERT_FALSE(driver_resets(&params, 10.26));
    TEST_ASSERT_FALSE(driver_resets(&params, 10.49));
    TEST_ASSERT_TRUE(driver_resets(&params, 10.51));
    params.fault_reset_every_s = 0.0;
    TEST_ASSERT_FALSE(driver_resets(&params, 0.0));
}

void test_the_trace_is_linear_between_its_points_and_constant_outside(void)
{
    const double time_s[] = {0.0, 10.0, 20.0, 20.5};
    const double speed[] = {0.0, 5.0, 5.0, 0.0};
    const driver_trace_t trace = {.time_s = time_s, .speed_m_per_s = speed, .points = 4};
    int cursor = 0;
    TEST_ASSERT_EQUAL_DOUBLE(0.0, driver_trace_at(&trace, &cursor, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.25, driver_trace_at(&trace, &cursor, 2.5));
    TEST_ASSERT_EQUAL_DOUBLE(5.0, driver_trace_at(&trace, &cursor, 10.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2.5, driver_trace_at(&trace, &cursor, 20.25));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, driver_trace_at(&trace, &cursor, 1000.0));
}

void test_at_steady_speed_the_demand_is_the_road_load(void)
{
    const double time_s[] = {0.0, 100.0};
    const double speed[] = {10.0, 10.0};
    const driver_trace_t trace = {.time_s = time_s, .speed_m_per_s = speed, .points = 2};
    const driver_demand_t demand = ask(&trace, 10.0, 5.0);
    const double force_n = 0.014 * 660.0 * 9.81 + 0.5 * 1.2 * 0.4 * 1.4 * 100.0;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, force_n * 0.25 / WHEELS, demand.drive_nm);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, demand.brake_nm);
    TEST_ASSERT_EQUAL_DOUBLE(10.0, demand.reference_m_per_s);
}

void test_braking_demand_is_mass_times_deceleration_less_road_load(void)
{
    const double time_s[] = {0.0, 10.0};
    const double speed[] = {10.0, 0.0};
    const driver_trace_t trace = {.time_s = time_s, .speed_m_per_s = speed, .points = 2};
    const driver_demand_t demand = ask(&trace, 5.0, 5.0);
    const double force_n = 660.0 * 1.0 - 0.014 * 660.0 * 9.81 - 0.5 * 1.2 * 0.4 * 1.4 * 25.0;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, force_n * 0.25 / WHEELS, demand.brake_nm);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, demand.drive_nm);
}

void test_speed_error_is_corrected_by_a_proportional_and_an_integral_part(void)
{
    const double time_s[] = {0.0, 100.0};
    const double speed[] = {5.0, 5.0};
    const driver_trace_t trace = {.time_s = time_s, .speed_m_per_s = speed, .points = 2};
    const double exact = ask(&trace, 5.0, 1.0).drive_nm;
    const double first = ask(&trace, 4.9, 1.0).drive_nm;
    /* 2 m w e, and one step of m w^2 e */
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 660.0 * 0.1 * (2.0 + STEP_S) * 0.25 / WHEELS, first - exact);
    const double second = ask(&trace, 4.9, 1.0).drive_nm;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 660.0 * 0.1 * STEP_S * 0.25 / WHEELS, second - first);
}

void test_driver_model_has_anti_windup_at_full_pedal(void)
{
    const double time_s[] = {0.0, 1000.0};
    const double speed[] = {20.0, 20.0};
    const driver_trace_t trace = {.time_s = time_s, .speed_m_per_s = speed, .points = 2};
    for (int k = 0; k < 100000; k++) {
        TEST_ASSERT_EQUAL_DOUBLE(40.0, ask(&trace, 0.0, 1.0).drive_nm);
    }
    TEST_ASSERT_EQUAL_DOUBLE(0.0, state.integral_m);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, ask(&trace, 21.0, 1.0).drive_nm);
}

void test_stopped_vehicle_is_braked_on_a_slope_but_not_on_the_flat(void)
{
    const double time_s[] = {0.0, 10.0};
    const double speed[] = {0.0, 0.0};
    const driver_trace_t trace = {.time_s = time_s, .speed_m_per_s = speed, .points = 2};
    driver_demand_t demand = ask(&trace, 0.0, 1.0);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, demand.brake_nm);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, demand.drive_nm);
    vehicle.slope_n = -500.0;
    demand = ask(&trace, 0.0, 1.0);
    TEST_ASSERT_TRUE(demand.brake_nm * WHEELS / 0.25 >= 500.0);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, demand.drive_nm);
}

/* Which of the two counts is the controllers' decision. */
void test_constant_pedals_are_both_where_the_scenario_puts_them(void)
{
    const driver_trace_t none = {.points = 0};
    params.follow_trace = 0.0;
    params.drive_demand_nm = -12.0;
    TEST_ASSERT_EQUAL_DOUBLE(-12.0, ask(&none, 3.0, 0.0).drive_nm);
    params.brake_demand_nm = 25.0;
    TEST_ASSERT_EQUAL_DOUBLE(-12.0, ask(&none, 3.0, 0.0).drive_nm);
    TEST_ASSERT_EQUAL_DOUBLE(25.0, ask(&none, 3.0, 0.0).brake_nm);
}
