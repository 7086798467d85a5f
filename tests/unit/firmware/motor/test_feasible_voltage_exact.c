/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Voltage bounds of a motor of powers of two: each condition at its limit. A unit is 2^20 of the
 * binary scale.
 */
#include <math.h>

#include "core/q15.h"
#include "plain_motor.h"
#include "random_values.h"
#include "unity.h"

enum { UNIT_LOG2 = 20, ROUNDS = 4000, MOST_b = 1 << 22, CIRCLE_b = 255 << 14 };

static plain_motor_t motor;

void setUp(void)
{
    plain_motor_init(&motor);
    motor.config.current_map.torque_points = 3;
    motor.config.current_map.speed_points = 2;
    motor.config.motor.derate_winding_temperature_cC = 10000;
    motor.config.motor.max_winding_temperature_cC = 15000;
}

void tearDown(void) {}

static int32_t units(double x)
{
    return (int32_t)lround(ldexp(x, UNIT_LOG2));
}

static int32_t ratio(double x)
{
    return (int32_t)lround(ldexp(x, 24));
}

void test_torque_that_friction_makes_is_none(void)
{
    motor.model.friction_b = 100;
    const feasible_side_t driving = plain_side(&motor, SIDE_DRIVING, 0);
    const feasible_side_t braking = plain_side(&motor, SIDE_BRAKING, 0);
    TEST_ASSERT_EQUAL_INT32(0, feasible_magnitude_mNm(&driving, 100));
    TEST_ASSERT_EQUAL_INT32(1, feasible_magnitude_mNm(&driving, 101));
    TEST_ASSERT_EQUAL_INT32(0, feasible_magnitude_mNm(&braking, 100));
    TEST_ASSERT_EQUAL_INT32(1, feasible_magnitude_mNm(&braking, 99));
}

/* u_d = -4 2^20, u_q = 2^20: |u|^2 = 17 2^40, a 16th more than 2^44. */
void test_a_point_holds_up_to_a_sixteenth_more_of_the_squared_voltage(void)
{
    motor.model.reactance_q_b = SCALED_ONE;
    motor.model.voltage_q_b = 1 << 20;
    motor.set.voltage_squared = INT64_C(1) << 44;
    motor_point_t at = {.d_b = 0, .x_b = 4 << 20};
    TEST_ASSERT_TRUE(feasible_holds(&motor.set, at));
    at.x_b++;
    TEST_ASSERT_FALSE(feasible_holds(&motor.set, at));
    at.x_b = 0;
    motor.model.voltage_q_b = (4 << 20) + (1 << 18);
    TEST_ASSERT_FALSE(feasible_holds(&motor.set, at));
}

/* ---- the lowest i_d of field weakening ---- */

static int32_t weakest_b(int32_t phase_mV)
{
    return feasible_set_at(&motor.model, phase_mV).weakest_d_b;
}

void test_a_voltage_of_zero_or_less_is_none(void)
{
    motor.constants.voltage_shift = 4;
    TEST_ASSERT_TRUE(feasible_set_at(&motor.model, 1).voltage_squared == 256);
    TEST_ASSERT_TRUE(feasible_set_at(&motor.model, 0).voltage_squared == 0);
    TEST_ASSERT_TRUE(feasible_set_at(&motor.model, -1).voltage_squared == 0);
}

/* A flux that the circle cannot weaken to zero: down to the circle, hot only to the configured. */
void test_field_weakening_ends_at_the_circle_and_hot_at_the_configured_current(void)
{
    motor.constants.inductance_d_b = SCALED_ONE;
    motor.constants.weakening_most_b = 1 << 20;
    motor.model.speed_b = 1 << 22;
    TEST_ASSERT_INT32_WITHIN(CIRCLE_b >> 14, -CIRCLE_b, weakest_b(1 << 20));
    motor.model.winding_temperature_cC = 15000;
    TEST_ASSERT_EQUAL_INT32(-(1 << 20), weakest_b(1 << 20));
    motor.constants.weakening_most_b = 1 << 23;
    TEST_ASSERT_EQUAL_INT32(-CIRCLE_b, weakest_b(1 << 20));
}

void test_field_does_not_rise_where_the_voltage_would_bear_a_higher_flux(void)
{
    motor.constants.inductance_d_b = SCALED_ONE;
    motor.constants.inductance_q_b = SCALED_ONE;
    motor.model.flux_b = 1 << 20;
    motor.model.saliency_b = SCALED_ONE / 2;
    const int32_t SPEEDS_b[] = {0, 1, 1 << 10};
    for (int k = 0; k < 3; k++) {
        motor.model.speed_b = SPEEDS_b[k];
        TEST_ASSERT_EQUAL_INT32(0, weakest_b(1 << 24));
    }
}

/* Without saliency, or with a flux of no voltage, the i_d that cancels the flux; a flux of four
 * units over an inductance of none is more than the circle. */
void test_field_weakening_without_torque_of_saliency_cancels_the_flux(void)
{
    motor.constants.inductance_d_b = SCALED_ONE / 4;
    motor.constants.inductance_q_b = 1 << 10;
    motor.model.speed_b = 1 << 22;
    motor.model.flux_b = 4;
    TEST_ASSERT_EQUAL_INT32(-16, weakest_b(0));
    motor.model.saliency_b = 1;
    motor.constants.inductance_d_b = 0;
    TEST_ASSERT_INT32_WITHIN(CIRCLE_b >> 14, -CIRCLE_b, weakest_b(0));
}

/* The i_d of the largest torque on the circle of flux U/w, as its derivative over the flux of d
 * says: psi L_q + sqrt((psi L_q)^2 + 8 ((L_d - L_q) U/w)^2) divides 2 (L_d - L_q) (U/w)^2. */
static double best_d(double psi, double l_d, double l_q, double flux)
{
    const double saliency = l_d - l_q;
    const double sum =
        psi * l_q + sqrt(psi * psi * l_q * l_q + 8.0 * saliency * saliency * flux * flux);
    return (2.0 * saliency * flux * flux / sum - psi) / l_d;
}

void test_field_weakening_ends_at_maximum_torque_per_voltage(void)
{
    random_t random = random_seeded(61);
    int inside = 0;
    for (int n = 0; n < ROUNDS; n++) {
        const double psi = random_real(&random, 0.2, 6.0);
        const double l_d = random_real(&random, 0.3, 2.0);
        const double l_q = random_real(&random, 0.3, 2.0);
        const double volts = random_real(&random, 0.1, 4.0);
        motor.constants.inductance_d_b = ratio(l_d);
        motor.constants.inductance_q_b = ratio(l_q);
        motor.model.saliency_b = motor.constants.inductance_d_b - motor.constants.inductance_q_b;
        motor.model.flux_b = units(psi);
        motor.model.speed_b = SCALED_ONE;
        const double circle = ldexp(CIRCLE_b, -UNIT_LOG2);
        const double wanted = fmax(-circle, fmin(best_d(psi, l_d, l_q, volts), 0.0));
        inside += wanted > -circle && wanted < 0.0;
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, wanted, ldexp(weakest_b(units(volts)), -UNIT_LOG2));
    }
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 4, inside);
}

/* One unit of voltage at standstill is a flux of one: sum = 1 + sqrt(3), i_d = (1 / sum - 1) / 4.
 */
void test_standstill_counts_as_one_unit_of_speed(void)
{
    motor.constants.inductance_d_b = 4 * SCALED_ONE;
    motor.constants.inductance_q_b = SCALED_ONE;
    motor.model.saliency_b = SCALED_ONE / 2;
    const double wanted_b = (1.0 / (1.0 + sqrt(3.0)) - 1.0) / 4.0 * SCALED_ONE;
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * SCALED_ONE, wanted_b, weakest_b(1));
}

/* ---- caps ---- */

void test_a_cap_of_any_torque_is_a_point_on_its_side(void)
{
    motor.model.friction_b = 100;
    TEST_ASSERT_EQUAL_INT32(1100, feasible_side_at(&motor.set, SIDE_DRIVING, 1000).cap.x_b);
    TEST_ASSERT_EQUAL_INT32(-900, feasible_side_at(&motor.set, SIDE_BRAKING, 1000).cap.x_b);
    TEST_ASSERT_EQUAL_INT32((1 << 25) - 1,
                            feasible_side_at(&motor.set, SIDE_DRIVING, INT32_MAX).cap.x_b);
    TEST_ASSERT_EQUAL_INT32(-(1 << 25),
                            feasible_side_at(&motor.set, SIDE_BRAKING, INT32_MAX).cap.x_b);
}

/* |u|^2 = 0 with an EMF that the lowest i_d cancels: the end is zero torque, which friction brakes.
 */
void test_an_ellipse_of_one_point_exists(void)
{
    motor.model.friction_b = 100;
    motor.model.reactance_q_b = SCALED_ONE;
    motor.model.voltage_q_per_d = SCALED_ONE;
    motor.model.voltage_q_b = 1 << 12;
    motor.set.weakest_d_b = -(1 << 12);
    motor.set.voltage_squared = 0;
    feasible_side_t side = plain_side(&motor, SIDE_BRAKING, MOST_b);
    side.cap_has_voltage = false;
    TEST_ASSERT_EQUAL_INT32(100, feasible_by_voltage_mNm(&side));
    /* 2^24 too much of |u|^2, which a reactance of 2^-12 shows as one unit. */
    motor.model.reactance_q_b = 1 << 12;
    motor.set.weakest_d_b = 0;
    side = plain_side(&motor, SIDE_BRAKING, MOST_b);
    side.cap_has_voltage = false;
    TEST_ASSERT_EQUAL_INT32(0, feasible_by_voltage_mNm(&side));
}

/* 2^12 V over 2^-12 Ohm. */
void test_the_smallest_reactance_counts(void)
{
    motor.model.reactance_q_b = 1 << 12;
    motor.set.voltage_squared = 1 << 24;
    feasible_side_t side = plain_side(&motor, SIDE_DRIVING, 1 << 25);
    side.cap_has_voltage = false;
    TEST_ASSERT_EQUAL_INT32(1 << 24, feasible_by_voltage_mNm(&side));
}

/* ---- points on the ellipse and on the circle ---- */

/* x 3, u_q = 6 + i_d, |u| up to 5: i_d -2. */
static void three_four_five(void)
{
    motor.model.reactance_q_b = SCALED_ONE;
    motor.model.voltage_q_per_d = SCALED_ONE;
    motor.model.voltage_q_b = 6 << 20;
    motor.set.voltage_squared = INT64_C(25) << 40;
    motor.set.weakest_d_b = -(4 << 20);
}

void test_the_point_of_a_torque_is_on_the_ellipse_down_to_the_lowest_i_d(void)
{
    three_four_five();
    motor_point_t at = feasible_point(&motor.set, 3 << 20);
    TEST_ASSERT_EQUAL_INT32(-(2 << 20), at.d_b);
    TEST_ASSERT_EQUAL_INT32(3 << 20, at.x_b);
    motor.set.weakest_d_b = -(1 << 20);
    at = feasible_point(&motor.set, 3 << 20);
    TEST_ASSERT_EQUAL_INT32(-(1 << 20), at.d_b);
}

void test_a_cap_inside_the_end_of_the_ellipse_is_no_bound(void)
{
    three_four_five();
    feasible_side_t side = plain_side(&motor, SIDE_DRIVING, 3 << 20);
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, feasible_by_voltage_mNm(&side));
    TEST_ASSERT_EQUAL_INT32(0, side.cap.d_b);
    side.cap_has_voltage = false;
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, feasible_by_voltage_mNm(&side));
    TEST_ASSERT_EQUAL_INT32(-(2 << 20), side.cap.d_b);
    TEST_ASSERT_EQUAL_INT32(3 << 20, side.cap_mNm);
    TEST_ASSERT_TRUE(side.cap_has_voltage);
}

/* Phase current 5, the map's i_d -3, i_q 4; one unit more is beyond the circle. */
void test_a_point_on_the_circle_keeps_the_i_d_of_the_map(void)
{
    motor.constants.current_most_b = 5 << 18;
    for (int k = 0; k < 3; k++) {
        motor.map_lsb[k] = plain_entry(&motor, 18, -3.0);
    }
    TEST_ASSERT_EQUAL_INT32(-(3 << 18), feasible_point(&motor.set, 4 << 18).d_b);
    TEST_ASSERT_GREATER_THAN_INT32(-(3 << 18), feasible_point(&motor.set, (4 << 18) + 1).d_b);
}
