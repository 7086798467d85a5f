/* SPDX-License-Identifier: Apache-2.0 */
/* What an uncertain L_q does to the observer's angle, against the circuit in double precision. */
#include "motor/observer_error.h"

#include <math.h>
#include <stdlib.h>

#include "motor/current_setpoint.h"
#include "motor/flux_map.h"
#include "paper_vehicle.h"
#include "random_values.h"
#include "reference_motor.h"
#include "unity.h"

#define PI 3.14159265358979323846

static const double SHARES[] = {0.5, 1.5};

static config_t config;
static motor_constants_t constants;
static motor_model_t model;
static feasible_set_t set;

static void at_conditions(config_t image, int32_t speed_mrad_s, int32_t phase_mV)
{
    config = image;
    motor_constants_init(&constants, &config);
    model = motor_model_at(&constants, &config, speed_mrad_s, 2500);
    set = feasible_set_at(&model, phase_mV);
}

void setUp(void) {}

void tearDown(void) {}

/* The rotor's frame: psi + (L_d - L_q) i_d along the observer's angle, L_q/2 i_q across it. */
void test_l_q_explains_the_angle_that_half_of_it_makes(void)
{
    random_t random = random_seeded(34);
    for (int n = 0; n < 20000; n++) {
        config = n % 2 == 0 ? paper_vehicle() : salient_vehicle();
        const config_motor_t *m = &config.motor;
        const motor_current_t i = {.d_mA = random_between(&random, -300000, 60000),
                                   .q_mA = random_between(&random, -300000, 300000)};
        const double along_pwb =
            1e3 * m->flux_linkage_nWb + (double)(m->d_inductance_nH - m->q_inductance_nH) * i.d_mA;
        const double across_pwb = 0.5 * m->q_inductance_nH * i.q_mA;
        const double turn = atan2(fabs(across_pwb), fabs(along_pwb)) / (2.0 * PI) * 65536.0;
        const int32_t before = (int32_t)floor(turn) - 2;
        TEST_ASSERT_TRUE(before < 0 || observer_error_explains(&config, i, before));
        TEST_ASSERT_FALSE(observer_error_explains(&config, i, before + 5));
        TEST_ASSERT_FALSE(observer_error_explains(&config, i, 16400 + n % 14000));
    }
    const motor_current_t none = {0, 0};
    TEST_ASSERT_FALSE(observer_error_explains(&config, none, 0));
}

/* Degrees by which the observer in use settles, sin e = dL i_q/A with A of the true i_d: grown from
 * zero with dL. The currents are of the frame in use. Above 90: it does not settle. */
static double settled_deg(const config_motor_t *m, double share, double i_d_a, double i_q_a)
{
    enum { STEPS = 200, ROUNDS = 20 };
    double e = 0.0;
    for (int step = 1; step <= STEPS; step++) {
        const double change_nh = (share - 1.0) * m->q_inductance_nH * step / STEPS;
        for (int round = 0; round < ROUNDS; round++) {
            const double d_a = i_d_a * cos(e) - i_q_a * sin(e);
            const double active_nwb =
                m->flux_linkage_nWb + (m->d_inductance_nH - m->q_inductance_nH - change_nh) * d_a;
            const double sine = change_nh * i_q_a / active_nwb;
            if (active_nwb <= 0.0 || fabs(sine) >= 1.0) {
                return 180.0;
            }
            e += 0.5 * (asin(sine) - e);
        }
    }
    return fabs(e) * 180.0 / PI;
}

static double worst_deg(double torque_nm)
{
    const current_setpoint_t i = current_setpoint_step(&set, (int32_t)lround(torque_nm * 1e3), 0);
    double worst = 0.0;
    for (int k = 0; k < 2; k++) {
        worst =
            fmax(worst, settled_deg(&config.motor, SHARES[k], i.i_d_mA * 1e-3, i.i_q_mA * 1e-3));
    }
    return worst;
}

/* Beyond the bound by a quarter the error is more than 15 degrees, at it less. Iron current turns
 * the observer as well. */
static void assert_bound(side_t side, bool weakened)
{
    const feasible_side_t whole = feasible_side_at(&set, side, config.motor.max_torque_mNm);
    const double most_nm = 1e-3 * observer_error_torque_mNm(&whole);
    const double along = side == SIDE_BRAKING ? -1.0 : 1.0;
    TEST_ASSERT_TRUE(most_nm > 0.0);
    TEST_ASSERT_TRUE(worst_deg(along * most_nm) < 15.5);
    TEST_ASSERT_TRUE(weakened || worst_deg(1.25 * along * most_nm) > 15.0);
}

void test_the_observer_settles_within_15_degrees_at_the_largest_torque_of_a_salient_motor(void)
{
    for (int32_t mrad_s = 20000; mrad_s <= 300000; mrad_s += 40000) {
        at_conditions(salient_vehicle(), mrad_s, 200000);
        assert_bound(SIDE_BRAKING, false);
        assert_bound(SIDE_DRIVING, false);
    }
}

/* Field weakening takes active flux where half of L_q is less than L_d, and adds some else. */
void test_the_currents_of_the_bound_are_those_within_the_voltage(void)
{
    at_conditions(salient_vehicle(), 300000, 60000);
    assert_bound(SIDE_BRAKING, true);
    config_t surface = paper_vehicle();
    surface.motor.d_inductance_nH = 300000;
    surface.motor.q_inductance_nH = 300000;
    for (int32_t mV = 12000; mV <= 40000; mV += 4000) {
        at_conditions(surface, 25000, mV);
        assert_bound(SIDE_BRAKING, true);
    }
}

/* 38 uH of 56 A are 2.1 of 20.4 mWb. */
void test_a_hub_motor_keeps_all_of_its_torque(void)
{
    at_conditions(paper_vehicle(), 40000, 30000);
    const feasible_side_t side = feasible_side_at(&set, SIDE_BRAKING, config.motor.max_torque_mNm);
    TEST_ASSERT_TRUE(observer_error_torque_mNm(&side) > config.motor.max_torque_mNm);
}

/* L_q within 10 % of a map. The same motor, its map straight. */
void test_a_flux_map_leaves_more_torque(void)
{
    at_conditions(salient_vehicle(), 40000, 200000);
    const feasible_side_t side = feasible_side_at(&set, SIDE_BRAKING, config.motor.max_torque_mNm);
    const int32_t by_constants_mNm = observer_error_torque_mNm(&side);
    config.flux_map.d_points = 2;
    TEST_ASSERT_TRUE(flux_map_present(&config));
    TEST_ASSERT_TRUE(observer_error_torque_mNm(&side) > 4 * by_constants_mNm);
}
