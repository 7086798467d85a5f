/* SPDX-License-Identifier: Apache-2.0 */
#include "blending_rig.h"

void setUp(void)
{
    rig_up();
}

void tearDown(void) {}

static brake_blending_out_t split(int32_t strategy, int32_t demand_mNm)
{
    config.brake.strategy = strategy;
    in.brake_torque_mNm = demand_mNm;
    return step();
}

/* ---- the three strategies ---- */

void test_parallel_ratio_gives_the_motor_a_fixed_share_up_to_electric_rated_torque(void)
{
    /* floor(50000 * 6554 / 32768) = 10000. A fifth of 300 Nm is 60 Nm, above the rating of 40 Nm.
     */
    assert_split(10000, 40000, REASON_ELECTRIC_SHARE, split(CONFIG_STRATEGY_PARALLEL_RATIO, 50000));
    assert_split(40000, 260000, REASON_ELECTRIC_RATED,
                 split(CONFIG_STRATEGY_PARALLEL_RATIO, 300000));
    capability.regenerating = limit_init(6000, REASON_CHARGE_CURRENT);
    assert_split(6000, 44000, REASON_CHARGE_CURRENT, split(CONFIG_STRATEGY_PARALLEL_RATIO, 50000));
}

void test_parallel_free_travel_brakes_with_the_motor_alone_up_to_electric_rated_torque(void)
{
    assert_split(30000, 0, REASON_NONE, split(CONFIG_STRATEGY_PARALLEL_FREE_TRAVEL, 30000));
    assert_split(40000, 0, REASON_NONE, split(CONFIG_STRATEGY_PARALLEL_FREE_TRAVEL, 40000));
    assert_split(40000, 20000, REASON_ELECTRIC_RATED,
                 split(CONFIG_STRATEGY_PARALLEL_FREE_TRAVEL, 60000));
    capability.regenerating = limit_init(15000, REASON_BUS_VOLTAGE_HIGH);
    assert_split(15000, 45000, REASON_BUS_VOLTAGE_HIGH,
                 split(CONFIG_STRATEGY_PARALLEL_FREE_TRAVEL, 60000));
}

void test_series_optimal_never_exceeds_the_loss_optimum(void)
{
    assert_split(20000, 0, REASON_NONE, split(CONFIG_STRATEGY_SERIES_OPTIMAL, 20000));
    assert_split(24000, 36000, REASON_LOSS_OPTIMUM, split(CONFIG_STRATEGY_SERIES_OPTIMAL, 60000));
}

void test_parallel_strategies_ignore_the_loss_optimum(void)
{
    capability.optimal = limit_init(1000, REASON_LOSS_OPTIMUM);
    assert_split(40000, 20000, REASON_ELECTRIC_RATED,
                 split(CONFIG_STRATEGY_PARALLEL_FREE_TRAVEL, 60000));
}

void test_available_torque_is_independent_of_the_demand_without_a_fixed_share(void)
{
    for (int32_t demand_mNm = 0; demand_mNm <= 100000; demand_mNm += 10000) {
        TEST_ASSERT_EQUAL_INT32(
            24000, split(CONFIG_STRATEGY_SERIES_OPTIMAL, demand_mNm).available.torque_mNm);
        TEST_ASSERT_EQUAL_INT32(
            40000, split(CONFIG_STRATEGY_PARALLEL_FREE_TRAVEL, demand_mNm).available.torque_mNm);
    }
}

void test_zero_and_negative_demands_give_zero_torque_of_both_brakes(void)
{
    assert_split(0, 0, REASON_NONE, split(CONFIG_STRATEGY_SERIES_OPTIMAL, 0));
    assert_split(0, 0, REASON_NONE, split(CONFIG_STRATEGY_PARALLEL_FREE_TRAVEL, -5000));
    assert_split(0, 0, REASON_NONE, split(CONFIG_STRATEGY_PARALLEL_RATIO, INT32_MIN));
}

void test_electric_plus_hydraulic_torque_equals_the_demand_in_every_step(void)
{
    random_t random = random_seeded(1);
    for (int n = 0; n < 100000; n++) {
        random_conditions(&random);
        motor_follows(0); /* the first step of a braking: the motor's last command is zero */
        const brake_blending_out_t out = step();
        TEST_ASSERT_EQUAL_INT32(in.brake_torque_mNm, out.electric_mNm + out.hydraulic_mNm);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, out.electric_mNm);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, out.hydraulic_mNm);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(out.available.torque_mNm, out.electric_mNm);
        TEST_ASSERT_TRUE((out.reason == REASON_NONE) == (out.electric_mNm == in.brake_torque_mNm));
    }
}

void test_electric_torque_never_exceeds_the_torque_limit_under_any_strategy(void)
{
    random_t random = random_seeded(2);
    for (int n = 0; n < 100000; n++) {
        random_conditions(&random);
        const brake_blending_out_t out = step();
        TEST_ASSERT_LESS_OR_EQUAL_INT32(capability.regenerating.torque_mNm,
                                        out.available.torque_mNm);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(capability.regenerating.torque_mNm, out.electric_mNm);
        if (config.brake.strategy == CONFIG_STRATEGY_SERIES_OPTIMAL) {
            TEST_ASSERT_LESS_OR_EQUAL_INT32(capability.optimal.torque_mNm, out.electric_mNm);
        }
    }
}

/* ---- motor torque that differs from its command ---- */

void test_hydraulic_torque_rises_by_the_amount_the_motor_falls_at_its_rate(void)
{
    capability.optimal = limit_init(10000, REASON_CHARGE_CURRENT); /* falls from 24 Nm in a step */
    in.brake_torque_mNm = 30000;
    for (int32_t commanded_mNm = 24000; commanded_mNm >= 10000; commanded_mNm -= 400) {
        motor_follows(commanded_mNm);
        const brake_blending_out_t out = step();
        TEST_ASSERT_EQUAL_INT32(10000, out.electric_mNm);
        TEST_ASSERT_EQUAL_INT32(30000 - commanded_mNm, out.hydraulic_mNm);
    }
}

void test_motor_shortfall_beyond_the_band_is_moved_to_the_hydraulic_brake_in_one_step(void)
{
    in.brake_torque_mNm = 20000;
    motor_follows(20000);
    TEST_ASSERT_EQUAL_INT32(0, step().hydraulic_mNm);
    in.motor_achieved_mNm = -12000; /* shortfall 8 Nm, of which 2 Nm are tolerated */
    TEST_ASSERT_EQUAL_INT32(6000, step().hydraulic_mNm);
    in.motor_achieved_mNm = -18000;
    TEST_ASSERT_EQUAL_INT32(0, step().hydraulic_mNm);
}

void test_achieved_driving_torque_counts_as_zero_braking_torque(void)
{
    in.brake_torque_mNm = 20000;
    motor_follows(20000);
    in.motor_achieved_mNm = 5000;
    TEST_ASSERT_EQUAL_INT32(18000, step().hydraulic_mNm);
}

void test_achieved_plus_hydraulic_torque_never_exceeds_the_demand(void)
{
    random_t random = random_seeded(3);
    for (int n = 0; n < 100000; n++) {
        random_conditions(&random);
        const int32_t forward = in.speed_mrad_s >= 0 ? 1 : -1;
        const int32_t commanded_mNm = random_between(&random, 0, 60000);
        const int32_t achieved_mNm = random_between(&random, 0, commanded_mNm);
        in.motor_command_mNm = -commanded_mNm * forward;
        in.motor_achieved_mNm = -achieved_mNm * forward;
        in.torque_enable.drive_q15 = Q15_ONE;
        const brake_blending_out_t out = step();
        TEST_ASSERT_LESS_OR_EQUAL_INT32(in.brake_torque_mNm, out.electric_mNm);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(in.brake_torque_mNm, out.hydraulic_mNm);
        if (out.hydraulic_mNm > 0) {
            /* Only the motor alone may exceed the demand, while its torque falls at its rate. */
            TEST_ASSERT_LESS_OR_EQUAL_INT32(in.brake_torque_mNm, achieved_mNm + out.hydraulic_mNm);
        }
    }
}

void test_falling_demand_with_excess_motor_torque_gives_zero_hydraulic_torque(void)
{
    /* The demand falls from 40 to 10 Nm. The motor has reached 20 Nm, still more than the demand.
     */
    in.brake_torque_mNm = 10000;
    in.motor_command_mNm = -40000;
    in.motor_achieved_mNm = -20000;
    TEST_ASSERT_EQUAL_INT32(0, step().hydraulic_mNm);
}

void test_split_is_symmetric_in_the_direction_of_rotation(void)
{
    random_t random = random_seeded(4);
    for (int n = 0; n < 20000; n++) {
        random_conditions(&random);
        in.speed_mrad_s = random_between(&random, 1, 70000);
        in.motor_command_mNm = random_between(&random, -60000, 60000);
        in.motor_achieved_mNm = random_between(&random, -60000, 60000);
        brake_blending_init(&state, &config);
        torque_limits_init(&limits_state, &limits);
        const brake_blending_out_t forward = step();
        in.speed_mrad_s = -in.speed_mrad_s;
        in.motor_command_mNm = -in.motor_command_mNm;
        in.motor_achieved_mNm = -in.motor_achieved_mNm;
        brake_blending_init(&state, &config);
        torque_limits_init(&limits_state, &limits);
        const brake_blending_out_t backward = step();
        TEST_ASSERT_EQUAL_INT32(forward.electric_mNm, backward.electric_mNm);
        TEST_ASSERT_EQUAL_INT32(forward.hydraulic_mNm, backward.hydraulic_mNm);
    }
}

/* ---- blend-out at low speed ---- */

void test_motor_torque_falls_linearly_between_the_blend_out_speeds(void)
{
    config.brake.strategy = CONFIG_STRATEGY_PARALLEL_FREE_TRAVEL;
    in.brake_torque_mNm = 40000;
    in.speed_mrad_s = 2618;
    assert_split(40000, 0, REASON_NONE, step());
    in.speed_mrad_s = 1728; /* the middle: 890 / 1780 of 40 Nm */
    assert_split(20000, 20000, REASON_BLEND_OUT, step());
    in.speed_mrad_s = 838;
    assert_split(0, 40000, REASON_BLEND_OUT, step());
}

/* Otherwise the parallel strategies would return more energy at low speed, where the loss optimum
 * is small. */
void test_loss_optimum_applies_until_the_blend_out_limit_is_tighter(void)
{
    in.brake_torque_mNm = 30000;
    in.speed_mrad_s = 1728; /* half of 50 Nm is more than the optimum of 24 Nm */
    assert_split(24000, 6000, REASON_LOSS_OPTIMUM, step());
    in.speed_mrad_s = 927; /* 89 / 1780 of 50 Nm */
    assert_split(2499, 27501, REASON_BLEND_OUT, step());
    in.speed_mrad_s = 838;
    assert_split(0, 30000, REASON_BLEND_OUT, step());
}

void test_electric_braking_torque_is_zero_at_standstill_under_every_strategy(void)
{
    for (int32_t strategy = 0; strategy < 3; strategy++) {
        in.speed_mrad_s = 0;
        const brake_blending_out_t out = split(strategy, 20000);
        TEST_ASSERT_EQUAL_INT32(0, out.electric_mNm);
        TEST_ASSERT_EQUAL_INT32(20000, out.hydraulic_mNm);
    }
}

void test_blend_out_of_zero_width_is_a_step_at_its_speed(void)
{
    config.brake.blend_out_start_mrad_s = 1000;
    config.brake.blend_out_end_mrad_s = 1000;
    capability.optimal = limit_init(50000, REASON_LOSS_OPTIMUM);
    in.brake_torque_mNm = 40000;
    in.speed_mrad_s = 1001;
    assert_split(40000, 0, REASON_NONE, step());
    in.speed_mrad_s = 1000;
    assert_split(0, 40000, REASON_BLEND_OUT, step());
    in.speed_mrad_s = 0;
    assert_split(0, 40000, REASON_BLEND_OUT, step());
}

/* At standstill the braking torque of the last step, forward rotation, is a negative command. */
void test_at_standstill_a_negative_motor_torque_counts_as_braking(void)
{
    in.brake_torque_mNm = 30000;
    in.speed_mrad_s = 0;
    in.motor_command_mNm = -24000;
    in.motor_achieved_mNm = -24000;
    TEST_ASSERT_EQUAL_INT32(6000, step().hydraulic_mNm);
    in.motor_command_mNm = 24000;
    in.motor_achieved_mNm = 24000;
    TEST_ASSERT_EQUAL_INT32(30000, step().hydraulic_mNm);
}

void test_blend_out_at_zero_speed_still_gives_zero_motor_torque_at_standstill(void)
{
    config.brake.blend_out_start_mrad_s = 0;
    config.brake.blend_out_end_mrad_s = 0;
    in.brake_torque_mNm = 20000;
    in.speed_mrad_s = 0;
    assert_split(0, 20000, REASON_BLEND_OUT, step());
    in.speed_mrad_s = 1;
    assert_split(20000, 0, REASON_NONE, step());
}

/* ---- anti-lock ---- */

void test_electric_torque_is_zero_during_anti_lock_and_300_ms_after(void)
{
    in.brake_torque_mNm = 20000;
    abs_active = true;
    assert_split(0, 20000, REASON_ABS, step());
    assert_split(0, 20000, REASON_ABS, step());
    abs_active = false;
    for (int n = 1; n < 300; n++) {
        assert_split(0, 20000, REASON_ABS, step());
    }
    assert_split(20000, 0, REASON_NONE, step());
}

/* The hydraulic command is the rest in the same step: the bound steps, so no slope is expected of
 * it. After the intervention its last share holds. */
void test_motor_keeps_the_share_that_the_anti_lock_system_leaves_it(void)
{
    in.brake_torque_mNm = 20000;
    for (int32_t percent = 0; percent <= 100; percent += 5) {
        abs_active = true;
        abs_share_percent = (uint8_t)percent;
        assert_split(200 * percent, 20000 - 200 * percent, percent < 100 ? REASON_ABS : REASON_NONE,
                     step());
        abs_active = false;
        abs_share_percent = 77;
        for (int n = 1; n < 300; n++) {
            (void)step();
        }
        assert_split(20000, 0, REASON_NONE, step());
    }
}

void test_motor_returns_abs_hold_ms_after_anti_lock(void)
{
    in.brake_torque_mNm = 20000;
    const int32_t hold_ms[] = {100, 1, 0, 10000};
    for (int k = 0; k < 4; k++) {
        config.brake.abs_hold_ms = hold_ms[k];
        abs_active = true;
        assert_split(0, 20000, REASON_ABS, step());
        abs_active = false;
        for (int32_t n = 1; n < hold_ms[k]; n++) {
            assert_split(0, 20000, REASON_ABS, step());
        }
        assert_split(20000, 0, REASON_NONE, step());
    }
}

/* ---- torque enable and hydraulic limit ---- */

void test_zero_torque_enable_moves_the_whole_demand_to_the_hydraulic_brake_in_one_step(void)
{
    in.brake_torque_mNm = 20000;
    motor_follows(20000);
    TEST_ASSERT_EQUAL_INT32(0, step().hydraulic_mNm);
    in.torque_enable.drive_q15 = 0;
    in.torque_enable.brake_q15 = 0;
    in.torque_enable.reason = REASON_OVERCURRENT;
    assert_split(0, 20000, REASON_OVERCURRENT, step());
}

void test_partial_torque_enable_is_a_share_of_max_torque(void)
{
    in.brake_torque_mNm = 60000;
    in.torque_enable.brake_q15 = 8192; /* a quarter of 50 Nm */
    in.torque_enable.reason = REASON_TORQUE_IMPLAUSIBLE;
    assert_split(12500, 47500, REASON_TORQUE_IMPLAUSIBLE, step());
}

void test_hydraulic_command_is_clamped_and_a_demand_beyond_both_brakes_has_reason_hydraulic_limit(
    void)
{
    config.brake.max_hydraulic_torque_mNm = 30000;
    in.brake_torque_mNm = 54000; /* 24 Nm electric and 30 Nm hydraulic */
    TEST_ASSERT_EQUAL_INT32(30000, step().hydraulic_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().hydraulic_reason);
    in.brake_torque_mNm = 54001;
    TEST_ASSERT_EQUAL_INT32(30000, step().hydraulic_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_LIMIT, step().hydraulic_reason);
}
