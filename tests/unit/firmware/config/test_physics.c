/* SPDX-License-Identifier: Apache-2.0 */
/* Ratios that no drive has: the first value beyond each is refused, the last one within is not. */
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "derive.h"
#include "refusal.h"
#include "unity.h"

void setUp(void)
{
    config = CONFIG_LU2013;
}

void tearDown(void) {}

static void assert_accepted(void)
{
    TEST_ASSERT_TRUE(derive(&config));
    const config_result_t result = sealed_result();
    TEST_ASSERT_EQUAL_STRING("", result.field);
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, result.code);
}

static void assert_broken(const char *words)
{
    (void)derive(&config);
    assert_relation(words);
}

/* 67.021 rad/s times 23 pole pairs. */
static double top_w_rad_s(void)
{
    return config.motor.max_speed_mrad_s * 1e-3 * config.motor.pole_pairs;
}

void test_one_inductance_is_at_most_sixteen_times_the_other(void)
{
    config.motor.type = CONFIG_MOTOR_IPMSM;
    config.motor.phase_resistance_uOhm = 10000; /* L_d / R longer than four periods */
    config.motor.d_inductance_nH = 4750;
    config.motor.q_inductance_nH = 76000;
    assert_accepted();
    config.motor.d_inductance_nH--;
    assert_broken("motor.q_inductance_nH within a quarter of and 16 times");
    config.motor.type = CONFIG_MOTOR_IPMSM;
    config.motor.d_inductance_nH = 100;
    config.motor.q_inductance_nH = 700000;
    assert_broken("motor.q_inductance_nH within a quarter of and 16 times");
    config.motor.type = CONFIG_MOTOR_IPMSM;
    config.current_loop.bandwidth_Hz = 100;
    config.motor.max_phase_current_mA = 50000; /* leaves flux at any i_d */
    config.motor.d_inductance_nH = 4 * config.motor.q_inductance_nH;
    assert_accepted();
    config.motor.d_inductance_nH++;
    assert_broken("motor.q_inductance_nH within a quarter of and 16 times");
}

void test_magnets_make_a_sixteenth_of_the_flux_by_saliency(void)
{
    /* 0.2 mH at 75 A: 15 mWb. */
    config.motor.type = CONFIG_MOTOR_IPMSM;
    config.motor.q_inductance_nH = config.motor.d_inductance_nH + 200000;
    config.motor.iron_loss_resistance_mOhm = 0;
    config.motor.iron_loss_resistance_slope_nOhm_s = 0;
    config.current_loop.bandwidth_Hz = 200;
    memset(config.current_map.current_d_lsb, 0, sizeof config.current_map.current_d_lsb);
    config.motor.flux_linkage_nWb = 937500;
    assert_accepted();
    config.motor.flux_linkage_nWb--;
    assert_broken("motor.flux_linkage_nWb at least 1/16");
}

void test_the_winding_s_time_constant_is_at_most_16384_periods(void)
{
    /* 76 uH at 20 kHz over 16 384: 92.8 uOhm. */
    config.motor.phase_resistance_uOhm = 93;
    config.drive.loss_resistance_uOhm = 0;
    (void)derive(&config);
    TEST_ASSERT_NOT_EQUAL_INT(CONFIG_RESULT_RELATION, sealed_result().code);
    config.motor.phase_resistance_uOhm = 92;
    assert_broken("L / R at most 16384 PWM periods");
}

/* Four times the inductance, and weak magnets, so that drag and current are no matter. */
static void weak_magnets_and_iron(int32_t iron_mOhm)
{
    config.motor.flux_linkage_nWb = 2500000;
    config.motor.d_inductance_nH *= 4;
    config.motor.q_inductance_nH *= 4;
    config.current_loop.bandwidth_Hz = 200;
    config.motor.iron_loss_resistance_slope_nOhm_s = 0;
    config.motor.iron_loss_resistance_mOhm = iron_mOhm;
}

void test_the_iron_branch_takes_at_most_half_at_top_speed(void)
{
    const double twice_mOhm = 2000.0 * top_w_rad_s() * 4.0 * config.motor.d_inductance_nH * 1e-9;
    weak_magnets_and_iron((int32_t)ceil(twice_mOhm) + 1);
    assert_accepted();
    config = CONFIG_LU2013;
    weak_magnets_and_iron((int32_t)floor(twice_mOhm) - 1);
    assert_broken("motor.iron_loss_resistance at least twice the reactance");
}

/* A slope whose constant left its format drove with 19 % too much. */
void test_the_iron_resistance_has_a_largest_value(void)
{
    const double largest_ohm =
        2048.0 * config.battery.max_voltage_mV / (double)config.motor.max_phase_current_mA;
    config.motor.iron_loss_resistance_mOhm = (int32_t)(largest_ohm * 999.0);
    config.motor.iron_loss_resistance_slope_nOhm_s = 0;
    assert_accepted();
    config.motor.iron_loss_resistance_mOhm = (int32_t)(largest_ohm * 1001.0);
    config.motor.iron_loss_resistance_slope_nOhm_s = 0;
    assert_broken("motor.iron_loss_resistance at most 2048 times");
    config.motor.iron_loss_resistance_mOhm = 0;
    config.motor.iron_loss_resistance_slope_nOhm_s = 2000000000;
    assert_broken("motor.iron_loss_resistance at most 2048 times");
}

/* Half of 58.4 V over 75 A: 389 mOhm, also without a constant part. */
void test_the_iron_resistance_does_not_vanish_at_a_hundredth_of_the_top_speed(void)
{
    const double slow_rad_s = top_w_rad_s() / 100.0;
    config.motor.flux_linkage_nWb = 2500000; /* so that drag is no matter */
    config.motor.iron_loss_resistance_mOhm = 0;
    config.motor.iron_loss_resistance_slope_nOhm_s = (int32_t)(0.392 / slow_rad_s * 1e9);
    assert_accepted();
    config.motor.flux_linkage_nWb = 2500000;
    config.motor.iron_loss_resistance_mOhm = 0;
    config.motor.iron_loss_resistance_slope_nOhm_s = (int32_t)(0.387 / slow_rad_s * 1e9);
    assert_broken("motor.iron_loss_resistance at a hundredth");
}

void test_drag_is_at_most_half_of_the_largest_torque(void)
{
    config.motor.iron_loss_resistance_mOhm = 0;
    config.motor.iron_loss_resistance_slope_nOhm_s = 0;
    config.motor.friction_torque_mNm = 20000;
    assert_accepted();
    config.motor.friction_torque_mNm = 20001;
    assert_broken("within half of motor.max_torque_mNm");
    /* 75 A make 1.5 23 20.4 mWb 75 A = 52.79 N m. */
    config.motor.max_torque_mNm = 80000;
    config.motor.iron_loss_resistance_mOhm = 0;
    config.motor.iron_loss_resistance_slope_nOhm_s = 0;
    config.motor.friction_torque_mNm = 26390;
    assert_accepted();
    config.motor.friction_torque_mNm = 26395;
    assert_broken("of what motor.max_phase_current_mA makes");
    /* 20 N m at 67.021 rad/s. */
    config.motor.iron_loss_resistance_mOhm = 0;
    config.motor.iron_loss_resistance_slope_nOhm_s = 0;
    config.motor.viscous_friction_uNm_s = 298500;
    assert_broken("within half of motor.max_torque_mNm");
    /* 1.5 p psi (w psi / R): 22 N m of 31.4 V over 1 ohm. */
    config.motor.iron_loss_resistance_mOhm = 1000;
    config.motor.iron_loss_resistance_slope_nOhm_s = 0;
    assert_broken("within half of motor.max_torque_mNm");
}

void test_surface_magnets_make_a_thirty_second_of_the_voltage_at_top_speed(void)
{
    /* 58.4 V / 32 at 1541.5 rad/s: 1183.9 uWb; the drop at 75 A is 8.8 V. */
    config.motor.flux_linkage_nWb = 1184500;
    assert_accepted();
    config.motor.flux_linkage_nWb = 1183500;
    assert_broken("back-EMF at motor.max_speed_mrad_s at least 1/32");
}

void test_a_tenth_of_flux_and_resistance_is_left_at_the_ends_of_the_temperatures(void)
{
    /* 125 K above the reference: -7 200 ppm/K leave a tenth. */
    config.motor.flux_coefficient_ppm_K = -7150;
    assert_accepted();
    config.motor.flux_coefficient_ppm_K = -7250;
    assert_broken("leave a tenth at the ends of the temperatures");
    config.motor.resistance_coefficient_ppm_K = 10000;
    config.motor.reference_temperature_cC = 15000;
    config.monitor.coldest_ambient_cC = 5000;
    config.monitor.warmest_ambient_cC = 6000;
    assert_broken("leave a tenth at the ends of the temperatures");
}

void test_magnets_too_strong_for_the_format_at_top_speed_are_refused(void)
{
    config.motor.flux_linkage_nWb *= 5;
    config.motor.iron_loss_resistance_mOhm = 0;
    config.motor.iron_loss_resistance_slope_nOhm_s = 0;
    assert_broken("current_loop.flux_pu_q16 fits its format at motor.max_speed_mrad_s");
}
