/* SPDX-License-Identifier: Apache-2.0 */
/* A slip of the rotor sensor beside a gain error of all current sensors, which turns the observed
 * flux as well. */
#include "angle_choice_rig.h"

#define PI 3.14159265358979323846

enum {
    SLIPPED_STEPS = 12,
    OPPOSED_STEPS = 2,
    NAME_STEPS = 10,
    GAIN_STEPS = 255,
    SIXTEEN_DEGREES = 2913
};

void setUp(void)
{
    rig_up_salient(100000);
    config.rotor.sensor = CONFIG_ROTOR_ANGLE;
}

void tearDown(void) {}

static reason_t name_after(int steps)
{
    run(steps);
    return seen.name;
}

static void observe(double d_wb, double q_wb, double i_d_a, double i_q_a)
{
    at.flux_q14 = (int32_t)lround(hypot(d_wb, q_wb) / FLUX_WB * EXPECTED_Q14);
    at.difference_turn = (int16_t)lround(-atan2(q_wb, d_wb) / (2.0 * PI) * 65536.0);
    at.i_pu.d = per_unit(i_d_a);
    at.i_pu.q = per_unit(i_q_a);
}

/* The sensors show i, of which `times` flows; the angle is right. The observer takes the flux
 * linkage of what flows and L_q times what is shown: psi + (times L_d - L_q) i_d, and across it
 * (times - 1) L_q i_q. */
static void observe_gain(double times, double i_d_a, double i_q_a)
{
    observe(FLUX_WB + (times * D_H - Q_H) * i_d_a, (times - 1.0) * Q_H * i_q_a, i_d_a, i_q_a);
}

/* The sensor is `degrees` ahead, the currents are right: psi - (L_q - L_d) i_d of the true angle.
 */
static void observe_slip(double degrees, double i_d_a, double i_q_a)
{
    const double turn = degrees * PI / 180.0;
    const double true_d_a = i_d_a * cos(turn) - i_q_a * sin(turn);
    const double size_wb = FLUX_WB - (Q_H - D_H) * true_d_a;
    observe(size_wb * cos(turn), -size_wb * sin(turn), i_d_a, i_q_a);
}

void test_a_slip_with_current_is_named_in_its_twelfth_step_forwards_and_backwards(void)
{
    for (int side = -1; side <= 1; side += 2) {
        for (double i_q_a = -140.0; i_q_a <= 140.0; i_q_a += 35.0) {
            for (double degrees = 18.0; degrees <= 30.0; degrees += 6.0) {
                setUp();
                run(100);
                observe_slip(side * degrees, -0.9 * fabs(i_q_a), i_q_a);
                TEST_ASSERT_EQUAL_INT(REASON_NONE, name_after(SLIPPED_STEPS - 1));
                TEST_ASSERT_EQUAL_INT(REASON_ROTOR_SLIPPED, name_after(1));
            }
        }
    }
}

/* Seven tenths to eight thirteenths of the current, where that turns the flux by 16 degrees. */
void test_a_gain_that_is_too_low_leaves_the_name_to_the_battery_while_driving_and_braking(void)
{
    int cases = 0;
    for (double i_q_a = -140.0; i_q_a <= 140.0; i_q_a += 280.0) {
        for (double times = 1.45; times <= 1.58; times += 0.02) {
            setUp();
            run(100);
            observe_gain(times, -130.0, i_q_a);
            TEST_ASSERT_TRUE(at.difference_turn >= SIXTEEN_DEGREES ||
                             at.difference_turn <= -SIXTEEN_DEGREES);
            TEST_ASSERT_EQUAL_INT(REASON_NONE, name_after(SLIPPED_STEPS));
            TEST_ASSERT_TRUE(rotor.sensor_wrong && observed());
            TEST_ASSERT_EQUAL_INT(REASON_NONE, name_after(GAIN_STEPS - 2));
            TEST_ASSERT_EQUAL_INT(REASON_ROTOR_SLIPPED, name_after(1));
            cases++;
        }
    }
    TEST_ASSERT_EQUAL_INT(14, cases);
}

void test_no_sensor_gets_a_name_while_the_battery_contradicts_the_current(void)
{
    run(100);
    observe_slip(25.0, -120.0, -140.0);
    gain_suspected = true;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, name_after(1000));
    gain_suspected = false;
    TEST_ASSERT_EQUAL_INT(REASON_ROTOR_SLIPPED, name_after(1));
    gain_suspected = true; /* a name that is known stays */
    TEST_ASSERT_EQUAL_INT(REASON_ROTOR_SLIPPED, name_after(100));
}

/* The next slip of the same sensor is judged anew. */
void test_each_slip_is_judged_by_its_own_current(void)
{
    run(100);
    observe_gain(1.5, -130.0, -140.0);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, name_after(50));
    observe_slip(0.0, 0.0, 0.0);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, name_after(50 + config.monitor.rotor_warning_time_ms));
    TEST_ASSERT_FALSE(rotor.sensor_wrong);
    observe_slip(25.0, -120.0, -140.0);
    TEST_ASSERT_EQUAL_INT(REASON_ROTOR_SLIPPED, name_after(SLIPPED_STEPS));
}

/* psi = 1 mWb, L_q = 1 mH, L_q - L_d = 0.1 mH, so that 1 A is 1000 permille across and 100 along,
 * and the flux of the observer is in permille. */
static void start_in_permille(void)
{
    setUp();
    config.motor.flux_linkage_nWb = 1000000;
    config.motor.q_inductance_nH = 1000000;
    config.motor.d_inductance_nH = 900000;
    config.drive.current_full_scale_mA = 32768;
    at.expected_q14 = 1000;
    at.flux_q14 = 1000;
    run(100);
}

/* A slip whose last step has this flux and current is given no name. */
static bool waits(int16_t flux, int16_t difference_turn, int32_t i_d_mA, int32_t i_q_mA)
{
    at.difference_turn = difference_turn;
    run(SLIPPED_STEPS - 1);
    at.flux_q14 = flux;
    at.i_pu.d = i_d_mA;
    at.i_pu.q = i_q_mA;
    const reason_t reason = name_after(1);
    TEST_ASSERT_TRUE(rotor.sensor_wrong);
    start_in_permille();
    return reason == REASON_NONE;
}

void test_bounds_of_length_side_and_size_are_exact(void)
{
    start_in_permille();
    TEST_ASSERT_TRUE(waits(1000, -4000, 0, 1000));
    TEST_ASSERT_TRUE(waits(1111, -4000, 0, 1000)); /* a ninth of 1000 */
    TEST_ASSERT_FALSE(waits(1112, -4000, 0, 1000));
    TEST_ASSERT_TRUE(waits(889, -4000, 0, 1000));
    TEST_ASSERT_FALSE(waits(888, -4000, 0, 1000));
    TEST_ASSERT_TRUE(waits(1222, -4000, -1000, 1000)); /* 1100 and a ninth */
    TEST_ASSERT_FALSE(waits(1223, -4000, -1000, 1000));
    TEST_ASSERT_TRUE(waits(1000, -4000, 1000, 1000)); /* 900 and a ninth */
    TEST_ASSERT_FALSE(waits(1001, -4000, 1000, 1000));
    TEST_ASSERT_FALSE(waits(1000, 4000, 0, 1000)); /* the other side */
    TEST_ASSERT_FALSE(waits(1000, -4000, 0, -1000));
    TEST_ASSERT_TRUE(waits(1000, 4000, 0, -1000));
    TEST_ASSERT_FALSE(waits(1000, 4000, 0, 0));
    TEST_ASSERT_TRUE(waits(1000, -6520, 0, 1000)); /* 5/8 of a radian */
    TEST_ASSERT_FALSE(waits(1000, -6521, 0, 1000));
    TEST_ASSERT_TRUE(waits(1000, 3260, 0, -500));
    TEST_ASSERT_FALSE(waits(1000, 3261, 0, -500));
}

/* 1 H and 1 mWb: 1 A is a thousand times the magnets' flux, 2440 A pass 32 bits of permille. */
void test_a_current_far_beyond_the_magnets_flux_saturates(void)
{
    for (int32_t i_pu = 1; i_pu <= 20000; i_pu += 19999) {
        start_in_permille();
        config.motor.q_inductance_nH = 1000000000;
        config.motor.d_inductance_nH = 1000000000;
        config.drive.current_full_scale_mA = 32768 * 122;
        TEST_ASSERT_TRUE(waits(1000, -4000, 0, i_pu * (i_pu == 1 ? 8 : 1)));
    }
}

/* In the last step alone, so that the observer is still confirmed: 33 times the magnets' flux, as
 * the current makes it; and an expected flux of zero counts as one. */
void test_any_flux_in_the_last_step_is_compared(void)
{
    start_in_permille();
    config.motor.d_inductance_nH = 1;
    at.expected_q14 = 1;
    at.flux_q14 = 1;
    TEST_ASSERT_TRUE(waits(32767, -4000, -32768, 32767));
    at.expected_q14 = 0;
    at.flux_q14 = 1;
    TEST_ASSERT_TRUE(waits(1, -4000, 0, 1000));
}

/* At 60 degrees the sensor's speed tells, 10 ms later, whatever current flows. */
void test_an_opposed_sensor_waits_for_its_speed_alone(void)
{
    start_in_permille();
    at.difference_turn = -10923;
    at.i_pu.q = 2000;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, name_after(OPPOSED_STEPS + NAME_STEPS - 2));
    TEST_ASSERT_EQUAL_INT(REASON_ROTOR_SLIPPED, name_after(1));
}
