/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "paper_vehicle.h"
#include "random_values.h"
#include "reference_motor.h"
#include "torque/current_setpoint.h"
#include "torque/loss_maps.h"
#include "torque_model.h"
#include "unity.h"

static config_t config;
static int32_t phase_mV;

void setUp(void)
{
    config = paper_vehicle_without_i_d();
    phase_mV = 10000000; /* the voltage always suffices */
}

void tearDown(void) {}

/* The setpoint while field weakening adds weakening_mA to i_d. */
static current_setpoint_t weakened(int32_t speed_mrad_s, int32_t torque_mNm, int32_t weakening_mA)
{
    const motor_model_t model = model_at(&config, speed_mrad_s, 2500);
    const feasible_set_t set = feasible_set_at(&model, phase_mV);
    return current_setpoint_step(&set, torque_mNm, weakening_mA);
}

static current_setpoint_t reference(int32_t speed_mrad_s, int32_t torque_mNm)
{
    return weakened(speed_mrad_s, torque_mNm, 0);
}

void test_d_current_is_zero_with_a_zero_map(void)
{
    TEST_ASSERT_EQUAL_INT32(0, reference(30000, -30000).i_d_mA);
    TEST_ASSERT_EQUAL_INT32(0, reference(-30000, 30000).i_d_mA);
}

void test_the_iron_current_is_added_to_the_torque_current(void)
{
    /* 300 r/min: torque current 30 Nm / 0.7038 = 42.626 A, times 1 + a^2 = 1.0000886, iron current
     * 2.5260 A: 45.156 A driving, -40.104 A braking. */
    TEST_ASSERT_INT32_WITHIN(20, 45156, reference(mrad_s_of_rpm(300.0), 30000).i_q_mA);
    TEST_ASSERT_INT32_WITHIN(20, -40104, reference(mrad_s_of_rpm(300.0), -30000).i_q_mA);
}

void test_q_current_of_zero_torque_is_the_iron_current(void)
{
    TEST_ASSERT_INT32_WITHIN(20, 2526, reference(mrad_s_of_rpm(300.0), 0).i_q_mA);
    TEST_ASSERT_EQUAL_INT32(0, reference(0, 0).i_q_mA);
}

void test_d_current_is_that_of_the_map_at_the_airgap_torque(void)
{
    config = salient_vehicle();
    config.motor.friction_torque_mNm = 5000; /* airgap torque = shaft torque + 5 Nm, forward */
    config.motor.viscous_friction_uNm_s = 0;
    for (int32_t torque_mNm = -200000; torque_mNm <= 200000; torque_mNm += 7777) {
        TEST_ASSERT_EQUAL_INT32(loss_maps_d_current_mA(&config, 100000, 2500, torque_mNm + 5000),
                                reference(100000, torque_mNm).i_d_mA);
        TEST_ASSERT_EQUAL_INT32(loss_maps_d_current_mA(&config, -100000, 2500, torque_mNm - 5000),
                                reference(-100000, torque_mNm).i_d_mA);
    }
}

/* Airgap torque, mNm, of terminal currents, from the circuit in double precision. */
static double torque_of(const reference_motor_t *m, double i_d_a, double i_q_a)
{
    const double g = m->w_rad_s * m->iron_siemens;
    const double i_qt_a =
        (i_q_a - g * (m->l_d_h * i_d_a + m->psi_wb)) / (1.0 + g * g * m->l_d_h * m->l_q_h);
    return reference_point(m, i_d_a + g * m->l_q_h * i_qt_a, i_qt_a).torque_nm * 1e3;
}

void test_torque_of_the_setpoint_is_the_command_at_any_field_weakening(void)
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
        const double i_d_a = (out.i_d_mA + weakening_mA) * 1e-3;
        const double torque_found_mNm = torque_of(&motor, i_d_a, out.i_q_mA * 1e-3);
        if (!out.limited) {
            unlimited++;
            TEST_ASSERT_DOUBLE_WITHIN(150.0, torque_mNm, torque_found_mNm); /* 0.1 % */
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(10000, unlimited);
}

void test_without_saliency_q_current_changes_with_d_current_only_by_the_iron_current(void)
{
    /* w L / R_i = 9411 ppm at 300 r/min: i_d = -20 A reduces the iron current by 0.188 A. */
    TEST_ASSERT_INT32_WITHIN(20, 45156 - 188, weakened(mrad_s_of_rpm(300.0), 30000, -20000).i_q_mA);
}

void test_d_current_setpoint_excludes_the_field_weakening_current(void)
{
    config = salient_vehicle();
    TEST_ASSERT_EQUAL_INT32(reference(100000, 50000).i_d_mA,
                            weakened(100000, 50000, -40000).i_d_mA);
    TEST_ASSERT_EQUAL_INT32(reference(100000, 50000).i_d_mA,
                            weakened(100000, 50000, 40000).i_d_mA); /* counts as zero */
}

void test_map_and_field_weakening_together_stay_on_the_current_circle(void)
{
    /* With 400 A less 1/256 = 398.44 A. The trim is at most 121.2 A: an i_d setpoint of the map's
     * for 50 Nm leaves room for it, one at the circle does not. */
    config = salient_vehicle();
    const int32_t trim_mA = 121216;
    const int32_t map_mA = reference(100000, 50000).i_d_mA;
    TEST_ASSERT_TRUE(map_mA - trim_mA > -398437);
    TEST_ASSERT_INT32_WITHIN(20, map_mA, weakened(100000, 50000, -trim_mA).i_d_mA);
    config.motor.max_phase_current_mA = 130000;
    const int32_t circle_mA = 130000 - 130000 / 256;
    TEST_ASSERT_TRUE(map_mA - trim_mA < -circle_mA);
    TEST_ASSERT_INT32_WITHIN(20, -circle_mA, weakened(100000, 50000, -trim_mA).i_d_mA - trim_mA);
}

void test_phase_current_limit_clamps_the_current_and_sets_limited(void)
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

void test_torque_at_the_phase_current_limit_is_smaller_and_keeps_its_sign(void)
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
        const double i_d_mA = (double)out.i_d_mA + weakening_mA;
        TEST_ASSERT_TRUE(length_mA(i_d_mA, out.i_q_mA) <= config.motor.max_phase_current_mA + 1.0);
        if (out.limited) {
            limited++;
            const reference_motor_t motor = reference_motor(&config, speed_mrad_s, 2500);
            const double torque_found_mNm = torque_of(&motor, i_d_mA * 1e-3, out.i_q_mA * 1e-3);
            /* Iron loss brakes with at most 6 Nm here. */
            TEST_ASSERT_TRUE(fabs(torque_found_mNm) <= fabs((double)torque_mNm) + 200.0);
            TEST_ASSERT_TRUE(torque_found_mNm * torque_mNm >= 0.0 ||
                             fabs(torque_found_mNm) < 6000.0);
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(5000, limited);
}

void test_torque_beyond_the_current_circle_gives_at_least_85_percent_of_the_best(void)
{
    /* Ten times the largest torque: the i_d of the map's last point alone would take the whole
     * current circle and leave i_q = 0. */
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

void test_q_current_is_within_its_limit_and_has_the_sign_of_a_torque_above_iron_drag(void)
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

/* Magnitude of the phase voltage, V, of terminal currents. */
static double voltage_of(const reference_motor_t *m, double i_d_a, double i_q_a)
{
    const double g = m->w_rad_s * m->iron_siemens;
    const double i_qt_a =
        (i_q_a - g * (m->l_d_h * i_d_a + m->psi_wb)) / (1.0 + g * g * m->l_d_h * m->l_q_h);
    const double i_dt_a = i_d_a + g * m->l_q_h * i_qt_a;
    return hypot(m->resistance_ohm * i_d_a - m->w_rad_s * m->l_q_h * i_qt_a,
                 m->resistance_ohm * i_q_a + m->w_rad_s * (m->l_d_h * i_dt_a + m->psi_wb));
}

/* Where the voltage just suffices for zero torque at the end of the current circle, the trim has
 * wound up. Braking needs less voltage there, up to atan(R/(w L)) = 16 degrees or 21 A of the 75. A
 * trim that takes the braking current away holds the voltage where it is, and stays for ever. */
void test_trim_does_not_take_the_braking_current_that_lowers_the_voltage(void)
{
    config = CONFIG_LU2013;
    const int32_t speed_mrad_s = 61850;
    const reference_motor_t motor = reference_motor(&config, speed_mrad_s, 2500);
    const double iron_a = 2.0; /* about, at zero torque */
    const double needed_v = voltage_of(&motor, -sqrt(75.0 * 75.0 - iron_a * iron_a), iron_a);
    phase_mV = (int32_t)(1.002e3 * needed_v);
    for (int32_t torque_mNm = -1000; torque_mNm >= -12000; torque_mNm -= 500) {
        const current_setpoint_t out = weakened(speed_mrad_s, torque_mNm, -60000);
        const double i_d_a = out.i_d_mA * 1e-3 - 60.0;
        const double i_q_a = out.i_q_mA * 1e-3;
        TEST_ASSERT_TRUE(out.feasible && !out.limited);
        TEST_ASSERT_DOUBLE_WITHIN(100.0, torque_mNm, torque_of(&motor, i_d_a, i_q_a));
        TEST_ASSERT_TRUE(voltage_of(&motor, i_d_a, i_q_a) <= 1.001 * needed_v);
        TEST_ASSERT_TRUE(hypot(i_d_a, i_q_a) <= 75.1);
    }
    /* Driving needs more voltage: the trim comes first, as before. */
    const current_setpoint_t drives = weakened(speed_mrad_s, 12000, -60000);
    TEST_ASSERT_TRUE(drives.limited);
}
