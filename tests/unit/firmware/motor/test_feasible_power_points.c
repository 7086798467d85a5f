/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The points of the bounds by battery power, and each condition on the way to them at its limit, to
 * the unit: powers of two whose roots are whole numbers.
 */
#include "plain_motor.h"
#include "unity.h"

enum { A = 1 << 22, B = 1 << 20, NEAR = 1 << 8 };

static plain_motor_t motor;
static const motor_point_t NOWHERE = {.d_b = 12345, .x_b = 54321};

void setUp(void)
{
    plain_motor_init(&motor);
    motor.set.power.b = SCALED_ONE; /* a power is a torque current */
}

void tearDown(void) {}

static int32_t by_drawn(side_t sign, int32_t cap_b, int32_t power_b, motor_point_t *found)
{
    feasible_side_t side = plain_side(&motor, sign, cap_b);
    side.cap.d_b = -77;
    const feasible_cap_power_t cap = feasible_cap_power(&side);
    *found = NOWHERE;
    return feasible_by_drawn_at(&side, &cap, power_b, found);
}

static int32_t by_returned(int32_t cap_b, feasible_returned_t returned, motor_point_t *found)
{
    feasible_side_t side = plain_side(&motor, SIDE_BRAKING, cap_b);
    side.cap.d_b = -77;
    const feasible_cap_power_t cap = feasible_cap_power(&side);
    *found = NOWHERE;
    return feasible_by_returned_at(&side, &cap, returned, found);
}

static void assert_point(int32_t d_b, int32_t x_b, motor_point_t found)
{
    TEST_ASSERT_EQUAL_INT32(d_b, found.d_b);
    TEST_ASSERT_EQUAL_INT32(x_b, found.x_b);
}

/* ---- the point ---- */

void test_without_a_bound_the_point_is_that_of_the_cap(void)
{
    motor_point_t found;
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, by_drawn(SIDE_DRIVING, 1 << 20, 1 << 20, &found));
    assert_point(-77, 1 << 20, found);
    const feasible_returned_t returned = {.power_b = 1 << 20};
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, by_returned(1 << 20, returned, &found));
    assert_point(-77, -(1 << 20), found);
}

/* The map's i_d of zero torque current or any, without a slope to the last unit. */
void test_with_a_bound_the_point_is_that_of_the_power_with_the_i_d_of_the_map(void)
{
    motor_point_t found;
    TEST_ASSERT_EQUAL_INT32(1 << 24, by_drawn(SIDE_DRIVING, 1 << 25, 1 << 24, &found));
    assert_point(0, 1 << 24, found);
    const feasible_returned_t returned = {.power_b = 1 << 24};
    TEST_ASSERT_EQUAL_INT32(1 << 24, by_returned(1 << 25, returned, &found));
    assert_point(0, -(1 << 24), found);
    motor.set.power = (feasible_power_t){.a = SCALED_ONE};
    TEST_ASSERT_EQUAL_INT32(1 << 24, by_drawn(SIDE_BRAKING, 1 << 25, 1 << 24, &found));
    assert_point(0, -(1 << 24), found);
}

/* Zero torque draws 1000 beyond what there is, or returns it: no current of torque. */
void test_where_zero_torque_is_too_much_the_point_has_no_current_of_torque(void)
{
    motor_point_t found;
    motor.set.power.c = 1000;
    TEST_ASSERT_EQUAL_INT32(0, by_drawn(SIDE_DRIVING, 1 << 20, 900, &found));
    assert_point(0, 0, found);
    motor.set.power.c = -1000;
    const feasible_returned_t returned = {.power_b = 900};
    TEST_ASSERT_EQUAL_INT32(0, by_returned(1 << 20, returned, &found));
    assert_point(0, 0, found);
}

/* ---- the loss of the bridge ---- */

/* The straight line has the loss of the cap's current, and its slope: i_q = x + 2^21, of either
 * sign or zero. */
void test_the_line_for_the_loss_of_the_bridge_goes_through_that_of_the_cap(void)
{
    const int32_t loss_b = 1 << 18;
    motor.set.power = (feasible_power_t){.c = 0};
    motor.constants.loss_b = loss_b;
    for (int32_t i_q_b = -1; i_q_b <= 1; i_q_b++) {
        motor.model.iron_current_b = (1 << 21) + i_q_b;
        const feasible_side_t side = plain_side(&motor, SIDE_BRAKING, 1 << 21);
        const feasible_cap_power_t cap = feasible_cap_power(&side);
        TEST_ASSERT_EQUAL_INT32(i_q_b, cap.i_q_b);
        TEST_ASSERT_EQUAL_INT32(i_q_b < 0 ? -loss_b : loss_b, cap.b);
        /* 2^18 of 2^21 over 2^24, and less than a unit for one of i_q */
        TEST_ASSERT_INT32_WITHIN(1, i_q_b < 0 ? -(1 << 15) : 1 << 15, cap.c);
        TEST_ASSERT_INT32_WITHIN(1, 0, (int32_t)cap.drawn_b);
    }
}

/* ---- uncertain angle ---- */

/* w 2^25 by one unit of an angle: two units, of an EMF of one times an i_d of two. */
void test_the_smallest_uncertain_angle_of_a_hall_sensor_counts(void)
{
    motor.set.power = (feasible_power_t){.c = 0};
    motor.constants.hall_angle_b = 1;
    motor.model.speed_b = 1 << 25;
    motor.model.emf_b = SCALED_ONE;
    const motor_point_t at = {.d_b = -(1 << 25), .x_b = 0};
    const feasible_returned_t returned = {.power_b = 1000};
    TEST_ASSERT_EQUAL_INT32(1000 - 2 * 2, feasible_excess_b(&motor.set, at, returned));
}

/* A motor that has to draw, or a battery that takes nothing, draws nothing for its angle. */
void test_an_uncertain_angle_takes_nothing_where_the_battery_takes_nothing(void)
{
    motor.set.power = (feasible_power_t){.c = 0};
    motor.constants.hall_angle_b = SCALED_ONE;
    motor.model.speed_b = SCALED_ONE;
    motor.model.emf_b = 1 << 20;
    const motor_point_t at = {.d_b = -(1 << 20), .x_b = 0};
    for (int32_t power_b = -1000; power_b <= 0; power_b += 1000) {
        for (int32_t margin_b = 0; margin_b <= 1 << 20; margin_b += 1 << 20) {
            const feasible_returned_t returned = {.power_b = power_b, .margin_b = margin_b};
            TEST_ASSERT_EQUAL_INT32(power_b, feasible_excess_b(&motor.set, at, returned));
        }
    }
}

/* ---- a negligible power ---- */

/* The vertex returns 2^16; where 1000 have to be drawn, 2^16 + 1000 have to be negligible. */
void test_a_power_that_has_to_be_drawn_is_no_part_of_the_negligible_one(void)
{
    motor_point_t found;
    motor.set.power = (feasible_power_t){.a = A, .b = B};
    const feasible_returned_t draws = {.power_b = -1000};
    motor.constants.negligible_power_b = (1 << 16) + 1000;
    TEST_ASSERT_INT32_WITHIN(NEAR, 0, by_returned(1 << 23, draws, &found));
    motor.constants.negligible_power_b = (1 << 16) + 1001;
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, by_returned(1 << 23, draws, &found));
}

/* ---- corrections of i_d ---- */

/* i_d falls to -2^18 up to a torque of 2^20, and with it the power. */
static motor_point_t corrected(int32_t power_b)
{
    motor_point_t found;
    motor.map_lsb[0] = motor.map_lsb[2] = plain_entry(&motor, PLAIN_UNIT_LOG2, -0.25);
    motor.set.power = (feasible_power_t){.b = SCALED_ONE, .b_d = SCALED_ONE / 4};
    feasible_side_t side = plain_side(&motor, SIDE_DRIVING, 1 << 21);
    const feasible_cap_power_t cap = feasible_cap_power(&side);
    (void)feasible_by_drawn_at(&side, &cap, power_b, &found);
    return found;
}

/* A 32nd of the phase current, 2^22, is one of no second correction; a unit more is. */
void test_an_i_d_that_moves_by_a_32nd_of_the_phase_current_is_corrected_once(void)
{
    TEST_ASSERT_EQUAL_INT32(-(1 << 17), corrected(1 << 19).d_b);
    motor.constants.current_most_b = (1 << 22) - 32;
    TEST_ASSERT_NOT_EQUAL_INT32(-(1 << 17), corrected(1 << 19).d_b);
}

/* u_q = 2^24 + i_d, u_d = 0, no voltage: only an i_d of -2^24 has it. */
void test_the_i_d_of_a_bound_on_an_ellipse_of_one_point_is_that_point(void)
{
    motor_point_t found;
    motor.constants.current_most_b = 1 << 25;
    motor.model.voltage_q_b = SCALED_ONE;
    motor.model.voltage_q_per_d = SCALED_ONE;
    motor.set.voltage_squared = 0;
    motor.set.weakest_d_b = -(1 << 25);
    const feasible_side_t side = plain_side(&motor, SIDE_DRIVING, 1 << 21);
    const feasible_cap_power_t cap = feasible_cap_power(&side);
    TEST_ASSERT_EQUAL_INT32(1 << 20, feasible_by_drawn_at(&side, &cap, 1 << 20, &found));
    TEST_ASSERT_EQUAL_INT32(-SCALED_ONE, found.d_b);
}
