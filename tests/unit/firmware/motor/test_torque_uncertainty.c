/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What the wheel states of its torque estimate, against motors drawn within the limits: a forward
 * model in double precision, in which each has its own magnets, inductances, losses, current
 * sensors and angle, gives the real torque of measured currents.
 */
#include "motor/torque_uncertainty.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "random_values.h"
#include "saturated_vehicle.h"
#include "unity.h"

enum { MOTORS = 10000, ROUNDS = 12 };
static const double SQRT_3 = 1.7320508075688772;
/* 0.05, 0.2, 0.2, 0.02 and 3 degrees. */
static const config_tolerance_t TYPICAL = {.magnet_flux_q15 = 1638,
                                           .inductance_q15 = 6554,
                                           .drag_q15 = 6554,
                                           .current_gain_q15 = 655,
                                           .rotor_angle_rad_q15 = 1716};

static config_t config;
static bool saturates;

static void use(config_t image, config_tolerance_t limits)
{
    config = image;
    config.tolerance = limits;
    saturates = false;
}

void setUp(void)
{
    use(paper_vehicle(), TYPICAL);
}

void tearDown(void) {}

/* ---- the motor in double precision ---- */

/* What one motor has more than its file says, shares and an angle. */
typedef struct {
    double flux, l_d, l_q, drag, gain, angle_rad;
} deviation_t;

static double drawn(random_t *random, int32_t limit_q15)
{
    return random_real(random, -1.0, 1.0) * limit_q15 / 32768.0;
}

static deviation_t any_motor(random_t *random)
{
    const config_tolerance_t *limit = &config.tolerance;
    const deviation_t out = {.flux = drawn(random, limit->magnet_flux_q15),
                             .l_d = drawn(random, limit->inductance_q15),
                             .l_q = drawn(random, limit->inductance_q15),
                             .drag = drawn(random, limit->drag_q15),
                             .gain = drawn(random, limit->current_gain_q15),
                             .angle_rad = drawn(random, limit->rotor_angle_rad_q15)};
    return out;
}

/* Of the currents, without the magnets. */
static double reaction_d_Wb(double d_a, double q_a)
{
    return saturates ? saturated_d_Wb(d_a, q_a) : config.motor.d_inductance_nH * 1e-9 * d_a;
}

static double reaction_q_Wb(double d_a, double q_a)
{
    return saturates ? saturated_q_Wb(d_a, q_a) : config.motor.q_inductance_nH * 1e-9 * q_a;
}

/* Shaft torque of measured terminal currents, forward. */
static double torque_nm(double speed_rad_s, double d_a, double q_a, deviation_t is)
{
    const config_motor_t *m = &config.motor;
    const double w = speed_rad_s * m->pole_pairs;
    const double r_i_ohm =
        1e-3 * m->iron_loss_resistance_mOhm + 1e-9 * m->iron_loss_resistance_slope_nOhm_s * w;
    const double siemens = r_i_ohm > 0.0 ? (1.0 + is.drag) / r_i_ohm : 0.0;
    const double real_d_a = (1.0 + is.gain) * (d_a * cos(is.angle_rad) + q_a * sin(is.angle_rad));
    const double real_q_a = (1.0 + is.gain) * (q_a * cos(is.angle_rad) - d_a * sin(is.angle_rad));
    double i_dt_a = real_d_a;
    double i_qt_a = real_q_a;
    double psi_d = 0.0;
    double psi_q = 0.0;
    for (int n = 0; n < ROUNDS; n++) {
        psi_d = 1e-9 * m->flux_linkage_nWb * (1.0 + is.flux) +
                (1.0 + is.l_d) * reaction_d_Wb(i_dt_a, i_qt_a);
        psi_q = (1.0 + is.l_q) * reaction_q_Wb(i_dt_a, i_qt_a);
        i_dt_a = real_d_a + w * psi_q * siemens;
        i_qt_a = real_q_a - w * psi_d * siemens;
    }
    const double coulomb_nm = 1e-3 * m->friction_torque_mNm * fmin(speed_rad_s / 0.5, 1.0);
    const double friction_nm = coulomb_nm + 1e-6 * m->viscous_friction_uNm_s * speed_rad_s;
    return 1.5 * m->pole_pairs * (psi_d * i_qt_a - psi_q * i_dt_a) - friction_nm * (1.0 + is.drag);
}

/* Root of the mean square of real less estimated torque. */
static double deviation_nm(random_t *random, double speed_rad_s, double d_a, double q_a)
{
    const deviation_t none = {0};
    const double estimate_nm = torque_nm(speed_rad_s, d_a, q_a, none);
    double sum = 0.0;
    for (int n = 0; n < MOTORS; n++) {
        const double error_nm = torque_nm(speed_rad_s, d_a, q_a, any_motor(random)) - estimate_nm;
        sum += error_nm * error_nm;
    }
    return sqrt(sum / MOTORS);
}

/* ---- the firmware ---- */

static double stated_nm(double speed_rad_s, double d_a, double q_a)
{
    motor_constants_t constants;
    motor_constants_init(&constants, &config);
    const motor_current_t i = {.d_mA = (int32_t)lround(d_a * 1e3),
                               .q_mA = (int32_t)lround(q_a * 1e3)};
    const motor_model_t model =
        motor_model_around(&constants, &config, (int32_t)lround(speed_rad_s * 1e3),
                           config.motor.reference_temperature_cC, i);
    return 1e-3 * torque_uncertainty_mNm(&model, motor_model_point(&model, i));
}

/* A mean square of 10 000 draws is within 2 % with four standard deviations. */
static void assert_drawn(random_t *random, double speed_rad_s, double d_a, double q_a, double above)
{
    const double drawn_nm = deviation_nm(random, speed_rad_s, d_a, q_a);
    const double stated = stated_nm(speed_rad_s, d_a, q_a);
    TEST_ASSERT_TRUE(stated >= 0.96 * drawn_nm - 0.002);
    TEST_ASSERT_TRUE(stated <= (1.0 + above) * drawn_nm + 0.002);
}

/* At one i_d, i_q of both signs from zero to the phase current. */
static void assert_along_i_q(double speed_rad_s, double d_a, double above)
{
    random_t random = random_seeded(34);
    const double most_a = 1e-3 * config.motor.max_phase_current_mA;
    const double end_a = sqrt(most_a * most_a - d_a * d_a);
    for (int k = -4; k <= 4; k++) {
        assert_drawn(&random, speed_rad_s, d_a, end_a * k / 4.0, above);
    }
}

/* At rest, at 40 km/h and beyond; with and without field weakening. */
void test_a_surface_magnet_motor_states_the_deviation_of_drawn_motors(void)
{
    for (int k = 0; k < 3; k++) {
        const double d_a = -20.0 * k;
        assert_along_i_q(0.0, d_a, 0.04);
        assert_along_i_q(44.4, d_a, 0.04);
        assert_along_i_q(67.0, d_a, 0.04);
    }
}

void test_a_salient_motor_states_the_deviation_of_drawn_motors(void)
{
    use(salient_vehicle(), TYPICAL);
    for (int k = 0; k < 4; k++) {
        const double d_a = -100.0 * k;
        assert_along_i_q(0.0, d_a, 0.04);
        assert_along_i_q(300.0, d_a, 0.04);
    }
}

/* From zero to the largest torque of either sign, at the current angle of most torque. */
static void assert_along_torque(double speed_rad_s, double above)
{
    static const deviation_t NONE = {0};
    random_t random = random_seeded(34);
    for (int k = -4; k <= 4; k++) {
        const double i_a = 1e-3 * config.motor.max_phase_current_mA * abs(k) / 4.0;
        double d_a = 0.0;
        double q_a = k < 0 ? -i_a : i_a;
        for (int degrees = 1; degrees < 80; degrees++) {
            const double angle = degrees * acos(-1.0) / 180.0;
            const double other_d_a = -i_a * sin(angle);
            const double other_q_a = copysign(i_a * cos(angle), k);
            const double better_nm = torque_nm(speed_rad_s, other_d_a, other_q_a, NONE) -
                                     torque_nm(speed_rad_s, d_a, q_a, NONE);
            d_a = better_nm * k > 0.0 ? other_d_a : d_a;
            q_a = better_nm * k > 0.0 ? other_q_a : q_a;
        }
        assert_drawn(&random, speed_rad_s, d_a, q_a, above);
    }
}

/* Gain and angle are taken with the chords of the fluxes, which change more than saturated iron. */
void test_a_mapped_motor_states_the_deviation_of_drawn_motors(void)
{
    use(saturated_vehicle(), TYPICAL);
    saturates = true;
    assert_along_torque(0.0, 0.08);
    assert_along_torque(300.0, 0.08);
    assert_along_i_q(0.0, -300.0, 0.08);
    assert_along_i_q(300.0, -300.0, 0.08);
}

/* ---- one limit at a time: 3/2 23 0.0204 Wb 40 A = 28.15 N m ---- */

static const double AT_40_A_nm = 1.5 * 23 * 0.0204 * 40.0;

void test_magnets_and_current_gain_take_their_share_of_the_torque(void)
{
    const config_tolerance_t magnets = {.magnet_flux_q15 = 1638};
    use(paper_vehicle(), magnets);
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.05 * AT_40_A_nm / SQRT_3, stated_nm(0.0, 0.0, -40.0));
    const config_tolerance_t gain = {.current_gain_q15 = 655};
    use(paper_vehicle(), gain);
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.02 * AT_40_A_nm / SQRT_3, stated_nm(0.0, 0.0, 40.0));
}

/* The iron takes its current from the magnets, which no sensor measures: zero stays zero. */
void test_a_gain_of_the_sensors_makes_no_torque_where_no_current_flows(void)
{
    const config_tolerance_t gain = {.current_gain_q15 = 16384};
    use(paper_vehicle(), gain);
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.0, stated_nm(44.4, 0.0, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.5 * AT_40_A_nm / SQRT_3, stated_nm(44.4, 0.0, -40.0));
}

/* A turned i_d acts as i_q; without i_d only the cosine counts, which is of second order. */
void test_an_angle_error_makes_torque_of_the_weakening_current(void)
{
    const config_tolerance_t angle = {.rotor_angle_rad_q15 = 1716};
    use(paper_vehicle(), angle);
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.0, stated_nm(0.0, 0.0, 60.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.05236 * AT_40_A_nm / SQRT_3, stated_nm(0.0, -40.0, 0.0));
}

/* Along the current circle the torque is largest where turning does not change it. */
void test_at_most_torque_per_ampere_an_angle_error_does_not_count(void)
{
    const config_tolerance_t angle = {.rotor_angle_rad_q15 = 1716};
    use(salient_vehicle(), angle);
    const double s_h = 0.4e-3;
    const double i_a = 300.0;
    const double d_a = (0.09 - sqrt(0.0081 + 8.0 * s_h * s_h * i_a * i_a)) / (4.0 * s_h);
    const double q_a = sqrt(i_a * i_a - d_a * d_a);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.0, stated_nm(0.0, d_a, q_a));
    /* Field weakening with the same current: -200 A, 223.6 A. */
    const double turned_nm = 6.0 * ((0.09 + s_h * 200.0) * 200.0 - s_h * 223.6 * 223.6);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.05236 * turned_nm / SQRT_3, stated_nm(0.0, -200.0, 223.6));
}

/* Each inductance alone moves the torque by 3/2 p L i_d i_q, also where the two are equal. */
void test_inductances_take_their_share_of_the_reluctance_torque(void)
{
    const config_tolerance_t inductance = {.inductance_q15 = 6554};
    use(salient_vehicle(), inductance);
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.0, stated_nm(0.0, 0.0, 300.0));
    const double each_nm = 0.2 * 6.0 * 100.0 * 200.0;
    TEST_ASSERT_DOUBLE_WITHIN(0.02, each_nm * hypot(0.25e-3, 0.65e-3) / SQRT_3,
                              stated_nm(0.0, -100.0, 200.0));
}

/* Without current the wheel is dragged by w psi/R_i in the iron and by friction. */
void test_drag_is_uncertain_where_no_current_flows(void)
{
    const config_tolerance_t drag = {.drag_q15 = 6554};
    config_t image = paper_vehicle();
    image.motor.friction_torque_mNm = 500;
    image.motor.viscous_friction_uNm_s = 0;
    use(image, drag);
    const double w = 44.4 * 23.0;
    const double iron_nm = 1.5 * 23.0 * 0.0204 * w * 0.0204 / (1.5 + 0.006 * w);
    TEST_ASSERT_DOUBLE_WITHIN(0.004, 0.2 * (iron_nm + 0.5) / SQRT_3, stated_nm(44.4, 0.0, 0.0));
}

/* ---- shape ---- */

void test_without_limits_nothing_is_uncertain(void)
{
    const config_tolerance_t none = {0};
    use(salient_vehicle(), none);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, stated_nm(300.0, -200.0, 200.0));
}

void test_turning_backwards_is_as_uncertain_as_forwards(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(0.002, stated_nm(40.0, -20.0, -30.0), stated_nm(-40.0, -20.0, 30.0));
}

/* Any currents and limits: no overflow, and never negative. */
void test_no_currents_make_it_negative(void)
{
    random_t random = random_seeded(7);
    const config_tolerance_t widest = {16384, 32768, 32768, 16384, 16384};
    for (int n = 0; n < 20000; n++) {
        use(n % 2 == 0 ? paper_vehicle() : salient_vehicle(), widest);
        motor_constants_t constants;
        motor_constants_init(&constants, &config);
        const motor_model_t model =
            motor_model_at(&constants, &config, random_wild(&random), random_wild(&random));
        const motor_current_t i = {.d_mA = random_wild(&random), .q_mA = random_wild(&random)};
        TEST_ASSERT_TRUE(torque_uncertainty_mNm(&model, motor_model_point(&model, i)) >= 0);
    }
}
