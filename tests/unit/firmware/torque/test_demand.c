/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "core/q15.h"
#include "paper_vehicle.h"
#include "random_values.h"
#include "torque/demand.h"
#include "unity.h"

enum { TIMEOUT = 100, HOLD = 300, RATE = 400, ROLLING = 20000 };

static config_t config;
static demand_state_t state;
static slow_input_t in;
static int32_t speed_mrad_s;

void setUp(void)
{
    const slow_input_t none = {.demand.direction = DRIVE_DIRECTION_FORWARD};
    config = paper_vehicle();
    config.brake.demand_timeout_ms = TIMEOUT;
    config.brake.torque_rate_mNm_s = RATE * 1000; /* in a step of 1 ms */
    config.brake.hydraulic_dead_time_ms = 0;
    config.brake.hydraulic_time_constant_ms = 0;
    config.driver.lost_hold_ms = HOLD;
    config.driver.no_other_brake = 0;
    config.driver.direction_change_mrad_s = 3000;
    in = none;
    speed_mrad_s = 0;
    demand_init(&state);
}

void tearDown(void) {}

static demand_t step(int32_t drive_mNm, int32_t brake_mNm, uint32_t age_ms)
{
    in.demand.drive_torque_mNm = drive_mNm;
    in.demand.brake_torque_mNm = brake_mNm;
    in.demand_age_ms = age_ms;
    return demand_step(&state, &config, &in, speed_mrad_s);
}

static demand_t fresh(int32_t drive_mNm, int32_t brake_mNm)
{
    return step(drive_mNm, brake_mNm, 0);
}

static demand_t silent(int milliseconds)
{
    demand_t out = step(in.demand.drive_torque_mNm, in.demand.brake_torque_mNm, TIMEOUT + 1);
    for (int n = 1; n < milliseconds; n++) {
        out = step(in.demand.drive_torque_mNm, in.demand.brake_torque_mNm, TIMEOUT + 1);
    }
    return out;
}

void test_a_fresh_demand_passes_unchanged(void)
{
    const demand_t forward = fresh(12345, 0);
    TEST_ASSERT_EQUAL_INT32(12345, forward.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(0, forward.brake_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(0, forward.lift_off_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, forward.reason);
    TEST_ASSERT_EQUAL_INT(DRIVE_DIRECTION_FORWARD, forward.engaged);
    TEST_ASSERT_FALSE(forward.drive_withdrawn);
    TEST_ASSERT_TRUE(forward.hydraulic_valid);
    TEST_ASSERT_EQUAL_INT32(20000, fresh(0, 20000).brake_torque_mNm);
}

void test_braking_has_priority_over_driving_with_reason_brake_priority(void)
{
    const demand_t both = fresh(30000, 1);
    TEST_ASSERT_EQUAL_INT32(0, both.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(1, both.brake_torque_mNm);
    TEST_ASSERT_TRUE(both.drive_withdrawn);
    TEST_ASSERT_EQUAL_INT(REASON_BRAKE_PRIORITY, both.reason);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, fresh(0, 1).reason);
    TEST_ASSERT_EQUAL_INT32(30000, fresh(30000, 0).drive_torque_mNm);
}

void test_the_reason_of_the_pedals_is_shown_unless_the_demand_has_one_of_its_own(void)
{
    in.demand.reason = REASON_ACCELERATOR_LOCKED;
    TEST_ASSERT_EQUAL_INT(REASON_ACCELERATOR_LOCKED, fresh(0, 0).reason);
    TEST_ASSERT_EQUAL_INT(REASON_ACCELERATOR_LOCKED, fresh(0, 1).reason);
    TEST_ASSERT_EQUAL_INT(REASON_BRAKE_PRIORITY, fresh(30000, 1).reason);
    TEST_ASSERT_EQUAL_INT(REASON_DEMAND_TIMEOUT, silent(1).reason);
}

void test_negative_braking_demand_counts_as_zero(void)
{
    const demand_t out = fresh(5000, -20000);
    TEST_ASSERT_EQUAL_INT32(0, out.brake_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(5000, out.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(0, fresh(0, INT32_MIN).brake_torque_mNm);
}

/* ---- lift-off ---- */

void test_drive_demand_against_the_direction_is_lift_off_braking(void)
{
    demand_t out = fresh(-20000, 0);
    TEST_ASSERT_EQUAL_INT32(0, out.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(20000, out.lift_off_mNm);
    in.demand.direction = DRIVE_DIRECTION_REVERSE;
    out = fresh(20000, 0);
    TEST_ASSERT_EQUAL_INT32(0, out.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(20000, out.lift_off_mNm);
    TEST_ASSERT_EQUAL_INT32(-20000, fresh(-20000, 0).drive_torque_mNm);
}

/* UN R13-H: applying the service brake must not reduce lift-off braking. */
void test_brake_pedal_does_not_reduce_lift_off_braking(void)
{
    const demand_t out = fresh(-20000, 5000);
    TEST_ASSERT_EQUAL_INT32(20000, out.lift_off_mNm);
    TEST_ASSERT_EQUAL_INT32(5000, out.brake_torque_mNm);
}

void test_anti_lock_intervention_ends_lift_off_braking_only(void)
{
    in.demand.abs_active = true;
    TEST_ASSERT_EQUAL_INT32(0, fresh(-20000, 5000).lift_off_mNm);
    TEST_ASSERT_EQUAL_INT32(5000, fresh(-20000, 5000).brake_torque_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_ABS, fresh(-20000, 0).reason);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, fresh(0, 5000).reason);
    in.demand.abs_active = false;
    fresh(-20000, 5000);
    in.demand.abs_active = true;
    TEST_ASSERT_EQUAL_INT32(0, silent(1).lift_off_mNm);
}

/* ---- direction ---- */

void test_direction_is_refused_while_the_wheel_turns_against_it(void)
{
    fresh(0, 0);
    speed_mrad_s = ROLLING;
    in.demand.direction = DRIVE_DIRECTION_REVERSE;
    demand_t out = fresh(-10000, 0);
    TEST_ASSERT_EQUAL_INT(DRIVE_DIRECTION_NEUTRAL, out.engaged);
    TEST_ASSERT_EQUAL_INT32(0, out.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(0, out.lift_off_mNm);
    TEST_ASSERT_TRUE(out.drive_withdrawn);
    TEST_ASSERT_EQUAL_INT(REASON_DRIVE_DIRECTION, out.reason);
    TEST_ASSERT_EQUAL_INT32(8000,
                            fresh(-10000, 8000).brake_torque_mNm); /* the brake always works */
    speed_mrad_s = 3000;
    out = fresh(-10000, 0);
    TEST_ASSERT_EQUAL_INT(DRIVE_DIRECTION_REVERSE, out.engaged);
    TEST_ASSERT_EQUAL_INT32(-10000, out.drive_torque_mNm);
}

/* A vehicle in forward drive that rolls back on a slope still drives forward. */
void test_engaged_direction_stays_while_the_vehicle_rolls_back(void)
{
    fresh(0, 0);
    speed_mrad_s = -ROLLING;
    const demand_t out = fresh(10000, 0);
    TEST_ASSERT_EQUAL_INT(DRIVE_DIRECTION_FORWARD, out.engaged);
    TEST_ASSERT_EQUAL_INT32(10000, out.drive_torque_mNm);
}

void test_neutral_is_accepted_at_any_speed_and_left_in_the_direction_of_rolling(void)
{
    fresh(0, 0);
    speed_mrad_s = ROLLING;
    in.demand.direction = DRIVE_DIRECTION_NEUTRAL;
    const demand_t out = fresh(10000, 0);
    TEST_ASSERT_EQUAL_INT(DRIVE_DIRECTION_NEUTRAL, out.engaged);
    TEST_ASSERT_EQUAL_INT32(0, out.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(0, fresh(-10000, 0).lift_off_mNm);
    in.demand.direction = DRIVE_DIRECTION_FORWARD;
    TEST_ASSERT_EQUAL_INT32(10000, fresh(10000, 0).drive_torque_mNm);
}

/* ---- loss ---- */

void test_demand_is_lost_one_millisecond_after_demand_timeout(void)
{
    fresh(0, 20000);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step(0, 20000, TIMEOUT).reason);
    TEST_ASSERT_EQUAL_INT(REASON_DEMAND_TIMEOUT, step(0, 20000, TIMEOUT + 1).reason);
    TEST_ASSERT_EQUAL_INT(REASON_DEMAND_TIMEOUT, step(0, 20000, UINT32_MAX).reason);
}

void test_lost_driving_demand_is_zero_at_once(void)
{
    fresh(30000, 0);
    const demand_t out = silent(1);
    TEST_ASSERT_EQUAL_INT32(0, out.drive_torque_mNm);
    TEST_ASSERT_TRUE(out.drive_withdrawn);
    TEST_ASSERT_EQUAL_INT(REASON_DEMAND_TIMEOUT, out.reason);
    TEST_ASSERT_EQUAL_INT(DRIVE_DIRECTION_FORWARD, out.engaged);
}

void test_lost_braking_demand_is_kept_for_its_time_and_falls_at_the_rate_of_its_replacement(void)
{
    config.brake.hydraulic_rate_mNm_s = 1000 * RATE;
    fresh(-1000, 20000);
    demand_t out = silent(HOLD);
    TEST_ASSERT_EQUAL_INT32(20000, out.brake_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(1000, out.lift_off_mNm);
    TEST_ASSERT_TRUE(out.hydraulic_valid);
    /* 21 N m at 400 mN m a step: 52.5 steps. */
    for (int n = 1; n <= 53; n++) {
        out = silent(1);
        const int32_t left_mNm = q_max(21000 - RATE * n, 0);
        TEST_ASSERT_EQUAL_INT32(left_mNm, out.brake_torque_mNm + out.lift_off_mNm);
        TEST_ASSERT_FALSE(out.hydraulic_valid);
    }
    TEST_ASSERT_EQUAL_INT(REASON_DEMAND_TIMEOUT, silent(1).reason);
}

void test_braking_demand_stays_for_the_dead_time_of_the_path_that_replaces_it(void)
{
    config.brake.hydraulic_rate_mNm_s = 1000 * RATE;
    config.brake.hydraulic_dead_time_ms = 40;
    fresh(0, 20000);
    silent(HOLD);
    const demand_t out = silent(40);
    TEST_ASSERT_EQUAL_INT32(20000, out.brake_torque_mNm);
    TEST_ASSERT_FALSE(out.hydraulic_valid);
    TEST_ASSERT_EQUAL_INT32(20000 - RATE, silent(1).brake_torque_mNm);
}

/* The brake system has taken its own path by then, also where the demand was lost before. */
void test_a_braking_demand_is_not_kept_when_own_frames_do_not_leave(void)
{
    config.brake.hydraulic_rate_mNm_s = 1000 * RATE;
    config.brake.hydraulic_dead_time_ms = 40;
    for (int lost_before = 0; lost_before <= 100; lost_before += 100) {
        fresh(0, 20000);
        silent(lost_before);
        in.demand.reason = REASON_TRANSMIT_TIMEOUT;
        demand_t out = silent(40);
        TEST_ASSERT_EQUAL_INT(REASON_TRANSMIT_TIMEOUT, out.reason);
        TEST_ASSERT_FALSE(out.hydraulic_valid);
        TEST_ASSERT_EQUAL_INT32(20000, out.brake_torque_mNm);
        TEST_ASSERT_EQUAL_INT32(20000 - RATE, silent(1).brake_torque_mNm);
        in.demand.reason = REASON_NONE; /* frames leave again, no demand comes */
        TEST_ASSERT_FALSE(silent(1).hydraulic_valid);
    }
}

/* A first-order lag of 50 ms leaves exp(-t/50 ms) of the demand to the motor; a recurrence of 1 ms
 * differs by half a step, 1 %. The torque rate, here 200 ms for all of it, does not delay it. */
void test_lost_braking_demand_falls_as_the_path_that_replaces_it_arrives(void)
{
    config.brake.torque_rate_mNm_s = 100000;
    config.brake.hydraulic_rate_mNm_s = 2000000;
    config.brake.hydraulic_time_constant_ms = 50;
    config.brake.hydraulic_dead_time_ms = 20;
    fresh(0, 20000);
    TEST_ASSERT_FALSE(silent(HOLD + 20).handed_over);
    for (int n = 1; n <= 150; n++) {
        const demand_t out = silent(1);
        TEST_ASSERT_TRUE(out.handed_over);
        TEST_ASSERT_DOUBLE_WITHIN(250.0, 20000.0 * exp(-n / 50.0), out.brake_torque_mNm);
    }
    TEST_ASSERT_EQUAL_INT32(0, silent(300).brake_torque_mNm);
}

/* The accelerator beneath a brake pedal that is released by the loss of the link. */
void test_masked_driving_demand_stays_zero_when_the_braking_above_it_has_fallen(void)
{
    fresh(40000, 5000);
    for (int n = 0; n < 2 * HOLD; n++) {
        TEST_ASSERT_EQUAL_INT32(0, silent(1).drive_torque_mNm);
    }
}

void test_vehicle_without_another_brake_keeps_the_demand_until_one_arrives(void)
{
    config.driver.no_other_brake = 1;
    fresh(0, 20000);
    const int32_t speeds_mrad_s[] = {20000, 0, -3000};
    for (int k = 0; k < 3; k++) {
        speed_mrad_s = speeds_mrad_s[k];
        const demand_t out = silent(20 * HOLD);
        TEST_ASSERT_EQUAL_INT32(20000, out.brake_torque_mNm);
        TEST_ASSERT_TRUE(out.hydraulic_valid);
    }
    TEST_ASSERT_EQUAL_INT32(0, fresh(0, 0).brake_torque_mNm);
}

void test_demand_applies_again_in_the_first_step_after_its_loss(void)
{
    fresh(0, 20000);
    silent(HOLD + 20);
    const demand_t back = fresh(0, 20000);
    TEST_ASSERT_EQUAL_INT32(20000, back.brake_torque_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, back.reason);
    TEST_ASSERT_TRUE(back.hydraulic_valid);
    TEST_ASSERT_EQUAL_INT32(20000, silent(HOLD).brake_torque_mNm); /* with the whole time again */
}

void test_demand_is_zero_and_the_hydraulic_command_void_before_the_first_message(void)
{
    const demand_t out = step(30000, 20000, UINT32_MAX);
    TEST_ASSERT_EQUAL_INT32(0, out.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(0, out.brake_torque_mNm);
    TEST_ASSERT_FALSE(out.hydraulic_valid);
    TEST_ASSERT_EQUAL_INT(DRIVE_DIRECTION_NEUTRAL, out.engaged);
}

/* ---- any sequence ---- */

static void draw_input(random_t *random)
{
    in.demand.drive_torque_mNm = (int32_t)random_u64(random);
    in.demand.brake_torque_mNm = random_chance(random, 0.5) ? 0 : (int32_t)random_u64(random);
    in.demand_age_ms = random_chance(random, 0.9) ? 0 : (uint32_t)random_u64(random);
    in.demand.direction = (drive_direction_t)random_between(random, 0, 3);
    in.demand.abs_active = random_chance(random, 0.1);
    speed_mrad_s = (int32_t)random_u64(random);
}

static void assert_lawful(const demand_t *out)
{
    const int32_t sign = drive_direction_sign(out->engaged);
    TEST_ASSERT_TRUE(out->brake_torque_mNm >= 0 &&
                     out->brake_torque_mNm <= 100000000); /* 100 kN m */
    TEST_ASSERT_TRUE(out->lift_off_mNm >= 0 && out->lift_off_mNm <= 100000000);
    TEST_ASSERT_INT32_WITHIN(100000000, 0, out->drive_torque_mNm);
    const bool lost = in.demand_age_ms > TIMEOUT;
    TEST_ASSERT_TRUE(out->drive_torque_mNm == 0 || (out->brake_torque_mNm == 0 && !lost));
    TEST_ASSERT_TRUE(out->drive_torque_mNm == 0 || out->lift_off_mNm == 0);
    TEST_ASSERT_TRUE(out->drive_torque_mNm * sign >= 0);
    TEST_ASSERT_TRUE(!out->drive_withdrawn || out->drive_torque_mNm == 0);
    const bool all = out->drive_torque_mNm - sign * out->lift_off_mNm == in.demand.drive_torque_mNm;
    const bool too_much =
        in.demand.drive_torque_mNm != q_limit(in.demand.drive_torque_mNm, 100000000);
    TEST_ASSERT_TRUE(all || too_much || in.demand.abs_active || out->reason != REASON_NONE);
}

void test_outputs_obey_priority_direction_and_bounds_for_any_sequence(void)
{
    random_t random = random_seeded(3);
    demand_t before = fresh(0, 0);
    for (int n = 0; n < 200000; n++) {
        draw_input(&random);
        if (random_chance(&random, 0.01)) {
            config.driver.no_other_brake = random_between(&random, 0, 1);
        }
        const demand_t out = demand_step(&state, &config, &in, speed_mrad_s);
        assert_lawful(&out);
        if (in.demand_age_ms > TIMEOUT) { /* an old demand never grows */
            TEST_ASSERT_LESS_OR_EQUAL_INT32(before.brake_torque_mNm, out.brake_torque_mNm);
            TEST_ASSERT_EQUAL_INT(before.engaged, out.engaged);
        }
        before = out;
    }
}

void test_rate_is_the_configured_one_and_at_least_1_mNm_per_step(void)
{
    TEST_ASSERT_EQUAL_INT32(400, demand_rate_mNm_per_step(&config));
    config.brake.torque_rate_mNm_s = 100; /* 0.1 mNm a step, below the resolution of 1 mNm */
    TEST_ASSERT_EQUAL_INT32(1, demand_rate_mNm_per_step(&config));
}

/* The smallest torque has the reason of any other, and a reason is shown only for what it takes. */
void test_a_reason_is_that_of_what_is_taken_down_to_1_mNm(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_BRAKE_PRIORITY, fresh(1, 10000).reason);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, fresh(-1, 0).reason);
    TEST_ASSERT_EQUAL_INT32(0, fresh(-1, 0).drive_torque_mNm);
    in.demand.abs_active = true;
    TEST_ASSERT_EQUAL_INT(REASON_ABS, fresh(-1, 0).reason);
    in.demand.abs_active = false;
    in.demand.direction = DRIVE_DIRECTION_NEUTRAL;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, fresh(0, 0).reason);
    TEST_ASSERT_EQUAL_INT(REASON_DRIVE_DIRECTION, fresh(1, 0).reason);
    TEST_ASSERT_EQUAL_INT(REASON_DRIVE_DIRECTION, fresh(-1, 0).reason);
}

/* 3 rad/s against it is as much as is accepted, in both directions. */
void test_a_direction_is_accepted_at_its_speed_limit_and_refused_beyond(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int beyond = 0; beyond < 2; beyond++) {
            demand_init(&state);
            in.demand.direction = sign > 0 ? DRIVE_DIRECTION_FORWARD : DRIVE_DIRECTION_REVERSE;
            speed_mrad_s = -sign * (3000 + beyond);
            TEST_ASSERT_EQUAL_INT(beyond ? DRIVE_DIRECTION_NEUTRAL : in.demand.direction,
                                  fresh(0, 0).engaged);
        }
    }
}

/* A damaged byte is no direction. */
void test_an_unknown_direction_is_neutral(void)
{
    in.demand.direction = (drive_direction_t)77;
    const demand_t out = fresh(10000, 0);
    TEST_ASSERT_EQUAL_INT(DRIVE_DIRECTION_NEUTRAL, out.engaged);
    TEST_ASSERT_EQUAL_INT32(0, out.drive_torque_mNm);
}

/* Lag of 99 ms: 16 N m arrive at 160 mN m a millisecond, all of which lift-off braking loses. */
void test_lift_off_and_demanded_braking_fall_together(void)
{
    config.brake.hydraulic_time_constant_ms = 99;
    config.brake.hydraulic_rate_mNm_s = 2000000;
    (void)fresh(-8000, 8000);
    const demand_t out = silent(HOLD + 1);
    TEST_ASSERT_EQUAL_INT32(8000 - 161, out.lift_off_mNm);
    TEST_ASSERT_EQUAL_INT32(8000, out.brake_torque_mNm);
}

/* A tenth, and one because what is left must end; at most the rate; at least one. */
void test_handed_over_torque_is_what_lag_and_rate_of_the_hydraulic_brake_let_arrive(void)
{
    config.brake.hydraulic_time_constant_ms = 9;
    config.brake.hydraulic_rate_mNm_s = 700000;
    TEST_ASSERT_EQUAL_INT32(501, demand_handed_over_mNm(&config, 5000));
    TEST_ASSERT_EQUAL_INT32(700, demand_handed_over_mNm(&config, 8000));
    TEST_ASSERT_EQUAL_INT32(1, demand_handed_over_mNm(&config, 0));
    config.brake.hydraulic_rate_mNm_s = 100;
    TEST_ASSERT_EQUAL_INT32(1, demand_handed_over_mNm(&config, 8000));
}

void test_the_rate_of_a_step_is_a_thousandth_of_the_rate_of_a_second(void)
{
    config.brake.torque_rate_mNm_s = 999000;
    TEST_ASSERT_EQUAL_INT32(999, demand_rate_mNm_per_step(&config));
    config.brake.torque_rate_mNm_s = 999999;
    TEST_ASSERT_EQUAL_INT32(999, demand_rate_mNm_per_step(&config));
}

/* Two kilonewton-metres a millisecond, without a lag. */
void test_the_rate_of_the_hydraulic_brake_is_of_a_second(void)
{
    config.brake.hydraulic_rate_mNm_s = 2000000000;
    config.brake.hydraulic_time_constant_ms = 0;
    TEST_ASSERT_EQUAL_INT32(2000000, demand_handed_over_mNm(&config, 100000000));
}
