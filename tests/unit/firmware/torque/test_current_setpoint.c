/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "model.h"
#include "paper_vehicle.h"
#include "random_values.h"
#include "reference_motor.h"
#include "torque/current_setpoint.h"
#include "torque/loss_maps.h"
#include "unity.h"

static config_t config;

void setUp(void)
{
    config = paper_vehicle_without_i_d();
}

void tearDown(void) {}

static current_setpoint_t weakened(int32_t speed_mrad_s, int32_t torque_mNm, int32_t weakening_mA)
{
    const motor_model_t model = model_at(&config, speed_mrad_s, 2500);
    return current_setpoint_step(&model, torque_mNm, weakening_mA);
}

static current_setpoint_t reference(int32_t speed_mrad_s, int32_t torque_mNm)
{
    return weakened(speed_mrad_s, torque_mNm, 0);
}

void test_without_a_map_all_of_the_current_is_in_the_quadrature_axis(void)
{
    TEST_ASSERT_EQUAL_INT32(0, reference(30000, -30000).i_d_mA);
    TEST_ASSERT_EQUAL_INT32(0, reference(-30000, 30000).i_d_mA);
}

void test_the_iron_current_is_added_to_the_torque_current(void)
{
    /* 300 r/min: 30 Nm / 0.7038 = 42.626 A make the torque, times 1 + a^2 = 1.0000886, and 2.5260 A
     * go through the iron: 45.156 A driving, -40.104 A braking. */
    TEST_ASSERT_INT32_WITHIN(20, 45156, reference(mrad_s_of_rpm(300.0), 30000).i_q_mA);
    TEST_ASSERT_INT32_WITHIN(20, -40104, reference(mrad_s_of_rpm(300.0), -30000).i_q_mA);
}

void test_no_torque_takes_just_the_iron_current(void)
{
    TEST_ASSERT_INT32_WITHIN(20, 2526, reference(mrad_s_of_rpm(300.0), 0).i_q_mA);
    TEST_ASSERT_EQUAL_INT32(0, reference(0, 0).i_q_mA);
}

void test_i_d_is_the_map_s_at_the_torque_of_the_airgap(void)
{
    config = salient_vehicle();
    config.motor.friction_torque_mNm =
        5000; /* 5 Nm more at the airgap driving, 5 Nm less braking, besides the viscous part */
    config.motor.viscous_friction_uNm_s = 0;
    for (int32_t torque_mNm = -200000; torque_mNm <= 200000; torque_mNm += 7777) {
        TEST_ASSERT_EQUAL_INT32(loss_maps_d_current_mA(&config, 100000, 2500, torque_mNm + 5000),
                                reference(100000, torque_mNm).i_d_mA);
        TEST_ASSERT_EQUAL_INT32(loss_maps_d_current_mA(&config, -100000, 2500, torque_mNm - 5000),
                                reference(-100000, torque_mNm).i_d_mA);
    }
}

/* Airgap torque, mNm, of terminal currents: the circuit's two equations solved in double precision.
 */
static double torque_of(const reference_motor_t *m, double i_d_a, double i_q_a)
{
    const double g = m->w_rad_s * m->iron_siemens;
    const double i_qt_a =
        (i_q_a - g * (m->l_d_h * i_d_a + m->psi_wb)) / (1.0 + g * g * m->l_d_h * m->l_q_h);
    return reference_point(m, i_d_a + g * m->l_q_h * i_qt_a, i_qt_a).torque_nm * 1e3;
}

void test_the_torque_is_the_one_asked_for_whatever_field_weakening_adds(void)
{
    random_t random = random_seeded(2);
    config = salient_vehicle();
    config.motor.friction_torque_mNm = 0;
    config.motor.viscous_friction_uNm_s = 0;
    int unlimited = 0;
    for (int n = 0; n < 20000; n++) {
        const int32_t speed_mrad_s = random_between(&random, -1200000, 1200000);
        const int32_t torque_mNm = random_between(&random, -150000, 150000);
        const int32_t weakening_mA = -random_between(&random, 0, 121000);
        const current_setpoint_t out = weakened(speed_mrad_s, torque_mNm, weakening_mA);
        const reference_motor_t motor = reference_motor(&config, speed_mrad_s, 2500);
        const double flows_a = (out.i_d_mA + weakening_mA) * 1e-3;
        const double made_mNm = torque_of(&motor, flows_a, out.i_q_mA * 1e-3);
        if (!out.limited) {
            unlimited++;
            TEST_ASSERT_DOUBLE_WITHIN(150.0, torque_mNm, made_mNm); /* 0.1 % */
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(10000, unlimited);
}

void test_a_motor_without_saliency_needs_the_same_i_q_for_any_i_d_but_for_the_iron(void)
{
    /* cross_d = w L / R_i = 9411 ppm at 300 r/min: 20 A of i_d take 0.188 A of the iron current
     * away. */
    TEST_ASSERT_INT32_WITHIN(20, 45156 - 188, weakened(mrad_s_of_rpm(300.0), 30000, -20000).i_q_mA);
}

void test_the_setpoint_leaves_to_the_fast_loop_what_it_adds_itself(void)
{
    config = salient_vehicle();
    TEST_ASSERT_EQUAL_INT32(reference(100000, 50000).i_d_mA,
                            weakened(100000, 50000, -40000).i_d_mA);
    TEST_ASSERT_EQUAL_INT32(reference(100000, 50000).i_d_mA,
                            weakened(100000, 50000, 40000).i_d_mA); /* never adds */
}

void test_map_and_field_weakening_together_stay_above_the_larger_of_the_two(void)
{
    /* Field weakening may take 121.2 A of 500 A; the map wants less for 50 Nm and more for 200 Nm.
     */
    config = salient_vehicle();
    const int32_t most_mA = 121216;
    const int32_t little_mA = reference(100000, 50000).i_d_mA;
    const int32_t much_mA = reference(100000, 200000).i_d_mA;
    TEST_ASSERT_TRUE(little_mA > -most_mA && much_mA < -most_mA);
    TEST_ASSERT_INT32_WITHIN(20, -most_mA, weakened(100000, 50000, -most_mA).i_d_mA - most_mA);
    TEST_ASSERT_INT32_WITHIN(20, much_mA, weakened(100000, 200000, -most_mA).i_d_mA - most_mA);
}

void test_the_phase_current_limit_cuts_the_current_and_says_so(void)
{
    config.motor.max_phase_current_mA = 20000; /* 14.076 Nm at rest */
    const current_setpoint_t driving = reference(0, 30000);
    TEST_ASSERT_EQUAL_INT32(20000, driving.i_q_mA);
    TEST_ASSERT_TRUE(driving.limited);
    const current_setpoint_t braking = reference(0, -30000);
    TEST_ASSERT_EQUAL_INT32(-20000, braking.i_q_mA);
    TEST_ASSERT_TRUE(braking.limited);
    TEST_ASSERT_FALSE(reference(0, 14000).limited);
    TEST_ASSERT_FALSE(reference(0, -14000).limited);
}

static double length_mA(double d_mA, double q_mA)
{
    return sqrt(d_mA * d_mA + q_mA * q_mA);
}

void test_where_the_current_limit_bites_the_torque_shrinks_and_keeps_its_sign(void)
{
    random_t random = random_seeded(3);
    config = salient_vehicle();
    config.motor.friction_torque_mNm = 0;
    config.motor.viscous_friction_uNm_s = 0;
    int limited = 0;
    for (int n = 0; n < 20000; n++) {
        config.motor.max_phase_current_mA = random_between(&random, 130000, 400000);
        const int32_t speed_mrad_s = random_between(&random, -1200000, 1200000);
        const int32_t torque_mNm = random_between(&random, -500000, 500000);
        const int32_t weakening_mA = -random_between(&random, 0, 121000);
        const current_setpoint_t out = weakened(speed_mrad_s, torque_mNm, weakening_mA);
        const double flows_mA = (double)out.i_d_mA + weakening_mA;
        TEST_ASSERT_TRUE(length_mA(flows_mA, out.i_q_mA) <=
                         config.motor.max_phase_current_mA + 1.0);
        if (out.limited) {
            limited++;
            const reference_motor_t motor = reference_motor(&config, speed_mrad_s, 2500);
            const double made_mNm = torque_of(&motor, flows_mA * 1e-3, out.i_q_mA * 1e-3);
            /* Iron drags with at most 6 Nm here. */
            TEST_ASSERT_TRUE(fabs(made_mNm) <= fabs((double)torque_mNm) + 200.0);
            TEST_ASSERT_TRUE(made_mNm * torque_mNm >= 0.0 || fabs(made_mNm) < 6000.0);
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(5000, limited);
}

void test_an_impossible_torque_still_gets_most_of_what_the_circle_holds(void)
{
    /* Ten times the torque: the map's i_d of its last point alone would fill the circle, and leave
     * a motor without i_q. */
    config = salient_vehicle();
    config.motor.max_phase_current_mA = 200000;
    const current_setpoint_t out = reference(0, 2200000);
    TEST_ASSERT_TRUE(out.limited);
    const reference_motor_t motor = reference_motor(&config, 0.0, 2500);
    double best_mNm = 0.0;
    for (double angle = 0.0; angle < 1.57; angle += 0.001) {
        best_mNm = fmax(best_mNm, torque_of(&motor, -200.0 * sin(angle), 200.0 * cos(angle)));
    }
    TEST_ASSERT_TRUE(torque_of(&motor, out.i_d_mA * 1e-3, out.i_q_mA * 1e-3) > 0.85 * best_mNm);
}

void test_the_current_never_exceeds_the_limit_and_never_flips_against_a_torque_beyond_the_iron(void)
{
    random_t random = random_seeded(1);
    for (int n = 0; n < 50000; n++) {
        const int32_t speed_mrad_s = random_between(&random, -67000, 67000);
        const int32_t torque_mNm = random_between(&random, -200000, 200000);
        const current_setpoint_t out = reference(speed_mrad_s, torque_mNm);
        TEST_ASSERT_INT32_WITHIN(config.motor.max_phase_current_mA, 0, out.i_q_mA);
        /* The iron current stays below 4 A at 67 rad/s; its torque below 3 Nm. */
        if (torque_mNm > 3000) {
            TEST_ASSERT_GREATER_THAN_INT32(0, out.i_q_mA);
        }
        if (torque_mNm < -3000) {
            TEST_ASSERT_LESS_THAN_INT32(0, out.i_q_mA);
        }
    }
}
