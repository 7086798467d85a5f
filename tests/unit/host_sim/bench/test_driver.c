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

void test_who_comes_to_rest_eases_the_brake_with_the_speed(void)
{
    const double time_s[] = {0.0, 10.0, 20.0};
    const double speed[] = {7.0, 0.0, 0.0};
    const driver_trace_t trace = {.time_s = time_s, .speed_m_per_s = speed, .points = 3};
    params.release_speed_m_per_s = 0.28;
    params.preview_s = 0.01;
    const double braked_n = 660.0 * 0.7;
    const double rolling_n = 0.014 * 660.0 * 9.81;
    for (int k = 0; k < 2; k++) {
        vehicle.slope_n = k == 0 ? 0.0 : -500.0;
        const double slope_n = k == 0 ? 0.0 : 500.0;
        state = driver_init();
        TEST_ASSERT_DOUBLE_WITHIN(0.1, (braked_n + slope_n - rolling_n) * 0.25 / WHEELS,
                                  ask(&trace, 0.42, 9.4).brake_nm);
        TEST_ASSERT_DOUBLE_WITHIN(0.1, (0.25 * (braked_n - rolling_n) + slope_n) * 0.25 / WHEELS,
                                  ask(&trace, 0.07, 9.9).brake_nm);
    }
    vehicle.slope_n = 500.0; /* uphill, steeper than the trace wants: it drives as before */
    state = driver_init();
    TEST_ASSERT_DOUBLE_WITHIN(0.1, (500.0 + rolling_n - braked_n) * 0.25 / WHEELS,
                              ask(&trace, 0.07, 9.9).drive_nm);
}

/* Down from 0.2 m/s to 0.1 and up again, and a pedal that the scenario holds. */
void test_brake_is_not_eased_where_nothing_comes_to_rest(void)
{
    const double time_s[] = {0.0, 10.0, 20.0};
    const double speed[] = {7.0, 0.1, 7.0};
    const driver_trace_t trace = {.time_s = time_s, .speed_m_per_s = speed, .points = 3};
    params.preview_s = 0.01;
    const double usual_nm = ask(&trace, 0.5, 10.5).brake_nm;
    params.release_speed_m_per_s = 0.3;
    state = driver_init();
    TEST_ASSERT_EQUAL_DOUBLE(usual_nm, ask(&trace, 0.5, 10.5).brake_nm);
    params.follow_trace = 0.0;
    params.brake_demand_nm = 25.0;
    TEST_ASSERT_EQUAL_DOUBLE(25.0, ask(&trace, 0.01, 10.0).brake_nm);
}

typedef struct {
    double jolt_m_per_s2, stands_s;
} stop_t;

static stop_t stop_by_brakes_alone(const driver_trace_t *trace, double begins_s)
{
    double speed = driver_trace_at(trace, &(int){0}, begins_s);
    stop_t out = {.stands_s = begins_s};
    state = driver_init();
    while (speed > 0.0 && out.stands_s < 100.0) {
        const driver_demand_t demand = ask(trace, speed, out.stands_s);
        out.jolt_m_per_s2 = (demand.brake_nm - demand.drive_nm) * WHEELS / 0.25 / 660.0;
        speed -= out.jolt_m_per_s2 * STEP_S;
        out.stands_s += STEP_S;
    }
    return out;
}

/* Brakes that follow at once, no rolling resistance. The last 0.3 m/s of a stop with 2 m/s^2 last
 * 0.15 s; eased, 0.15 s ln(2/0.1) down to 0.015 m/s, whence 0.1 m/s^2 stop it in another 0.15 s. */
void test_eased_stop_ends_softly_and_hardly_later(void)
{
    const double time_s[] = {0.0, 5.0, 30.0};
    const double speed[] = {10.0, 0.0, 0.0};
    const driver_trace_t trace = {.time_s = time_s, .speed_m_per_s = speed, .points = 3};
    vehicle.rolling_n = 0.0;
    params.preview_s = 0.001;
    const stop_t uneased = stop_by_brakes_alone(&trace, 3.0);
    params.release_speed_m_per_s = 0.3;
    const stop_t eased = stop_by_brakes_alone(&trace, 3.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1, eased.jolt_m_per_s2);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, uneased.stands_s + 0.15 * log(20.0), eased.stands_s);
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
