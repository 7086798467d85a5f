/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Single lines of the table of torque limits, in whole numbers: a largest torque of 32.768
 * N m, of which a share in Q15 is as many millinewtonmetres.
 */
#include "torque_limits_rig.h"
#include "unity.h"

enum { WHOLE_mNm = 32768 };

void setUp(void)
{
    rig_up(paper_vehicle_without_i_d());
    config.motor.max_torque_mNm = WHOLE_mNm;
}

void tearDown(void) {}

static void assert_line(int32_t expected_mNm, reason_t reason, limit_t line)
{
    TEST_ASSERT_EQUAL_INT32(expected_mNm, line.torque_mNm);
    TEST_ASSERT_EQUAL_INT(reason, line.reason);
}

/* ---- shares ---- */

/* Linear over 20 K: half, a quarter, all and nothing. */
void test_a_temperature_line_is_linear_between_its_two_temperatures(void)
{
    static const int32_t OVER_cC[] = {-1, 0, 1000, 1500, 2000, 2001};
    static const int32_t EXPECTED_mNm[] = {
        FEASIBLE_UNBOUNDED, FEASIBLE_UNBOUNDED, WHOLE_mNm / 2, WHOLE_mNm / 4, 0, 0};
    config.motor.derate_winding_temperature_cC = 13000;
    config.motor.max_winding_temperature_cC = 15000;
    config.drive.derate_switch_temperature_cC = 8000;
    config.drive.max_switch_temperature_cC = 10000;
    for (int k = 0; k < 6; k++) {
        assert_line(EXPECTED_mNm[k], REASON_WINDING_TEMPERATURE,
                    torque_limits_winding(&config, 13000 + OVER_cC[k]));
        assert_line(EXPECTED_mNm[k], REASON_SWITCH_TEMPERATURE,
                    torque_limits_switch(&config, 8000 + OVER_cC[k]));
        winding_temperature_cC = 13000 + OVER_cC[k];
        conditions.switch_temperature_cC = 8000 + OVER_cC[k];
        (void)at_speed(1000);
        const limit_t *const sides[] = {table.driving, table.braking};
        for (int side = 0; side < 2; side++) {
            assert_line(EXPECTED_mNm[k], REASON_WINDING_TEMPERATURE,
                        sides[side][TORQUE_LINE_WINDING]);
            assert_line(EXPECTED_mNm[k], REASON_SWITCH_TEMPERATURE,
                        sides[side][TORQUE_LINE_SWITCH]);
        }
    }
}

/* 3/2 23 20.4 mWb 10 A = 7.038 N m at the reference temperature: what only an estimate takes away
 * leaves that while braking, and all of it without another brake; driving ends. */
void test_an_estimate_alone_leaves_the_braking_torque_that_lasts(void)
{
    config.motor.derate_winding_temperature_cC = 13000;
    config.motor.max_winding_temperature_cC = 15000;
    config.motor.reference_temperature_cC = 15000;
    config.drive.derate_switch_temperature_cC = 8000;
    config.drive.max_switch_temperature_cC = 10000;
    conditions.only_modelled = true;
    conditions.lasting_mA = 10000;
    static const torque_line_t LINES[] = {TORQUE_LINE_WINDING, TORQUE_LINE_SWITCH};
    for (int alone = 0; alone <= 1; alone++) {
        config.driver.no_other_brake = alone;
        winding_temperature_cC = 15000;
        conditions.switch_temperature_cC = 10000;
        (void)at_speed(1000);
        for (int k = 0; k < 2; k++) {
            TEST_ASSERT_EQUAL_INT32(0, table.driving[LINES[k]].torque_mNm);
            const int32_t braking_mNm = table.braking[LINES[k]].torque_mNm;
            if (alone == 1) {
                TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, braking_mNm);
            } else {
                TEST_ASSERT_INT32_WITHIN(75, 7038, braking_mNm);
            }
        }
    }
    config.driver.no_other_brake = 0;
    winding_temperature_cC = 13200; /* nine tenths are more than that */
    (void)at_speed(1000);
    TEST_ASSERT_INT32_WITHIN(10, WHOLE_mNm * 9 / 10, table.braking[TORQUE_LINE_WINDING].torque_mNm);
    conditions.lasting_mA = 1000000; /* no line is beyond the largest torque */
    winding_temperature_cC = 15000;
    (void)at_speed(1000);
    TEST_ASSERT_EQUAL_INT32(WHOLE_mNm, table.braking[TORQUE_LINE_WINDING].torque_mNm);
}

void test_the_last_quarter_of_the_speed_fades_driving_in_either_direction(void)
{
    config.motor.max_speed_mrad_s = 64000;
    config.motor.speed_fade_share_q15 = 8192;
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        assert_line(FEASIBLE_UNBOUNDED, REASON_MAX_SPEED,
                    torque_limits_max_speed(&config, sign * 48000));
        assert_line(WHOLE_mNm / 4 * 3, REASON_MAX_SPEED,
                    torque_limits_max_speed(&config, sign * 52000));
        assert_line(WHOLE_mNm / 16, REASON_MAX_SPEED,
                    torque_limits_max_speed(&config, sign * 63000));
        assert_line(0, REASON_MAX_SPEED, torque_limits_max_speed(&config, sign * 64000));
    }
    (void)at_speed(-52000);
    assert_line(WHOLE_mNm / 4 * 3, REASON_MAX_SPEED, table.driving[TORQUE_LINE_MAX_SPEED]);
    assert_line(FEASIBLE_UNBOUNDED, REASON_NONE, table.braking[TORQUE_LINE_MAX_SPEED]);
}

void test_torque_enable_is_a_share_of_each_side(void)
{
    conditions.torque_enable.drive_q15 = 8192;
    conditions.torque_enable.brake_q15 = 16384;
    conditions.torque_enable.reason = REASON_BUS_VOLTAGE_LOW;
    (void)at_speed(1000);
    assert_line(8192, REASON_BUS_VOLTAGE_LOW, table.driving[TORQUE_LINE_ENABLE]);
    assert_line(16384, REASON_BUS_VOLTAGE_LOW, table.braking[TORQUE_LINE_ENABLE]);
}

/* A quarter of the tightest line before it, on each side by itself; none without a missing share.
 */
void test_a_gain_of_the_current_sensors_takes_its_share_of_all_other_limits_of_a_side(void)
{
    (void)at_speed(1000);
    assert_line(FEASIBLE_UNBOUNDED, REASON_CURRENT_GAIN, table.driving[TORQUE_LINE_CURRENT_GAIN]);
    assert_line(FEASIBLE_UNBOUNDED, REASON_CURRENT_GAIN, table.braking[TORQUE_LINE_CURRENT_GAIN]);
    conditions.current_missing_q15 = 8192;
    (void)at_speed(1000);
    assert_line(WHOLE_mNm / 4 * 3, REASON_CURRENT_GAIN, table.driving[TORQUE_LINE_CURRENT_GAIN]);
    assert_line(WHOLE_mNm / 4 * 3, REASON_CURRENT_GAIN, table.braking[TORQUE_LINE_CURRENT_GAIN]);
    conditions.torque_enable.drive_q15 = 8192;
    conditions.torque_enable.brake_q15 = 16384;
    (void)at_speed(1000);
    assert_line(6144, REASON_CURRENT_GAIN, table.driving[TORQUE_LINE_CURRENT_GAIN]);
    assert_line(12288, REASON_CURRENT_GAIN, table.braking[TORQUE_LINE_CURRENT_GAIN]);
    conditions.angle_valid = false;
    (void)at_speed(1000);
    assert_line(0, REASON_CURRENT_GAIN, table.braking[TORQUE_LINE_CURRENT_GAIN]);
}

void test_an_invalid_rotor_angle_leaves_no_torque_and_a_valid_one_any(void)
{
    for (int valid = 0; valid < 2; valid++) {
        conditions.angle_valid = valid != 0;
        (void)at_speed(1000);
        const int32_t expected_mNm = valid != 0 ? FEASIBLE_UNBOUNDED : 0;
        assert_line(expected_mNm, REASON_ROTOR_UNCERTAIN, table.driving[TORQUE_LINE_ROTOR]);
        assert_line(expected_mNm, REASON_ROTOR_UNCERTAIN, table.braking[TORQUE_LINE_ROTOR]);
    }
}

/* 5 V of phase voltage at an EMF of 28 V: no current of 75 A weakens the field so far. */
void test_the_voltage_has_a_line_of_each_side(void)
{
    phase_mV = 5000;
    (void)at_speed(60000);
    TEST_ASSERT_EQUAL_INT(REASON_VOLTAGE, table.driving[TORQUE_LINE_VOLTAGE].reason);
    TEST_ASSERT_EQUAL_INT(REASON_VOLTAGE, table.braking[TORQUE_LINE_VOLTAGE].reason);
    TEST_ASSERT_LESS_THAN_INT32(WHOLE_mNm, table.driving[TORQUE_LINE_VOLTAGE].torque_mNm);
}

/* ---- power ---- */

static void assert_power_line(int32_t expected_mNm, int32_t power_mW, int32_t speed_mrad_s)
{
    config.motor.max_power_mW = power_mW;
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        (void)at_speed(sign * speed_mrad_s);
        assert_line(expected_mNm, REASON_MAX_POWER, table.driving[TORQUE_LINE_MAX_POWER]);
        assert_line(expected_mNm, REASON_MAX_POWER, table.braking[TORQUE_LINE_MAX_POWER]);
    }
}

/* Rounded down; beyond 4000 rad/s the rest of the division in whole rad/s. 2 kN m is no bound. */
void test_the_power_line_is_the_quotient_of_power_and_speed(void)
{
    assert_power_line(3003003, 1000000, 333);
    assert_power_line(249, 999999, 3999999);
    assert_power_line(250, 1000000, 4000000);
    assert_power_line(1249, 4999999, 4000000);
    assert_power_line(624999, 1000000000, 1600001);
    assert_power_line(999, 3999998, 3999999);
    assert_power_line(FEASIBLE_UNBOUNDED, 1000000, 0);
    assert_power_line(FEASIBLE_UNBOUNDED, 1000000000, 500);
    assert_power_line(1996007984, 1000000000, 501);
    assert_power_line(1999999000, 999999500, 500);
}

/* ---- blend-out and strategy ---- */

/* Over 32 768 mrad/s: two below the start are a share of 1 - 2^-14, one is as good as whole. */
void test_a_blend_out_of_less_than_the_whole_is_a_bound(void)
{
    config.brake.strategy = CONFIG_STRATEGY_SERIES_OPTIMAL;
    config.brake.blend_out_start_mrad_s = 34768;
    config.brake.blend_out_end_mrad_s = 2000;
    assert_line(WHOLE_mNm - 2, REASON_BLEND_OUT, torque_limits_blend_out(&config, 34766));
    assert_line(FEASIBLE_UNBOUNDED, REASON_BLEND_OUT, torque_limits_blend_out(&config, 34767));
}

static void assert_strategy(int32_t optimum_mNm, int32_t rated_mNm, int32_t share_mNm,
                            reason_t share_reason)
{
    assert_line(optimum_mNm, REASON_LOSS_OPTIMUM, table.braking[TORQUE_LINE_LOSS_OPTIMUM]);
    assert_line(rated_mNm, REASON_ELECTRIC_RATED, table.braking[TORQUE_LINE_ELECTRIC_RATED]);
    assert_line(share_mNm, share_reason, table.braking[TORQUE_LINE_ELECTRIC_SHARE]);
}

void test_each_strategy_has_its_lines(void)
{
    config.brake.blend_out_start_mrad_s = 4000;
    config.brake.blend_out_end_mrad_s = 2000;
    config.brake.electric_rated_torque_mNm = 16384;
    config.brake.parallel_electric_share_q15 = 24576; /* three quarters */
    config.brake.strategy = CONFIG_STRATEGY_SERIES_OPTIMAL;
    torque_limits_strategy(table.braking, &config, 5000, 12345, 20000);
    assert_strategy(12345, FEASIBLE_UNBOUNDED, FEASIBLE_UNBOUNDED, REASON_ELECTRIC_SHARE);
    torque_limits_strategy(table.braking, &config, 5000, -1, 20000);
    assert_strategy(0, FEASIBLE_UNBOUNDED, FEASIBLE_UNBOUNDED, REASON_ELECTRIC_SHARE);
    config.brake.strategy = CONFIG_STRATEGY_PARALLEL_RATIO;
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        torque_limits_strategy(table.braking, &config, sign * 4000, 12345, 20000);
        assert_strategy(FEASIBLE_UNBOUNDED, 16384, 15000, REASON_ELECTRIC_SHARE);
        torque_limits_strategy(table.braking, &config, sign * 3000, 12345, 20000);
        assert_strategy(FEASIBLE_UNBOUNDED, 16384, 7500, REASON_BLEND_OUT);
        assert_line(8192, REASON_BLEND_OUT, table.braking[TORQUE_LINE_BLEND_OUT]);
    }
}

/* A parallel brake's share is of the demand of the step, which is not negative. */
void test_the_share_of_a_parallel_brake_is_of_the_demand(void)
{
    config.brake.strategy = CONFIG_STRATEGY_PARALLEL_RATIO;
    config.brake.parallel_electric_share_q15 = 16384;
    conditions.brake_torque_mNm = 20000;
    (void)at_speed(50000);
    assert_line(10000, REASON_ELECTRIC_SHARE, table.braking[TORQUE_LINE_ELECTRIC_SHARE]);
    conditions.brake_torque_mNm = -20000;
    (void)at_speed(50000);
    assert_line(0, REASON_ELECTRIC_SHARE, table.braking[TORQUE_LINE_ELECTRIC_SHARE]);
}

/* ---- loss braking and anti-lock ---- */

static int32_t loss_braking_current_b(int32_t winding_cC, int32_t switch_cC)
{
    const motor_model_t model = model_at(&config, 30000, winding_cC);
    const feasible_set_t set = feasible_set_at(&model, phase_mV);
    conditions.switch_temperature_cC = switch_cC;
    torque_limits_case_step(&state, &set, &conditions, &table);
    return table.losses.current_b;
}

/* The current of loss braking falls with the warmer of winding and switches, half at 140 and at 90
 * degC. */
void test_loss_braking_is_derated_by_the_warmer_part(void)
{
    config.motor.derate_winding_temperature_cC = 13000;
    config.motor.max_winding_temperature_cC = 15000;
    config.drive.derate_switch_temperature_cC = 8000;
    config.drive.max_switch_temperature_cC = 10000;
    config.brake.loss_braking = 1;
    const int32_t whole_b = loss_braking_current_b(2500, 2500);
    TEST_ASSERT_GREATER_THAN_INT32(1000, whole_b);
    TEST_ASSERT_EQUAL_INT32(whole_b / 2, loss_braking_current_b(14000, 2500));
    TEST_ASSERT_EQUAL_INT32(whole_b / 2, loss_braking_current_b(2500, 9000));
    TEST_ASSERT_EQUAL_INT32(whole_b / 4, loss_braking_current_b(14000, 9500));
    TEST_ASSERT_EQUAL_INT32(whole_b / 4, loss_braking_current_b(14500, 9000));
}

static limit_t anti_lock(void)
{
    const slow_input_t sent = torque_limits_case_input(&conditions);
    return torque_limits_anti_lock(&state, &config, &sent.demand, conditions.brake_torque_mNm);
}

void test_an_intervention_leaves_its_share_and_holds_it(void)
{
    config.brake.abs_hold_ms = 3;
    conditions.brake_torque_mNm = 20000;
    assert_line(FEASIBLE_UNBOUNDED, REASON_ABS, anti_lock());
    TEST_ASSERT_EQUAL_INT32(0, state.abs_hold_steps);
    conditions.abs_active = true;
    conditions.abs_share_percent = 40;
    assert_line(8000, REASON_ABS, anti_lock());
    conditions.abs_share_percent = 100;
    assert_line(20000, REASON_ABS, anti_lock());
    conditions.abs_share_percent = 101;
    assert_line(20000, REASON_ABS, anti_lock());
    conditions.abs_share_percent = 25;
    assert_line(5000, REASON_ABS, anti_lock());
    conditions.abs_active = false;
    conditions.abs_share_percent = 80;
    assert_line(5000, REASON_ABS, anti_lock());
    conditions.brake_torque_mNm = 8000;
    assert_line(2000, REASON_ABS, anti_lock());
    assert_line(FEASIBLE_UNBOUNDED, REASON_ABS, anti_lock());
    assert_line(FEASIBLE_UNBOUNDED, REASON_ABS, anti_lock());
}
