/* SPDX-License-Identifier: Apache-2.0 */
/* What motor and hydraulic brake get of a demand in a single step, from given states. */
#include <string.h>

#include "blending_rig.h"

enum { DEMAND_mNm = 60000 };

void setUp(void)
{
    memset(&in, 0, sizeof in);
    rig_up();
    config.brake.hydraulic_timeout_ms = 0;
    config.brake.hydraulic_report_delay_ms = 0;
    in.brake_torque_mNm = DEMAND_mNm;
}

void tearDown(void) {}

void test_a_start_leaves_no_number_of_before(void)
{
    memset(&state, 0x5A, sizeof state);
    brake_blending_init(&state, &config);
    TEST_ASSERT_EQUAL_INT32(0, state.bridged_q6_mNm);
    TEST_ASSERT_EQUAL_INT32(0, state.within_q6_mNm);
    TEST_ASSERT_EQUAL_INT32(0, state.bridging_ms);
    TEST_ASSERT_EQUAL_INT32(0, state.covered_mNm);
    TEST_ASSERT_EQUAL_INT32(0, state.slower_mrad_s);
    TEST_ASSERT_EQUAL_UINT8(0, state.open_steps);
    TEST_ASSERT_EQUAL_INT32(0, state.limit_lp_mNm.accumulator);
    TEST_ASSERT_EQUAL_INT32(0, state.speed_lp_mrad_s.accumulator);
}

/* Reports that a brake twice as late as configured may make 32765 of 32 768 of its command at
 * most, and one twice as early any share: the interval is 3/4 .. 1. */
static void makes_at_most_its_command(void)
{
    learned(8192, 32768, 65536, 32765 - 2048);
    TEST_ASSERT_EQUAL_INT32(24576, state.feedback.least_q15);
    TEST_ASSERT_EQUAL_INT32(ONE_q15, state.feedback.most_q15);
}

/* ---- what the motor is expected to make ---- */

static int32_t beside_short_mNm(int32_t short_mNm, int32_t achieved_mNm)
{
    in.torque_enable.drive_q15 = 0;
    in.torque_enable.brake_q15 = 0;
    in.short_mNm = short_mNm;
    in.motor_achieved_mNm = -achieved_mNm;
    return step().hydraulic_mNm;
}

void test_a_shorted_motor_that_shows_an_eighth_of_its_torque_makes_it(void)
{
    TEST_ASSERT_EQUAL_INT32(DEMAND_mNm - 8000, beside_short_mNm(8000, 1000));
    TEST_ASSERT_EQUAL_INT32(DEMAND_mNm, beside_short_mNm(8000, 999));
    TEST_ASSERT_EQUAL_INT32(DEMAND_mNm, beside_short_mNm(8000, 0));
    makes_at_most_its_command(); /* zero takes no part of a command back */
    TEST_ASSERT_EQUAL_INT32(DEMAND_mNm, beside_short_mNm(8000, 0));
}

/* 10 mN m in each of the 51 ms of half the build-up of 100 ms, or of motor_arrival. */
void test_beside_a_measured_brake_the_motor_arrives_in_half_its_build_up(void)
{
    config.brake.hydraulic_dead_time_ms = 40;
    config.brake.hydraulic_time_constant_ms = 60;
    in.motor_growth_mNm = 10;
    motor_follows(5000);
    config.brake.motor_arrival_ms = 100;
    TEST_ASSERT_EQUAL_INT32(DEMAND_mNm - 6000, step().hydraulic_mNm);
    measured(0, 0);
    TEST_ASSERT_EQUAL_INT32(DEMAND_mNm - 5510, step().hydraulic_mNm);
    config.brake.motor_arrival_ms = 30;
    TEST_ASSERT_EQUAL_INT32(DEMAND_mNm - 5300, step().hydraulic_mNm);
}

/* The motor may release 400 mN m in each of 100 ms: all of its 24 N m. What it then lacks is not
 * to be covered; of 1 mN m that it keeps, it is. */
void test_a_shortfall_counts_only_of_a_motor_that_is_to_make_torque(void)
{
    slow_brake(10000);
    config.brake.torque_rate_mNm_s = 400000;
    motor_follows(24000);
    in.motor_achieved_mNm = 0;
    capability.optimal = limit_init(0, REASON_LOSS_OPTIMUM);
    TEST_ASSERT_EQUAL_INT32(DEMAND_mNm - 10000, step().uncovered_mNm);
    brake_blending_init(&state, &config);
    slow_brake(10000);
    capability.optimal = limit_init(1, REASON_LOSS_OPTIMUM);
    const brake_blending_out_t out = step();
    TEST_ASSERT_EQUAL_INT32(DEMAND_mNm, out.uncovered_mNm);
    TEST_ASSERT_EQUAL_INT32(DEMAND_mNm, out.hydraulic_mNm); /* never more than the demand */
}

/* ---- the command of a brake of uncertain gain ---- */

/* The motor's torque is given: its command, of which it releases none. */
static int32_t commanded_mNm(int32_t required_mNm, int32_t motor_mNm)
{
    in.brake_torque_mNm = required_mNm + motor_mNm;
    capability.optimal = limit_init(motor_mNm, REASON_LOSS_OPTIMUM);
    motor_follows(motor_mNm);
    return step().hydraulic_mNm;
}

/* Missing is a quarter of 20 N m, or what the motor can take back, of which three quarters are
 * added. Excess is a quarter, less what the motor takes back; 3 N m of it are 2.4 N m of a command
 * whose gain is 5/4. */
void test_a_command_is_larger_by_what_may_be_missing_and_smaller_by_what_may_be_too_much(void)
{
    measured(0, 8192);
    TEST_ASSERT_EQUAL_INT32(20000 - 2400 + 1500, commanded_mNm(20000, 2000));
    TEST_ASSERT_EQUAL_INT32(20000 + 3750, commanded_mNm(20000, 10000));
    TEST_ASSERT_EQUAL_INT32(20000 - 1 + 3750, commanded_mNm(20000, 4999)); /* an excess of 1 */
    makes_at_most_its_command();
    TEST_ASSERT_EQUAL_INT32(20000 + 1500, commanded_mNm(20000, 2000));
    TEST_ASSERT_EQUAL_INT32(20000, commanded_mNm(20000, 0));
    learned(16384, 32768, 32768, 24576); /* three quarters */
    TEST_ASSERT_INT32_WITHIN(4, 20000, commanded_mNm(15000, 1000));
}

void test_a_command_is_smaller_by_no_more_than_the_motor_can_make_up_for(void)
{
    capability.regenerating = limit_init(2500, REASON_MAX_TORQUE);
    measured(0, 8192);
    TEST_ASSERT_EQUAL_INT32(20000 - 500 + 1500, commanded_mNm(20000, 2000));
    /* 10 N m that it cannot release at once, and may not make any more */
    capability.regenerating = limit_init(4000, REASON_MAX_TORQUE);
    TEST_ASSERT_EQUAL_INT32(60000 + 7500, commanded_mNm(60000, 10000));
}

/* ---- what the motor may make ---- */

/* 40 N m of a brake whose interval is a half wide: 20 N m may be missing, so the motor's bound of
 * 24 N m rises to 44, within the lines that are not the strategy's. */
static int32_t raised_mNm(void)
{
    brake_blending_init(&state, &config);
    slow_brake(40000);
    measured(0, 8192);
    return step().electric_mNm;
}

void test_the_bound_rises_by_what_a_measured_brake_may_miss(void)
{
    TEST_ASSERT_EQUAL_INT32(44000, raised_mNm());
    in.speed_mrad_s = -FAST_mrad_s;
    TEST_ASSERT_EQUAL_INT32(44000, raised_mNm());
    limits.braking[TORQUE_LINE_ROTOR] = limit_init(30000, REASON_ROTOR_UNCERTAIN);
    TEST_ASSERT_EQUAL_INT32(30000, raised_mNm());
    limits.braking[TORQUE_LINE_ROTOR] = limit_init(INT32_MAX, REASON_NONE);
    capability.regenerating = limit_init(31000, REASON_MAX_TORQUE);
    TEST_ASSERT_EQUAL_INT32(31000, raised_mNm());
    capability.regenerating = limit_init(50000, REASON_MAX_TORQUE);
    in.torque_enable.brake_q15 = 21299; /* 65 % of 50 N m */
    TEST_ASSERT_EQUAL_INT32(32499, raised_mNm());
    in.torque_enable.brake_q15 = Q15_ONE;
    abs_active = true;
    abs_share_percent = 55;
    TEST_ASSERT_EQUAL_INT32(33000, raised_mNm());
}

/* The line RETURNED falls from 30 to 10 N m: what is bridged above it stays. */
void test_the_bound_never_falls_by_what_may_be_missing(void)
{
    brake_blending_init(&state, &config);
    slow_brake(1000);
    measured(0, 8192);
    config.brake.bridging_time_ms = 178;
    capability.optimal = limit_init(50000, REASON_LOSS_OPTIMUM);
    motor_follows(30000);
    limits.braking[TORQUE_LINE_RETURNED] = limit_init(30000, REASON_CHARGE_CURRENT);
    (void)step();
    limits.braking[TORQUE_LINE_RETURNED] = limit_init(10000, REASON_CHARGE_CURRENT);
    TEST_ASSERT_EQUAL_INT32(30000, step().electric_mNm);
}

/* Beyond the lines of the strategy, by what a brake of 200 N m may miss, the motor brakes to
 * standstill: from a quarter of the blend-out's end, 838/4 + 1 = 210 mrad/s, down to zero. */
static int32_t raised_at_mNm(int32_t speed_mrad_s)
{
    brake_blending_init(&state, &config);
    slow_brake(200000);
    measured(0, 8192);
    in.speed_mrad_s = speed_mrad_s;
    return step().electric_mNm;
}

void test_what_the_motor_makes_beyond_the_strategy_fades_to_zero_at_standstill(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        TEST_ASSERT_EQUAL_INT32(50000, raised_at_mNm(sign * 210));
        TEST_ASSERT_EQUAL_INT32(25000, raised_at_mNm(sign * 105));
        /* 1/210 is 156 of 32768 */
        TEST_ASSERT_EQUAL_INT32(50000 * 156 / 32768, raised_at_mNm(sign));
    }
    TEST_ASSERT_EQUAL_INT32(0, raised_at_mNm(0));
    capability.regenerating = limit_init(10000, REASON_MAX_TORQUE);
    TEST_ASSERT_EQUAL_INT32(10000, raised_at_mNm(105));
    capability.regenerating = limit_init(50000, REASON_MAX_TORQUE);
    config.brake.blend_out_end_mrad_s = 160000; /* 39999/40001 is 32766 of 32768 */
    TEST_ASSERT_EQUAL_INT32(49996, raised_at_mNm(39999));
    TEST_ASSERT_EQUAL_INT32(50000, raised_at_mNm(40000));
}

/* ---- beside the hydraulic torque ---- */

void test_hydraulic_torque_apart_is_none_of_the_demand(void)
{
    slow_brake(10000);
    in.hydraulic_added_mNm = in.hydraulic_apart_mNm = 4000;
    state.covered_mNm = 1000;
    brake_blending_out_t out = step();
    TEST_ASSERT_EQUAL_INT32(DEMAND_mNm - 6000, out.uncovered_mNm);
    TEST_ASSERT_EQUAL_INT32(5000, out.rise_mNm);
    TEST_ASSERT_EQUAL_INT32(6000, state.covered_mNm);
    TEST_ASSERT_EQUAL_INT32(out.hydraulic_mNm + 4000,
                            state.hydraulic.commands_mNm[state.hydraulic.next]);
    in.hydraulic_added_mNm = in.hydraulic_apart_mNm = 12000; /* it has not come yet */
    out = step();
    TEST_ASSERT_EQUAL_INT32(DEMAND_mNm, out.uncovered_mNm);
    TEST_ASSERT_EQUAL_INT32(0, out.rise_mNm);
    TEST_ASSERT_EQUAL_INT32(0, state.covered_mNm);
    in.hydraulic_apart_mNm = 0; /* a hold before standstill */
    TEST_ASSERT_EQUAL_INT32(DEMAND_mNm - 10000, step().uncovered_mNm);
    in.brake_torque_mNm = 1000; /* less than the brake makes */
    in.hydraulic_added_mNm = 0;
    TEST_ASSERT_EQUAL_INT32(0, step().uncovered_mNm);
}

/* Measured while reports are used, else by the model with the learned gain. */
void test_the_hydraulic_torque_now_is_the_reported_or_the_modelled_one(void)
{
    slow_brake(10000);
    TEST_ASSERT_EQUAL_INT32(10000, step().made_mNm);
    measured(7000, 0);
    TEST_ASSERT_EQUAL_INT32(7000, step().made_mNm);
}

/* While an anti-lock system may move the valves a report shows nothing. */
void test_reports_show_nothing_beside_an_anti_lock_system(void)
{
    slow_brake(40000);
    reported(0, 0);
    config.brake.hydraulic_tolerance_mNm = 100;
    config.brake.abs_hold_ms = 0;
    abs_active = true;
    (void)step();
    TEST_ASSERT_EQUAL_INT(REASON_NONE, state.feedback.shows);
    abs_active = false;
    (void)step();
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_DEAD, state.feedback.shows);
}

/* The anti-lock system's share steps from all to a half, 10 of 20 N m: no slope is expected of it.
 */
void test_no_slope_is_expected_of_an_anti_lock_bound(void)
{
    slow_brake(0);
    in.brake_torque_mNm = 20000;
    motor_follows(20000);
    config.brake.torque_rate_mNm_s = 20000000;
    for (int n = 0; n < 1000; n++) {
        (void)step();
    }
    abs_active = true;
    abs_share_percent = 50;
    TEST_ASSERT_EQUAL_INT32(10000, step().hydraulic_mNm);
}

static int32_t hydraulic_after(int steps, bool open)
{
    int32_t hydraulic_mNm = 0;
    in.bridge_open = open;
    for (int n = 0; n < steps; n++) {
        hydraulic_mNm = step().hydraulic_mNm;
    }
    return hydraulic_mNm;
}

void test_an_open_bridge_is_waited_for_8_steps_and_after_as_many_closed_ones_the_motor_counts(void)
{
    in.brake_torque_mNm = 0; /* coasting */
    hydraulic_after(100, true);
    in.brake_torque_mNm = 20000;
    TEST_ASSERT_EQUAL_INT32(0, hydraulic_after(8, true));
    TEST_ASSERT_EQUAL_INT32(20000, hydraulic_after(1, true));
    TEST_ASSERT_EQUAL_INT32(20000, hydraulic_after(1000, true));
    TEST_ASSERT_EQUAL_INT32(20000, hydraulic_after(7, false));
    TEST_ASSERT_EQUAL_INT32(0, hydraulic_after(1, false));
}
