/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The inputs that available_ahead expects, to the unit, and that its result is the table of torque
 * limits of a step at these inputs. A low-pass of an eighth and a lead of 92/32 make a change of
 * 800 into 700 * 92/32 = 2012 ahead. On ramps of whole drives: test_available_ahead.c.
 */
#include <string.h>

#include "available_ahead_rig.h"
#include "random_values.h"
#include "reference_drive.h"
#include "torque_limits_rig.h"
#include "unity.h"

enum { MOST = 1 << 25, FASTEST_mrad_s = 67021 / 4 * 5 };

static motor_constants_t motor;
static available_ahead_state_t ahead;
static available_inputs_t in;

void setUp(void)
{
    rig_up(paper_vehicle());
    motor_constants_init(&motor, &config);
    torque_limits_init(&state, &table);
    memset(&in, 0, sizeof in);
    in.phase_voltage_mV = 28000;
    in.winding_temperature_cC = 2500;
    in.switch_temperature_cC = 2500;
    memset(&ahead, 0x5A, sizeof ahead);
    available_ahead_init(&ahead);
}

void tearDown(void) {}

static void assert_limit(int32_t torque_mNm, reason_t reason, limit_t limit)
{
    TEST_ASSERT_EQUAL_INT32(torque_mNm, limit.torque_mNm);
    TEST_ASSERT_EQUAL_INT(reason, limit.reason);
}

/* A round from the present table and inputs. */
static void sample_inputs(void)
{
    for (int n = 0; n < AVAILABLE_AHEAD_ROUND_steps; n++) {
        ahead_step(&ahead, &motor, &config, &table, &in, conditions.brake_torque_mNm);
    }
}

void test_a_start_leaves_no_number_of_before(void)
{
    const available_slope_t *slopes[] = {&ahead.speed,    &ahead.voltage,  &ahead.winding,
                                         &ahead.switches, &ahead.returned, &ahead.drawn};
    for (int n = 0; n < 6; n++) {
        TEST_ASSERT_TRUE(!slopes[n]->known && slopes[n]->value == 0);
        TEST_ASSERT_EQUAL_INT32(0, slopes[n]->low_passed_q3);
    }
    TEST_ASSERT_EQUAL_UINT32(0, ahead.step);
    TEST_ASSERT_EQUAL_INT32(
        FEASIBLE_UNBOUNDED,
        torque_limits_tightest(ahead.table.driving, 0, TORQUE_LINE_COUNT).torque_mNm);
    assert_limit(0, REASON_TORQUE_ENABLE, ahead.now.driving);
    assert_limit(0, REASON_TORQUE_ENABLE, ahead.now.braking);
    assert_limit(0, REASON_TORQUE_ENABLE, ahead.ahead.driving);
    assert_limit(0, REASON_TORQUE_ENABLE, ahead.ahead.braking);
}

/* Inputs are read in the first step alone, results come in the 15th. */
void test_a_round_takes_16_steps(void)
{
    table.driving[TORQUE_LINE_MAX_TORQUE] = limit_init(30000, REASON_MAX_TORQUE);
    table.braking[TORQUE_LINE_MAX_TORQUE] = limit_init(20000, REASON_MAX_TORQUE);
    for (uint32_t n = 0; n < AVAILABLE_AHEAD_ROUND_steps; n++) {
        TEST_ASSERT_EQUAL_UINT32(n, ahead.step);
        TEST_ASSERT_EQUAL_INT32(n <= 14 ? 0 : 30000, ahead.now.driving.torque_mNm);
        in.speed_mrad_s = n == 0 ? 5000 : 9000;
        ahead_step(&ahead, &motor, &config, &table, &in, conditions.brake_torque_mNm);
        TEST_ASSERT_EQUAL_INT32(5000, ahead.speed.value);
    }
    TEST_ASSERT_EQUAL_UINT32(0, ahead.step);
    assert_limit(20000, REASON_MAX_TORQUE, ahead.now.braking);
}

/* ---- inputs ---- */

static int32_t speed_after(int32_t first_mrad_s, int32_t second_mrad_s)
{
    available_ahead_init(&ahead);
    in.speed_mrad_s = first_mrad_s;
    sample_inputs();
    TEST_ASSERT_EQUAL_INT32(q_limit(first_mrad_s, MOST), ahead.expected.speed_mrad_s);
    in.speed_mrad_s = second_mrad_s;
    sample_inputs();
    return ahead.expected.speed_mrad_s;
}

void test_the_expected_speed_follows_its_slope_and_never_through_zero(void)
{
    TEST_ASSERT_EQUAL_INT32(10800 + 2012, speed_after(10000, 10800));
    TEST_ASSERT_EQUAL_INT32(-10800 - 2013, speed_after(-10000, -10800)); /* rounded down */
    TEST_ASSERT_EQUAL_INT32(10000 - 2013, speed_after(10800, 10000));
    TEST_ASSERT_EQUAL_INT32(0, speed_after(10000, 2000));
    TEST_ASSERT_EQUAL_INT32(0, speed_after(-10000, -2000));
    TEST_ASSERT_EQUAL_INT32(1, speed_after(1, 1));
    TEST_ASSERT_EQUAL_INT32(-1, speed_after(-1, -1));
    TEST_ASSERT_EQUAL_INT32(0, speed_after(1000, 0)); /* a wheel that stands is to stand */
    TEST_ASSERT_EQUAL_INT32(0, speed_after(-1000, 0));
}

void test_the_expected_speed_ends_a_quarter_beyond_the_highest_or_at_the_present_one(void)
{
    TEST_ASSERT_EQUAL_INT32(FASTEST_mrad_s, speed_after(30000, 67000));
    TEST_ASSERT_EQUAL_INT32(-FASTEST_mrad_s, speed_after(-30000, -67000));
    TEST_ASSERT_EQUAL_INT32(100000, speed_after(50000, 100000));
    TEST_ASSERT_EQUAL_INT32(MOST, speed_after(INT32_MAX, INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(MOST, speed_after(MOST - 8000, INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(-MOST, speed_after(INT32_MIN, INT32_MIN));
}

/* Two samples of an input, and what is expected then: what changes by more than `step` steps. */
static void assert_steps(int32_t *given, const int32_t *expected, int32_t from, int32_t step)
{
    const int32_t changes[] = {step, -step, step + 1, -step - 1};
    for (int n = 0; n < 4; n++) {
        available_ahead_init(&ahead);
        *given = from;
        sample_inputs();
        TEST_ASSERT_EQUAL_INT32(from, *expected);
        *given = from + changes[n];
        sample_inputs();
        if (n < 2) { /* 7/8 of it, 92/32 times; the low-pass and the lead are rounded */
            TEST_ASSERT_INT32_WITHIN(3, from + changes[n] + changes[n] * 7 / 8 * 92 / 32,
                                     *expected);
        } else {
            TEST_ASSERT_EQUAL_INT32(from + changes[n], *expected);
        }
    }
}

/* A sixteenth of the battery's highest voltage, half a kelvin, 64 thousandths of the largest power.
 */
void test_inputs_follow_their_slope_unless_they_step(void)
{
    assert_steps(&in.phase_voltage_mV, &ahead.expected.phase_voltage_mV, 28000,
                 config.battery.max_voltage_mV / 16);
    assert_steps(&in.winding_temperature_cC, &ahead.expected.winding_temperature_cC, 2000, 50);
    assert_steps(&in.switch_temperature_cC, &ahead.expected.switch_temperature_cC, 2000, 50);
    const int32_t power_step_b = 64 * motor.negligible_power_b;
    assert_steps(&table.drawn_b, &ahead.table.drawn_b, 500000, power_step_b);
    assert_steps(&table.losses.returned.power_b, &ahead.table.losses.returned.power_b, 1000000,
                 power_step_b);
}

void test_voltage_and_powers_are_expected_from_zero_to_the_largest_number(void)
{
    for (int n = 0; n < 2; n++) {
        const int32_t given = n == 0 ? INT32_MAX : -5;
        in.phase_voltage_mV = given;
        table.drawn_b = given;
        table.losses.returned.power_b = given;
        sample_inputs();
        TEST_ASSERT_EQUAL_INT32(n == 0 ? MOST : 0, ahead.expected.phase_voltage_mV);
        TEST_ASSERT_EQUAL_INT32(n == 0 ? MOST : 0, ahead.table.drawn_b);
        /* Below zero the motor has to draw now. */
        TEST_ASSERT_EQUAL_INT32(n == 0 ? MOST : -5, ahead.table.losses.returned.power_b);
    }
}

/* ---- the table at these inputs ---- */

static void step_at(int32_t speed_mrad_s, int32_t phase_voltage_mV, int32_t winding_cC)
{
    const motor_model_t model = motor_model_at(&motor, &config, speed_mrad_s, winding_cC);
    const feasible_set_t set = feasible_set_at(&model, phase_voltage_mV);
    torque_limits_state_t fresh;
    torque_limits_t unused;
    torque_limits_init(&fresh, &unused);
    torque_limits_case_step(&fresh, &set, &conditions, &table);
}

static void random_inputs(random_t *random)
{
    const config_motor_t *m = &config.motor;
    const config_battery_t *battery = &config.battery;
    in.speed_mrad_s = random_between(random, -m->max_speed_mrad_s, m->max_speed_mrad_s);
    in.phase_voltage_mV = random_between(random, 0, 6 * battery->max_voltage_mV / 10);
    in.winding_temperature_cC = random_between(random, 0, m->max_winding_temperature_cC);
    in.switch_temperature_cC = random_between(random, 0, config.drive.max_switch_temperature_cC);
    conditions.switch_temperature_cC = in.switch_temperature_cC;
    conditions.brake_torque_mNm = random_between(random, 0, m->max_torque_mNm);
    conditions.bus_voltage_mV =
        (battery->min_voltage_mV + battery->max_voltage_mV) / 2; /* no fold-back */
    const int32_t wheels = battery->driven_wheels;
    conditions.bms_charge_current_mA =
        random_between(random, 0, wheels * battery->max_charge_current_mA);
    conditions.bms_discharge_current_mA =
        random_between(random, 0, wheels * battery->max_discharge_current_mA);
    conditions.angle_valid = random_between(random, 0, 15) > 0;
    conditions.torque_enable.drive_q15 =
        (int16_t)(random_between(random, 0, 2) > 0 ? Q15_ONE : random_between(random, 0, Q15_ONE));
    conditions.torque_enable.reason = REASON_TORQUE_ENABLE;
    config.brake.strategy = random_between(random, 0, 2);
}

static void assert_same_lines(const limit_t *expected, const limit_t *lines)
{
    for (int line = 0; line < TORQUE_LINE_COUNT; line++) {
        assert_limit(expected[line].torque_mNm, expected[line].reason, lines[line]);
    }
}

static void assert_expected_table(void)
{
    assert_same_lines(table.driving, ahead.table.driving);
    assert_same_lines(table.braking, ahead.table.braking);
    const limit_t driving = torque_limits_tightest(table.driving, 0, TORQUE_LINE_COUNT);
    const limit_t braking = torque_limits_tightest(table.braking, 0, TORQUE_LINE_COUNT);
    assert_limit(driving.torque_mNm, driving.reason, ahead.ahead.driving);
    assert_limit(braking.torque_mNm, braking.reason, ahead.ahead.braking);
}

void test_of_steady_inputs_the_expected_table_is_the_present_one(void)
{
    static const config_t *const CONFIGS[] = {&CONFIG_LU2013, &CONFIG_EBIKE36V, &CONFIG_SCOOTER48V,
                                              &CONFIG_IPM400V};
    random_t random = random_seeded(41);
    int reasons[REASON_ACCELERATOR_LOCKED] = {0};
    for (int n = 0; n < 4000; n++) {
        rig_up(*CONFIGS[n % 4]);
        motor_constants_init(&motor, &config);
        random_inputs(&random);
        step_at(in.speed_mrad_s, in.phase_voltage_mV, in.winding_temperature_cC);
        available_ahead_init(&ahead);
        sample_inputs();
        assert_expected_table();
        reasons[ahead.ahead.driving.reason]++;
        reasons[ahead.ahead.braking.reason]++;
    }
    static const reason_t MET[] = {REASON_LOSS_OPTIMUM,        REASON_MAX_TORQUE,
                                   REASON_MAX_POWER,           REASON_PHASE_CURRENT,
                                   REASON_CHARGE_CURRENT,      REASON_DISCHARGE_CURRENT,
                                   REASON_WINDING_TEMPERATURE, REASON_SWITCH_TEMPERATURE,
                                   REASON_BLEND_OUT,           REASON_VOLTAGE,
                                   REASON_ELECTRIC_SHARE,      REASON_TORQUE_ENABLE,
                                   REASON_MAX_SPEED,           REASON_ROTOR_UNCERTAIN};
    for (unsigned k = 0; k < sizeof MET / sizeof MET[0]; k++) {
        TEST_ASSERT_GREATER_THAN_INT(10, reasons[MET[k]]);
    }
}

/* A slower wheel, a voltage and a winding that rise: the table of a step at what is expected. */
void test_of_changing_inputs_the_expected_table_is_that_of_a_step_at_the_expected_ones(void)
{
    random_t random = random_seeded(42);
    for (int n = 0; n < 1000; n++) {
        rig_up(n % 2 == 0 ? CONFIG_LU2013 : CONFIG_IPM400V);
        config.motor.friction_torque_mNm = 0; /* no torque lasts without a current */
        config.motor.viscous_friction_uNm_s = 0;
        motor_constants_init(&motor, &config);
        random_inputs(&random);
        available_ahead_init(&ahead);
        for (int round = 0; round < 3; round++) {
            in.speed_mrad_s = in.speed_mrad_s / 16 * 15;
            in.phase_voltage_mV += 100;
            in.winding_temperature_cC += 10;
            step_at(in.speed_mrad_s, in.phase_voltage_mV, in.winding_temperature_cC);
            sample_inputs();
        }
        const available_inputs_t *then = &ahead.expected;
        step_at(then->speed_mrad_s, then->phase_voltage_mV, then->winding_temperature_cC);
        assert_expected_table();
    }
}
