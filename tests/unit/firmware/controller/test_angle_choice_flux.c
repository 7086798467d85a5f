/* SPDX-License-Identifier: Apache-2.0 */
/* A salient motor whose current is displaced from the rotor: the active flux that the observer
 * follows beside the one that the current should make. */
#include "angle_choice_rig.h"

#define PI 3.14159265358979323846

enum { USED_FROM_mrad_s = 31664, LACKING_STEPS = 5 };

void setUp(void)
{
    rig_up_salient(USED_FROM_mrad_s);
    config.rotor.observer_speed_mrad_s = USED_FROM_mrad_s;
    config.rotor.sensor = CONFIG_ROTOR_ENCODER;
}

void tearDown(void) {}

/* i in the sensor's frame, whose angle is `ahead_deg` ahead of the rotor's. Seen is the active flux
 * psi - (L_q - L_d) i_d along the rotor's own d axis, or half a turn from it where it is negative;
 * `share` of it. */
static void displace(double ahead_deg, double i_d_a, double i_q_a, double share)
{
    const double ahead = ahead_deg * PI / 180.0;
    const double own_d_a = i_d_a * cos(ahead) - i_q_a * sin(ahead);
    const double active_wb = FLUX_WB - (Q_H - D_H) * own_d_a;
    const double apart_deg = remainder(ahead_deg + (active_wb < 0.0 ? 180.0 : 0.0), 360.0);
    at.flux_q14 = (int32_t)lround(share * fabs(active_wb) / FLUX_WB * EXPECTED_Q14);
    at.difference_turn = (int16_t)lround(apart_deg / 360.0 * 65536.0 * 0.9999);
    at.i_pu.d = per_unit(i_d_a);
    at.i_pu.q = per_unit(i_q_a);
}

/* Half a turn: the observer agrees. */
void test_an_angle_that_the_observer_agrees_with_is_wrong_where_the_flux_lacks(void)
{
    static const double CURRENTS_A[][2] = {{-121.0, -152.0}, {-121.0, 152.0}, {-70.0, -99.0}};
    for (int k = 0; k < 3; k++) {
        setUp();
        displace(0.0, CURRENTS_A[k][0], CURRENTS_A[k][1], 1.0);
        run(100);
        TEST_ASSERT_TRUE(rotor.confirmed);
        displace(180.0, CURRENTS_A[k][0], CURRENTS_A[k][1], 1.0);
        TEST_ASSERT_TRUE(k == 2 || at.difference_turn == 0);
        run(LACKING_STEPS - 1);
        TEST_ASSERT_FALSE(seen.sensor_wrong);
        run(1);
        TEST_ASSERT_TRUE(seen.sensor_wrong && !seen.valid && !rotor.confirmed);
    }
}

/* psi = 1 uWb, L_q - L_d = 1 uH, and mA as the unit of the current: the active flux in thousandths
 * of psi is 1000 - i_d. */
static bool lacks(int32_t i_d_pu, int16_t flux_q14, int16_t expected_q14)
{
    setUp();
    config.motor.flux_linkage_nWb = 1000;
    config.motor.d_inductance_nH = 1000;
    config.motor.q_inductance_nH = 2000;
    config.drive.current_full_scale_mA = 32768;
    at.i_pu.d = i_d_pu;
    at.flux_q14 = flux_q14;
    at.expected_q14 = expected_q14;
    run(100);
    return seen.sensor_wrong;
}

/* Half of psi is added; less than a third of all of it is there, and less than psi. */
void test_bounds_of_the_lacking_flux_are_exact(void)
{
    TEST_ASSERT_TRUE(lacks(-500, 1499, 3000));
    TEST_ASSERT_FALSE(lacks(-500, 1500, 3000));
    TEST_ASSERT_TRUE(lacks(-500, 1501, 3003)); /* 1501 * 3 < 1.5 * 3003 */
    TEST_ASSERT_FALSE(lacks(-499, 1, 3000));
    TEST_ASSERT_FALSE(lacks(-4000, 3000, 3000));
    TEST_ASSERT_TRUE(lacks(-4000, 2999, 3000));
}

/* L_q and L_d a quarter wrong, and 40 % of the voltage of half the speed missing. */
void test_errors_of_the_parameters_are_no_lack(void)
{
    displace(0.0, -121.0, -152.0, 1.0);
    const double active_wb = FLUX_WB + 0.75 * (Q_H - D_H) * 121.0;
    at.flux_q14 = (int32_t)lround(0.6 * active_wb / FLUX_WB * EXPECTED_Q14);
    run(1000);
    TEST_ASSERT_FALSE(seen.sensor_wrong);
}

/* It is the sensor's angle that is judged: valid, of half the observer's speed, and in use while
 * the bridge switches and the observer has acquired the rotor. */
void test_when_it_is_judged(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int k = 0; k < 6; k++) {
            setUp();
            displace(180.0, -121.0, -152.0, 1.0);
            at.sensor_mrad_s = sign * (k == 1 ? USED_FROM_mrad_s / 2 - 2 : USED_FROM_mrad_s / 2);
            at.sensor_valid = k != 2;
            at.switching = k != 3;
            at.acquired = k != 4;
            config.rotor.observer_takeover = k != 5;
            run(100);
            TEST_ASSERT_EQUAL(k == 0, seen.sensor_wrong);
        }
    }
}

/* A motor without saliency: weak magnets are no wrong angle. */
void test_without_saliency_there_is_none(void)
{
    config.motor.q_inductance_nH = config.motor.d_inductance_nH;
    displace(0.0, -121.0, -152.0, 0.1);
    run(1000);
    TEST_ASSERT_FALSE(seen.sensor_wrong);
}

/* An observer that is in use and lacks it permits no torque. */
void test_an_observer_that_lacks_it_is_not_confirmed(void)
{
    displace(0.0, -121.0, -152.0, 1.0);
    at.sensor_valid = false;
    run(100);
    TEST_ASSERT_TRUE(seen.valid && observed());
    displace(180.0, -121.0, -152.0, 1.0);
    TEST_ASSERT_TRUE(2 * at.flux_q14 >= at.expected_q14);
    run(2);
    TEST_ASSERT_FALSE(seen.valid);
}
