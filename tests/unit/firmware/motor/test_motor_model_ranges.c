/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The motor model with constants that are powers of two, so that its results are whole numbers, and
 * at the ends of its ranges (DERIVATIONS.md, Motor model).
 */
#include <math.h>

#include "motor/motor_model.h"
#include "paper_vehicle.h"
#include "unity.h"

enum { MOST_b = 1 << 26, REFERENCE_cC = 2500 };

static motor_constants_t constants;
static config_t config;

/* L_d 1/2, L_q 1, R 1/4, psi 1/2; no iron loss, no friction. */
void setUp(void)
{
    config = paper_vehicle();
    config.motor.pole_pairs = 1;
    config.motor.reference_temperature_cC = REFERENCE_cC;
    constants = (motor_constants_t){
        .current_shift = 4,
        .voltage_shift = 4,
        .resistance_b = SCALED_ONE / 4,
        .inductance_d_b = SCALED_ONE / 2,
        .inductance_q_b = SCALED_ONE,
        .flux_b = SCALED_ONE / 2,
        .torque_factor_q24 = SCALED_ONE,
        .torque_inverse_q24 = SCALED_ONE,
    };
}

void tearDown(void) {}

static motor_model_t model_of(int32_t speed_mrad_s)
{
    return motor_model_at(&constants, &config, speed_mrad_s, REFERENCE_cC);
}

/* ---- the model of a speed ---- */

void test_without_iron_loss_terminal_and_torque_current_are_the_same(void)
{
    const motor_model_t m = model_of(1 << 20);
    TEST_ASSERT_EQUAL_INT32(SCALED_ONE, m.one_plus_a2);
    TEST_ASSERT_EQUAL_INT32(SCALED_ONE, m.inverse_one_plus_a2);
    TEST_ASSERT_EQUAL_INT32(0, m.iron_current_b);
    TEST_ASSERT_EQUAL_INT32(1 << 19, m.voltage_q_b);
    TEST_ASSERT_EQUAL_INT32(SCALED_ONE / 4, m.voltage_q_per_x);
    TEST_ASSERT_EQUAL_INT32(1 << 19, m.voltage_q_per_d);
    /* Also at the reactance and EMF of the highest speed. */
    const motor_model_t fast = model_of(1 << 25);
    TEST_ASSERT_EQUAL_INT32(0, fast.cross_d);
    TEST_ASSERT_EQUAL_INT32(0, fast.cross_q);
    TEST_ASSERT_EQUAL_INT32(0, fast.iron_current_b);
}

/* 4 Ohm less 4 2^-16, so that 2^32 / R_i is a little more than 2^14: a conductance of 1/4. w 2^20:
 * w L_d / R_i = 2^19 / 4, w L_q / R_i = 2^20 / 4, a^2 = 2^(17 + 18 - 24), w psi / R_i = 2^19 / 4.
 */
void test_iron_loss_terms_are_the_reactances_over_the_iron_resistance(void)
{
    constants.iron_q16_b = 4 * 65535;
    const motor_model_t m = model_of(1 << 20);
    TEST_ASSERT_EQUAL_INT32(1 << 17, m.cross_d);
    TEST_ASSERT_EQUAL_INT32(1 << 18, m.cross_q);
    TEST_ASSERT_EQUAL_INT32(1 << 17, m.iron_current_b);
    TEST_ASSERT_EQUAL_INT32(SCALED_ONE + 2048, m.one_plus_a2);
    /* 2^24 / (1 + 2^-13) = 2^24 - 2048 + 1/4 */
    TEST_ASSERT_EQUAL_INT32(SCALED_ONE - 2048, m.inverse_one_plus_a2);
    TEST_ASSERT_EQUAL_INT32(-(1 << 17), m.flux_per_x); /* (L_d - L_q) / 4 */
    TEST_ASSERT_EQUAL_INT32((1 << 19) + (1 << 15), m.voltage_q_b);
    TEST_ASSERT_EQUAL_INT32((1 << 22) + 512 + (1 << 13), m.voltage_q_per_x);
    TEST_ASSERT_EQUAL_INT32((1 << 19) + (1 << 15), m.voltage_q_per_d);
}

/* cross_q / w L_q is the conductance, 2^40 / R_i in steps of 2^8 up to 2^26. */
static int32_t conductance_of(int32_t iron_q16_b)
{
    constants.iron_q16_b = iron_q16_b;
    return model_of(1 << 22).cross_q * 4; /* w L_q = 2^22 */
}

void test_iron_conductance_is_that_of_the_resistance_up_to_four(void)
{
    TEST_ASSERT_EQUAL_INT32(65537 << 8, conductance_of(65535)); /* 65535 65537 = 2^32 - 1 */
    TEST_ASSERT_EQUAL_INT32(214748 << 8, conductance_of(20000));
    TEST_ASSERT_EQUAL_INT32(MOST_b, conductance_of(12000)); /* 357 913 2^8 is more */
    TEST_ASSERT_EQUAL_INT32(MOST_b, conductance_of(1));
    TEST_ASSERT_EQUAL_INT32(0, conductance_of(0));
}

/* 32 768 Ohm and as much by the speed: 2^32 2^-16 Ohm, of which 2^31 - 1 count. */
void test_iron_resistance_counts_up_to_31_bits(void)
{
    constants.iron_q16_b = 1 << 30;
    constants.iron_slope_q16_b = 1 << 30;
    TEST_ASSERT_EQUAL_INT32(2 << 9, model_of(1 << 25).cross_q); /* w L_q = 2 times 2^24 */
}

void test_currents_of_the_iron_loss_end_at_their_limits(void)
{
    constants.iron_q16_b = 1; /* a conductance of 4 */
    constants.inductance_d_b = SCALED_ONE;
    constants.flux_b = SCALED_ONE;
    const motor_model_t m = model_of(1 << 25);
    TEST_ASSERT_EQUAL_INT32(MOST_b - 1, m.cross_d);
    TEST_ASSERT_EQUAL_INT32(MOST_b - 1, m.cross_q);
    TEST_ASSERT_EQUAL_INT32(MOST_b, m.one_plus_a2);
    TEST_ASSERT_EQUAL_INT32(MOTOR_MODEL_MOST_CURRENT_b, m.iron_current_b);
}

void test_speed_ends_at_its_limit_also_beyond_32_bits(void)
{
    TEST_ASSERT_EQUAL_INT32(1 << 24, model_of(1 << 24).speed_b);
    TEST_ASSERT_EQUAL_INT32(1 << 25, model_of(1 << 26).speed_b);
    config.motor.pole_pairs = 2;
    TEST_ASSERT_EQUAL_INT32(1 << 25, model_of(INT32_MAX).speed_b);
    TEST_ASSERT_EQUAL_INT32(1 << 25, model_of(-INT32_MAX).speed_b);
}

void test_friction_ends_at_its_limit_also_beyond_32_bits(void)
{
    constants.coulomb_step_q8_b = 1 << 30;
    constants.viscous_b = 1 << 30;
    TEST_ASSERT_EQUAL_INT32(MOST_b - 1, model_of(1 << 24).friction_b);
}

/* A flux of 1/2 that falls by a 512th a kelvin, 2^15 units and a 100th of it a hundredth. */
void test_flux_falls_with_temperature_down_to_four_units(void)
{
    config.motor.flux_coefficient_ppm_K = -1; /* only its sign counts */
    constants.flux_fall_b = 327 << 16;
    motor_model_t m = motor_model_at(&constants, &config, 0, REFERENCE_cC + 100);
    TEST_ASSERT_EQUAL_INT32(SCALED_ONE / 2 - 32700, m.flux_b);
    m = motor_model_at(&constants, &config, 0, REFERENCE_cC - 100);
    TEST_ASSERT_EQUAL_INT32(SCALED_ONE / 2 + 32700, m.flux_b);
    constants.flux_b = 8;
    m = motor_model_at(&constants, &config, 0, REFERENCE_cC + 100);
    TEST_ASSERT_EQUAL_INT32(4, m.flux_b);
}

/* ---- torque of a point, and back ---- */

/* psi 1/16, L_d - L_q 1/2, w L_q / R_i 1/4, a factor of 3/2. */
static motor_model_t salient_model(void)
{
    constants.torque_factor_q24 = SCALED_ONE / 2 * 3;
    const motor_model_t out = {
        .constants = &constants,
        .config = &config,
        .flux_b = 1 << 20,
        .saliency_b = SCALED_ONE / 2,
        .cross_q = SCALED_ONE / 4,
        .flux_per_x = SCALED_ONE / 8,
        .one_plus_a2 = SCALED_ONE,
        .inverse_one_plus_a2 = SCALED_ONE,
    };
    return out;
}

/* A saliency of one unit, 2^-24, adds two units of flux at an i_d of 2^25. */
void test_a_saliency_of_one_unit_counts(void)
{
    motor_model_t m = salient_model();
    constants.torque_factor_q24 = SCALED_ONE;
    const motor_point_t at = {.d_b = 1 << 25, .x_b = SCALED_ONE};
    m.cross_q = 0;
    m.flux_per_x = 0;
    m.saliency_b = 1;
    TEST_ASSERT_EQUAL_INT32((1 << 20) + 2, motor_model_airgap_b(&m, at));
    TEST_ASSERT_EQUAL_INT32(1 << 20, motor_model_x_of_airgap_b(&m, 1 << 16, 0));
    m.saliency_b = -1;
    TEST_ASSERT_EQUAL_INT32((1 << 20) - 2, motor_model_airgap_b(&m, at));
    TEST_ASSERT_EQUAL_INT32(1 << 20, motor_model_x_of_airgap_b(&m, 1 << 16, 0));
}

/* i_d 2^20, x 2^20: i_dt = 2^20 + 2^18, flux = 2^20 + 2^19 + 2^17; the torque's derivative counts
 * the flux of x twice, 2^17 more. */
void test_derivatives_of_the_torque_are_those_of_flux_times_current(void)
{
    const motor_model_t m = salient_model();
    const motor_point_t at = {.d_b = 1 << 20, .x_b = 1 << 20};
    const int32_t slope_b = (1 << 20) + (1 << 19) + (1 << 18);
    TEST_ASSERT_EQUAL_INT32(slope_b / 2 * 3, motor_model_airgap_per_x(&m, at));
    TEST_ASSERT_EQUAL_INT32((1 << 18) * 3, motor_model_airgap_per_d(&m, at));
    /* -2^19 / (7 2^18) = -2/7 */
    TEST_ASSERT_INT32_WITHIN(1, -4793490, motor_model_x_per_d(&m, at));
}

/* i_d -2^23 leaves a negative flux: a quarter of the magnet's, 2^18, stands for it. */
void test_derivatives_keep_a_quarter_of_the_flux_where_i_d_cancels_it(void)
{
    const motor_model_t m = salient_model();
    const motor_point_t at = {.d_b = -(1 << 23), .x_b = 1 << 17};
    TEST_ASSERT_EQUAL_INT32((1 << 18) / 2 * 3, motor_model_airgap_per_x(&m, at));
    TEST_ASSERT_EQUAL_INT32(-SCALED_ONE / 4, motor_model_x_per_d(&m, at));
}

/* Of (f + c x) x = t the root that is zero at t = 0, 2 t / (f + sqrt(f^2 + 4 c t)); f at least a
 * quarter of the magnet's flux, and so is half of the sum. */
static void assert_current_of_torque(const motor_model_t *m, int32_t airgap_b, int32_t d_b)
{
    const double least = floor(m->flux_b / 4.0);
    const double f = fmax(m->flux_b + ldexp(m->saliency_b, -24) * d_b, least);
    const double under_root = f * f + 4.0 * m->flux_per_x * airgap_b;
    const double sum = fmax(f + sqrt(fmax(under_root, 0.0)), 2.0 * least);
    const double x_b = ldexp(2.0 * airgap_b / sum, 24);
    TEST_ASSERT_DOUBLE_WITHIN(2.0 + 2e-4 * fabs(x_b), x_b,
                              motor_model_x_of_airgap_b(m, airgap_b, d_b));
}

void test_current_of_a_torque_is_the_small_root_with_a_quarter_of_the_flux_at_least(void)
{
    motor_model_t m = salient_model();
    const int32_t D_b[] = {-(1 << 23), -(1 << 21), -(1 << 20), 0, 1 << 20};
    for (int k = 0; k < 5; k++) {
        assert_current_of_torque(&m, 1 << 20, D_b[k]);
        assert_current_of_torque(&m, -(1 << 13), D_b[k]);
        assert_current_of_torque(&m, -(1 << 18), D_b[k]); /* no root */
    }
    /* So few units of flux that one of x would show in it through i_dt. */
    m.flux_b = 64;
    m.saliency_b = MOST_b - 1;
    m.cross_q = MOST_b - 1;
    m.flux_per_x = 0;
    assert_current_of_torque(&m, 16, 0);
}

void test_current_of_a_torque_without_saliency_ends_at_its_limit_also_beyond_32_bits(void)
{
    motor_model_t m = salient_model();
    m.saliency_b = 0;
    m.x_per_airgap_q23 = 1 << 30;
    TEST_ASSERT_EQUAL_INT32((1 << 25) - 1, motor_model_x_of_airgap_b(&m, 1 << 30, 0));
    TEST_ASSERT_EQUAL_INT32(-(1 << 25), motor_model_x_of_airgap_b(&m, -(1 << 30), 0));
    TEST_ASSERT_EQUAL_INT32(128 << 4, motor_model_x_of_airgap_b(&m, 1 << 4, 0));
}

/* ---- signs of the rotation ---- */

/* 2^32 mN m count as 2^31 - 1, of either sign. */
void test_the_largest_torque_and_current_change_their_sign_without_overflow(void)
{
    constants.torque_shift = -2;
    motor_model_t m = model_of(-1);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, motor_model_shaft_mNm(&m, -(1 << 30)));
    constants.torque_shift = 0;
    m = model_of(-1);
    TEST_ASSERT_EQUAL_INT32(1 << 29, motor_model_airgap_of_shaft_b(&m, INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(-(1 << 29), motor_model_airgap_of_shaft_b(&m, INT32_MAX));
    const motor_current_t i = {.d_mA = 0, .q_mA = INT32_MIN};
    TEST_ASSERT_EQUAL_INT32((1 << 25) - 1, motor_model_point(&m, i).x_b);
}

/* ---- bus current ---- */

/* R 1/4, w L_q 1/4; u_q = 2^20 + x / 2 + i_d / 4. */
static motor_model_t model_of_voltages(void)
{
    const motor_model_t out = {
        .constants = &constants,
        .config = &config,
        .one_plus_a2 = SCALED_ONE,
        .resistance_b = SCALED_ONE / 4,
        .reactance_q_b = SCALED_ONE / 4,
        .voltage_q_b = 1 << 20,
        .voltage_q_per_x = SCALED_ONE / 2,
        .voltage_q_per_d = SCALED_ONE / 4,
    };
    return out;
}

/* i_d -2^20, i_q 2^20: u_d = -2^19, u_q = 5 2^18, the sum of products 7 2^14; the switches, 1/16
 * each way, 2^13 more. Three halves of the sum, 184 320, over 48 V 2^4. Switching: |i| = (7/8 +
 * 1/2) 2^20 = 11 2^17 at 2^16 V are 11 2^9, three halves of it 8 448. */
void test_bus_current_is_power_over_the_bus_voltage_and_switching_beside_it(void)
{
    const motor_model_t m = model_of_voltages();
    constants.loss_b = 1 << 16;
    constants.loss_resistance_b = SCALED_ONE / 16;
    const motor_point_t at = {.d_b = -(1 << 20), .x_b = 1 << 20};
    const double motor_mA = ldexp(184320.0 / (48000 << 4), 24 - 4);
    const double switching_mA = ldexp(8448.0 / (48000 << 4), 24 - 4);
    TEST_ASSERT_EQUAL_INT32((int32_t)motor_mA, motor_model_bus_current_mA(&m, at, 48000));
    TEST_ASSERT_EQUAL_INT32((int32_t)switching_mA, motor_model_switching_current_mA(&m, at, 48000));
}

/* Two thirds of c1 |i| + 3/2 c2 |i|^2: 2^16 times 2^20 and 1/16 of 2^40, over 2^24. */
void test_the_loss_of_the_bridge_is_that_of_its_drop_and_of_its_resistance(void)
{
    constants.loss_b = 1 << 16;
    constants.loss_resistance_b = SCALED_ONE / 16;
    TEST_ASSERT_EQUAL_INT32((1 << 12) + (1 << 12), motor_model_bridge_loss_b(&constants, 1 << 20));
    TEST_ASSERT_EQUAL_INT32((1 << 14) + (1 << 16), motor_model_bridge_loss_b(&constants, 1 << 22));
}

/* 2^13 times 2^12 is 2, three halves of it 3; over one unit of voltage 3 2^24. */
void test_a_bus_voltage_of_zero_counts_as_one_unit(void)
{
    motor_model_t m = model_of_voltages();
    m.voltage_q_b = 1 << 13;
    m.voltage_q_per_x = 0;
    const motor_point_t at = {.d_b = 0, .x_b = 1 << 12};
    const int32_t NONE_mV[] = {0, -1, INT32_MIN};
    for (int k = 0; k < 3; k++) {
        TEST_ASSERT_EQUAL_INT32(3 << 20, motor_model_bus_current_mA(&m, at, NONE_mV[k]));
    }
}

/* i_q = 4 x + 2^25 = 5 2^25, u_q = 2^26 - 1 + 4 x = 6 2^25, three halves of 30 2^26 more than 2^31:
 * 2^31 - 1 over 2^30 is two. */
void test_power_ends_at_32_bits(void)
{
    motor_model_t m = model_of_voltages();
    m.one_plus_a2 = MOST_b;
    m.iron_current_b = 1 << 25;
    m.voltage_q_b = MOST_b - 1;
    m.voltage_q_per_x = MOST_b;
    const motor_point_t at = {.d_b = 0, .x_b = 1 << 25};
    TEST_ASSERT_INT32_WITHIN(1, 2 << 20, motor_model_bus_current_mA(&m, at, 1 << 26));
}
