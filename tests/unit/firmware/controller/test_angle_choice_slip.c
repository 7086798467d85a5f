/* SPDX-License-Identifier: Apache-2.0 */
/* When a slip of the rotor sensor gets its name, whatever current flows. */
#include "angle_choice_rig.h"

#define PI 3.14159265358979323846

enum { SLIPPED_STEPS = 12, OPPOSED_STEPS = 2, NAME_STEPS = 10, OPPOSED_TURN = 10923 };

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

/* The sensor is `degrees` ahead, the currents are right: psi - (L_q - L_d) i_d of the true angle.
 */
static void observe_slip(double degrees, double i_d_a, double i_q_a)
{
    const double turn = degrees * PI / 180.0;
    const double true_d_a = i_d_a * cos(turn) - i_q_a * sin(turn);
    const double size_wb = FLUX_WB - (Q_H - D_H) * true_d_a;
    observe(size_wb * cos(turn), -size_wb * sin(turn), i_d_a, i_q_a);
}

/* What half of L_q turns the observer by. */
static double explained_deg(double i_d_a, double i_q_a)
{
    return atan(0.5 * Q_H * fabs(i_q_a) / (FLUX_WB - (Q_H - D_H) * i_d_a)) * 180.0 / PI;
}

void test_a_slip_beyond_what_l_q_explains_is_named_in_its_twelfth_step_forwards_and_backwards(void)
{
    for (int side = -1; side <= 1; side += 2) {
        for (double i_q_a = -140.0; i_q_a <= 140.0; i_q_a += 35.0) {
            const double i_d_a = -0.9 * fabs(i_q_a);
            const double least_deg = 16.0 + explained_deg(i_d_a, i_q_a);
            setUp();
            run(100);
            observe_slip(side * (least_deg + 0.2), i_d_a, i_q_a);
            TEST_ASSERT_EQUAL_INT(REASON_NONE, name_after(SLIPPED_STEPS - 1));
            TEST_ASSERT_EQUAL_INT(REASON_ROTOR_SLIPPED, name_after(1));
            setUp();
            run(100);
            observe_slip(side * (least_deg - 0.2), i_d_a, i_q_a);
            TEST_ASSERT_EQUAL_INT(REASON_NONE, name_after(100));
        }
    }
}

/* At 60 degrees the sensor's speed tells, 10 ms later, whatever current flows. */
void test_an_opposed_sensor_waits_for_its_speed_alone(void)
{
    run(100);
    at.difference_turn = -OPPOSED_TURN;
    at.i_pu.q = 2000;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, name_after(OPPOSED_STEPS + NAME_STEPS - 2));
    TEST_ASSERT_EQUAL_INT(REASON_ROTOR_SLIPPED, name_after(1));
}

static bool is_wrong_after(int32_t sensor, double degrees, int steps)
{
    const double i_d_a = -126.0, i_q_a = 140.0, turn = degrees * PI / 180.0;
    const double size_wb = FLUX_WB - (Q_H - D_H) * i_d_a;
    setUp();
    config.rotor.sensor = sensor;
    run(100);
    at.sensor_mrad_s /= 2; /* no slip, which is a sensor's that turns as fast */
    observe(size_wb * cos(turn), -size_wb * sin(turn), i_d_a, i_q_a);
    run(steps);
    return seen.sensor_wrong;
}

/* 16 degrees and 26 of L_q are within the 60; halls are up to 30 late. */
void test_an_opposed_sensor_is_beyond_every_healthy_one(void)
{
    const double late_deg = 46.0 + explained_deg(-126.0, 140.0);
    TEST_ASSERT_TRUE(is_wrong_after(CONFIG_ROTOR_ANGLE, 60.1, OPPOSED_STEPS));
    TEST_ASSERT_FALSE(is_wrong_after(CONFIG_ROTOR_HALL, late_deg - 0.2, 100));
    TEST_ASSERT_TRUE(is_wrong_after(CONFIG_ROTOR_HALL, late_deg + 0.2, OPPOSED_STEPS));
}
