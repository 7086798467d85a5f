/* SPDX-License-Identifier: Apache-2.0 */
/* A hold whose motor is gone, over a restart, and on a wheel that turns all the same. */
#include "hill_hold_rig.h"

void setUp(void)
{
    rig_start();
}

void tearDown(void) {}

/* ---- a motor that is gone ---- */

/* At standstill with the pedal down, without a driving torque: by a fault, or without a link. */
void test_a_motor_that_may_not_drive_releases_nothing(void)
{
    hold();
    may_drive = false;
    for (int n = 0; n < 2 * RELEASE; n++) {
        TEST_ASSERT_EQUAL_INT32(HOLD, drive(40000, 0));
    }
}

void test_a_release_that_loses_its_motor_is_taken_back(void)
{
    hold();
    TEST_ASSERT_LESS_THAN_INT32(HOLD, drive(20000, 20000));
    may_drive = false;
    TEST_ASSERT_EQUAL_INT32(HOLD, drive(20000, 19600));
}

/* Driven off at 1 rad/s. */
static void leave(int32_t at_mrad_s)
{
    hold();
    standstill = false;
    speed_mrad_s = at_mrad_s;
    (void)drive(40000, 25000);
    for (int n = 0; n < HOLD / 400; n++) {
        (void)drive(40000, HOLD);
    }
    TEST_ASSERT_EQUAL_INT32(0, drive(40000, HOLD));
}

void test_a_wheel_that_loses_its_motor_while_it_drives_off_is_held_when_it_comes_back(void)
{
    leave(1000);
    may_drive = false;
    TEST_ASSERT_EQUAL_INT32(0, drive(0, 0)); /* it still goes forward */
    speed_mrad_s = -300;
    TEST_ASSERT_EQUAL_INT32(0, step()); /* slower than standstill, by a sensor alone */
    speed_mrad_s = -301;
    TEST_ASSERT_EQUAL_INT32(HOLD, step());
    setUp();
    leave(1000);
    may_drive = false;
    standstill = true;
    speed_mrad_s = 0;
    TEST_ASSERT_EQUAL_INT32(HOLD, drive(40000, 0));
    setUp();
    leave(1000);
    may_drive = false;
    seen = false; /* its sensor is gone as well */
    TEST_ASSERT_EQUAL_INT32(HOLD, drive(40000, 0));
}

void test_a_wheel_whose_motor_may_drive_or_that_was_faster_rolls_back_as_its_driver_wants(void)
{
    leave(1000);
    speed_mrad_s = BACK;
    TEST_ASSERT_EQUAL_INT32(0, drive(0, 0));
    setUp();
    leave(1000);
    speed_mrad_s = SLOW + 1;
    TEST_ASSERT_EQUAL_INT32(0, drive(0, 0));
    may_drive = false;
    speed_mrad_s = BACK;
    TEST_ASSERT_EQUAL_INT32(0, step());
    setUp();
    leave(SLOW);
    may_drive = false;
    speed_mrad_s = BACK;
    TEST_ASSERT_EQUAL_INT32(HOLD, step());
}

void test_neutral_and_the_brake_pedal_end_the_watch_over_a_wheel_that_drives_off(void)
{
    for (int neutral = 0; neutral <= 1; neutral++) {
        setUp();
        leave(1000);
        may_drive = false;
        demand.brake_torque_mNm = 1 - neutral;
        demand.engaged = neutral != 0 ? DRIVE_DIRECTION_NEUTRAL : DRIVE_DIRECTION_FORWARD;
        TEST_ASSERT_EQUAL_INT32(0, drive(0, 0));
        demand.brake_torque_mNm = 0;
        demand.engaged = DRIVE_DIRECTION_FORWARD;
        speed_mrad_s = BACK;
        TEST_ASSERT_EQUAL_INT32(0, step());
    }
}

/* ---- a restart ---- */

/* As the application does it: another controller, with what was kept of this one. */
static void restart(void)
{
    const hill_hold_kept_t kept = hill_hold_keep(&state, demand.engaged);
    demand.engaged = kept.direction;
    demand.drive_torque_mNm = 0;
    demand.brake_torque_mNm = 0;
    motor_mNm = 0;
    may_drive = false; /* no link, no calibrated sensors yet */
    standstill = true; /* no edge has been seen yet */
    hill_hold_init(&state);
    hill_hold_resume(&state, &kept);
}

void test_a_held_vehicle_is_held_in_the_first_millisecond_after_a_restart_and_after_another(void)
{
    hold();
    for (int n = 0; n < 3; n++) {
        restart();
        TEST_ASSERT_EQUAL_INT32(HOLD, step());
        TEST_ASSERT_TRUE(hill_hold_works(&state));
    }
    restart();
    restart(); /* before the first step */
    TEST_ASSERT_EQUAL_INT32(HOLD, step());
    may_drive = true;
    TEST_ASSERT_EQUAL_INT32(HOLD, step());
    TEST_ASSERT_EQUAL_INT32(0, drive(40000, HOLD)); /* as usual */
}

void test_what_is_not_held_is_not_held_after_a_restart(void)
{
    demand.brake_torque_mNm = 10000;
    speed_mrad_s = 10000;
    TEST_ASSERT_EQUAL_INT32(0, step());
    restart();
    TEST_ASSERT_EQUAL_INT(DRIVE_DIRECTION_NEUTRAL, demand.engaged);
    TEST_ASSERT_EQUAL_INT32(0, step());
    setUp();
    hold();
    demand.engaged = DRIVE_DIRECTION_NEUTRAL;
    (void)step();
    demand.engaged = DRIVE_DIRECTION_FORWARD;
    restart();
    TEST_ASSERT_EQUAL_INT32(0, step());
}

/* Slower it is caught, with hydraulic torque that stops it; faster it rolls, and that is told. */
void test_a_hold_is_not_resumed_on_a_wheel_that_rolls_and_that_is_told(void)
{
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        setUp();
        hold();
        restart();
        speed_mrad_s = sign * SLOW;
        TEST_ASSERT_EQUAL_INT32(HOLD, step());
        TEST_ASSERT_FALSE(hill_hold_fails(&state));
        speed_mrad_s = sign * (SLOW + 1);
        TEST_ASSERT_EQUAL_INT32(0, step());
        TEST_ASSERT_TRUE(hill_hold_fails(&state));
        TEST_ASSERT_FALSE(hill_hold_works(&state));
        speed_mrad_s = sign * 301;
        TEST_ASSERT_EQUAL_INT32(0, step());
        TEST_ASSERT_TRUE(hill_hold_fails(&state));
        speed_mrad_s = sign * 300;
        TEST_ASSERT_EQUAL_INT32(0, step());
        TEST_ASSERT_FALSE(hill_hold_fails(&state));
    }
}

void test_a_lost_hold_is_told_until_the_driver_takes_over(void)
{
    for (int brakes = 0; brakes <= 1; brakes++) {
        setUp();
        hold();
        restart();
        standstill = false;
        speed_mrad_s = SLOW + 1;
        (void)step();
        TEST_ASSERT_TRUE(hill_hold_fails(&state));
        may_drive = true; /* that alone is not enough */
        (void)step();
        TEST_ASSERT_TRUE(hill_hold_fails(&state));
        demand.brake_torque_mNm = brakes;
        demand.drive_torque_mNm = 1 - brakes;
        (void)step();
        TEST_ASSERT_FALSE(hill_hold_fails(&state));
    }
}

/* Braked by its driver, or with its motor back, it is a hold like any other. */
void test_a_resumed_hold_is_one_like_any_other_as_soon_as_the_driver_brakes_or_could_drive(void)
{
    for (int brakes = 0; brakes <= 1; brakes++) {
        setUp();
        hold();
        restart();
        may_drive = brakes == 0;
        demand.brake_torque_mNm = brakes;
        (void)step();
        demand.brake_torque_mNm = 0;
        may_drive = false;
        standstill = false;
        speed_mrad_s = SLOW + 1; /* it is towed */
        TEST_ASSERT_EQUAL_INT32(HOLD, step());
    }
}

void test_without_a_hold_torque_none_is_lost(void)
{
    config.driver.hold_torque_mNm = 0;
    standstill = true;
    demand.brake_torque_mNm = 10000;
    (void)step();
    restart();
    speed_mrad_s = SLOW + 1;
    TEST_ASSERT_EQUAL_INT32(0, step());
    TEST_ASSERT_FALSE(hill_hold_fails(&state));
    TEST_ASSERT_FALSE(hill_hold_works(&state));
}

/* After a restart a wheel that drives off shows no speed at first, and is not taken for standing.
 */
void test_a_restart_while_driving_off_holds_a_wheel_that_rolls_back_and_no_other(void)
{
    leave(1000);
    restart();
    TEST_ASSERT_EQUAL_INT32(0, step());
    speed_mrad_s = 1000;
    standstill = false;
    TEST_ASSERT_EQUAL_INT32(0, step());
    restart();
    TEST_ASSERT_EQUAL_INT32(0, step());
    speed_mrad_s = -301;
    TEST_ASSERT_EQUAL_INT32(HOLD, step());
    speed_mrad_s = -SLOW - 1;
    TEST_ASSERT_EQUAL_INT32(0, step());
    TEST_ASSERT_TRUE(hill_hold_fails(&state));
}

/* ---- a wheel that turns although it is held ---- */

void test_a_held_wheel_that_turns_for_a_second_is_told_and_its_hold_does_not_work(void)
{
    hold();
    standstill = false;
    speed_mrad_s = BACK;
    for (int n = 1; n < HILL_HOLD_CAUGHT_ms; n++) {
        TEST_ASSERT_EQUAL_INT32(HOLD, step());
    }
    TEST_ASSERT_TRUE(hill_hold_works(&state));
    TEST_ASSERT_FALSE(hill_hold_fails(&state));
    TEST_ASSERT_EQUAL_INT32(HOLD, step()); /* it goes on: what there is of it brakes */
    TEST_ASSERT_FALSE(hill_hold_works(&state));
    TEST_ASSERT_TRUE(hill_hold_fails(&state));
    TEST_ASSERT_EQUAL_INT32(HOLD, step());
    TEST_ASSERT_TRUE(hill_hold_fails(&state));
    speed_mrad_s = -300;
    TEST_ASSERT_EQUAL_INT32(HOLD, step());
    TEST_ASSERT_TRUE(hill_hold_works(&state));
    TEST_ASSERT_FALSE(hill_hold_fails(&state));
}

void test_a_wheel_that_its_motor_turns_is_no_failed_hold(void)
{
    hold();
    speed_mrad_s = BACK;
    for (int n = 0; n < 2 * HILL_HOLD_CAUGHT_ms; n++) {
        (void)drive(10000, 10000);
    }
    TEST_ASSERT_FALSE(hill_hold_fails(&state));
}
