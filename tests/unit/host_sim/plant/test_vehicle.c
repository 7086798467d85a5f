/* SPDX-License-Identifier: Apache-2.0 */
/* Vehicle motion: closed-form solutions, stops at exactly zero, standstill on slopes, conservation
 * of energy. */
#include "plant/vehicle.h"

#include <math.h>

#include "unity.h"

static const double STEP_S = 50e-6;
static vehicle_params_t params;
static road_params_t road;
static vehicle_state_t state;

void setUp(void)
{
    const vehicle_params_t car = {.mass_kg = 660.0,
                                  .wheel_radius_m = 0.25,
                                  .frontal_area_m2 = 1.4,
                                  .drag_coefficient = 0.4,
                                  .rolling_resistance = 0.014,
                                  .driven_wheels = 4.0};
    const road_params_t flat = {
        .air_density_kg_per_m3 = 1.2, .gravity_m_per_s2 = 9.81, .slope = 0.0};
    const vehicle_state_t at_rest = {.speed_m_per_s = 0.0};
    params = car;
    road = flat;
    state = at_rest;
}

void tearDown(void) {}

typedef struct {
    double torque_work_j, friction_heat_j, drag_j, rolling_j, climbed_j;
} energies_t;

/* Constant torque and brake for a time. */
static energies_t drive(double torque_nm, double brake_nm, double time_s)
{
    const vehicle_t vehicle = vehicle_on_road(&params, &road);
    const vehicle_load_t load = {.torque_impulse_nms = torque_nm * STEP_S,
                                 .friction_capacity_nm = brake_nm};
    energies_t sum = {.torque_work_j = 0.0};
    const int steps = (int)lround(time_s / STEP_S);
    for (int k = 0; k < steps; k++) {
        const vehicle_flow_t flow = vehicle_step(&vehicle, &state, &load, STEP_S);
        const double omega = flow.mean_speed_m_per_s / params.wheel_radius_m;
        sum.torque_work_j += load.torque_impulse_nms * omega;
        sum.friction_heat_j += brake_nm * flow.friction_used * omega * STEP_S;
        sum.drag_j += flow.drag_j;
        sum.rolling_j += flow.rolling_j;
        sum.climbed_j += flow.climbed_j;
    }
    return sum;
}

void test_acceleration_is_force_over_mass(void)
{
    road.air_density_kg_per_m3 = 0.0;
    params.rolling_resistance = 0.0;
    drive(165.0, 0.0, 4.0); /* 660 N on 660 kg */
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4.0, state.speed_m_per_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 8.0, state.distance_m);
}

void test_coast_down_by_air_drag_is_the_closed_form_hyperbola(void)
{
    params.rolling_resistance = 0.0;
    state.speed_m_per_s = 15.0;
    drive(0.0, 0.0, 60.0);
    const double k = 0.5 * 1.2 * 0.4 * 1.4 / 660.0;
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 15.0 / (1.0 + k * 15.0 * 60.0), state.speed_m_per_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, log(1.0 + k * 15.0 * 60.0) / k, state.distance_m);
}

void test_stopping_distance_is_v_squared_over_two_a_and_the_final_speed_zero(void)
{
    road.air_density_kg_per_m3 = 0.0;
    params.rolling_resistance = 0.0;
    const double speed = 40.0 / 3.6;
    const double deceleration = 4.0 * 60.0 / 0.25 / 660.0;
    state.speed_m_per_s = speed;
    const energies_t sum = drive(0.0, 240.0, 20.0);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, state.speed_m_per_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, speed * speed / (2.0 * deceleration), state.distance_m);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5 * 660.0 * speed * speed, sum.friction_heat_j);
}

void test_reverse_motion_is_symmetric_to_forward_motion(void)
{
    state.speed_m_per_s = 8.0;
    drive(30.0, 20.0, 3.0);
    const vehicle_state_t forward = state;
    setUp();
    state.speed_m_per_s = -8.0;
    drive(-30.0, 20.0, 3.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -forward.speed_m_per_s, state.speed_m_per_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -forward.distance_m, state.distance_m);
}

void test_friction_holds_the_vehicle_on_a_slope_up_to_its_capacity(void)
{
    road.slope = 0.10;
    const double pull_nm = 660.0 * 9.81 * 0.10 / sqrt(1.01) * 0.25;
    const double rolling_nm = 0.014 * 660.0 * 9.81 / sqrt(1.01) * 0.25;
    drive(0.0, pull_nm - rolling_nm + 1.0, 2.0);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, state.speed_m_per_s);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, state.distance_m);
    drive(0.0, pull_nm - rolling_nm - 1.0, 2.0);
    TEST_ASSERT_TRUE(state.speed_m_per_s < 0.0);
    /* one newton-metre too little: a = F/m */
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, -1.0 / 0.25 / 660.0 * 2.0, state.speed_m_per_s);
}

void test_vehicle_starts_only_above_the_torque_of_rolling_resistance(void)
{
    const double rolling_nm = 0.014 * 660.0 * 9.81 * 0.25;
    drive(0.99 * rolling_nm, 0.0, 1.0);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, state.speed_m_per_s);
    drive(1.01 * rolling_nm, 0.0, 1.0);
    TEST_ASSERT_TRUE(state.speed_m_per_s > 0.0);
}

void test_work_is_the_sum_of_heat_potential_and_kinetic_energy_within_rounding(void)
{
    road.slope = 0.03;
    state.speed_m_per_s = 10.0;
    const vehicle_t vehicle = vehicle_on_road(&params, &road);
    const double before_j = vehicle_kinetic_energy_j(&vehicle, &state);
    energies_t sum = drive(60.0, 5.0, 10.0);
    const energies_t more =
        drive(-90.0, 120.0, 10.0); /* through standstill and back down the slope, or held */
    sum.torque_work_j += more.torque_work_j;
    sum.friction_heat_j += more.friction_heat_j;
    sum.drag_j += more.drag_j;
    sum.rolling_j += more.rolling_j;
    sum.climbed_j += more.climbed_j;
    const double gained_j = vehicle_kinetic_energy_j(&vehicle, &state) - before_j;
    /* 400 000 roundings of a speed */
    TEST_ASSERT_DOUBLE_WITHIN(1e-9 * sum.torque_work_j, sum.torque_work_j,
                              sum.friction_heat_j + sum.drag_j + sum.rolling_j + sum.climbed_j +
                                  gained_j);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 660.0 * 9.81 * state.height_m, sum.climbed_j);
    TEST_ASSERT_TRUE(sum.rolling_j > 0.0);
    TEST_ASSERT_TRUE(sum.drag_j > 0.0);
}

void test_wind_adds_to_the_air_speed_also_at_standstill(void)
{
    road.wind_m_per_s = 5.0;
    const vehicle_t vehicle = vehicle_on_road(&params, &road);
    const double per_square = 0.5 * 1.2 * 0.4 * 1.4;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, per_square * 15.0 * 15.0, vehicle_drag_n(&vehicle, 10.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, per_square * 25.0, vehicle_drag_n(&vehicle, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -per_square * 25.0, vehicle_drag_n(&vehicle, -10.0));
}
