/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "motor/motor_model.h"
#include "paper_vehicle.h"
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

/* ---- exact values: round numbers make every binary shift known ---- */

/* 2^20 mA, 2^22 mrad/s of four pole pairs, and an EMF of 2^22 mV from a flux of 1 Wb: shifts of 2,
 * 0 and 0. 3 p = 12 lies between 2^3 and 2^4, so that torque has a shift of 2 + 0 - 0 + 1 - 3 = 0.
 */
static config_t round_numbers(void)
{
    config_t config = CONFIG_LU2013;
    config.motor.pole_pairs = 4;
    config.motor.max_phase_current_mA = 1 << 20;
    config.motor.max_speed_mrad_s = 1 << 20;
    config.motor.flux_linkage_nWb = 1000000000;
    config.motor.d_inductance_nH = 1000;
    config.motor.q_inductance_nH = 1000;
    config.motor.phase_resistance_uOhm = 1000;
    config.battery.max_voltage_mV = 400000;
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    return config;
}

static motor_constants_t constants_of(const config_t *config)
{
    motor_constants_t out;
    motor_constants_init(&out, config);
    return out;
}

/* floor(value 2^shift / divisor), in 64 bits. */
static int32_t exact(int64_t value, int shift, int64_t divisor)
{
    return (int32_t)(value * (INT64_C(1) << shift) / divisor);
}

void test_a_quantity_of_a_power_of_two_is_at_the_lower_end_of_23_bits(void)
{
    config_t config = round_numbers();
    motor_constants_t k = constants_of(&config);
    TEST_ASSERT_EQUAL_INT32(2, k.current_shift);
    TEST_ASSERT_EQUAL_INT32(0, k.voltage_shift);
    TEST_ASSERT_EQUAL_INT32(0, k.speed_shift);
    TEST_ASSERT_EQUAL_INT32(0, k.torque_shift);
    TEST_ASSERT_EQUAL_INT32(1 << 22, k.current_most_b);
    config.motor.max_phase_current_mA -= 1;
    config.motor.max_speed_mrad_s *= 2; /* 2^23, and with it the EMF */
    k = constants_of(&config);
    TEST_ASSERT_EQUAL_INT32(3, k.current_shift);
    TEST_ASSERT_EQUAL_INT32(-1, k.voltage_shift);
    TEST_ASSERT_EQUAL_INT32(-1, k.speed_shift);
    config.motor.max_speed_mrad_s -= 1; /* 2^23 - 4 */
    k = constants_of(&config);
    TEST_ASSERT_EQUAL_INT32(0, k.voltage_shift);
    TEST_ASSERT_EQUAL_INT32(0, k.speed_shift);
}

/* Factors 3 p / 2^floor(log2(3 p)), and the torque scale with them. */
void test_torque_factor_of_any_pole_pairs_lies_between_one_and_two(void)
{
    config_t config = round_numbers();
    for (int32_t pole_pairs = 1; pole_pairs <= 60; pole_pairs++) {
        config.motor.pole_pairs = pole_pairs;
        const motor_constants_t k = constants_of(&config);
        const int log2_3p = (int)floor(log2(3.0 * pole_pairs));
        TEST_ASSERT_EQUAL_INT32(exact(3 * (int64_t)pole_pairs, 24 - log2_3p, 1),
                                k.torque_factor_q24);
        TEST_ASSERT_EQUAL_INT32(exact(1, 24 + log2_3p, 3 * (int64_t)pole_pairs),
                                k.torque_inverse_q24);
        TEST_ASSERT_EQUAL_INT32(k.current_shift + k.voltage_shift - k.speed_shift + 1 - log2_3p,
                                k.torque_shift);
    }
}

/* The voltage shift turns from 0 to 1 where the largest voltage falls below 2^22 mV. */
static int32_t voltage_shift_of(const config_t *config)
{
    return constants_of(config).voltage_shift;
}

void test_voltage_scale_follows_an_emf_to_the_millivolt(void)
{
    config_t config = round_numbers();
    TEST_ASSERT_EQUAL_INT32(0, voltage_shift_of(&config)); /* 2^22 mrad/s times 1 Wb */
    config.motor.flux_linkage_nWb -= 1;                    /* 4 uV less */
    TEST_ASSERT_EQUAL_INT32(1, voltage_shift_of(&config));
}

/* 1 mH at 2^22 mrad/s: 2^22 uOhm, with 1 kA 2^22 mV. */
void test_voltage_scale_follows_the_reactive_drop_of_the_larger_inductance(void)
{
    config_t config = round_numbers();
    config.motor.flux_linkage_nWb = 1000000;
    config.motor.max_phase_current_mA = 1000000;
    config.motor.d_inductance_nH = 1000000;
    TEST_ASSERT_EQUAL_INT32(0, voltage_shift_of(&config));
    config.motor.d_inductance_nH = 999999;
    TEST_ASSERT_EQUAL_INT32(1, voltage_shift_of(&config));
    config.motor.q_inductance_nH = 1000000;
    TEST_ASSERT_EQUAL_INT32(0, voltage_shift_of(&config));
    config.motor.max_phase_current_mA = 999999;
    TEST_ASSERT_EQUAL_INT32(1, voltage_shift_of(&config));
}

void test_voltage_scale_follows_the_resistive_drop_where_that_is_larger(void)
{
    config_t config = round_numbers();
    config.motor.flux_linkage_nWb = 1000000;
    config.motor.max_phase_current_mA = 1000000;
    config.motor.phase_resistance_uOhm = 1 << 22;
    TEST_ASSERT_EQUAL_INT32(0, voltage_shift_of(&config));
    config.motor.phase_resistance_uOhm -= 1;
    TEST_ASSERT_EQUAL_INT32(1, voltage_shift_of(&config));
}

/* 2 MV is 2^20.9 mV. */
void test_voltage_scale_follows_the_battery_where_that_is_largest(void)
{
    config_t config = round_numbers();
    config.motor.flux_linkage_nWb = 1000000;
    config.battery.max_voltage_mV = 1 << 20;
    TEST_ASSERT_EQUAL_INT32(2, voltage_shift_of(&config));
    config.battery.max_voltage_mV -= 1;
    TEST_ASSERT_EQUAL_INT32(3, voltage_shift_of(&config));
}

/* 1 H at 2^22 mrad/s is 4.2 kOhm, beyond 2^31 uOhm: counts as 2^31 - 1 uOhm, with 1 kA 2^31 - 1 mV,
 * which takes eight bits more than 2^23 - 1. */
void test_voltage_scale_ends_at_a_reactance_of_31_bits(void)
{
    config_t config = round_numbers();
    config.motor.max_phase_current_mA = 1000000;
    config.motor.d_inductance_nH = 1000000000;
    TEST_ASSERT_EQUAL_INT32(-8, voltage_shift_of(&config));
}

/* 1e12 is 2^12 5^12; 1e9 is 2^9 5^9. Where a value is a little more or less than 1 Wb or 1 mH its
 * quotient lies so near a whole number that one more or less in the divisor changes it. */
void test_flux_and_inductances_are_exact_to_the_last_bit(void)
{
    config_t config = round_numbers();
    const int32_t FLUX_nWb[] = {1000000000, 1000000059};
    const int32_t INDUCTANCE_nH[] = {1003685, 1016553};
    for (int n = 0; n < 2; n++) {
        config.motor.flux_linkage_nWb = FLUX_nWb[n];
        config.motor.d_inductance_nH = INDUCTANCE_nH[n];
        config.motor.q_inductance_nH = INDUCTANCE_nH[1 - n];
        const motor_constants_t k = constants_of(&config);
        TEST_ASSERT_EQUAL_INT32(0, k.voltage_shift);
        TEST_ASSERT_EQUAL_INT32(exact(FLUX_nWb[n], 24, 1000000000), k.flux_b);
        TEST_ASSERT_EQUAL_INT32(exact(INDUCTANCE_nH[n], 46 - 12, 244140625), k.inductance_d_b);
        TEST_ASSERT_EQUAL_INT32(exact(INDUCTANCE_nH[1 - n], 46 - 12, 244140625), k.inductance_q_b);
    }
}

/* 1e17 is 2^17 5^17, and 10^4 ppm are 2^4 5^4. */
void test_change_of_flux_with_temperature_is_exact_to_the_last_bit(void)
{
    config_t config = round_numbers();
    config.motor.flux_coefficient_ppm_K = -10000;
    const int32_t FLUX_nWb[] = {1000000000, 1000000002, 1000000003};
    for (int n = 0; n < 3; n++) {
        config.motor.flux_linkage_nWb = FLUX_nWb[n];
        TEST_ASSERT_EQUAL_INT32(exact(FLUX_nWb[n], 40 + 4 - 17, 1220703125),
                                constants_of(&config).flux_fall_b);
    }
}

/* 1 Ohm, 10^4 ppm: 10^10 2^38 / 10^14. */
void test_resistance_and_its_rise_are_exact_to_the_last_bit(void)
{
    config_t config = round_numbers();
    config.motor.phase_resistance_uOhm = 1000000;
    config.motor.resistance_coefficient_ppm_K = 10000;
    config.drive.loss_resistance_uOhm = 1000000;
    const motor_constants_t k = constants_of(&config);
    TEST_ASSERT_EQUAL_INT32(1 << 22, k.resistance_b);
    TEST_ASSERT_EQUAL_INT32(1 << 22, k.loss_resistance_b);
    TEST_ASSERT_EQUAL_INT32(exact(1, 38, 10000), k.resistance_rise_b);
}

void test_iron_resistance_is_exact_to_the_last_bit(void)
{
    config_t config = round_numbers();
    config.motor.iron_loss_resistance_mOhm = 123456789;
    const int32_t SLOPE_nOhm_s[] = {1000000000, 1000000001};
    for (int n = 0; n < 2; n++) {
        config.motor.iron_loss_resistance_slope_nOhm_s = SLOPE_nOhm_s[n];
        const motor_constants_t k = constants_of(&config);
        TEST_ASSERT_EQUAL_INT32(1 << 30, k.iron_q16_b); /* 123457 Ohm 2^14 is more */
        TEST_ASSERT_EQUAL_INT32(exact(SLOPE_nOhm_s[n], 38 - 12, 244140625), k.iron_slope_q16_b);
    }
    config.motor.iron_loss_resistance_mOhm = 12345678;
    TEST_ASSERT_EQUAL_INT32(exact(12345678, 14, 1000), constants_of(&config).iron_q16_b);
}

void test_friction_is_exact_to_the_last_bit(void)
{
    config_t config = round_numbers();
    config.motor.friction_torque_mNm = 987654;
    config.motor.viscous_friction_uNm_s = 87654321;
    const motor_constants_t k = constants_of(&config);
    TEST_ASSERT_EQUAL_INT32(exact(987654, 8, 500), k.coulomb_step_q8_b);
    TEST_ASSERT_EQUAL_INT32(exact(87654321, 24, 4000000), k.viscous_b); /* of 4 pole pairs */
}

/* Two thirds of a thousandth: 2e9 / 3 2^-22, to nearest 159. A loss of 1 W an ampere: 2e6 / 3000
 * mV, of 3 W 2000. Halls: half a period is 1 / (2 f) s, a unit of speed 1 mrad/s. */
void test_powers_and_the_hall_angle_are_exact_to_the_last_bit(void)
{
    config_t config = round_numbers();
    config.motor.max_power_mW = 1000000000;
    config.drive.loss_per_ampere_uW_A = 1000000;
    config.drive.pwm_frequency_Hz = 20000;
    motor_constants_t k = constants_of(&config);
    TEST_ASSERT_EQUAL_INT32(159, k.negligible_power_b);
    TEST_ASSERT_EQUAL_INT32(666, k.loss_b);
    TEST_ASSERT_EQUAL_INT32(exact(1, 48, INT64_C(2000) * 20000), k.hall_angle_b);
    config.motor.max_power_mW = 3 * 1000000 << 8;
    config.drive.loss_per_ampere_uW_A = 1000000000;
    k = constants_of(&config);
    TEST_ASSERT_EQUAL_INT32(122, k.negligible_power_b); /* 2e6 2^-14 = 122.07 */
    TEST_ASSERT_EQUAL_INT32(666666, k.loss_b);
    config.rotor.sensor = CONFIG_ROTOR_ENCODER;
    TEST_ASSERT_EQUAL_INT32(0, constants_of(&config).hall_angle_b);
}

/* With 60 V and 1 kA the shift of voltage is 7, so that 100 Ohm are 100 2^29 and 2 kW an ampere
 * 1.3e6 2^7. */
void test_resistance_and_loss_of_the_bridge_end_at_26_bits(void)
{
    config_t config = round_numbers();
    config.motor.flux_linkage_nWb = 1000000;
    config.battery.max_voltage_mV = 60000;
    config.drive.loss_resistance_uOhm = 100000000;
    config.drive.loss_per_ampere_uW_A = 2000000000;
    const motor_constants_t k = constants_of(&config);
    TEST_ASSERT_EQUAL_INT32(7, k.voltage_shift);
    TEST_ASSERT_EQUAL_INT32((1 << 26) - 1, k.loss_resistance_b);
    TEST_ASSERT_EQUAL_INT32((1 << 26) - 1, k.loss_b);
}

/* Twice the speed and a quarter of the flux: shifts of 1 for voltage, -1 for speed, and 2 + 1 + 1 +
 * 1
 * - 3 for torque. */
void test_every_shift_counts_in_the_constants_with_its_sign(void)
{
    config_t config = round_numbers();
    config.motor.max_speed_mrad_s = 1 << 21;
    config.motor.flux_linkage_nWb = 250000000;
    config.motor.flux_coefficient_ppm_K = -1000;
    config.motor.resistance_coefficient_ppm_K = 1000;
    config.motor.iron_loss_resistance_mOhm = 10000;
    config.motor.iron_loss_resistance_slope_nOhm_s = 1000000;
    config.motor.friction_torque_mNm = 1000;
    config.motor.viscous_friction_uNm_s = 1000000;
    config.drive.pwm_frequency_Hz = 50000;
    const motor_constants_t k = constants_of(&config);
    TEST_ASSERT_EQUAL_INT32(1, k.voltage_shift);
    TEST_ASSERT_EQUAL_INT32(-1, k.speed_shift);
    TEST_ASSERT_EQUAL_INT32(2, k.torque_shift);
    /* 2^58 / 10^9 a nanoweber and 2^68 / 10^12 a nanohenry: 1/4 Wb and 1 uH as the constants. */
    TEST_ASSERT_EQUAL_INT32(k.flux_b, exact(1, 58 - 2 - k.flux_unit_shift, 1));
    TEST_ASSERT_EQUAL_INT32(k.inductance_d_b, exact(1, 68 - k.inductance_unit_shift, 1000000000));
    TEST_ASSERT_EQUAL_INT32(exact(1, 39, 100000000), k.resistance_rise_b); /* 1 mOhm, 1e-3 */
    TEST_ASSERT_EQUAL_INT32(exact(1, 42 - 2, 100000), k.flux_fall_b);      /* 1/4 Wb, 1e-3 */
    TEST_ASSERT_EQUAL_INT32(exact(10, 15, 1), k.iron_q16_b);
    TEST_ASSERT_EQUAL_INT32(exact(1, 40, 1000000), k.iron_slope_q16_b);
    TEST_ASSERT_EQUAL_INT32(exact(2, 10, 1), k.coulomb_step_q8_b);
    TEST_ASSERT_EQUAL_INT32(exact(1, 27, 4), k.viscous_b);
    TEST_ASSERT_EQUAL_INT32(exact(1, 49, 100000000), k.hall_angle_b);
}
