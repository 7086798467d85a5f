/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "motor/current_setpoint.h"
#include "motor/loss_maps.h"
#include "paper_vehicle.h"
#include "random_values.h"
#include "reference_motor.h"
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
        TEST_ASSERT_EQUAL_INT32(map_d_mA(&config, 100000, 2500, torque_mNm + 5000),
                                reference(100000, torque_mNm).i_d_mA);
        TEST_ASSERT_EQUAL_INT32(map_d_mA(&config, -100000, 2500, torque_mNm - 5000),
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

/* Hardly any saliency: with the map's i_d, of a salient motor, the circle leaves less torque than
 * with i_d = 0. A motor that turns slowly on a high voltage has a torque of few bits. */
void test_torques_near_the_largest_of_the_circle_are_made_in_any_scale(void)
{
    for (int32_t slower = 1; slower <= 10000; slower *= 10) {
        config = salient_vehicle();
        config.battery.max_voltage_mV = 420000;
        config.motor.q_inductance_nH = config.motor.d_inductance_nH * 49 / 50;
        config.motor.max_speed_mrad_s /= slower;
        const reference_motor_t motor = reference_motor(&config, 0.0, 2500);
        const double most_a = config.motor.max_phase_current_mA * 1e-3 * 255.0 / 256.0;
        const double best_mNm = torque_of(&motor, 0.0, most_a);
        for (double share = 0.9; share < 0.998; share += 0.003) {
            const double wanted_mNm = share * best_mNm;
            const current_setpoint_t out = reference(0, (int32_t)wanted_mNm);
            TEST_ASSERT_FALSE(out.limited);
            TEST_ASSERT_DOUBLE_WITHIN(0.003 * best_mNm, wanted_mNm,
                                      torque_of(&motor, out.i_d_mA * 1e-3, out.i_q_mA * 1e-3));
        }
    }
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

/* ---- the trim ---- */

void test_a_trim_of_a_milliampere_is_one(void)
{
    TEST_ASSERT_EQUAL_INT32(0, weakened(30000, 30000, -1).i_d_mA);
}

/* With a hot winding down to 121.2 A; the map's i_d for 200 N m is lower and stays. */
void test_the_trim_does_not_raise_a_map_s_current_below_that_of_field_weakening(void)
{
    config = salient_vehicle();
    config.motor.derate_winding_temperature_cC = 2400;
    config.motor.max_winding_temperature_cC = 2500;
    const int32_t map_mA = reference(100000, 200000).i_d_mA;
    TEST_ASSERT_LESS_THAN_INT32(-130000, map_mA);
    TEST_ASSERT_EQUAL_INT32(map_mA + 40000, weakened(100000, 200000, -40000).i_d_mA);
}

/* The whole i_d and i_q of a trim at 61.85 rad/s, where atan(R/(w L_q)) leaves 75 A times R/(w L_q)
 * of braking current; field weakening may use the whole circle. */
static double trimmed_d_a(int32_t torque_mNm, int32_t trim_mA)
{
    config.current_loop.field_weakening_current_pu_q15 = 32767;
    return 1e-3 * (weakened(61850, torque_mNm, trim_mA).i_d_mA + trim_mA);
}

static double braking_a(int32_t torque_mNm)
{
    return -1e-3 * reference(61850, torque_mNm).i_q_mA;
}

/* A trim to the end of field weakening, 74.7 of 75 A, leaves the current of 8 N m, and of that of
 * 30 N m what is within the angle. */
void test_the_trim_leaves_the_braking_current_up_to_the_angle_of_least_voltage(void)
{
    const reference_motor_t motor = reference_motor(&config, 61850, 2500);
    const double most_a = 1e-3 * config.motor.max_phase_current_mA;
    const double kept_a = most_a * motor.resistance_ohm / (motor.w_rad_s * motor.l_q_h);
    TEST_ASSERT_TRUE(braking_a(-8000) > 7.0 && braking_a(-8000) < 0.5 * kept_a);
    TEST_ASSERT_TRUE(braking_a(-30000) > 1.5 * kept_a);
    const double little_a = -sqrt(most_a * most_a - braking_a(-8000) * braking_a(-8000));
    TEST_ASSERT_DOUBLE_WITHIN(0.05, little_a, trimmed_d_a(-8000, -74990));
    const double much_a = -sqrt(most_a * most_a - kept_a * kept_a);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, much_a, trimmed_d_a(-30000, -74990));
    /* Less than that is the trim's, also where the current then is beyond the circle. */
    TEST_ASSERT_DOUBLE_WITHIN(0.002, -70.0, trimmed_d_a(-30000, -70000));
    TEST_ASSERT_DOUBLE_WITHIN(0.002, -50.0, trimmed_d_a(-30000, -50000));
    TEST_ASSERT_DOUBLE_WITHIN(0.002, -74.0, trimmed_d_a(30000, -74000)); /* driving: the trim's */
}

/* At rest R/(w L_q) has no end: all of the braking current stays. */
void test_at_rest_the_trim_leaves_all_of_the_braking_current(void)
{
    config.motor.max_phase_current_mA = 41000;
    const double q_a = -1e-3 * reference(0, -12000).i_q_mA;
    const double d_a = 1e-3 * (weakened(0, -12000, -40000).i_d_mA - 40000);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 12.0 / 0.7038, q_a);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, -sqrt(41.0 * 41.0 - q_a * q_a), d_a);
}

/* Where the voltage takes i_d to the end of field weakening, the trim does not take it back. */
void test_the_trim_does_not_raise_the_current_of_the_voltage_limit(void)
{
    config = CONFIG_LU2013;
    config.motor.iron_loss_resistance_mOhm = 0;
    const reference_motor_t motor = reference_motor(&config, 61850, 2500);
    phase_mV = (int32_t)(0.97e3 * voltage_of(&motor, -75.0, 0.0));
    const current_setpoint_t alone = reference(61850, -8000);
    TEST_ASSERT_LESS_THAN_INT32(-74600, alone.i_d_mA);
    TEST_ASSERT_EQUAL_INT32(alone.i_d_mA + 20000, weakened(61850, -8000, -20000).i_d_mA);
}

/* ---- signs and limits ---- */

void test_the_current_has_the_torque_s_sign_at_the_smallest_speed(void)
{
    for (int32_t speed_mrad_s = -1; speed_mrad_s <= 1; speed_mrad_s++) {
        TEST_ASSERT_INT32_WITHIN(5, 42626, reference(speed_mrad_s, 30000).i_q_mA);
        TEST_ASSERT_INT32_WITHIN(5, -42626, reference(speed_mrad_s, -30000).i_q_mA);
    }
}

/* i_q before its limit, of a model at rest without i_d. */
static int32_t wanted_q_mA(int32_t torque_mNm)
{
    const motor_model_t model = model_at(&config, 0, 2500);
    return model_q_mA(&model, torque_mNm, 0);
}

/* 65.28 A: a 256th is 255 mA. The flux is varied to meet every milliampere. What the circle leaves
 * of the torque has the voltage. */
void test_limited_begins_a_256th_beyond_the_circle_and_what_is_left_is_feasible(void)
{
    bool met[2] = {false, false};
    config.motor.max_phase_current_mA = 65280;
    const int32_t flux_nWb = config.motor.flux_linkage_nWb;
    for (int32_t part = 0; part < 40; part++) {
        config.motor.flux_linkage_nWb = flux_nWb + part * 1000;
        const int32_t edge_mA = 65280 + 255;
        const int32_t near_mNm =
            (int32_t)(edge_mA * 1.5e-9 * config.motor.pole_pairs * config.motor.flux_linkage_nWb);
        for (int32_t torque_mNm = near_mNm - 4; torque_mNm <= near_mNm + 4; torque_mNm++) {
            const int32_t q_mA = wanted_q_mA(torque_mNm);
            const current_setpoint_t driving = reference(0, torque_mNm);
            TEST_ASSERT_EQUAL_INT(q_mA > edge_mA, driving.limited);
            TEST_ASSERT_TRUE(driving.feasible);
            met[0] |= q_mA == edge_mA;
            met[1] |= q_mA == edge_mA + 1;
        }
        TEST_ASSERT_TRUE(reference(0, -51000).feasible);
    }
    TEST_ASSERT_TRUE(met[0] && met[1]);
}

/* A root has an error of 2^-14; the limit itself has none. */
void test_a_current_of_exactly_the_limit_is_within_it(void)
{
    int met = 0;
    for (int32_t most_mA = 1000003; most_mA < 1100000; most_mA += 1237) {
        config.motor.max_phase_current_mA = most_mA;
        const int32_t near_mNm = (int32_t)(most_mA * 0.7038);
        for (int32_t torque_mNm = near_mNm - 100; torque_mNm <= near_mNm + 100; torque_mNm++) {
            if (wanted_q_mA(torque_mNm) == most_mA) {
                met++;
                TEST_ASSERT_EQUAL_INT32(most_mA, reference(0, torque_mNm).i_q_mA);
            }
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(10, met);
}

/* ---- voltage ---- */

/* R i: 1.32 V of 42.6 A, 1.81 V with 40 A of i_d. */
void test_a_trim_that_the_voltage_does_not_suffice_for_is_not_feasible(void)
{
    phase_mV = 1400;
    TEST_ASSERT_TRUE(reference(0, 30000).feasible);
    TEST_ASSERT_FALSE(weakened(0, 30000, -40000).feasible);
    phase_mV = 1900;
    TEST_ASSERT_TRUE(weakened(0, 30000, -40000).feasible);
    phase_mV = 1200;
    TEST_ASSERT_FALSE(reference(0, 30000).feasible);
}

/* Zero torque at the lowest i_d needs u V; 3 % more is left to the fast loop. */
void test_torque_is_forced_only_where_the_voltage_suffices_for_none(void)
{
    config = CONFIG_LU2013;
    config.motor.iron_loss_resistance_mOhm = 0;
    const reference_motor_t motor = reference_motor(&config, 80000, 2500);
    const motor_model_t model = model_at(&config, 80000, 2500);
    const double weakest_a =
        1e-3 * model_current_mA(&model, feasible_set_at(&model, 20000).weakest_d_b);
    const double needed_v = voltage_of(&motor, weakest_a, 0.0);
    phase_mV = (int32_t)(1e3 * needed_v);
    TEST_ASSERT_EQUAL_INT32(0, reference(80000, -20000).forced_mNm);
    for (int32_t torque_mNm = 0; torque_mNm <= 20000; torque_mNm += 20000) {
        TEST_ASSERT_EQUAL_INT32(0, reference(80000, torque_mNm).forced_mNm);
        TEST_ASSERT_INT32_WITHIN(1, (int32_t)floor(1e3 * weakest_a),
                                 reference(80000, torque_mNm).i_d_mA);
    }
    phase_mV = (int32_t)(0.95e3 * needed_v);
    TEST_ASSERT_FALSE(reference(80000, 20000).feasible);
    phase_mV = (int32_t)(0.9e3 * needed_v);
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        const current_setpoint_t out = reference(sign * 80000, 0);
        const double found_mNm = torque_of(&motor, 1e-3 * out.i_d_mA, sign * 1e-3 * out.i_q_mA) +
                                 -model_friction_mNm(&model);
        TEST_ASSERT_GREATER_THAN_INT32(500, out.forced_mNm);
        TEST_ASSERT_DOUBLE_WITHIN(50.0, -found_mNm, out.forced_mNm);
        /* The trim changes no forced point. */
        TEST_ASSERT_EQUAL_INT32(out.i_d_mA + 20000, weakened(sign * 80000, 0, -20000).i_d_mA);
        TEST_ASSERT_EQUAL_INT32(out.i_q_mA, weakened(sign * 80000, 0, -20000).i_q_mA);
    }
}
