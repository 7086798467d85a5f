/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The torque available AVAILABLE_AHEAD_ms later: what was expected against what came, on ramps of
 * speed, bus voltage, temperature and battery limits, for every shipped configuration. The truth is
 * the table of torque limits of the later step, whose bounds other tests compare with the circuit
 * in double precision.
 */
#include <math.h>
#include <stdlib.h>

#include "available_ahead_rig.h"
#include "core/q15.h"
#include "reference_drive.h"
#include "torque_limits_case.h"
#include "unity.h"

enum { LONGEST_ms = 40000, SETTLED_ms = 3 * 128 };

/* Of one millisecond. */
typedef struct {
    double speed_mrad_s, bus_mV, winding_cC, switch_cC;
    double charge_mA, discharge_mA; /* of the pack */
    double flowing_mA;              /* of this motor, out of the battery */
} sample_t;

typedef struct {
    const config_t *config;
    motor_constants_t motor;
    torque_limits_state_t limits;
    torque_limits_t table;
    available_ahead_state_t ahead;
} watched_t;

static watched_t drive;
static torque_enable_t enabled;
static bool anti_lock;
static limit_t now_braking[LONGEST_ms], now_driving[LONGEST_ms];
static limit_t ahead_braking[LONGEST_ms], ahead_driving[LONGEST_ms];
static int length;

void setUp(void)
{
    const torque_enable_t all = {.drive_q15 = Q15_ONE, .brake_q15 = Q15_ONE};
    enabled = all;
    anti_lock = false;
}

void tearDown(void) {}

static void start(const config_t *config)
{
    drive.config = config;
    motor_constants_init(&drive.motor, config);
    torque_limits_init(&drive.limits, &drive.table);
    available_ahead_init(&drive.ahead);
    length = 0;
}

static void step(sample_t at)
{
    TEST_ASSERT_LESS_THAN_INT(LONGEST_ms, length);
    const config_t *config = drive.config;
    const motor_model_t model =
        motor_model_at(&drive.motor, config, (int32_t)at.speed_mrad_s, (int32_t)at.winding_cC);
    const int32_t phase_mV = (int32_t)(0.53 * at.bus_mV);
    const feasible_set_t set = feasible_set_at(&model, phase_mV);
    const torque_limits_case_t in = {
        .bus_voltage_mV = (int32_t)at.bus_mV,
        .bus_current_mA = (int32_t)at.flowing_mA,
        .bms_charge_current_mA = (int32_t)at.charge_mA,
        .bms_discharge_current_mA = (int32_t)at.discharge_mA,
        .switch_temperature_cC = (int32_t)at.switch_cC,
        .angle_valid = true,
        .abs_active = anti_lock,
        .torque_enable = enabled,
    };
    torque_limits_case_step(&drive.limits, &set, &in, &drive.table);
    const available_inputs_t seen = {
        .speed_mrad_s = model.speed_mrad_s,
        .phase_voltage_mV = phase_mV,
        .winding_temperature_cC = (int32_t)at.winding_cC,
        .switch_temperature_cC = (int32_t)at.switch_cC,
    };
    ahead_step(&drive.ahead, &drive.motor, config, &drive.table, &seen, 0);
    now_braking[length] = torque_limits_tightest(drive.table.braking, 0, TORQUE_LINE_COUNT);
    now_driving[length] = torque_limits_tightest(drive.table.driving, 0, TORQUE_LINE_COUNT);
    ahead_braking[length] = drive.ahead.ahead.braking;
    ahead_driving[length] = drive.ahead.ahead.driving;
    length++;
}

static double bound_mNm(void)
{
    return fmax(2000.0, 0.05 * drive.config->motor.rated_torque_mNm);
}

/* Largest difference between what was expected, three time constants after the start, and what
 * came. */
static double worst_mNm(const limit_t *expected, const limit_t *came)
{
    double worst = 0.0;
    for (int n = SETTLED_ms; n + AVAILABLE_AHEAD_ms < length; n++) {
        worst = fmax(worst, abs(expected[n].torque_mNm - came[n + AVAILABLE_AHEAD_ms].torque_mNm));
    }
    return worst;
}

static void assert_expected(void)
{
    TEST_ASSERT_TRUE(worst_mNm(ahead_braking, now_braking) < bound_mNm());
    TEST_ASSERT_TRUE(worst_mNm(ahead_driving, now_driving) < bound_mNm());
}

static sample_t calm(const config_t *config)
{
    const config_battery_t *battery = &config->battery;
    const sample_t out = {
        .speed_mrad_s = 0.5 * config->motor.max_speed_mrad_s,
        .bus_mV = 0.5 * (battery->min_voltage_mV + battery->max_voltage_mV),
        .winding_cC = 2500.0,
        .switch_cC = 2500.0,
        .charge_mA = 1.0 * battery->max_charge_current_mA * battery->driven_wheels,
        .discharge_mA = 1.0 * battery->max_discharge_current_mA * battery->driven_wheels,
    };
    return out;
}

static const config_t *const CONFIGS[] = {&CONFIG_LU2013, &CONFIG_EBIKE36V, &CONFIG_SCOOTER48V,
                                          &CONFIG_IPM400V};
enum { CONFIG_COUNT = 4 };

/* At 3 m/s2, from standstill to beyond the highest speed and back. */
static void ramp_of_speed(const config_t *config, double sign)
{
    const double per_ms = 3.0 / (1e-6 * config->vehicle.wheel_radius_um);
    const double top_mrad_s = 1.08 * config->motor.max_speed_mrad_s;
    sample_t at = calm(config);
    at.speed_mrad_s = sign > 0.0 ? 0.0 : top_mrad_s;
    for (start(config); at.speed_mrad_s >= 0.0 && at.speed_mrad_s <= top_mrad_s;
         at.speed_mrad_s += sign * per_ms) {
        step(at);
    }
}

void test_on_ramps_of_speed_the_expected_torques_come(void)
{
    for (int c = 0; c < CONFIG_COUNT; c++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            ramp_of_speed(CONFIGS[c], sign);
            assert_expected();
        }
        /* The present torques, taken for the later ones, miss by more. */
        TEST_ASSERT_TRUE(worst_mNm(now_driving, now_driving) > bound_mNm());
    }
}

/* Winding and switches at 2 K/s from below the derating to its end, where the torque is zero. */
void test_a_derating_is_expected_before_it_begins(void)
{
    for (int c = 0; c < CONFIG_COUNT; c++) {
        const config_t *config = CONFIGS[c];
        sample_t at = calm(config);
        const double edge_cC = config->motor.derate_winding_temperature_cC;
        start(config);
        for (at.winding_cC = edge_cC - 200.0; at.winding_cC < edge_cC + 800.0;
             at.winding_cC += 0.2) {
            step(at);
        }
        assert_expected();
        at = calm(config);
        start(config);
        for (at.switch_cC = config->drive.derate_switch_temperature_cC - 200.0;
             at.switch_cC < config->drive.max_switch_temperature_cC; at.switch_cC += 0.2) {
            step(at);
        }
        assert_expected();
        for (int n = SETTLED_ms; n + AVAILABLE_AHEAD_ms < length; n++) {
            const limit_t later = now_driving[n + AVAILABLE_AHEAD_ms];
            TEST_ASSERT_TRUE(later.torque_mNm > bound_mNm() ||
                             ahead_driving[n].reason == REASON_SWITCH_TEMPERATURE);
        }
    }
}

/* The bus rises through the fold-back to the highest voltage in six seconds. */
void test_a_bus_that_rises_into_the_fold_back_is_expected(void)
{
    for (int c = 0; c < CONFIG_COUNT; c++) {
        const config_battery_t *battery = &CONFIGS[c]->battery;
        const double width_mV = battery->max_voltage_mV - battery->foldback_voltage_mV;
        sample_t at = calm(CONFIGS[c]);
        start(CONFIGS[c]);
        for (at.bus_mV = battery->foldback_voltage_mV - width_mV;
             at.bus_mV < battery->max_voltage_mV; at.bus_mV += width_mV / 3000.0) {
            step(at);
        }
        assert_expected();
    }
}

/* The limits of the battery fall to zero within 30 s, in the steps of a message every 100 ms: a
 * ramp of steps is expected within three and a half of them. */
void test_falling_limits_of_the_battery_are_expected(void)
{
    for (int c = 0; c < CONFIG_COUNT; c++) {
        const sample_t first = calm(CONFIGS[c]);
        start(CONFIGS[c]);
        for (int n = 0; n < 32000; n++) {
            const double left = fmax(0.0, 1.0 - n / 100 / 300.0);
            sample_t at = first;
            at.charge_mA *= left;
            at.discharge_mA *= left;
            step(at);
        }
        assert_expected();
    }
}

/* Within two rounds, with the same reason. */
void test_what_disables_torque_holds_for_the_expected_torque_as_well(void)
{
    for (int c = 0; c < CONFIG_COUNT; c++) {
        const sample_t at = calm(CONFIGS[c]);
        start(CONFIGS[c]);
        for (int n = 0; n < 100; n++) {
            step(at);
        }
        TEST_ASSERT_GREATER_THAN_INT32(0, ahead_braking[length - 1].torque_mNm);
        TEST_ASSERT_GREATER_THAN_INT32(0, ahead_driving[length - 1].torque_mNm);
        anti_lock = true;
        for (int n = 0; n < 2 * AVAILABLE_AHEAD_ROUND_steps; n++) {
            step(at);
        }
        TEST_ASSERT_EQUAL_INT32(0, ahead_braking[length - 1].torque_mNm);
        TEST_ASSERT_EQUAL_INT(REASON_ABS, ahead_braking[length - 1].reason);
        anti_lock = false;
        const torque_enable_t none = {.reason = REASON_BATTERY_DISCONNECTED};
        enabled = none;
        for (int n = 0; n < 2 * AVAILABLE_AHEAD_ROUND_steps; n++) {
            step(at);
        }
        TEST_ASSERT_EQUAL_INT32(0, ahead_driving[length - 1].torque_mNm);
        TEST_ASSERT_EQUAL_INT(REASON_BATTERY_DISCONNECTED, ahead_driving[length - 1].reason);
        setUp();
    }
}

/* A charge limit that falls from whole to a half at once and stays is no slope. */
void test_a_step_of_a_limit_is_not_continued(void)
{
    for (int c = 0; c < CONFIG_COUNT; c++) {
        sample_t at = calm(CONFIGS[c]);
        start(CONFIGS[c]);
        for (int n = 0; n < 2000; n++) {
            at.charge_mA = calm(CONFIGS[c]).charge_mA * (n < 1000 ? 0.4 : 0.1);
            step(at);
        }
        for (int n = 1000 + 2 * AVAILABLE_AHEAD_ROUND_steps; n < 2000; n++) {
            TEST_ASSERT_INT32_WITHIN((int32_t)bound_mNm(), now_braking[n].torque_mNm,
                                     ahead_braking[n].torque_mNm);
        }
    }
}

void test_before_the_first_round_no_torque_is_available(void)
{
    start(&CONFIG_LU2013);
    TEST_ASSERT_EQUAL_INT32(0, drive.ahead.ahead.braking.torque_mNm);
    TEST_ASSERT_EQUAL_INT32(0, drive.ahead.now.driving.torque_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_TORQUE_ENABLE, drive.ahead.ahead.driving.reason);
}
