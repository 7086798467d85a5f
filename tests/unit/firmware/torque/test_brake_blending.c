/* SPDX-License-Identifier: Apache-2.0 */
#include "random_values.h"
#include "split.h"

void setUp(void)
{
    before_blending();
}

void tearDown(void) {}

static brake_blending_out_t split(int32_t strategy, int32_t demand_mNm)
{
    config.brake.strategy = strategy;
    in.demand_mNm = demand_mNm;
    return step();
}

/* ---- the three strategies ---- */

void test_parallel_ratio_gives_the_motor_its_fixed_share_up_to_its_rating(void)
{
    /* floor(50000 * 6554 / 32768) = 10000; of 300 Nm a fifth would be 60 Nm, the rating is 40 Nm.
     */
    assert_split(10000, 40000, REASON_ELECTRIC_SHARE, split(CONFIG_STRATEGY_PARALLEL_RATIO, 50000));
    assert_split(40000, 260000, REASON_ELECTRIC_RATED,
                 split(CONFIG_STRATEGY_PARALLEL_RATIO, 300000));
    capability.regenerating = limit_init(6000, REASON_CHARGE_CURRENT);
    assert_split(6000, 44000, REASON_CHARGE_CURRENT, split(CONFIG_STRATEGY_PARALLEL_RATIO, 50000));
}

void test_parallel_free_travel_brakes_with_the_motor_alone_up_to_its_rating(void)
{
    assert_split(30000, 0, REASON_NONE, split(CONFIG_STRATEGY_PARALLEL_FREE_TRAVEL, 30000));
    assert_split(40000, 0, REASON_NONE, split(CONFIG_STRATEGY_PARALLEL_FREE_TRAVEL, 40000));
    assert_split(40000, 20000, REASON_ELECTRIC_RATED,
                 split(CONFIG_STRATEGY_PARALLEL_FREE_TRAVEL, 60000));
    capability.regenerating = limit_init(15000, REASON_BUS_VOLTAGE_HIGH);
    assert_split(15000, 45000, REASON_BUS_VOLTAGE_HIGH,
                 split(CONFIG_STRATEGY_PARALLEL_FREE_TRAVEL, 60000));
}

void test_series_optimal_never_goes_beyond_the_torque_that_returns_the_most(void)
{
    assert_split(20000, 0, REASON_NONE, split(CONFIG_STRATEGY_SERIES_OPTIMAL, 20000));
    assert_split(24000, 36000, REASON_LOSS_OPTIMUM, split(CONFIG_STRATEGY_SERIES_OPTIMAL, 60000));
}

void test_the_parallel_strategies_do_not_know_the_optimum(void)
{
    capability.optimal = limit_init(1000, REASON_LOSS_OPTIMUM);
    assert_split(40000, 20000, REASON_ELECTRIC_RATED,
                 split(CONFIG_STRATEGY_PARALLEL_FREE_TRAVEL, 60000));
}

void test_what_is_available_does_not_depend_on_how_much_is_demanded_where_no_share_is_fixed(void)
{
    for (int32_t demand_mNm = 0; demand_mNm <= 100000; demand_mNm += 10000) {
        TEST_ASSERT_EQUAL_INT32(
            24000, split(CONFIG_STRATEGY_SERIES_OPTIMAL, demand_mNm).available.torque_mNm);
        TEST_ASSERT_EQUAL_INT32(
            40000, split(CONFIG_STRATEGY_PARALLEL_FREE_TRAVEL, demand_mNm).available.torque_mNm);
    }
}

void test_no_demand_brakes_nothing_and_a_negative_one_is_no_demand(void)
{
    assert_split(0, 0, REASON_NONE, split(CONFIG_STRATEGY_SERIES_OPTIMAL, 0));
    assert_split(0, 0, REASON_NONE, split(CONFIG_STRATEGY_PARALLEL_FREE_TRAVEL, -5000));
    assert_split(0, 0, REASON_NONE, split(CONFIG_STRATEGY_PARALLEL_RATIO, INT32_MIN));
}

static void random_situation(random_t *random)
{
    config.brake.strategy = random_between(random, 0, 2);
    config.brake.max_hydraulic_torque_mNm = 1000000;
    capability.regenerating = limit_init(random_between(random, 0, 60000), REASON_MAX_POWER);
    capability.optimal = capability.regenerating;
    limit_tighten(&capability.optimal, random_between(random, 0, 80000), REASON_LOSS_OPTIMUM);
    in.demand_mNm = random_between(random, 0, 300000);
    in.speed_mrad_s = random_between(random, -70000, 70000);
    abs_active = random_chance(random, 0.05);
    in.torque_enable.brake_q15 =
        (int16_t)(random_chance(random, 0.2) ? random_between(random, 0, Q15_ONE) : Q15_ONE);
    in.torque_enable.reason = REASON_TORQUE_ENABLE;
}

void test_electric_and_hydraulic_together_are_the_demand_in_every_step(void)
{
    random_t random = random_seeded(1);
    for (int n = 0; n < 100000; n++) {
        random_situation(&random);
        motor_follows(0); /* at the beginning of braking nothing has been asked of the motor yet */
        const brake_blending_out_t out = step();
        TEST_ASSERT_EQUAL_INT32(in.demand_mNm, out.electric_mNm + out.hydraulic_mNm);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, out.electric_mNm);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, out.hydraulic_mNm);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(out.available.torque_mNm, out.electric_mNm);
        TEST_ASSERT_TRUE((out.reason == REASON_NONE) == (out.electric_mNm == in.demand_mNm));
    }
}

void test_the_motor_never_gets_more_than_its_limit_under_any_strategy(void)
{
    random_t random = random_seeded(2);
    for (int n = 0; n < 100000; n++) {
        random_situation(&random);
        const brake_blending_out_t out = step();
        TEST_ASSERT_LESS_OR_EQUAL_INT32(capability.regenerating.torque_mNm,
                                        out.available.torque_mNm);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(capability.regenerating.torque_mNm, out.electric_mNm);
        if (config.brake.strategy == CONFIG_STRATEGY_SERIES_OPTIMAL) {
            TEST_ASSERT_LESS_OR_EQUAL_INT32(capability.optimal.torque_mNm, out.electric_mNm);
        }
    }
}

/* ---- while the motor is on its way ---- */

void test_while_the_motor_leaves_at_its_rate_the_hydraulic_brake_rises_by_what_it_gives_up(void)
{
    capability.optimal = limit_init(10000, REASON_CHARGE_CURRENT); /* dropped from 24 Nm */
    in.demand_mNm = 30000;
    for (int32_t commanded_mNm = 24000; commanded_mNm >= 10000; commanded_mNm -= 400) {
        motor_follows(commanded_mNm);
        const brake_blending_out_t out = step();
        TEST_ASSERT_EQUAL_INT32(10000, out.electric_mNm);
        TEST_ASSERT_EQUAL_INT32(30000 - commanded_mNm, out.hydraulic_mNm);
    }
}

void test_a_shortfall_of_the_motor_goes_to_the_hydraulic_brake_in_the_same_step(void)
{
    in.demand_mNm = 20000;
    motor_follows(20000);
    TEST_ASSERT_EQUAL_INT32(0, step().hydraulic_mNm);
    in.motor_achieved_mNm = -12000; /* 8 Nm are missing, 2 Nm are tolerated */
    TEST_ASSERT_EQUAL_INT32(6000, step().hydraulic_mNm);
    in.motor_achieved_mNm = -18000;
    TEST_ASSERT_EQUAL_INT32(0, step().hydraulic_mNm);
}

void test_a_motor_that_drives_instead_of_braking_counts_as_giving_nothing(void)
{
    in.demand_mNm = 20000;
    motor_follows(20000);
    in.motor_achieved_mNm = 5000;
    TEST_ASSERT_EQUAL_INT32(18000, step().hydraulic_mNm);
}

void test_what_the_motor_gives_and_the_hydraulic_brake_adds_is_never_more_than_the_demand(void)
{
    random_t random = random_seeded(3);
    for (int n = 0; n < 100000; n++) {
        random_situation(&random);
        const int32_t forward = in.speed_mrad_s >= 0 ? 1 : -1;
        const int32_t commanded_mNm = random_between(&random, 0, 60000);
        const int32_t achieved_mNm = random_between(&random, 0, commanded_mNm);
        in.motor_command_mNm = -commanded_mNm * forward;
        in.motor_achieved_mNm = -achieved_mNm * forward;
        in.torque_enable.bridge = BRIDGE_PWM;
        const brake_blending_out_t out = step();
        TEST_ASSERT_LESS_OR_EQUAL_INT32(in.demand_mNm, out.electric_mNm);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(in.demand_mNm, out.hydraulic_mNm);
        if (out.hydraulic_mNm > 0) {
            /* The motor still gives more than it will be asked for while it leaves: only then may
             * it exceed. */
            TEST_ASSERT_LESS_OR_EQUAL_INT32(in.demand_mNm, achieved_mNm + out.hydraulic_mNm);
        }
    }
}

void test_easing_off_the_pedal_does_not_make_the_hydraulic_brake_bite(void)
{
    /* The pedal falls from 40 to 10 Nm while the motor, which only reached 20 Nm, is still on its
     * way down: it gives more than is demanded already. */
    in.demand_mNm = 10000;
    in.motor_command_mNm = -40000;
    in.motor_achieved_mNm = -20000;
    TEST_ASSERT_EQUAL_INT32(0, step().hydraulic_mNm);
}

void test_backwards_the_split_is_the_same(void)
{
    random_t random = random_seeded(4);
    for (int n = 0; n < 20000; n++) {
        random_situation(&random);
        in.speed_mrad_s = random_between(&random, 1, 70000);
        in.motor_command_mNm = random_between(&random, -60000, 60000);
        in.motor_achieved_mNm = random_between(&random, -60000, 60000);
        brake_blending_init(&state);
        limits_state.abs_hold_steps = 0;
        const brake_blending_out_t forward = step();
        in.speed_mrad_s = -in.speed_mrad_s;
        in.motor_command_mNm = -in.motor_command_mNm;
        in.motor_achieved_mNm = -in.motor_achieved_mNm;
        brake_blending_init(&state);
        limits_state.abs_hold_steps = 0;
        const brake_blending_out_t backward = step();
        TEST_ASSERT_EQUAL_INT32(forward.electric_mNm, backward.electric_mNm);
        TEST_ASSERT_EQUAL_INT32(forward.hydraulic_mNm, backward.hydraulic_mNm);
    }
}

/* ---- hand-over ---- */

void test_between_the_hand_over_speeds_the_motor_fades_out_and_the_hydraulic_brake_in(void)
{
    config.brake.strategy = CONFIG_STRATEGY_PARALLEL_FREE_TRAVEL;
    in.demand_mNm = 40000;
    in.speed_mrad_s = 2618;
    assert_split(40000, 0, REASON_NONE, step());
    in.speed_mrad_s = 1728; /* half-way: 890 of 1780 mrad/s leave half of 40 Nm */
    assert_split(20000, 20000, REASON_BLEND_OUT, step());
    in.speed_mrad_s = 838;
    assert_split(0, 40000, REASON_BLEND_OUT, step());
}

/* Where the best torque is small the parallel strategies would otherwise return more on the last
 * metres. */
void test_the_best_torque_is_kept_until_what_the_hand_over_leaves_is_smaller(void)
{
    in.demand_mNm = 30000;
    in.speed_mrad_s = 1728; /* half of 50 Nm is more than the best 24 Nm */
    assert_split(24000, 6000, REASON_LOSS_OPTIMUM, step());
    in.speed_mrad_s = 927; /* 89 of 1780 mrad/s leave a twentieth of 50 Nm */
    assert_split(2499, 27501, REASON_BLEND_OUT, step());
    in.speed_mrad_s = 838;
    assert_split(0, 30000, REASON_BLEND_OUT, step());
}

void test_electric_braking_never_holds_a_standing_vehicle(void)
{
    for (int32_t strategy = 0; strategy < 3; strategy++) {
        in.speed_mrad_s = 0;
        const brake_blending_out_t out = split(strategy, 20000);
        TEST_ASSERT_EQUAL_INT32(0, out.electric_mNm);
        TEST_ASSERT_EQUAL_INT32(20000, out.hydraulic_mNm);
    }
}

void test_a_hand_over_without_width_is_a_step_with_the_motor_above_it(void)
{
    config.brake.blend_out_start_mrad_s = 1000;
    config.brake.blend_out_end_mrad_s = 1000;
    capability.optimal = limit_init(50000, REASON_LOSS_OPTIMUM);
    in.demand_mNm = 40000;
    in.speed_mrad_s = 1001;
    assert_split(40000, 0, REASON_NONE, step());
    in.speed_mrad_s = 1000;
    assert_split(0, 40000, REASON_BLEND_OUT, step());
    in.speed_mrad_s = 0;
    assert_split(0, 40000, REASON_BLEND_OUT, step());
}

/* Coming to rest forwards, the torque that is still commanded is a backward one, as the torque
 * limit would command it. */
void test_at_standstill_a_backward_torque_is_what_is_left_of_braking(void)
{
    in.demand_mNm = 30000;
    in.speed_mrad_s = 0;
    in.motor_command_mNm = -24000;
    in.motor_achieved_mNm = -24000;
    TEST_ASSERT_EQUAL_INT32(6000, step().hydraulic_mNm);
    in.motor_command_mNm = 24000;
    in.motor_achieved_mNm = 24000;
    TEST_ASSERT_EQUAL_INT32(30000, step().hydraulic_mNm);
}

void test_even_a_hand_over_at_no_speed_leaves_standstill_to_the_hydraulic_brake(void)
{
    config.brake.blend_out_start_mrad_s = 0;
    config.brake.blend_out_end_mrad_s = 0;
    in.demand_mNm = 20000;
    in.speed_mrad_s = 0;
    assert_split(0, 20000, REASON_BLEND_OUT, step());
    in.speed_mrad_s = 1;
    assert_split(20000, 0, REASON_NONE, step());
}

/* ---- anti-lock ---- */

void test_with_anti_lock_at_work_the_motor_gets_out_of_the_way_for_300_ms_longer(void)
{
    in.demand_mNm = 20000;
    abs_active = true;
    assert_split(0, 20000, REASON_ABS, step());
    assert_split(0, 20000, REASON_ABS, step());
    abs_active = false;
    for (int n = 1; n < 300; n++) {
        assert_split(0, 20000, REASON_ABS, step());
    }
    assert_split(20000, 0, REASON_NONE, step());
}

/* ---- the valve ---- */

void test_losing_the_torque_enable_moves_the_whole_demand_to_the_hydraulic_brake_in_one_step(void)
{
    in.demand_mNm = 20000;
    motor_follows(20000);
    TEST_ASSERT_EQUAL_INT32(0, step().hydraulic_mNm);
    in.torque_enable.bridge = BRIDGE_OFF;
    in.torque_enable.brake_q15 = 0;
    in.torque_enable.reason = REASON_OVERCURRENT;
    assert_split(0, 20000, REASON_OVERCURRENT, step());
    in.torque_enable.bridge = BRIDGE_SHORT;
    assert_split(0, 20000, REASON_OVERCURRENT, step());
}

void test_a_bridge_that_does_not_switch_is_not_counted_on_even_if_braking_is_permitted(void)
{
    in.demand_mNm = 20000;
    motor_follows(20000);
    in.torque_enable.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT32(20000, step().hydraulic_mNm);
}

void test_a_partial_torque_enable_leaves_that_share_of_the_motor_s_largest_torque(void)
{
    in.demand_mNm = 60000;
    in.torque_enable.brake_q15 = 8192; /* a quarter of the 50 Nm that the motor has */
    in.torque_enable.reason = REASON_TORQUE_IMPLAUSIBLE;
    assert_split(12500, 47500, REASON_TORQUE_IMPLAUSIBLE, step());
}

void test_the_hydraulic_brake_is_not_asked_for_more_than_it_can_and_a_demand_beyond_both_is_named(
    void)
{
    config.brake.max_hydraulic_torque_mNm = 30000;
    in.demand_mNm = 54000; /* 24 Nm electric leave just that */
    TEST_ASSERT_EQUAL_INT32(30000, step().hydraulic_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().hydraulic_reason);
    in.demand_mNm = 54001;
    TEST_ASSERT_EQUAL_INT32(30000, step().hydraulic_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_LIMIT, step().hydraulic_reason);
}
