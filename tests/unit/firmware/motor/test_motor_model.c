/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "motor/motor_model.h"
#include "paper_vehicle.h"
#include "random_values.h"
#include "reference_motor.h"
#include "torque_model.h"
#include "unity.h"

/* Rounding stays below 0.1 % of rated torque and 20 mA (motor_model.h). */
static double torque_tolerance_mNm(const config_t *config)
{
    return 1e-3 * config->motor.rated_torque_mNm;
}

enum { CURRENT_TOLERANCE_mA = 20, ROUNDS = 20000 };

void setUp(void) {}

void tearDown(void) {}

static motor_current_t currents(int32_t i_d_mA, int32_t i_q_mA)
{
    const motor_current_t out = {.d_mA = i_d_mA, .q_mA = i_q_mA};
    return out;
}

static int32_t torque_of_mNm(const motor_model_t *model, motor_current_t i)
{
    return motor_model_torque_mNm(model, motor_model_point(model, i));
}

static motor_current_t currents_of(const reference_point_t *point)
{
    return currents((int32_t)lround(point->i_d_a * 1e3), (int32_t)lround(point->i_q_a * 1e3));
}

/* Coulomb friction is constant from 0.5 rad/s on and proportional to speed below. */
static double friction_mNm(const config_t *config, double speed_mrad_s)
{
    const double share = fmax(-1.0, fmin(1.0, speed_mrad_s / 500.0));
    return config->motor.friction_torque_mNm * share +
           config->motor.viscous_friction_uNm_s * speed_mrad_s * 1e-6;
}

static void compare_torque_at_random_currents(const config_t *config, uint64_t seed)
{
    random_t random = random_seeded(seed);
    const double most_a = config->motor.max_phase_current_mA * 1e-3;
    for (int n = 0; n < ROUNDS; n++) {
        const int32_t top = config->motor.max_speed_mrad_s;
        const int32_t speed_mrad_s = random_between(&random, -top, top);
        const int32_t temperature_cC = random_between(&random, -2000, 15000);
        const reference_motor_t motor = reference_motor(config, speed_mrad_s, temperature_cC);
        const reference_point_t point = reference_point(
            &motor, random_real(&random, -most_a, most_a), random_real(&random, -most_a, most_a));

        const motor_model_t model = model_at(config, speed_mrad_s, temperature_cC);
        const int32_t torque_mNm = torque_of_mNm(&model, currents_of(&point));
        TEST_ASSERT_DOUBLE_WITHIN(torque_tolerance_mNm(config),
                                  point.torque_nm * 1e3 - friction_mNm(config, speed_mrad_s),
                                  torque_mNm);
    }
}

void test_the_torque_of_any_currents_of_a_surface_magnet_motor_is_that_of_the_circuit(void)
{
    const config_t config = paper_vehicle();
    compare_torque_at_random_currents(&config, 11);
}

void test_the_torque_of_any_currents_of_a_salient_motor_is_that_of_the_circuit(void)
{
    const config_t config = salient_vehicle();
    compare_torque_at_random_currents(&config, 12);
}

void test_the_torque_of_any_currents_without_iron_loss_is_that_of_the_circuit(void)
{
    config_t config = salient_vehicle();
    config.motor.iron_loss_resistance_mOhm = 0;
    config.motor.iron_loss_resistance_slope_nOhm_s = 0;
    compare_torque_at_random_currents(&config, 13);
}

/* At i_d = 0, from random torque currents; shaft torque in, terminal current out. */
static void compare_current_of_random_torques(const config_t *config, uint64_t seed)
{
    random_t random = random_seeded(seed);
    const double most_a = config->motor.max_phase_current_mA * 1e-3;
    for (int n = 0; n < ROUNDS; n++) {
        const int32_t top = config->motor.max_speed_mrad_s;
        const int32_t speed_mrad_s = random_between(&random, -top, top);
        const int32_t temperature_cC = random_between(&random, -2000, 15000);
        const reference_motor_t motor = reference_motor(config, speed_mrad_s, temperature_cC);
        const reference_point_t point =
            reference_point_without_i_d(&motor, random_real(&random, -most_a, most_a));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, point.i_d_a);

        const motor_model_t model = model_at(config, speed_mrad_s, temperature_cC);
        const double shaft_mNm = point.torque_nm * 1e3 - friction_mNm(config, speed_mrad_s);
        const int32_t current_mA = model_q_mA(&model, (int32_t)lround(shaft_mNm), 0);
        TEST_ASSERT_DOUBLE_WITHIN(CURRENT_TOLERANCE_mA + 2e-4 * fabs(point.i_q_a) * 1e3,
                                  point.i_q_a * 1e3, current_mA);
    }
}

void test_the_current_of_any_torque_of_a_surface_magnet_motor_is_that_of_the_circuit(void)
{
    const config_t config = paper_vehicle();
    compare_current_of_random_torques(&config, 21);
}

void test_the_current_of_any_torque_of_a_salient_motor_is_that_of_the_circuit(void)
{
    const config_t config = salient_vehicle();
    compare_current_of_random_torques(&config, 22);
}

/* Random torque currents with any i_d that leaves at least 60 % of the flux. Torque has two current
 * roots; the root compared is the one that is zero at zero torque. */
static void compare_current_at_any_i_d(const config_t *config, uint64_t seed)
{
    random_t random = random_seeded(seed);
    const double most_a = config->motor.max_phase_current_mA * 1e-3;
    int compared = 0;
    for (int n = 0; n < ROUNDS; n++) {
        const int32_t top = config->motor.max_speed_mrad_s;
        const int32_t speed_mrad_s = random_between(&random, -top, top);
        const reference_motor_t motor = reference_motor(config, speed_mrad_s, 2500);
        const double i_qt_a = random_real(&random, -most_a, most_a);
        const reference_point_t point =
            reference_point(&motor, random_real(&random, -most_a, most_a), i_qt_a);
        const double saliency_h = motor.l_d_h - motor.l_q_h;
        if (motor.psi_wb + saliency_h * point.i_d_a < 0.6 * motor.psi_wb) {
            continue;
        }
        compared++;
        const motor_model_t model = model_at(config, speed_mrad_s, 2500);
        const double shaft_mNm = point.torque_nm * 1e3 - friction_mNm(config, speed_mrad_s);
        const int32_t i_d_mA = (int32_t)lround(point.i_d_a * 1e3);
        /* Residual of four iterations: the fourth power of the share of the flux that the iron
         * branch shifts. */
        const double share =
            fabs(saliency_h * motor.w_rad_s * motor.l_q_h * motor.iron_siemens * i_qt_a) /
            (motor.psi_wb + saliency_h * point.i_d_a);
        const double left_mA = 2.0 * pow(share, 4.0) * fabs(i_qt_a) * 1e3;
        TEST_ASSERT_DOUBLE_WITHIN(CURRENT_TOLERANCE_mA + left_mA + 4e-4 * fabs(point.i_q_a) * 1e3,
                                  point.i_q_a * 1e3,
                                  model_q_mA(&model, (int32_t)lround(shaft_mNm), i_d_mA));
    }
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 2, compared);
}

void test_the_current_of_any_torque_at_any_i_d_is_that_of_the_circuit(void)
{
    const config_t paper = paper_vehicle();
    const config_t salient = salient_vehicle();
    compare_current_at_any_i_d(&paper, 23);
    compare_current_at_any_i_d(&salient, 24);
}

void test_current_is_bounded_and_has_the_sign_of_the_torque_where_i_d_cancels_the_flux(void)
{
    /* psi + (L_d - L_q) i_d is zero at 0.09 Wb / 0.4 mH = 225 A and negative above. */
    const config_t config = salient_vehicle();
    const motor_model_t model = model_at(&config, 0, 2500);
    for (int32_t i_d_mA = 160000; i_d_mA <= 400000; i_d_mA += 1000) {
        const int32_t driving_mA = model_q_mA(&model, 100000, i_d_mA);
        const int32_t braking_mA = model_q_mA(&model, -100000, i_d_mA);
        TEST_ASSERT_TRUE(driving_mA > 0);
        TEST_ASSERT_INT32_WITHIN(10, -driving_mA, braking_mA);
        /* 100 Nm over 3/2 * 4 * a quarter of 0.09 Wb */
        TEST_ASSERT_TRUE(driving_mA <= 740741 + 100);
    }
    TEST_ASSERT_INT32_WITHIN(100, 740741, model_q_mA(&model, 100000, 400000));
}

static void compare_round_trip(const config_t *config, uint64_t seed)
{
    random_t random = random_seeded(seed);
    for (int n = 0; n < ROUNDS; n++) {
        const int32_t top = config->motor.max_speed_mrad_s;
        const motor_model_t model = model_at(config, random_between(&random, -top, top),
                                             random_between(&random, -2000, 15000));
        const int32_t most = config->motor.max_torque_mNm;
        const int32_t torque_mNm = random_between(&random, -most, most);
        const int32_t i_d_mA = random_between(&random, -config->motor.max_phase_current_mA / 2, 0);
        const int32_t current_mA = model_q_mA(&model, torque_mNm, i_d_mA);
        TEST_ASSERT_DOUBLE_WITHIN(torque_tolerance_mNm(config), torque_mNm,
                                  torque_of_mNm(&model, currents(i_d_mA, current_mA)));
    }
}

void test_torque_of_the_current_of_a_torque_is_that_torque(void)
{
    const config_t paper = paper_vehicle();
    const config_t salient = salient_vehicle();
    compare_round_trip(&paper, 31);
    compare_round_trip(&salient, 32);
}

void test_current_has_the_sign_of_the_torque_where_saliency_cancels_the_flux(void)
{
    /* With this iron resistance i_dt is as large as i_qt, and the flux of the linear model would be
     * zero: (psi - c x) x has its largest value at half of the flux, which lies below this torque.
     * So the current is twice that of the magnet alone, times 1 + a^2. */
    config_t config = salient_vehicle();
    config.motor.friction_torque_mNm = 0;
    config.motor.viscous_friction_uNm_s = 0;
    config.motor.iron_loss_resistance_mOhm = 1000;
    config.motor.iron_loss_resistance_slope_nOhm_s = 0;
    const motor_model_t model = model_at(&config, 400000, 2500); /* w L_q / R_i = 1.04 */
    const double magnet_alone_mA = 200000.0 / (1.5 * 4 * 0.09);
    const double net_mA =
        model_q_mA(&model, 200000, 0) - model_current_mA(&model, model.iron_current_b);
    TEST_ASSERT_TRUE(net_mA > 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * magnet_alone_mA,
                              2.0 * magnet_alone_mA * model.one_plus_a2 / SCALED_ONE, net_mA);
    TEST_ASSERT_TRUE(model_q_mA(&model, -200000, 0) <
                     model_current_mA(&model, model.iron_current_b));
}

void test_rated_current_of_the_paper_s_motor_gives_rated_torque_at_standstill(void)
{
    /* 30 A rms, 42.426 A peak: 3/2 * 23 * 0.0204 * 42.426 = 29.860 Nm (physics section 1). */
    const config_t config = paper_vehicle();
    const motor_model_t model = model_at(&config, 0, 2500);
    TEST_ASSERT_INT32_WITHIN(30, 29860, torque_of_mNm(&model, currents(0, 42426)));
}

void test_iron_loss_brakes_at_zero_current(void)
{
    /* At 300 r/min, w = 722.57: R_i = 5.8354 Ohm, w psi = 14.740 V, iron current 2.5260 A, a = w L
     * / R_i = 0.009411; torque -3/2 * 23 * 0.0204 * 2.5260 / (1 + a^2) = -1.7776 Nm. */
    const config_t config = paper_vehicle();
    const motor_model_t forward = model_at(&config, mrad_s_of_rpm(300.0), 2500);
    const motor_model_t backward = model_at(&config, -mrad_s_of_rpm(300.0), 2500);
    TEST_ASSERT_INT32_WITHIN(5, -1778, torque_of_mNm(&forward, currents(0, 0)));
    TEST_ASSERT_INT32_WITHIN(5, 1778, torque_of_mNm(&backward, currents(0, 0)));
    TEST_ASSERT_DOUBLE_WITHIN(2.0, 2526.0, model_current_mA(&forward, forward.iron_current_b));
    TEST_ASSERT_DOUBLE_WITHIN(2.0, 14740.0, model_voltage_mV(&forward, forward.emf_b));
}

static double resistance_uOhm(const config_t *config, int32_t temperature_cC)
{
    const motor_model_t model = model_at(config, 0, temperature_cC);
    return model_resistance_uOhm(&model);
}

static double flux_nWb(const config_t *config, int32_t temperature_cC)
{
    const motor_model_t model = model_at(config, 0, temperature_cC);
    return model_flux_nWb(&model);
}

void test_resistance_rises_by_39_3_percent_over_100_kelvin(void)
{
    const config_t config = paper_vehicle(); /* 31 mOhm at 25 degC, 3930 ppm/K */
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 31000.0, resistance_uOhm(&config, 2500));
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 43183.0, resistance_uOhm(&config, 12500));
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 25518.0, resistance_uOhm(&config, -2000));
}

void test_flux_falls_by_11_percent_over_100_kelvin_with_a_coefficient_of_minus_1100_ppm(void)
{
    config_t config = paper_vehicle(); /* 20.4 mWb at 25 degC */
    TEST_ASSERT_DOUBLE_WITHIN(100.0, 20400000.0, flux_nWb(&config, 12500));
    config.motor.flux_coefficient_ppm_K = -1100;
    TEST_ASSERT_DOUBLE_WITHIN(100.0, 20400000.0, flux_nWb(&config, 2500));
    TEST_ASSERT_DOUBLE_WITHIN(100.0, 18156000.0, flux_nWb(&config, 12500));
    TEST_ASSERT_DOUBLE_WITHIN(100.0, 21409800.0, flux_nWb(&config, -2000));
    /* 20 Nm take 20 / (1.5 * 23 * 0.018156) A, 30 A make 1.5 * 23 * 0.018156 * 30 Nm. */
    const motor_model_t hot = model_at(&config, 0, 12500);
    TEST_ASSERT_INT32_WITHIN(2, 31929, model_q_mA(&hot, 20000, 0));
    TEST_ASSERT_INT32_WITHIN(2, 18791, torque_of_mNm(&hot, currents(0, 30000)));
}

void test_resistance_and_flux_stay_positive_at_any_temperature(void)
{
    config_t config = paper_vehicle();
    config.motor.flux_coefficient_ppm_K = -10000;
    TEST_ASSERT_DOUBLE_WITHIN(100.0, 2040000.0, flux_nWb(&config, INT32_MAX));
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 3100.0, resistance_uOhm(&config, -100000));
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 3100.0, resistance_uOhm(&config, INT32_MIN));
    TEST_ASSERT_TRUE(resistance_uOhm(&config, INT32_MAX) > 31000.0);
}

static void compare_voltage(const config_t *config, uint64_t seed)
{
    random_t random = random_seeded(seed);
    const double most_a = config->motor.max_phase_current_mA * 1e-3;
    for (int n = 0; n < ROUNDS; n++) {
        const int32_t top = config->motor.max_speed_mrad_s;
        const int32_t speed_mrad_s = random_between(&random, -top, top);
        const int32_t temperature_cC = random_between(&random, -2000, 15000);
        const reference_motor_t motor = reference_motor(config, speed_mrad_s, temperature_cC);
        const double i_dt_a = random_real(&random, -most_a, most_a);
        const double i_qt_a = random_real(&random, -most_a, most_a);
        const reference_point_t point = reference_point(&motor, i_dt_a, i_qt_a);
        const double u_d_v =
            motor.resistance_ohm * point.i_d_a - motor.w_rad_s * motor.l_q_h * i_qt_a;
        const double u_q_v = motor.resistance_ohm * point.i_q_a +
                             motor.w_rad_s * (motor.l_d_h * i_dt_a + motor.psi_wb);

        const motor_model_t model = model_at(config, speed_mrad_s, temperature_cC);
        const motor_point_t at = model_point(&model, point.i_d_a * 1e3, point.i_q_a * 1e3);
        const double u_d_mV = model_voltage_mV(&model, motor_model_u_d_b(&model, at));
        const double u_q_mV = model_voltage_mV(&model, motor_model_u_q_b(&model, at));
        const double forward = speed_mrad_s >= 0 ? 1.0 : -1.0;
        /* 1e-4 of the largest voltage. */
        const double volts = 1e-4 * model_voltage_mV(&model, 1 << 23);
        TEST_ASSERT_DOUBLE_WITHIN(volts, u_d_v * 1e3, u_d_mV);
        TEST_ASSERT_DOUBLE_WITHIN(volts, u_q_v * 1e3 * forward, u_q_mV);
    }
}

void test_the_voltage_of_any_currents_is_that_of_the_circuit(void)
{
    const config_t paper = paper_vehicle();
    const config_t salient = salient_vehicle();
    compare_voltage(&paper, 41);
    compare_voltage(&salient, 42);
}

void test_torque_saturates_at_any_currents_and_speed(void)
{
    const config_t config = salient_vehicle();
    const int32_t ends[] = {INT32_MIN, -1, 0, 1, INT32_MAX};
    for (int s = 0; s < 5; s++) {
        const motor_model_t model = model_at(&config, ends[s], 2500);
        for (int d = 0; d < 5; d++) {
            for (int q = 0; q < 5; q++) {
                const motor_current_t i = currents(ends[d], ends[q]);
                TEST_ASSERT_INT32_WITHIN(1000000000, 0, torque_of_mNm(&model, i));
                (void)model_q_mA(&model, ends[q], ends[d]);
            }
        }
    }
}

void test_torque_changes_sign_with_speed_and_q_current(void)
{
    const config_t config = salient_vehicle();
    random_t random = random_seeded(61);
    for (int n = 0; n < ROUNDS; n++) {
        const int32_t speed_mrad_s = random_between(&random, 0, config.motor.max_speed_mrad_s);
        const int32_t i_d_mA = random_between(&random, -400000, 400000);
        const int32_t i_q_mA = random_between(&random, -400000, 400000);
        const motor_model_t forward = model_at(&config, speed_mrad_s, 2500);
        const motor_model_t backward = model_at(&config, -speed_mrad_s, 2500);
        TEST_ASSERT_EQUAL_INT32(torque_of_mNm(&forward, currents(i_d_mA, i_q_mA)),
                                -torque_of_mNm(&backward, currents(i_d_mA, -i_q_mA)));
    }
}

void test_friction_opposes_the_rotation_and_is_zero_at_standstill(void)
{
    config_t config = paper_vehicle();
    config.motor.friction_torque_mNm = 500;
    config.motor.viscous_friction_uNm_s = 10000; /* 10 mNm at 1 rad/s */
    const int32_t speeds_mrad_s[] = {0, 20000, -20000, 250};
    const double friction_mNm_at[] = {0.0, 700.0, -700.0, 252.5}; /* 500 + 20 * 10; half, 2.5 */
    for (int k = 0; k < 4; k++) {
        const motor_model_t model = model_at(&config, speeds_mrad_s[k], 2500);
        TEST_ASSERT_DOUBLE_WITHIN(0.5, friction_mNm_at[k], model_friction_mNm(&model));
    }
}
