/* SPDX-License-Identifier: Apache-2.0 */
/* Torque bounds by phase current of all shipped configurations, against a bisection along the
 * current circle on the circuit in double precision. */
#include "reference_drive.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

/* On the circle with 0.4 % in reserve: maximum torque per ampere by golden section, and where the
 * voltage does not suffice there, by bisection down to where it does or field weakening ends. */
static double by_current_nm(const drive_t *drive, double sign)
{
    const double most_a = 1e-3 * drive->config->motor.max_phase_current_mA * (1.0 - 1.0 / 256.0);
    const reference_motor_t *m = &drive->motor;
    const double saliency_h = m->l_d_h - m->l_q_h;
    double low_a = -most_a;
    double high_a = most_a;
    for (int n = 0; n < 80; n++) {
        const double a = low_a + 0.382 * (high_a - low_a);
        const double b = low_a + 0.618 * (high_a - low_a);
        const double at_a = (m->psi_wb + saliency_h * a) * sqrt(most_a * most_a - a * a);
        const double at_b = (m->psi_wb + saliency_h * b) * sqrt(most_a * most_a - b * b);
        if (at_a > at_b) {
            high_a = b;
        } else {
            low_a = a;
        }
    }
    double inside_a = fmin(fmax(drive->weakest_a, -most_a), low_a);
    double d_a = low_a;
    for (int n = 0; n < HALVINGS; n++) {
        const double q_a = sign * sqrt(fmax(most_a * most_a - d_a * d_a, 0.0));
        if (volts(drive, of_terminal(drive, d_a, q_a)) <= drive->phase_v) {
            if (n == 0) {
                break;
            }
            inside_a = d_a;
        } else {
            low_a = d_a;
        }
        d_a = 0.5 * (inside_a + low_a);
    }
    const double q_a = sign * sqrt(fmax(most_a * most_a - d_a * d_a, 0.0));
    if (volts(drive, of_terminal(drive, d_a, q_a)) > 1.001 * drive->phase_v) {
        return -1.0; /* nowhere on the circle: bridge_choice.h opens the bridge */
    }
    return fmax(sign * (of_terminal(drive, d_a, q_a).torque_nm - friction_nm(drive)), 0.0);
}

/* Voltage and current together leave no less torque than both leave one after the other: more where
 * the ellipse meets the circle beyond its end at the lowest i_d, but no more than the circle. */
static void assert_leaves_as_much(feasible_side_t side, int32_t most_mNm)
{
    const int32_t cap_mNm = side.cap_mNm;
    feasible_circle_t circle = {.known = false};
    feasible_side_t other = side;
    const feasible_bounds_t ends = feasible_by_voltage_and_current(&other, &circle);
    const int32_t by_voltage_mNm = feasible_by_voltage_mNm(&side);
    const int32_t by_current_mNm = feasible_by_current_mNm(&side, &circle);
    const int32_t wanted_mNm = q_min(q_min(by_voltage_mNm, by_current_mNm), cap_mNm);
    const int32_t found_mNm = q_min(q_min(ends.voltage_mNm, ends.current_mNm), cap_mNm);
    TEST_ASSERT_GREATER_OR_EQUAL_INT32(wanted_mNm - most_mNm / 500, found_mNm);
    if (by_voltage_mNm != FEASIBLE_UNBOUNDED && ends.voltage_mNm == FEASIBLE_UNBOUNDED) {
        TEST_ASSERT_LESS_OR_EQUAL_INT32(by_current_mNm, found_mNm);
    }
    TEST_ASSERT_EQUAL_INT32(q_min(found_mNm, cap_mNm), other.cap_mNm);
}

/* At a speed whose EMF is half of the voltage the zero current needs no field weakening. */
void test_a_point_that_the_voltage_suffices_for_is_not_forced(void)
{
    const config_t *config = &CONFIG_LU2013;
    const motor_model_t model = model_at(config, 30000, 2500);
    const feasible_set_t set = feasible_set_at(&model, 2 * 14076); /* 30 rad/s * 23 * 20.4 mWb */
    motor_point_t at = {.d_b = 0, .x_b = 0};
    TEST_ASSERT_FALSE(feasible_forced(&set, &at));
    TEST_ASSERT_EQUAL_INT32(0, at.d_b);
    TEST_ASSERT_EQUAL_INT32(0, at.x_b);
}

void test_phase_current_bounds_of_every_configuration_match_a_bisection_on_the_circuit(void)
{
    const config_t *const configs[] = {&CONFIG_LU2013, &CONFIG_EBIKE36V, &CONFIG_SCOOTER48V,
                                       &CONFIG_IPM400V};
    for (int c = 0; c < 4; c++) {
        random_t random = random_seeded((uint64_t)(20 + c));
        int bounded = 0;
        for (int n = 0; n < STATES; n++) {
            int32_t phase_mV = 0;
            drive_t drive = any_drive(configs[c], &random, &phase_mV);
            const motor_model_t model = model_at(configs[c], drive.speed_mrad_s, drive.winding_cC);
            const feasible_set_t set = feasible_set_at(&model, phase_mV);
            drive.weakest_a = 1e-3 * model_current_mA(&model, set.weakest_d_b);
            const int32_t most_mNm = configs[c]->motor.max_torque_mNm;
            const int32_t cap_mNm = n % 2 == 0 ? most_mNm : 3 * most_mNm;
            feasible_circle_t circle = {.known = false};
            for (int sign = -1; sign <= 1; sign += 2) {
                feasible_side_t side =
                    feasible_side_at(&set, sign > 0 ? SIDE_DRIVING : SIDE_BRAKING, cap_mNm);
                assert_leaves_as_much(side, most_mNm);
                const int32_t found_mNm = feasible_by_current_mNm(&side, &circle);
                const double wanted_mNm = 1e3 * by_current_nm(&drive, sign);
                if (wanted_mNm < 0.0) {
                    continue;
                }
                if (found_mNm == FEASIBLE_UNBOUNDED) {
                    TEST_ASSERT_TRUE(wanted_mNm >= 0.998 * cap_mNm);
                } else {
                    bounded++;
                    TEST_ASSERT_DOUBLE_WITHIN(2e-3 * most_mNm, wanted_mNm, found_mNm);
                }
            }
        }
        TEST_ASSERT_GREATER_THAN_INT(STATES / 2, bounded);
    }
}
