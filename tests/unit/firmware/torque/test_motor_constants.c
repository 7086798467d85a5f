/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "paper_vehicle.h"
#include "torque/motor_model.h"
#include "unity.h"

enum { LEAST_SIZE = 1 << 22 };

void setUp(void) {}

void tearDown(void) {}

/* The scales leave the largest current, voltage and speed between 2^22 and 2^23 (motor_model.h). */
void test_largest_quantities_fill_23_bits(void)
{
    const config_t *config = &CONFIG_LU2013;
    motor_constants_t k;
    motor_constants_init(&k, config);
    const double current_b = ldexp(config->motor.max_phase_current_mA, k.current_shift);
    const double w_mrad_s = (double)config->motor.max_speed_mrad_s * config->motor.pole_pairs;
    const double speed_b = ldexp(w_mrad_s, k.speed_shift);
    TEST_ASSERT_TRUE(current_b >= LEAST_SIZE && current_b < 2 * LEAST_SIZE);
    TEST_ASSERT_TRUE(speed_b >= LEAST_SIZE && speed_b < 2 * LEAST_SIZE);
    /* Voltage: EMF, reactive drop and battery, the largest of them. */
    const double emf_mV = w_mrad_s * config->motor.flux_linkage_nWb * 1e-9;
    const double reactance_ohm = w_mrad_s * config->motor.q_inductance_nH * 1e-12;
    const double drop_mV = fmax(reactance_ohm, config->motor.phase_resistance_uOhm * 1e-6) *
                           config->motor.max_phase_current_mA;
    const double most_mV = fmax(fmax(emf_mV, drop_mV), config->battery.max_voltage_mV);
    const double voltage_b = ldexp(most_mV, k.voltage_shift);
    TEST_ASSERT_TRUE(voltage_b >= LEAST_SIZE - 1 && voltage_b < 2 * LEAST_SIZE);
}

/* A product with 24 fraction bits is in the scale of its result. */
void test_constants_are_the_configuration_in_the_scales(void)
{
    const config_motor_t *motor = &CONFIG_LU2013.motor;
    motor_constants_t k;
    motor_constants_init(&k, &CONFIG_LU2013);
    const int32_t impedance = k.voltage_shift - k.current_shift;
    const int32_t per_speed = k.voltage_shift - k.speed_shift;
    TEST_ASSERT_DOUBLE_WITHIN(1.0, ldexp(motor->phase_resistance_uOhm * 1e-6, 24 + impedance),
                              k.resistance_b);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, ldexp(motor->flux_linkage_nWb * 1e-9, 24 + per_speed), k.flux_b);
    TEST_ASSERT_DOUBLE_WITHIN(1.0,
                              ldexp(motor->d_inductance_nH * 1e-12, 48 + impedance - k.speed_shift),
                              k.inductance_d_b);
    TEST_ASSERT_DOUBLE_WITHIN(1.0,
                              ldexp(motor->q_inductance_nH * 1e-12, 48 + impedance - k.speed_shift),
                              k.inductance_q_b);
    TEST_ASSERT_DOUBLE_WITHIN(ldexp(1.0, -20), 1.0,
                              ldexp(1.0, -48) * k.torque_factor_q24 * k.torque_inverse_q24);
}

/* A field-weakening current of many times the phase current limit is accepted: the scale of
 * currents ends at four to eight times that limit. */
void test_weakening_current_stays_within_the_scale_of_currents(void)
{
    config_t config = CONFIG_LU2013;
    config.drive.current_full_scale_mA = 4000000;
    config.motor.max_phase_current_mA = 100;
    config.current_loop.field_weakening_current_pu_q15 = 32767;
    motor_constants_t constants;
    motor_constants_init(&constants, &config);
    TEST_ASSERT_EQUAL_INT32(MOTOR_MODEL_MOST_CURRENT_b, constants.weakening_most_b);
    config.current_loop.field_weakening_current_pu_q15 = 0;
    motor_constants_init(&constants, &config);
    TEST_ASSERT_EQUAL_INT32(0, constants.weakening_most_b);
}
