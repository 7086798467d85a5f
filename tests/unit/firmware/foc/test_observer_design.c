/* SPDX-License-Identifier: Apache-2.0 */
/* The EMF observer's constants. */
#include "foc/observer_design.h"

#include <math.h>

#include "observer_config.h"
#include "unity.h"

enum { LIMIT_Q15 = 31003 /* of the modulation */ };

static config_t config;

void setUp(void)
{
    config = observer_config();
}

void tearDown(void) {}

/* Magnets' flux and current against 2 * 11.384 mWb + 5/4 * 8 mWb. */
void test_flux_linkage_is_a_share_in_q14_that_of_the_current_in_q15(void)
{
    TEST_ASSERT_EQUAL_INT32(5692, observer_design_flux_q14(&config));
    TEST_ASSERT_EQUAL_INT32(8000, observer_design_inductance_q15(&config));
}

/* Iron that saturates: a psi_q that rises twice as steeply at first as the constants' fits no scale
 * of theirs. Magnets' flux and current against 2 * 11.384 mWb + 5/4 * 16 mWb, 42.768 mWb. */
void test_full_scale_is_that_of_the_steepest_psi_q_of_a_flux_map(void)
{
    config_flux_map_t *map = &config.flux_map;
    map->d_points = 2;
    map->q_points = 3;
    map->q_step_mA = 1000;
    map->lsb_log2 = 3;
    const int32_t twice_nWb = 2 * config.motor.q_inductance_nH; /* at 1 A */
    const int16_t rise_lsb = (int16_t)(twice_nWb >> map->lsb_log2);
    const int16_t psi_q_lsb[6] = {0,        (int16_t)(rise_lsb / 2), rise_lsb, 0,
                                  rise_lsb, (int16_t)(rise_lsb + 1)};
    for (int k = 0; k < 6; k++) {
        map->psi_q_lsb[k] = psi_q_lsb[k];
    }
    TEST_ASSERT_INT32_WITHIN(1, lround(11.384 / 42.768 * 16384), observer_design_flux_q14(&config));
    TEST_ASSERT_INT32_WITHIN(1, lround(8.0 / 42.768 * 32768),
                             observer_design_inductance_q15(&config));
}

/* Four times 200 rad/s; 1 rad/s is 1 024 in Q24 a period. */
void test_leak_is_four_times_the_lowest_speed_in_use(void)
{
    TEST_ASSERT_EQUAL_INT32(800 * 1024, observer_design_leak_q24(&config));
    config.rotor.observer_speed_mrad_s = 10001;
    TEST_ASSERT_EQUAL_INT32(409640, observer_design_leak_q24(&config)); /* 409 640.96 */
}

void test_leak_is_at_least_400_a_second_and_at_most_an_eighth_of_a_period(void)
{
    config.rotor.observer_speed_mrad_s = 9999;
    TEST_ASSERT_EQUAL_INT32(400 * 1024, observer_design_leak_q24(&config));
    config.rotor.observer_speed_mrad_s = 60000;
    TEST_ASSERT_EQUAL_INT32(1 << 21, observer_design_leak_q24(&config));
    config.rotor.observer_speed_mrad_s = 2980000; /* 3.0e9, beyond 31 bits */
    config.motor.pole_pairs = 60;
    config.drive.pwm_frequency_Hz = 4000;
    TEST_ASSERT_EQUAL_INT32(1 << 21, observer_design_leak_q24(&config));
}

/* 1 Ohm and 100 A for 1/16 384 s: 6.1 mWb. Rounded to nearest. */
void test_resistance_is_that_of_winding_and_switch_and_at_most_an_eighth(void)
{
    config.motor.phase_resistance_uOhm = 16384 * 5;
    config.drive.loss_resistance_uOhm = 16384 * 2;
    TEST_ASSERT_EQUAL_INT32(700, observer_design_resistance_q15(&config));
    config.motor.phase_resistance_uOhm = 41; /* half of 1 uWb with a switch of as much */
    config.drive.loss_resistance_uOhm = 41;
    TEST_ASSERT_EQUAL_INT32(1, observer_design_resistance_q15(&config));
    config.drive.loss_resistance_uOhm = 40;
    TEST_ASSERT_EQUAL_INT32(0, observer_design_resistance_q15(&config));
    config.motor.phase_resistance_uOhm = 16384 * 50;
    TEST_ASSERT_EQUAL_INT32(4095, observer_design_resistance_q15(&config));
}

/* Whole nanowebers of a period, of the circle and of a phase. */
static double volt_q15(int32_t full_scale_mV)
{
    const double period_nWb = floor(full_scale_mV * 1e6 / 16384.0);
    const double inverse = round(32768.0 / sqrt(3.0)) / 32768.0;
    return floor(floor(floor(period_nWb * LIMIT_Q15 / 32768.0) * inverse) / 1000.0 + 0.5);
}

void test_flux_of_a_period_is_the_circle_of_the_bus_voltage_base(void)
{
    for (int32_t mV = 200000; mV < 202000; mV++) {
        config.drive.voltage_full_scale_mV = mV;
        TEST_ASSERT_EQUAL_INT32((int32_t)volt_q15(mV),
                                observer_design_volt_q15(&config, LIMIT_Q15));
    }
    config.drive.voltage_full_scale_mV = 300000;
    TEST_ASSERT_EQUAL_INT32(8191, observer_design_volt_q15(&config, LIMIT_Q15));
}
