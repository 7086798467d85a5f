/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The model of a motor with a flux map: exact at the currents around which it is made, and its
 * solutions around their own last ones converge to those of the map. Against the circuit in double
 * precision, with the fluxes of the points along straight lines.
 */
#include <math.h>
#include <string.h>

#include "core/q15.h"
#include "motor/current_setpoint.h"
#include "motor/flux_map.h"
#include "motor/motor_model.h"
#include "random_values.h"
#include "reference_flux_map.h"
#include "saturated_vehicle.h"
#include "unity.h"

static config_t config;
static motor_constants_t constants;

void setUp(void)
{
    config = saturated_vehicle();
    config.motor.reference_temperature_cC = 2500;
    config.motor.flux_coefficient_ppm_K = -1100;
    config.motor.friction_torque_mNm = 0;
    config.motor.viscous_friction_uNm_s = 0;
    motor_constants_init(&constants, &config);
}

void tearDown(void) {}

/* The steady state of terminal currents, i_q along the rotation. */
typedef struct {
    double torque_nm, u_d_v, u_q_v;
} circuit_t;

static circuit_t circuit(double w_rad_s, double shift_a, double i_d_a, double i_q_a)
{
    const config_motor_t *m = &config.motor;
    const double r_i_ohm =
        1e-3 * m->iron_loss_resistance_mOhm + 1e-9 * m->iron_loss_resistance_slope_nOhm_s * w_rad_s;
    const double r_ohm = 1e-6 * m->phase_resistance_uOhm;
    double d_a = i_d_a;
    double q_a = i_q_a;
    double psi_d = 0.0;
    double psi_q = 0.0;
    for (int n = 0; n < 60; n++) {
        const reference_flux_t at =
            reference_flux(&config.flux_map, 1e3 * (d_a + shift_a), 1e3 * q_a);
        psi_d = 1e-9 * at.d_nWb;
        psi_q = 1e-9 * at.q_nWb;
        d_a = i_d_a + w_rad_s * psi_q / r_i_ohm;
        q_a = i_q_a - w_rad_s * psi_d / r_i_ohm;
    }
    const circuit_t out = {.torque_nm = 1.5 * m->pole_pairs * (psi_d * q_a - psi_q * d_a),
                           .u_d_v = r_ohm * i_d_a - w_rad_s * psi_q,
                           .u_q_v = r_ohm * i_q_a + w_rad_s * psi_d};
    return out;
}

/* Magnets of 0.09 Wb fall by 0.11 % a kelvin; 0.25e-3 H along i_d. */
static double shift_a(int32_t winding_cC)
{
    return -1.1e-5 * (winding_cC - 2500) * 0.09 / 0.25e-3;
}

/* At any temperature; the resistance does not follow it here. */
void test_torque_and_voltage_are_those_of_the_map_at_the_currents_of_the_model(void)
{
    random_t random = random_seeded(1);
    config.motor.resistance_coefficient_ppm_K = 0;
    motor_constants_init(&constants, &config);
    for (int n = 0; n < 3000; n++) {
        const int32_t winding_cC = random_between(&random, -2000, 14000);
        const int32_t speed_mrad_s = random_between(&random, 0, 1200000);
        const motor_current_t at = {.d_mA = random_between(&random, -390000, 0),
                                    .q_mA = random_between(&random, -400000, 400000)};
        const motor_model_t m =
            motor_model_around(&constants, &config, speed_mrad_s, winding_cC, at);
        const motor_point_t point = motor_model_point(&m, at);
        const circuit_t want =
            circuit(speed_mrad_s * 4e-3, shift_a(winding_cC), at.d_mA * 1e-3, at.q_mA * 1e-3);
        /* 0.1 % of 220 N m, 0.2 V of 220 V: the flux across the iron's currents to first order. */
        TEST_ASSERT_DOUBLE_WITHIN(0.22, want.torque_nm, motor_model_torque_mNm(&m, point) * 1e-3);
        TEST_ASSERT_DOUBLE_WITHIN(
            0.2, want.u_d_v, ldexp(motor_model_u_d_b(&m, point), -constants.voltage_shift) * 1e-3);
        TEST_ASSERT_DOUBLE_WITHIN(
            0.2, want.u_q_v, ldexp(motor_model_u_q_b(&m, point), -constants.voltage_shift) * 1e-3);
    }
}

/* Magnets that are warmer by 100 K: 11 % less flux, as -39.6 A in psi_d = 0.09 + 0.25e-3 i_d. */
void test_warm_magnets_move_the_map_along_i_d(void)
{
    const motor_current_t at = {.d_mA = -100000, .q_mA = -200000};
    const motor_model_t m = motor_model_around(&constants, &config, 0, 12500, at);
    const circuit_t want = circuit(0.0, shift_a(12500), -100.0, -200.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.2, want.torque_nm,
                              motor_model_torque_mNm(&m, motor_model_point(&m, at)) * 1e-3);
}

static void assert_same_power(const feasible_power_t *want, const feasible_power_t *power)
{
    TEST_ASSERT_EQUAL_INT32(want->a, power->a);
    TEST_ASSERT_EQUAL_INT32(want->b, power->b);
    TEST_ASSERT_EQUAL_INT32(want->b_d, power->b_d);
    TEST_ASSERT_EQUAL_INT32(want->c, power->c);
    TEST_ASSERT_EQUAL_INT32(want->c_d, power->c_d);
    TEST_ASSERT_EQUAL_INT32(want->c_dd, power->c_dd);
}

/* Model, power and lowest i_d; the voltage is its root, within 2^-14 of it. */
void test_a_feasible_set_moved_to_currents_is_the_one_of_a_model_around_them(void)
{
    random_t random = random_seeded(2);
    int differ = 0;
    for (int n = 0; n < 200; n++) {
        const int32_t speed_mrad_s = random_between(&random, 0, 1200000);
        const int32_t phase_mV = random_between(&random, 50000, 220000);
        const motor_current_t at = {.d_mA = random_between(&random, -390000, 0),
                                    .q_mA = random_between(&random, -400000, 400000)};
        motor_model_t m = motor_model_at(&constants, &config, speed_mrad_s, 2500);
        feasible_set_t set = feasible_set_at(&m, phase_mV);
        const int32_t before_b = set.weakest_d_b;
        feasible_set_around(&set, &m, at);
        const motor_model_t want_m =
            motor_model_around(&constants, &config, speed_mrad_s, 2500, at);
        const feasible_set_t want = feasible_set_at(&want_m, phase_mV);
        TEST_ASSERT_EQUAL_INT32(want_m.flux_b, m.flux_b);
        TEST_ASSERT_EQUAL_INT32(want_m.inductance_q_b, m.inductance_q_b);
        TEST_ASSERT_EQUAL_INT32(want_m.voltage_q_b, m.voltage_q_b);
        assert_same_power(&want.power, &set.power);
        TEST_ASSERT_TRUE(want.voltage_squared == set.voltage_squared);
        const int32_t near_b = constants.current_most_b >> 10;
        TEST_ASSERT_INT32_WITHIN(near_b, want.weakest_d_b, set.weakest_d_b);
        differ += q_abs(want.weakest_d_b - before_b) > 4 * near_b;
    }
    TEST_ASSERT_GREATER_THAN_INT(10, differ);
}

typedef struct {
    motor_current_t last;
    double torque_nm;
} solved_t;

/* One slow step: the setpoint of a torque around that of the step before. */
static void solve(solved_t *state, int32_t speed_mrad_s, int32_t torque_mNm)
{
    const motor_model_t m =
        motor_model_around(&constants, &config, speed_mrad_s, 2500, state->last);
    const feasible_set_t set = feasible_set_at(&m, 220000);
    const current_setpoint_t out = current_setpoint_step(&set, torque_mNm, 0);
    const motor_current_t at = {.d_mA = out.i_d_mA, .q_mA = out.i_q_mA};
    state->last = at;
    state->torque_nm = circuit(speed_mrad_s * 4e-3, 0.0, at.d_mA * 1e-3, at.q_mA * 1e-3).torque_nm;
}

/* A step of the whole torque from zero current: within 2 % after five steps, and never above it by
 * more afterwards. From the tenth on within 0.2 % of the largest torque. */
void test_a_step_of_torque_converges_to_the_map_within_some_milliseconds(void)
{
    for (int32_t speed_mrad_s = 0; speed_mrad_s <= 400000; speed_mrad_s += 100000) {
        for (int32_t torque_mNm = -200000; torque_mNm <= 200000; torque_mNm += 25000) {
            solved_t state = {.last = {.d_mA = 0, .q_mA = 0}};
            for (int n = 0; n < 20; n++) {
                solve(&state, speed_mrad_s, torque_mNm);
                const double error_nm = state.torque_nm - torque_mNm * 1e-3;
                if (n >= 5) {
                    TEST_ASSERT_DOUBLE_WITHIN(0.02 * fabs(torque_mNm * 1e-3) + 0.4, 0.0, error_nm);
                }
                if (n >= 10) {
                    TEST_ASSERT_DOUBLE_WITHIN(0.44, 0.0, error_nm);
                }
            }
        }
    }
}

/* At the torque rate of 2 N m a millisecond the torque is within 2 % of its demand from the first
 * step on, through zero torque too. */
void test_a_ramp_of_torque_is_followed_within_two_per_cent(void)
{
    solved_t state = {.last = {.d_mA = 0, .q_mA = 0}};
    for (int32_t torque_mNm = -180000; torque_mNm <= 180000; torque_mNm += 2000) {
        solve(&state, 100000, torque_mNm);
        if (torque_mNm > -170000) {
            TEST_ASSERT_DOUBLE_WITHIN(0.02 * fabs(torque_mNm * 1e-3) + 1.0, torque_mNm * 1e-3,
                                      state.torque_nm);
        }
    }
}
