/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Bounds by battery power with coefficients that are powers of two: a x^2 + b x + c has roots that
 * are whole numbers, met within the 2^-14 of a square root.
 */
#include "plain_motor.h"
#include "unity.h"

enum { A = 1 << 22, B = 1 << 20, ROOT_LOG2 = 13 };

static plain_motor_t motor;
static const feasible_returned_t NO_POWER = {.power_b = 0, .margin_b = 0};

void setUp(void)
{
    plain_motor_init(&motor);
    motor.set.power.a = A; /* 1/4 */
    motor.set.power.b = B;
}

void tearDown(void) {}

static void assert_near(int32_t expected, int32_t found)
{
    TEST_ASSERT_INT32_WITHIN(1 + (expected >> ROOT_LOG2), expected, found);
}

static int32_t driving_mNm(int32_t cap_b, int32_t power_b)
{
    const feasible_side_t side = plain_side(&motor, SIDE_DRIVING, cap_b);
    return feasible_by_drawn_mNm(&side, power_b);
}

static int32_t drawing_brake_mNm(int32_t cap_b, int32_t power_b)
{
    const feasible_side_t side = plain_side(&motor, SIDE_BRAKING, cap_b);
    return feasible_by_drawn_mNm(&side, power_b);
}

static int32_t returning_mNm(int32_t cap_b, feasible_returned_t returned)
{
    const feasible_side_t side = plain_side(&motor, SIDE_BRAKING, cap_b);
    return feasible_by_returned_mNm(&side, returned);
}

/* ---- coefficients ---- */

/* Switches of 1/4 beside R 1/4; u_q = 2^20 + x / 2 + d / 4, iron current 2^20 + d / 4, w L_q 1/8:
 * with the switches u_q = 5 2^18 + 3/4 x + 5/16 d, times i_q = x + 2^20 + d / 4, and R d^2. */
void test_power_of_currents_is_the_product_of_voltage_and_current_with_the_switches(void)
{
    motor.config = (config_t){.current_map = {.torque_points = 3, .speed_points = 2}};
    motor.constants.loss_resistance_b = SCALED_ONE / 4;
    motor.model.resistance_b = SCALED_ONE / 4;
    motor.model.voltage_q_b = 1 << 20;
    motor.model.voltage_q_per_x = SCALED_ONE / 2;
    motor.model.voltage_q_per_d = SCALED_ONE / 4;
    motor.model.iron_current_b = 1 << 20;
    motor.model.cross_d = SCALED_ONE / 4;
    motor.model.reactance_q_b = SCALED_ONE / 8;
    const feasible_power_t power = feasible_set_at(&motor.model, 1000).power;
    TEST_ASSERT_EQUAL_INT32(3 << 22, power.a);
    TEST_ASSERT_EQUAL_INT32((3 << 18) + (5 << 18), power.b);
    TEST_ASSERT_EQUAL_INT32((3 << 20) + (5 << 20) - (2 << 20), power.b_d);
    TEST_ASSERT_EQUAL_INT32(5 << 14, power.c);
    TEST_ASSERT_EQUAL_INT32((5 << 16) + (5 << 16), power.c_d);
    TEST_ASSERT_EQUAL_INT32((2 << 22) + (5 << 18), power.c_dd);
}

/* Units of 2^-16 mA and mV: 1 mA times 1 V and 2/3 are 1000 2^8 2/3. */
void test_battery_power_is_two_thirds_of_current_times_voltage_and_never_negative(void)
{
    motor.constants.current_shift = 16;
    motor.constants.voltage_shift = 16;
    TEST_ASSERT_INT32_WITHIN(1, 500 * 256 * 2 / 3, feasible_power_b(&motor.model, 1, 500));
    TEST_ASSERT_EQUAL_INT32(0, feasible_power_b(&motor.model, 0, 500));
    TEST_ASSERT_EQUAL_INT32(0, feasible_power_b(&motor.model, -1, 500));
    TEST_ASSERT_EQUAL_INT32(0, feasible_power_b(&motor.model, 500, 0));
    TEST_ASSERT_EQUAL_INT32(0, feasible_power_b(&motor.model, 500, -1));
}

/* ---- uncertain angle ---- */

/* w L_d - w L_q = 1/4, w psi = 2^20; i_d = -2^20, i_q = -2^19: u_q i_d - u_d i_q = -3 2^14 - 2^12,
 * at an angle of 1/16 rad 13 2^8. */
static const motor_point_t ACROSS = {.d_b = -(1 << 20), .x_b = -(1 << 19)};
enum { MORE_b = 13 << 8 };

static void make_the_angle_uncertain(void)
{
    motor.set.power = (feasible_power_t){.c = 0};
    motor.constants.hall_angle_b = SCALED_ONE / 4;
    motor.model.speed_b = SCALED_ONE / 4;
    motor.model.emf_b = 1 << 20;
    motor.model.reactance_d_b = SCALED_ONE / 2;
    motor.model.reactance_q_b = SCALED_ONE / 4;
}

void test_an_uncertain_angle_takes_from_the_battery_s_power_what_exceeds_the_margin(void)
{
    make_the_angle_uncertain();
    feasible_returned_t returned = {.power_b = 10000, .margin_b = 1000};
    TEST_ASSERT_EQUAL_INT32(11000 - MORE_b, feasible_excess_b(&motor.set, ACROSS, returned));
    returned.margin_b = 100000;
    TEST_ASSERT_EQUAL_INT32(10000, feasible_excess_b(&motor.set, ACROSS, returned));
    returned = (feasible_returned_t){.power_b = 100, .margin_b = 0};
    TEST_ASSERT_EQUAL_INT32(0, feasible_excess_b(&motor.set, ACROSS, returned));
}

void test_what_a_point_returns_less_ends_at_32_bits(void)
{
    motor.set.power.c = 1 << 26;
    const feasible_returned_t returned = {.power_b = INT32_MAX, .margin_b = 0};
    const motor_point_t none = {.d_b = 0, .x_b = 0};
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, feasible_excess_b(&motor.set, none, returned));
}

/* ---- power drawn ---- */

/* b x = 1 at x = 2^4. */
void test_driving_torque_of_one_unit_of_power_is_not_zero(void)
{
    assert_near(1 << 4, driving_mNm(1 << 20, 1));
    TEST_ASSERT_EQUAL_INT32(0, driving_mNm(1 << 20, 0));
    motor.set.power.c = 1000;
    TEST_ASSERT_EQUAL_INT32(0, driving_mNm(1 << 20, 900));
}

/* At x = -2^23: a x^2 = 2^20, b x = -2^19. */
void test_braking_torque_of_a_drawn_power_is_the_far_root_of_the_power(void)
{
    assert_near(1 << 23, drawing_brake_mNm(1 << 24, 1 << 19));
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, drawing_brake_mNm(1 << 23, 1 << 19));
    motor.constants.negligible_power_b = 1 << 19;
    assert_near(1 << 23, drawing_brake_mNm(1 << 24, 100));
    motor.constants.negligible_power_b = 100;
    assert_near(1 << 23, drawing_brake_mNm(1 << 24, 1 << 19));
    motor.set.power.c = 1 << 10;
    assert_near(1 << 23, drawing_brake_mNm(1 << 24, (1 << 19) + (1 << 10)));
}

/* Without resistance there is no far root: the end of the range of currents. */
void test_braking_torque_of_a_drawn_power_without_resistance_is_the_end_of_the_range(void)
{
    motor.set.power = (feasible_power_t){.b = 1, .c = 1000};
    TEST_ASSERT_EQUAL_INT32(1 << 25, drawing_brake_mNm(1 << 24, 0));
}

/* ---- power returned ---- */

/* At x = -2^20: a x^2 = 2^14, b x = -2^16, so that 3 2^14 are returned; the vertex at -2^21. */
void test_braking_torque_that_returns_a_power_is_the_near_root(void)
{
    const feasible_returned_t returned = {.power_b = 3 << 14, .margin_b = 0};
    assert_near(1 << 20, returning_mNm(1 << 21, returned));
    assert_near(1 << 20, returning_mNm(1 << 24, returned)); /* beyond the far root */
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, returning_mNm(1 << 20, returned));
    const feasible_returned_t less = {.power_b = (3 << 14) - 1, .margin_b = 0};
    assert_near(1 << 20, returning_mNm(1 << 20, less));
}

/* The vertex, x = -2^21, returns 2^16. */
void test_the_largest_returned_power_is_not_exceeded_by_any_torque(void)
{
    const feasible_returned_t returned = {.power_b = 1 << 16, .margin_b = 0};
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, returning_mNm(1 << 21, returned));
    assert_near(1 << 21, returning_mNm(1 << 23, returned));
    const feasible_returned_t more = {.power_b = (1 << 16) + 1, .margin_b = 0};
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, returning_mNm(1 << 23, more));
}

/* Of the 2^16 that the vertex returns: a negligible power, or less than that. */
void test_a_negligible_power_may_be_returned_to_a_full_battery(void)
{
    motor.constants.negligible_power_b = (1 << 16) + 1;
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, returning_mNm(1 << 23, NO_POWER));
    motor.constants.negligible_power_b = 1 << 16;
    TEST_ASSERT_EQUAL_INT32(0, returning_mNm(1 << 23, NO_POWER));
    /* What the battery takes counts as part of it. */
    const feasible_returned_t some = {.power_b = 1, .margin_b = 0};
    assert_near(1 << 4, returning_mNm(1 << 23, some));
    motor.constants.negligible_power_b = 0;
    const feasible_returned_t most = {.power_b = 1 << 16, .margin_b = 0};
    assert_near(1 << 21, returning_mNm(1 << 23, most));
    motor.set.power.b = 1;
    TEST_ASSERT_EQUAL_INT32(0, returning_mNm(1 << 23, NO_POWER));
    motor.set.power.b = 0; /* nothing is returned at any torque */
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, returning_mNm(1 << 23, most));
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, returning_mNm(1 << 23, NO_POWER));
}

void test_no_braking_torque_is_left_where_zero_torque_returns_more_than_the_battery_takes(void)
{
    motor.set.power.c = -1000;
    TEST_ASSERT_EQUAL_INT32(0, returning_mNm(1 << 20, NO_POWER));
}

/* Loss of the bridge 2^18 |i|, i_q = x + 2^21: at the cap, -2^21, i_q is zero, and the straight
 * line for the loss is that of driving currents; one unit of i_q less and it is that of braking
 * ones, with a near root at -2^20: (3 2^18 - 2^18) / 2 a. */
void test_the_loss_of_the_bridge_rises_with_the_current_of_either_sign(void)
{
    const feasible_returned_t returned = {.power_b = 1 << 16, .margin_b = 0};
    motor.constants.loss_b = 1 << 18;
    motor.model.iron_current_b = 1 << 21;
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, returning_mNm(1 << 21, returned));
    motor.model.iron_current_b = (1 << 21) - 1;
    TEST_ASSERT_TRUE(returning_mNm(1 << 21, returned) != FEASIBLE_UNBOUNDED);
}

/* |u|^2 = (x / 2^9)^2 + (2^20 + i_d)^2 is never as low as 2^20 at x = 2^20: i_d is that of the
 * least voltage, -2^20, where the ellipse has no slope. Power does not depend on i_d here. */
void test_a_bound_beside_the_voltage_ellipse_has_the_i_d_of_the_least_voltage(void)
{
    motor.model.reactance_q_b = SCALED_ONE >> 9;
    motor.model.voltage_q_b = 1 << 20;
    motor.model.voltage_q_per_d = SCALED_ONE;
    motor.set.voltage_squared = 1 << 20;
    motor.set.weakest_d_b = -(1 << 22);
    assert_near(1 << 20, driving_mNm(1 << 21, (1 << 14) + (1 << 16)));
}
