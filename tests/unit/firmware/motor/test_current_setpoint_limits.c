/* SPDX-License-Identifier: Apache-2.0 */
/* Current setpoints of a motor of powers of two at the limits of voltage and phase current. */
#include "motor/current_setpoint.h"
#include "plain_motor.h"
#include "unity.h"

enum { UNIT = 1 << 20, MOST_mA = 4 * UNIT / 2 };

static plain_motor_t motor;

/* Phase current 4, of units of 2^20 or half as many milliamperes. */
void setUp(void)
{
    plain_motor_init(&motor);
    motor.config.motor.max_phase_current_mA = MOST_mA;
    motor.constants.weakening_most_b = 4 * UNIT;
}

void tearDown(void) {}

static void use_voltage(double u)
{
    motor.set.voltage_squared = (int64_t)ldexp(u * u, 2 * PLAIN_UNIT_LOG2);
}

/* u_d = -x: a torque of 8 takes more than the voltage of 5, the 4 of the phase current do not. */
void test_a_setpoint_is_feasible_where_the_limited_current_has_voltage(void)
{
    motor.model.reactance_q_b = SCALED_ONE;
    use_voltage(5.0);
    const current_setpoint_t out = current_setpoint_step(&motor.set, 8 * UNIT, 0);
    TEST_ASSERT_TRUE(out.limited);
    TEST_ASSERT_INT32_WITHIN(MOST_mA / 256, MOST_mA, out.i_q_mA);
    TEST_ASSERT_TRUE(out.feasible);
}

/* u_q = 8 + x: a braking torque of 8 takes no voltage, that of the phase current 4. */
void test_a_setpoint_is_not_feasible_where_only_the_unlimited_current_has_voltage(void)
{
    motor.model.voltage_q_b = 8 * UNIT;
    motor.model.voltage_q_per_x = SCALED_ONE;
    use_voltage(2.0);
    const current_setpoint_t out = current_setpoint_step(&motor.set, -8 * UNIT, 0);
    TEST_ASSERT_TRUE(out.limited);
    TEST_ASSERT_FALSE(out.feasible);
    /* A torque of 6 takes 2, and all that is feasible is within a phase current of 6. */
    motor.constants.current_most_b = 6 * UNIT;
    motor.config.motor.max_phase_current_mA = 6 * UNIT / 2;
    const current_setpoint_t whole = current_setpoint_step(&motor.set, -6 * UNIT, 0);
    TEST_ASSERT_FALSE(whole.limited);
    TEST_ASSERT_TRUE(whole.feasible);
}

/* Without reactance R/(w L_q) has no end, without either it is none: braking current of 2 stays
 * where a trim of 4 would take it. */
void test_the_trim_leaves_the_braking_current_of_any_resistance_without_reactance(void)
{
    motor.set.weakest_d_b = -4 * UNIT;
    for (int32_t r_b = 0; r_b <= SCALED_ONE; r_b += SCALED_ONE / 4) {
        motor.model.resistance_b = r_b;
        const current_setpoint_t out = current_setpoint_step(&motor.set, -2 * UNIT, -MOST_mA);
        const double left = r_b > 0 ? sqrt(12.0) : 4.0;
        TEST_ASSERT_DOUBLE_WITHIN(2e-3 * MOST_mA, -left * UNIT / 2, out.i_d_mA - MOST_mA);
    }
}
