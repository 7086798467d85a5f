/* SPDX-License-Identifier: Apache-2.0 */
#include "random_values.h"
#include "torque_command_rig.h"

static struct {
    limit_t driving, regenerating;
} capability;

void setUp(void)
{
    rig_up();
    capability.driving = limits.driving[TORQUE_LINE_MAX_TORQUE];
    capability.regenerating = limits.braking[TORQUE_LINE_MAX_TORQUE];
}

void tearDown(void) {}

static limit_t enabled(int32_t most_mNm, int16_t share_q15)
{
    const int32_t part_mNm = (int32_t)((int64_t)most_mNm * share_q15 / 32768);
    return limit_init(share_q15 < Q15_ONE ? part_mNm : INT32_MAX, in.torque_enable.reason);
}

static torque_command_out_t step(int32_t speed_mrad_s, int32_t drive_mNm, int32_t electric_mNm)
{
    in.speed_mrad_s = speed_mrad_s;
    in.drive_torque_mNm = drive_mNm;
    in.electric_mNm = electric_mNm;
    in.uncovered_mNm = in.rise_mNm = 0;
    limits.driving[TORQUE_LINE_MAX_TORQUE] = capability.driving;
    limits.driving[TORQUE_LINE_ENABLE] = enabled(40000, in.torque_enable.drive_q15);
    limits.braking[TORQUE_LINE_MAX_TORQUE] = capability.regenerating;
    limits.braking[TORQUE_LINE_ENABLE] = enabled(25000, in.torque_enable.brake_q15);
    return command_step();
}

static torque_command_out_t settle(int32_t speed_mrad_s, int32_t drive_mNm, int32_t electric_mNm)
{
    for (int n = 0; n < SETTLED; n++) {
        step(speed_mrad_s, drive_mNm, electric_mNm);
    }
    return step(speed_mrad_s, drive_mNm, electric_mNm);
}

static void assert_command(int32_t command_mNm, reason_t reason, torque_command_out_t out)
{
    TEST_ASSERT_EQUAL_INT32(command_mNm, out.command_mNm);
    TEST_ASSERT_EQUAL_INT(reason, out.reason);
}

void test_torque_rises_and_falls_at_its_rate_with_reason_torque_rate(void)
{
    assert_command(400, REASON_TORQUE_RATE, step(FORWARD, 1000, 0));
    assert_command(800, REASON_TORQUE_RATE, step(FORWARD, 1000, 0));
    assert_command(1000, REASON_NONE, step(FORWARD, 1000, 0));
    assert_command(600, REASON_TORQUE_RATE, step(FORWARD, 0, 0));
    assert_command(200, REASON_TORQUE_RATE, step(FORWARD, 0, 0));
    assert_command(0, REASON_NONE, step(FORWARD, 0, 0));
}

void test_the_torque_is_falling_until_a_smaller_one_of_the_same_sign_is_reached(void)
{
    static const int32_t SIGN[] = {1, -1};
    for (int k = 0; k < 2; k++) {
        command_begins();
        TEST_ASSERT_FALSE(step(FORWARD * SIGN[k], SIGN[k] * 1000, 0).falling); /* rises */
        TEST_ASSERT_FALSE(settle(FORWARD * SIGN[k], SIGN[k] * 1000, 0).falling);
        TEST_ASSERT_TRUE(step(FORWARD * SIGN[k], SIGN[k] * 500, 0).falling);  /* 600 */
        TEST_ASSERT_FALSE(step(FORWARD * SIGN[k], SIGN[k] * 500, 0).falling); /* 500 */
        TEST_ASSERT_FALSE(step(FORWARD * SIGN[k], 0, 0).falling);             /* to none */
        settle(FORWARD * SIGN[k], SIGN[k] * 1000, 0);
        TEST_ASSERT_FALSE(step(FORWARD * SIGN[k], 0, 1000).falling); /* to the opposite one */
    }
}

/* Without a valid angle it ramps. */
void test_what_the_observers_angle_does_not_allow_goes_in_one_step(void)
{
    for (int along = 0; along <= 1; along++) {
        in.angle_valid = false;
        limits.driving[TORQUE_LINE_ROTOR].torque_mNm = FEASIBLE_UNBOUNDED;
        limits.braking[TORQUE_LINE_ROTOR].torque_mNm = FEASIBLE_UNBOUNDED;
        const int32_t drive_mNm = along == 1 ? 20000 : 0;
        const int32_t sign = along == 1 ? 1 : -1;
        settle(FORWARD, drive_mNm, 20000 - drive_mNm);
        limit_t *line = along == 1 ? limits.driving : limits.braking;
        line[TORQUE_LINE_ROTOR] = limit_init(9000, REASON_ROTOR_UNCERTAIN);
        const int32_t electric_mNm = along == 1 ? 0 : 9000;
        TEST_ASSERT_EQUAL_INT32(sign * (20000 - RATE),
                                step(FORWARD, drive_mNm, electric_mNm).command_mNm);
        in.angle_valid = true;
        TEST_ASSERT_EQUAL_INT32(sign * 9000, step(FORWARD, drive_mNm, electric_mNm).command_mNm);
    }
}

void test_braking_acts_against_the_rotation(void)
{
    assert_command(-10000, REASON_NONE, settle(FORWARD, 0, 10000));
    assert_command(10000, REASON_NONE, settle(BACKWARD, 0, 10000));
}

void test_driving_limit_bounds_driving_in_both_directions(void)
{
    assert_command(30000, REASON_NONE, settle(FORWARD, 30000, 0));
    assert_command(40000, REASON_MAX_TORQUE, settle(FORWARD, 60000, 0));
    assert_command(-40000, REASON_MAX_TORQUE, settle(BACKWARD, -60000, 0));
}

void test_driving_limit_bounds_both_signs_of_torque_at_standstill(void)
{
    assert_command(40000, REASON_MAX_TORQUE, settle(0, 60000, 0));
    assert_command(-40000, REASON_MAX_TORQUE, settle(0, -60000, 0));
}

void test_braking_limit_bounds_a_drive_demand_against_the_rotation(void)
{
    assert_command(-25000, REASON_CHARGE_CURRENT, settle(FORWARD, -60000, 0));
    assert_command(25000, REASON_CHARGE_CURRENT, settle(BACKWARD, 60000, 0));
    capability.driving =
        limit_init(0, REASON_MAX_SPEED); /* a driving limit does not bound braking */
    assert_command(-25000, REASON_CHARGE_CURRENT, settle(FORWARD, -60000, 0));
}

/* At any speed but zero, torque against the rotation is braking. */
void test_braking_limit_bounds_a_drive_demand_against_the_smallest_speed(void)
{
    assert_command(-25000, REASON_CHARGE_CURRENT, settle(1, -100000, 0));
    assert_command(25000, REASON_CHARGE_CURRENT, settle(-1, 100000, 0));
}

/* Brake blending counts a negative torque as braking at standstill (test_brake_blending.c). */
void test_braking_torque_is_negative_at_standstill(void)
{
    assert_command(-5000, REASON_NONE, settle(0, 0, 5000));
}

void test_driving_and_braking_have_separate_torque_enables(void)
{
    in.torque_enable.drive_q15 = 8192; /* a quarter of 40 Nm */
    in.torque_enable.reason = REASON_ROTOR_UNCERTAIN;
    assert_command(10000, REASON_ROTOR_UNCERTAIN, settle(FORWARD, 60000, 0));
    assert_command(-25000, REASON_CHARGE_CURRENT, settle(FORWARD, -60000, 0));
    in.torque_enable.drive_q15 = Q15_ONE;
    in.torque_enable.brake_q15 = 8192; /* a quarter of 25 Nm */
    assert_command(40000, REASON_MAX_TORQUE, settle(FORWARD, 60000, 0));
    assert_command(-6250, REASON_ROTOR_UNCERTAIN, settle(FORWARD, -60000, 0));
}

void test_torque_falls_at_its_rate_after_the_torque_enable_is_withdrawn(void)
{
    settle(FORWARD, 30000, 0);
    in.torque_enable.drive_q15 = 0;
    in.torque_enable.reason = REASON_TORQUE_ENABLE;
    assert_command(29600, REASON_TORQUE_RATE, step(FORWARD, 30000, 0));
    assert_command(0, REASON_TORQUE_ENABLE, settle(FORWARD, 30000, 0));
}

void test_command_is_zero_in_one_step_when_the_bridge_stops_switching(void)
{
    settle(FORWARD, 30000, 0);
    const torque_enable_t full = in.torque_enable;
    in.torque_enable.drive_q15 = 0;
    in.torque_enable.brake_q15 = 0;
    in.torque_enable.reason = REASON_OVERCURRENT;
    assert_command(0, REASON_OVERCURRENT, step(FORWARD, 30000, 0));
    assert_command(0, REASON_OVERCURRENT, step(FORWARD, 0, 10000));
    assert_command(0, REASON_NONE, step(FORWARD, 0, 0));
    /* and afterwards it starts again from zero */
    in.torque_enable = full;
    assert_command(400, REASON_TORQUE_RATE, step(FORWARD, 30000, 0));
}

/* ---- what goes at once ---- */

void test_withdrawn_driving_torque_goes_at_once_and_braking_begins_at_its_rate(void)
{
    settle(FORWARD, 30000, 0);
    in.drive_withdrawn = true;
    assert_command(-400, REASON_TORQUE_RATE, step(FORWARD, 0, 20000));
    assert_command(-800, REASON_TORQUE_RATE, step(FORWARD, 0, 20000));
    command_begins();
    in.drive_withdrawn = false;
    settle(0, 30000, 0); /* at standstill every torque drives */
    in.drive_withdrawn = true;
    assert_command(0, REASON_NONE, step(0, 0, 0));
}

void test_torque_of_a_wheel_that_rolls_back_is_braking_and_is_not_withdrawn(void)
{
    settle(BACKWARD, 20000, 0);
    in.drive_withdrawn = true;
    assert_command(20000, REASON_NONE, step(BACKWARD, 0, 20000));
}

void test_braking_torque_above_the_anti_lock_limit_goes_at_once(void)
{
    settle(FORWARD, 0, 20000);
    limits.braking[TORQUE_LINE_ABS] = limit_init(5000, REASON_ABS);
    assert_command(-5000, REASON_NONE, step(FORWARD, 0, 5000));
    limits.braking[TORQUE_LINE_ABS] = limit_init(0, REASON_ABS);
    assert_command(0, REASON_NONE, step(FORWARD, 0, 0));
    settle(FORWARD, 30000, 0); /* a driving torque is none of its business */
    assert_command(29600, REASON_TORQUE_RATE, step(FORWARD, 0, 0));
}

/* Of 30 N m the hydraulic brake makes 10, then 12: the motor leaves with it, however slow the rate
 * is, and no further than to what the demand leaves it. Without a demand, and driving, nothing is
 * taken over. */
void test_braking_torque_that_the_hydraulic_brake_has_taken_over_goes_at_once(void)
{
    static const int32_t SPEEDS_mrad_s[] = {FORWARD, BACKWARD};
    for (int k = 0; k < 2; k++) {
        const int32_t speed_mrad_s = SPEEDS_mrad_s[k];
        const int32_t sign = k == 0 ? -1 : 1;
        command_begins();
        settle(speed_mrad_s, 0, 20000);
        in.electric_mNm = in.uncovered_mNm = 18000;
        in.rise_mNm = 2000;
        assert_command(sign * 18000, REASON_NONE, command_step());
        in.rise_mNm = 1000; /* less than the motor has too much */
        in.uncovered_mNm = in.electric_mNm = 10000;
        assert_command(sign * 17000, REASON_TORQUE_RATE, command_step());
        in.rise_mNm = 0; /* a demand that falls: for comfort, at the rate */
        assert_command(sign * 16600, REASON_TORQUE_RATE, command_step());
        settle(speed_mrad_s, -sign * 20000, 0);
        in.electric_mNm = in.uncovered_mNm = 0;
        in.drive_torque_mNm = -sign * 20000;
        in.rise_mNm = 5000;
        assert_command(-sign * 20000, REASON_NONE, command_step());
    }
}

void test_braking_torque_of_a_wheel_that_turns_round_goes_at_once(void)
{
    static const int32_t SPEEDS_mrad_s[] = {BACKWARD, -1};
    for (int k = 0; k < 2; k++) {
        command_begins();
        settle(FORWARD, 0, 20000);
        assert_command(0, REASON_NONE, step(SPEEDS_mrad_s[k], 0, 0));
    }
}

/* A speed of zero may be a stuck hall line: the torque falls at its rate, and goes at once when the
 * wheel turns round. */
void test_braking_torque_falls_at_its_rate_at_zero_speed(void)
{
    settle(FORWARD, 0, 20000);
    assert_command(-19600, REASON_TORQUE_RATE, step(0, 0, 0));
    assert_command(-19200, REASON_TORQUE_RATE, step(0, 0, 0));
    assert_command(0, REASON_NONE, step(-1, 0, 0));
}

void test_driving_torque_after_braking_to_rest_is_withdrawn_at_once(void)
{
    settle(FORWARD, 0, 20000);
    settle(0, 0, 0);
    settle(0, 20000, 0);
    in.drive_withdrawn = true;
    assert_command(0, REASON_NONE, step(0, 0, 0));
}

/* A hill start: the torque that stops a wheel from rolling back drives it afterwards. */
void test_driving_torque_stays_when_a_wheel_that_rolled_back_turns_forward(void)
{
    settle(BACKWARD, 20000, 0);
    assert_command(20000, REASON_NONE, step(0, 20000, 0));
    assert_command(20000, REASON_NONE, step(FORWARD, 20000, 0));
}

void test_command_stays_between_zero_and_the_demand_under_random_limits(void)
{
    random_t random = random_seeded(1);
    for (int n = 0; n < 20000; n++) {
        capability.driving = limit_init(random_between(&random, 0, 60000), REASON_MAX_POWER);
        capability.regenerating = limit_init(random_between(&random, 0, 60000), REASON_MAX_POWER);
        in.torque_enable.drive_q15 = (int16_t)random_between(&random, 0, Q15_ONE);
        in.torque_enable.brake_q15 = (int16_t)random_between(&random, 0, Q15_ONE);
        const int32_t speed_mrad_s = random_between(&random, -70000, 70000);
        const int32_t drive_mNm = random_between(&random, -60000, 60000);
        command_begins();
        for (int k = 0; k < 160; k++) {
            const int32_t command_mNm = step(speed_mrad_s, drive_mNm, 0).command_mNm;
            TEST_ASSERT_GREATER_OR_EQUAL_INT32(drive_mNm < 0 ? drive_mNm : 0, command_mNm);
            TEST_ASSERT_LESS_OR_EQUAL_INT32(drive_mNm > 0 ? drive_mNm : 0, command_mNm);
        }
    }
}

void test_the_command_never_grows_faster_than_the_rate_and_falls_faster_to_zero_only(void)
{
    random_t random = random_seeded(2);
    int32_t before_mNm = 0;
    for (int n = 0; n < 100000; n++) {
        const bool braking = random_chance(&random, 0.5);
        const int32_t command_mNm = step(random_between(&random, -70000, 70000),
                                         braking ? 0 : random_between(&random, -60000, 60000),
                                         braking ? random_between(&random, 0, 60000) : 0)
                                        .command_mNm;
        const bool within_rate = q_abs(command_mNm - before_mNm) <= RATE;
        TEST_ASSERT_TRUE(within_rate || q_abs(command_mNm) <= RATE);
        before_mNm = command_mNm;
    }
}

/* ---- torque rate near the voltage limit ---- */

/* voltage_use_q15 is a square: 30802 and 31457 are 0.94 and 0.96 of that of the largest voltage. */
void test_torque_rises_at_its_full_rate_up_to_voltage_use_0_94(void)
{
    in.voltage_use_q15 = 30801;
    assert_command(400, REASON_TORQUE_RATE, step(FORWARD, 10000, 0));
    assert_command(800, REASON_TORQUE_RATE, step(FORWARD, 10000, 0));
}

void test_torque_rate_falls_with_the_remaining_voltage(void)
{
    in.voltage_use_q15 = 31129; /* the middle of 30802 and 31457, less 0.15 % */
    assert_command(200, REASON_TORQUE_RATE, step(FORWARD, 10000, 0));
    assert_command(-200, REASON_TORQUE_RATE, (settle(FORWARD, 0, 0), step(FORWARD, 0, 10000)));
}

void test_torque_falls_with_reason_voltage_above_voltage_use_0_96(void)
{
    settle(FORWARD, 0, 10000);
    in.voltage_use_q15 = 31457;
    assert_command(-10000, REASON_NONE, step(FORWARD, 0, 10000));
    assert_command(-10000, REASON_VOLTAGE, step(FORWARD, 0, 20000)); /* neither rises nor falls */
    in.voltage_use_q15 =
        31831; /* 374 above 31457, width 655.36: 400 * 374/655.36 = 228.3, rounded down to 229 */
    assert_command(-9771, REASON_VOLTAGE, step(FORWARD, 0, 10000));
    in.voltage_use_q15 = INT32_MAX;
    assert_command(-9371, REASON_VOLTAGE, step(FORWARD, 0, 10000));
    assert_command(0, REASON_VOLTAGE, settle(FORWARD, 0, 10000));
}

/* A winding whose current comes half the way to its setpoint in a step: u^2/U^2 is 0.5, and 1.25
 * after a step at the whole rate. That stops the growth, but must not take the torque away. */
void test_torque_grows_though_each_step_of_it_needs_all_of_the_voltage(void)
{
    int32_t follows_mNm = 0;
    int32_t command_mNm = 0;
    for (int n = 0; n < 500; n++) {
        const int32_t moves_mNm = command_mNm - follows_mNm;
        in.voltage_use_q15 = 16384 + moves_mNm * 24576 / RATE;
        follows_mNm += moves_mNm / 2;
        command_mNm = step(FORWARD, 10000, 0).command_mNm;
    }
    TEST_ASSERT_EQUAL_INT32(10000, command_mNm);
}

/* After a step at the whole rate 400 less than 4 * 400 * (3/4)^n for n = 5, -21 (rounded up along
 * the way), and the whole rate some steps later. */
void test_torque_that_has_grown_falls_when_the_voltage_stays_beyond_voltage_use_0_96(void)
{
    assert_command(400, REASON_TORQUE_RATE, step(FORWARD, 10000, 0));
    in.voltage_use_q15 = INT32_MAX;
    for (int n = 0; n < 5; n++) {
        assert_command(400, REASON_VOLTAGE, step(FORWARD, 10000, 0));
    }
    TEST_ASSERT_INT32_WITHIN(4, 400 - 21, step(FORWARD, 10000, 0).command_mNm);
    assert_command(0, REASON_VOLTAGE, settle(FORWARD, 10000, 0));
}

/* A growth of a sixteenth of the rate explains no more than a quarter of it. */
void test_a_little_growth_keeps_little_of_the_torque(void)
{
    settle(FORWARD, 10000, 0);
    assert_command(10000 + RATE / 16, REASON_NONE, step(FORWARD, 10000 + RATE / 16, 0));
    in.voltage_use_q15 = INT32_MAX;
    assert_command(10000 + RATE / 16 - RATE * 3 / 4, REASON_VOLTAGE,
                   step(FORWARD, 10000 + RATE / 16, 0));
}

void test_torque_falls_at_its_full_rate_at_any_voltage_use(void)
{
    settle(FORWARD, 10000, 0);
    in.voltage_use_q15 = 31457;
    assert_command(9600, REASON_TORQUE_RATE, step(FORWARD, 0, 0));
    assert_command(9200, REASON_TORQUE_RATE, step(FORWARD, 0, 0));
}

/* The rate falls along a line over u^2/U^2: with its end at 0.8 and a slope of ten, whole below 0.7
 * and half at 0.75. */
void test_torque_growth_follows_the_configured_line(void)
{
    config.brake.torque_growth_end_q15 = 26214;     /* 0.8 */
    config.brake.torque_growth_slope_q9 = 10 * 512; /* per unit of u^2/U^2 */
    TEST_ASSERT_EQUAL_INT32(RATE, torque_command_growth_mNm(&config, 22937)); /* 0.7 */
    TEST_ASSERT_INT32_WITHIN(1, RATE / 2, torque_command_growth_mNm(&config, 24576));
    TEST_ASSERT_EQUAL_INT32(0, torque_command_growth_mNm(&config, 26214));
    TEST_ASSERT_INT32_WITHIN(1, -RATE / 2, torque_command_growth_mNm(&config, 27853)); /* 0.85 */
    TEST_ASSERT_EQUAL_INT32(-RATE, torque_command_growth_mNm(&config, INT32_MAX));
}
