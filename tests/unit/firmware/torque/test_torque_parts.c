/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What the slow step gives to its parts and takes from them: when the hydraulic brake is watched,
 * which side the limits are solved for, the hold, and the reason shown.
 */
#include <string.h>

#include "torque_rig.h"
#include "unity.h"

enum { HOLD = 30000, CREEP_mrad_s = 100 };

void setUp(void)
{
    torque_rig_reset();
}

void tearDown(void) {}

static torque_output_t run(int milliseconds)
{
    for (int n = 1; n < milliseconds; n++) {
        step();
    }
    return step();
}

void test_every_part_begins_anew(void)
{
    torque_state_t used;
    available_ahead_state_t ahead;
    memset(&used, 0x5A, sizeof used);
    memset(&ahead, 0x5A, sizeof ahead);
    torque_init(&used, &config);
    available_ahead_init(&ahead);
    TEST_ASSERT_EQUAL_INT32(0, used.hold.torque_mNm);
    TEST_ASSERT_FALSE(used.hold.holds);
    TEST_ASSERT_EQUAL_UINT32(ahead.step, used.ahead.step);
    TEST_ASSERT_EQUAL_INT32(ahead.now.driving.torque_mNm, used.ahead.now.driving.torque_mNm);
    TEST_ASSERT_EQUAL_INT32(ahead.ahead.braking.torque_mNm, used.ahead.ahead.braking.torque_mNm);
}

/* ---- the hydraulic brake is watched where speed and motor torque can be trusted ---- */

/* The watch pauses while it is not trusted, and after the first step's change of speed. */
static void settle_watch(void)
{
    run(HYDRAULIC_WATCH_PAUSE_ms + 1);
}

static bool is_watched(void)
{
    step();
    return state.blending.watch.pause_ms == 0;
}

void test_the_hydraulic_brake_is_watched_with_healthy_sensors(void)
{
    settle_watch();
    const torque_state_t settled = state;
    for (int reason = 0; reason < 128; reason++) {
        state = settled;
        in.torque_enable.reason = (reason_t)reason;
        const bool trusted = reason == REASON_NONE || reason == REASON_TORQUE_ENABLE ||
                             reason == REASON_HYDRAULIC_FEEDBACK ||
                             reason == REASON_HYDRAULIC_WEAK || reason == REASON_HYDRAULIC_DEAD ||
                             reason == REASON_HYDRAULIC_STRONG ||
                             reason == REASON_HYDRAULIC_STUCK || reason == REASON_HYDRAULIC_LATE;
        TEST_ASSERT_EQUAL_INT(trusted, is_watched());
    }
}

void test_the_hydraulic_brake_is_watched_with_a_valid_angle_and_without_slip_only(void)
{
    settle_watch();
    const torque_state_t settled = state;
    TEST_ASSERT_TRUE(is_watched());
    in.rotor_valid = false;
    TEST_ASSERT_FALSE(is_watched());
    in.rotor_valid = true;
    state = settled;
    in.abs_active = true;
    in.abs_share_percent = 100;
    TEST_ASSERT_FALSE(is_watched());
}

/* The brake system's own path: neither the command nor a report of it says anything. */
void test_a_brake_that_is_not_commanded_is_neither_watched_nor_read(void)
{
    in.hydraulic.age_ms = 0;
    in.hydraulic.valid = true;
    settle_watch();
    TEST_ASSERT_TRUE(is_watched());
    TEST_ASSERT_TRUE(state.blending.feedback.seen);
    in.demand_age_ms = UINT32_MAX;
    TEST_ASSERT_TRUE(is_watched()); /* the demand is kept */
    run(config.driver.lost_hold_ms + 10);
    TEST_ASSERT_FALSE(is_watched());
    const int32_t since_ms = state.blending.feedback.since_ms;
    step();
    TEST_ASSERT_EQUAL_INT32(since_ms + 1, state.blending.feedback.since_ms);
}

/* ---- whose limits are solved ---- */

/* In how many of eight steps a line follows the speed, on which the losses depend. */
static int steps_solved(bool braking)
{
    const limit_t *line =
        &(braking ? state.table.braking : state.table.driving)[TORQUE_LINE_PHASE_CURRENT];
    int solved = 0;
    for (int n = 0; n < TORQUE_LIMITS_TURN_steps; n++) {
        const int32_t before_mNm = line->torque_mNm;
        in.speed_mrad_s += 100;
        step();
        solved += line->torque_mNm != before_mNm ? 1 : 0;
    }
    return solved;
}

/* The other side once in eight steps. */
static void assert_demanded(side_t side)
{
    TEST_ASSERT_EQUAL_INT(side == SIDE_DRIVING ? TORQUE_LIMITS_TURN_steps : 1, steps_solved(false));
    TEST_ASSERT_EQUAL_INT(side == SIDE_BRAKING ? TORQUE_LIMITS_TURN_steps : 1, steps_solved(true));
}

void test_the_limits_of_the_demanded_side_alone_are_solved_in_every_step(void)
{
    config.motor.max_phase_current_mA = 20000; /* less than the largest torque takes */
    torque_init(&state, &config);
    step();
    assert_demanded(SIDE_DRIVING);
    in.drive_torque_mNm = 1;
    assert_demanded(SIDE_DRIVING);
    in.drive_torque_mNm = -1; /* lift-off braking */
    assert_demanded(SIDE_BRAKING);
    in.drive_torque_mNm = 0;
    in.brake_torque_mNm = 1;
    assert_demanded(SIDE_BRAKING);
    in.brake_torque_mNm = 0;
    in.drive_torque_mNm = 1000;
    in.speed_mrad_s = -in.speed_mrad_s; /* rolls back */
    assert_demanded(SIDE_BRAKING);
}

/* ---- the hold ---- */

static void stand_still(void)
{
    config.driver.hold_torque_mNm = HOLD;
    in.speed_mrad_s = 0;
    in.standstill = true;
}

void test_the_hold_counts_for_braking_and_lift_off_at_standstill(void)
{
    stand_still();
    in.brake_torque_mNm = 10000;
    torque_output_t out = step();
    TEST_ASSERT_EQUAL_INT32(HOLD, out.hydraulic_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_HILL_HOLD, out.hydraulic_reason);
    TEST_ASSERT_EQUAL_INT32(HOLD - 10000, state.blending.added_mNm);
    in.brake_torque_mNm = HOLD; /* no more than is demanded */
    out = step();
    TEST_ASSERT_EQUAL_INT32(HOLD, out.hydraulic_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, out.hydraulic_reason);
    torque_rig_reset();
    stand_still();
    in.drive_torque_mNm = -5000;
    TEST_ASSERT_EQUAL_INT32(HOLD, step().hydraulic_mNm);
}

void test_the_hydraulic_brake_has_what_the_blend_out_takes_of_lift_off_braking(void)
{
    in.speed_mrad_s = CREEP_mrad_s;
    in.drive_torque_mNm = -5000;
    TEST_ASSERT_EQUAL_INT32(5000, step().hydraulic_mNm);
}

/* The hydraulic brake fills up what the motor's optimum leaves of 60 N m: of lift-off braking it
 * takes over none. */
void test_lift_off_braking_stays_with_the_motor_while_the_hydraulic_brake_arrives(void)
{
    in.speed_mrad_s = mrad_s_of_rpm(60.0);
    in.brake_torque_mNm = 60000;
    const int32_t optimum_mNm = run(1000).command_mNm;
    torque_rig_reset();
    in.speed_mrad_s = mrad_s_of_rpm(60.0);
    in.brake_torque_mNm = 60000;
    in.drive_torque_mNm = -5000;
    int32_t most_mNm = 0;
    for (int n = 0; n < 1000; n++) {
        const torque_output_t out = step();
        TEST_ASSERT_LESS_OR_EQUAL_INT32(most_mNm, out.command_mNm);
        most_mNm = out.command_mNm;
    }
    TEST_ASSERT_EQUAL_INT32(optimum_mNm - 5000, most_mNm);
}

/* ---- the reason shown ---- */

void test_one_millinewton_metre_of_braking_shows_its_reason(void)
{
    in.speed_mrad_s = CREEP_mrad_s;
    in.brake_torque_mNm = 1;
    TEST_ASSERT_EQUAL_INT(REASON_LOSS_OPTIMUM, step().reason); /* none, so slowly */
    in.brake_torque_mNm = 0;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().reason);
}

/* The hydraulic brake's torque falls after the motor's: that is no limit of the motor any more. */
void test_released_pedals_show_no_reason_once_the_motor_is_without_torque(void)
{
    in.brake_torque_mNm = 60000;
    run(1000);
    in.brake_torque_mNm = 0;
    int shown = 0;
    for (int n = 0; n < 500; n++) {
        const torque_output_t out = step();
        if (out.command_mNm == 0 && state.blending.taken_mNm > 0) {
            shown++;
            TEST_ASSERT_EQUAL_INT(REASON_NONE, out.reason);
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(10, shown);
}

/* 2 A a motor of 53 V at 15.7 rad/s: 6.7 N m and the losses. */
void test_lift_off_braking_shows_the_limit_that_bounds_it(void)
{
    in.drive_torque_mNm = -30000;
    in.bms_charge_current_mA = 8000;
    const torque_output_t out = run(300);
    TEST_ASSERT_GREATER_THAN_INT32(-20000, out.command_mNm);
    TEST_ASSERT_LESS_THAN_INT32(-5000, out.command_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_CHARGE_CURRENT, out.reason);
}

/* The limit of the setpoint alone; the table's is that of the start. */
void test_phase_current_comes_before_the_torque_rate_and_after_other_limits(void)
{
    in.drive_torque_mNm = 30000;
    run(300);
    config.motor.max_phase_current_mA = 5000;
    TEST_ASSERT_EQUAL_INT(REASON_PHASE_CURRENT, step().reason);
    in.drive_torque_mNm = 35000;
    TEST_ASSERT_EQUAL_INT(REASON_PHASE_CURRENT, step().reason);
    in.winding_temperature_cC = config.motor.max_winding_temperature_cC - 1000;
    TEST_ASSERT_EQUAL_INT(REASON_WINDING_TEMPERATURE, run(300).reason);
}

/* ---- estimate and look ahead ---- */

/* More than 32.768 N m: one of 32 768 parts of the flux is a millinewton-metre. */
void test_the_estimate_lacks_the_missing_flux_s_part(void)
{
    in.drive_torque_mNm = 38000;
    run(300);
    int32_t estimates_mNm[3];
    for (int k = 0; k < 3; k++) {
        torque_state_t copy = state;
        in.flux_missing_q15 = k - 1;
        estimates_mNm[k] = torque_step(&copy, &config, &in).estimate_mNm;
    }
    TEST_ASSERT_GREATER_THAN_INT32(32768, estimates_mNm[1]);
    TEST_ASSERT_EQUAL_INT32(estimates_mNm[1], estimates_mNm[0]);
    TEST_ASSERT_EQUAL_INT32(estimates_mNm[1] - 1, estimates_mNm[2]);
}

void test_looking_ahead_goes_on_with_every_call(void)
{
    step();
    const uint32_t before = state.ahead.step;
    torque_look_ahead(&state, &config, &in);
    TEST_ASSERT_NOT_EQUAL_UINT32(before, state.ahead.step);
}
