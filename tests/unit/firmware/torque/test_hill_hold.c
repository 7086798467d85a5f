/* SPDX-License-Identifier: Apache-2.0 */
/* A hold from standstill, or before it uphill, until the vehicle drives off. */
#include "hill_hold_rig.h"
#include "random_values.h"

void setUp(void)
{
    rig_start();
}

void tearDown(void) {}

void test_hold_begins_at_standstill_while_braking(void)
{
    demand.brake_torque_mNm = 10000;
    TEST_ASSERT_EQUAL_INT32(0, step()); /* still rolls */
    demand.brake_torque_mNm = 0;
    standstill = true;
    TEST_ASSERT_EQUAL_INT32(0, step()); /* came to rest by itself */
    hold();
    standstill = false; /* the vehicle is pushed */
    TEST_ASSERT_EQUAL_INT32(HOLD, step());
}

/* Before standstill what the road brakes with. */
enum { HOLD_AHEAD = 14000 };

/* Uphill, with less demanded than the slope pulls with. */
static void stop_uphill(void)
{
    demand.brake_torque_mNm = 10000;
    road_mNm = HOLD_AHEAD;
    speed_mrad_s = 2000;
    split.slower_mrad_s = 1000;
    TEST_ASSERT_EQUAL_INT32(0, step());
    speed_mrad_s = 1000;
    split.slower_mrad_s = 0; /* it stands when the hydraulic brake has followed */
}

void test_hold_begins_before_standstill_where_the_slope_pulls_with_more_than_the_demand(void)
{
    stop_uphill();
    TEST_ASSERT_EQUAL_INT32(HOLD_AHEAD, step());
    speed_mrad_s = -100; /* stands, and begins to roll back: the speed is expected to grow */
    split.slower_mrad_s = 300;
    TEST_ASSERT_EQUAL_INT32(HOLD_AHEAD, step());
    standstill = true;
    TEST_ASSERT_EQUAL_INT32(HOLD, step());
    demand.brake_torque_mNm = 0;
    TEST_ASSERT_EQUAL_INT32(HOLD, step());
}

void test_a_demand_that_holds_the_slope_has_no_hold_before_standstill(void)
{
    stop_uphill();
    road_mNm = 8000; /* an eighth less than the demand, and a tolerance */
    TEST_ASSERT_EQUAL_INT32(0, step());
    road_mNm = 9000;
    TEST_ASSERT_EQUAL_INT32(9000, step());
}

void test_hold_before_standstill_ends_with_the_braking_or_if_the_wheel_becomes_faster(void)
{
    stop_uphill();
    TEST_ASSERT_EQUAL_INT32(HOLD_AHEAD, step());
    demand.brake_torque_mNm = 0;
    TEST_ASSERT_EQUAL_INT32(HOLD_AHEAD - 400, step()); /* at the torque rate */
    demand.brake_torque_mNm = 10000;
    TEST_ASSERT_EQUAL_INT32(HOLD_AHEAD, step());
    speed_mrad_s = 2100; /* began at 1000 */
    split.slower_mrad_s = 2100;
    TEST_ASSERT_EQUAL_INT32(HOLD_AHEAD - 400, step());
    hill_hold_init(&state);
    stop_uphill();
    demand.engaged = DRIVE_DIRECTION_NEUTRAL;
    TEST_ASSERT_EQUAL_INT32(0, step());
}

void test_without_a_hold_torque_there_is_none(void)
{
    config.driver.hold_torque_mNm = 0;
    standstill = true;
    demand.brake_torque_mNm = 10000;
    TEST_ASSERT_EQUAL_INT32(0, step());
}

/* A slope that pulls with G rolls the vehicle back if hold + T < G. hold = H (1 - T/T_r) with T_r
 * = H here, so the sum is H at any T. */
void test_hold_and_motor_torque_together_hold_the_slope_while_the_torque_rises(void)
{
    hold();
    config.driver.hold_release_ms = 10000;
    for (int32_t torque_mNm = 0; torque_mNm < HOLD; torque_mNm += 400) {
        const int32_t hold_mNm = drive(40000, torque_mNm);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(HOLD - torque_mNm - HOLD / 10, hold_mNm);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(HOLD - torque_mNm, hold_mNm);
    }
    TEST_ASSERT_EQUAL_INT32(0, drive(40000, HOLD));
    TEST_ASSERT_EQUAL_INT32(0, drive(0, 0));
}

void test_small_driving_torque_releases_within_the_release_time(void)
{
    hold();
    for (int n = 0; n < RELEASE - 1; n++) {
        TEST_ASSERT_GREATER_THAN_INT32(0, drive(1000, 1000));
    }
    TEST_ASSERT_EQUAL_INT32(0, drive(1000, 1000));
}

void test_wheel_that_rolls_back_is_caught_until_the_torque_suffices(void)
{
    hold();
    for (int n = 0; n < RELEASE / 2; n++) {
        drive(1000, 1000);
    }
    speed_mrad_s = BACK;
    TEST_ASSERT_EQUAL_INT32(29000, drive(1000, 1000));
    speed_mrad_s = 0;
    for (int n = 0; n < 2 * RELEASE; n++) {
        TEST_ASSERT_EQUAL_INT32(29000, drive(1000, 1000));
    }
    TEST_ASSERT_EQUAL_INT32(0, drive(40000, HOLD));
}

void test_wheel_that_drives_off_is_released_at_the_torque_rate(void)
{
    hold();
    speed_mrad_s = 400;
    const int32_t first_mNm = drive(10000, 10000);
    TEST_ASSERT_EQUAL_INT32(first_mNm - 400, drive(10000, 10000));
    TEST_ASSERT_EQUAL_INT32(first_mNm - 800, drive(0, 0)); /* also when the pedal is released */
}

void test_driver_who_changes_his_mind_is_held_again(void)
{
    hold();
    drive(10000, 10000);
    TEST_ASSERT_EQUAL_INT32(HOLD, drive(0, 9600));
}

void test_reverse_is_the_mirror_image(void)
{
    demand.engaged = DRIVE_DIRECTION_REVERSE;
    hold();
    TEST_ASSERT_INT32_WITHIN(HOLD / RELEASE, 20000, drive(-40000, -10000));
    speed_mrad_s = -BACK;
    TEST_ASSERT_EQUAL_INT32(20000, drive(-40000, -10000));
    TEST_ASSERT_TRUE(state.caught);
}

void test_neutral_releases_at_the_torque_rate_and_does_not_hold(void)
{
    hold();
    demand.engaged = DRIVE_DIRECTION_NEUTRAL;
    TEST_ASSERT_EQUAL_INT32(HOLD - 400, step());
    TEST_ASSERT_EQUAL_INT32(HOLD - 800, step());
    demand.brake_torque_mNm = 10000;
    TEST_ASSERT_EQUAL_INT32(HOLD - 1200, step());
}
/* ---- exact limits ---- */

/* Any braking, however little, begins it; a driving demand, however little, does not. */
void test_a_millinewton_metre_of_braking_at_standstill_is_enough(void)
{
    standstill = true;
    demand.brake_torque_mNm = 1;
    TEST_ASSERT_EQUAL_INT32(HOLD, step());
}

void test_before_standstill_any_braking_is_enough_and_any_driving_too_much(void)
{
    demand.brake_torque_mNm = 1;
    road_mNm = 2;
    speed_mrad_s = 1; /* as slow as it can be seen */
    TEST_ASSERT_EQUAL_INT32(2, step());
    hill_hold_init(&state);
    stop_uphill();
    demand.drive_torque_mNm = 1;
    TEST_ASSERT_EQUAL_INT32(0, step());
    hill_hold_init(&state);
    demand.drive_torque_mNm = -1;
    TEST_ASSERT_EQUAL_INT32(0, step());
}

/* An eighth of 10 N m less: more than 8.75 N m. */
void test_the_road_counts_from_seven_eighths_of_the_demand_on(void)
{
    stop_uphill();
    road_mNm = 8750;
    TEST_ASSERT_EQUAL_INT32(0, step());
    road_mNm = 8751;
    TEST_ASSERT_EQUAL_INT32(8751, step());
}

/* At 1000 mrad/s what is left when the hydraulic brake has followed is at most 333. */
void test_hold_begins_when_a_third_of_the_speed_is_left(void)
{
    stop_uphill();
    split.slower_mrad_s = 334;
    TEST_ASSERT_EQUAL_INT32(0, step());
    split.slower_mrad_s = 333;
    TEST_ASSERT_EQUAL_INT32(HOLD_AHEAD, step());
}

/* What the slope is taken for later moves it no more; the hold at standstill is whole. */
void test_hold_before_standstill_stays_what_it_was_at_its_beginning(void)
{
    stop_uphill();
    TEST_ASSERT_EQUAL_INT32(HOLD_AHEAD, step());
    road_mNm = 12000;
    TEST_ASSERT_EQUAL_INT32(HOLD_AHEAD, step());
    road_mNm = 21000;
    TEST_ASSERT_EQUAL_INT32(HOLD_AHEAD, step());
    standstill = true;
    TEST_ASSERT_EQUAL_INT32(HOLD, step());
}

void test_hold_before_standstill_is_at_most_the_whole_hold(void)
{
    stop_uphill();
    road_mNm = INT32_MAX;
    TEST_ASSERT_EQUAL_INT32(HOLD, step());
}

void test_hold_before_standstill_is_the_same_in_reverse(void)
{
    stop_uphill();
    demand.engaged = DRIVE_DIRECTION_REVERSE;
    speed_mrad_s = -1000;
    split.slower_mrad_s = 333;
    TEST_ASSERT_EQUAL_INT32(HOLD_AHEAD, step());
}

/* It began at 1000 mrad/s: up to 2001, halves rounded down, it stays. */
void test_hold_before_standstill_stays_up_to_twice_the_speed_at_which_it_began(void)
{
    stop_uphill();
    TEST_ASSERT_EQUAL_INT32(HOLD_AHEAD, step());
    speed_mrad_s = 2001;
    split.slower_mrad_s = 2001;
    TEST_ASSERT_EQUAL_INT32(HOLD_AHEAD, step());
    speed_mrad_s = 2002;
    TEST_ASSERT_EQUAL_INT32(HOLD_AHEAD - 400, step());
}

void test_the_speed_at_which_it_began_stays_that_of_the_beginning(void)
{
    stop_uphill();
    TEST_ASSERT_EQUAL_INT32(HOLD_AHEAD, step());
    speed_mrad_s = 1900;
    TEST_ASSERT_EQUAL_INT32(HOLD_AHEAD, step());
    speed_mrad_s = 2100; /* more than twice 1000, less than twice 1900 */
    split.slower_mrad_s = 2100;
    TEST_ASSERT_EQUAL_INT32(HOLD_AHEAD - 400, step());
}

/* Held and rolling back at 1 rad/s: what the motor's torque alone leaves of the hold. */
static int32_t caught(int32_t command_mNm)
{
    hill_hold_init(&state);
    speed_mrad_s = 0;
    demand.drive_torque_mNm = 0;
    hold();
    speed_mrad_s = BACK;
    return drive(1, command_mNm);
}

/* T_r = min(30, 3/4 of the largest torque) N m; half of it leaves half of the hold. */
void test_the_torque_that_releases_is_the_hold_s_or_three_quarters_of_the_motor_s(void)
{
    config.motor.max_torque_mNm = 20000;
    TEST_ASSERT_EQUAL_INT32(HOLD, caught(0));
    TEST_ASSERT_EQUAL_INT32(HOLD / 2, caught(7500));
    TEST_ASSERT_EQUAL_INT32(2, caught(14999)); /* 30 N m / 15 N m of the last mN m */
    TEST_ASSERT_EQUAL_INT32(0, caught(15000));
    config.motor.max_torque_mNm = 80000;
    TEST_ASSERT_EQUAL_INT32(HOLD / 2, caught(15000));
    TEST_ASSERT_EQUAL_INT32(1, caught(29999));
    TEST_ASSERT_EQUAL_INT32(HOLD, caught(-15000)); /* a torque backward holds no slope */
}

void test_a_hold_of_one_millinewton_metre_is_a_hold(void)
{
    config.driver.hold_torque_mNm = 1;
    standstill = true;
    demand.brake_torque_mNm = 1;
    TEST_ASSERT_EQUAL_INT32(1, step());
    demand.brake_torque_mNm = 0;
    speed_mrad_s = BACK;
    TEST_ASSERT_EQUAL_INT32(1, drive(1, 0));
    TEST_ASSERT_EQUAL_INT32(1, drive(1, 0));
    TEST_ASSERT_EQUAL_INT32(0, drive(1, 1));
}

void test_a_hold_of_one_millinewton_metre_begins_before_standstill_too(void)
{
    config.driver.hold_torque_mNm = 1;
    stop_uphill();
    TEST_ASSERT_EQUAL_INT32(1, step());
}

void test_without_a_hold_torque_driving_off_is_possible_at_once(void)
{
    config.driver.hold_torque_mNm = 0;
    standstill = true;
    demand.brake_torque_mNm = 10000;
    TEST_ASSERT_EQUAL_INT32(0, step());
    demand.brake_torque_mNm = 0;
    TEST_ASSERT_EQUAL_INT32(0, drive(1, 0));
}

/* Standstill is up to 300 mrad/s either way. */
void test_the_wheel_rolls_back_or_drives_off_beyond_the_speed_of_standstill(void)
{
    static const int32_t EDGES_mrad_s[] = {-300, -301, 300, 301};
    for (int k = 0; k < 4; k++) {
        hill_hold_init(&state);
        speed_mrad_s = 0;
        demand.drive_torque_mNm = 0;
        hold();
        speed_mrad_s = EDGES_mrad_s[k];
        drive(1, 0);
        TEST_ASSERT_EQUAL_INT(k == 1, state.caught);
        TEST_ASSERT_EQUAL_INT32(k == 3 ? HOLD - HOLD / RELEASE - 400 : HOLD, drive(0, 0));
    }
}

/* ---- what a step forgets ---- */

void test_a_release_that_is_interrupted_begins_again_with_its_whole_time(void)
{
    static const bool AHEAD[] = {false, true};
    for (int k = 0; k < 2; k++) {
        hill_hold_init(&state);
        demand.drive_torque_mNm = road_mNm = speed_mrad_s = 0;
        hold();
        standstill = false;
        speed_mrad_s = BACK;
        drive(1000, 1000);
        speed_mrad_s = 0;
        for (int n = 1; n < RELEASE / 2; n++) {
            drive(1000, 1000);
        }
        TEST_ASSERT_TRUE(state.caught);
        demand.brake_torque_mNm =
            AHEAD[k] ? 10000 : 0; /* on a slope that the demand does not hold */
        road_mNm = AHEAD[k] ? 12000 : 0;
        speed_mrad_s = AHEAD[k] ? 100 : 0;
        split.slower_mrad_s = 0;
        TEST_ASSERT_EQUAL_INT32(HOLD, drive(0, 600));
        TEST_ASSERT_FALSE(state.caught);
        demand.brake_torque_mNm = 0;
        for (int n = 1; n < RELEASE; n++) {
            TEST_ASSERT_GREATER_THAN_INT32(0, drive(1000, 0));
        }
        TEST_ASSERT_EQUAL_INT32(0, drive(1000, 0));
    }
}

void test_the_time_of_a_release_ends_with_it(void)
{
    (void)caught(1000);
    for (int n = 0; n < 2 * RELEASE; n++) {
        drive(1000, 1000);
    }
    TEST_ASSERT_EQUAL_INT32(RELEASE, state.release_ms);
}

void test_braking_at_standstill_does_not_begin_a_release_again(void)
{
    hold();
    demand.brake_torque_mNm = 1;
    for (int n = 1; n < RELEASE; n++) {
        TEST_ASSERT_GREATER_THAN_INT32(0, drive(1000, 0));
    }
    TEST_ASSERT_EQUAL_INT32(0, drive(1000, 0));
}

void test_a_hold_that_neutral_has_ended_does_not_come_back(void)
{
    hold();
    standstill = false;
    demand.engaged = DRIVE_DIRECTION_NEUTRAL;
    TEST_ASSERT_EQUAL_INT32(HOLD - 400, step());
    demand.engaged = DRIVE_DIRECTION_FORWARD;
    TEST_ASSERT_EQUAL_INT32(HOLD - 800, step());
}

void test_hold_is_between_zero_and_its_torque_for_any_input(void)
{
    random_t random = random_seeded(4);
    for (int n = 0; n < 200000; n++) {
        demand.brake_torque_mNm = random_chance(&random, 0.5) ? 0 : random_wild(&random);
        motor_mNm = random_wild(&random);
        demand.drive_torque_mNm = random_chance(&random, 0.5) ? 0 : random_wild(&random);
        speed_mrad_s = random_chance(&random, 0.5) ? CREEP : random_wild(&random);
        road_mNm = random_chance(&random, 0.5) ? 0 : q_max(random_wild(&random), 0);
        split.slower_mrad_s = random_chance(&random, 0.5) ? 0 : q_max(random_wild(&random), 0);
        demand.engaged = (drive_direction_t)random_between(&random, 0, 2);
        standstill = random_chance(&random, 0.5);
        if (random_chance(&random, 0.001)) {
            config.driver.hold_torque_mNm = random_between(&random, 0, 20000000);
            config.motor.max_torque_mNm = random_between(&random, 10, 20000000);
            hill_hold_init(&state);
        }
        const int32_t torque_mNm = step();
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, torque_mNm);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(config.driver.hold_torque_mNm, torque_mNm);
    }
}
