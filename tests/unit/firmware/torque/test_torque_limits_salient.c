/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "motor/current_setpoint.h"
#include "random_values.h"
#include "reference_motor.h"
#include "torque_limits_rig.h"
#include "unity.h"

void setUp(void)
{
    rig_up(salient_vehicle());
}

void tearDown(void) {}

static motor_current_t currents_of(const motor_model_t *model, int32_t torque_mNm)
{
    const feasible_set_t set = feasible_set_at(model, phase_mV);
    const current_setpoint_t i = current_setpoint_step(&set, torque_mNm, 0);
    const motor_current_t out = {.d_mA = i.i_d_mA, .q_mA = i.i_q_mA};
    return out;
}

/* Power from the battery, W, of a shaft torque with the current setpoint of
 * current_setpoint_step(), from the circuit in double precision. */
static double power_of_torque_w(const motor_model_t *model, int32_t torque_mNm)
{
    const motor_current_t i = currents_of(model, torque_mNm);
    const reference_motor_t m =
        reference_motor(&config, model->speed_mrad_s, winding_temperature_cC);
    const double g = m.w_rad_s * m.iron_siemens;
    const double i_qt_a = (i.q_mA * 1e-3 - g * (m.l_d_h * i.d_mA * 1e-3 + m.psi_wb)) /
                          (1.0 + g * g * m.l_d_h * m.l_q_h);
    const reference_point_t at = reference_point(&m, i.d_mA * 1e-3 + g * m.l_q_h * i_qt_a, i_qt_a);
    return at.power_w + reference_bridge_w(&config, at);
}

static void random_salient_conditions(random_t *random)
{
    config.motor.max_phase_current_mA = random_between(random, 150000, 400000);
    config.battery.max_charge_current_mA = 2000000;
    config.battery.max_discharge_current_mA = 2000000;
    conditions.bus_voltage_mV = random_between(random, 42000, 57000);
    conditions.bms_charge_current_mA = random_between(random, 0, 4000000);
    conditions.bms_discharge_current_mA = random_between(random, 0, 4000000);
    winding_temperature_cC = random_between(random, -2000, 12900);
}

void test_phase_current_limit_of_a_salient_motor_is_the_torque_at_the_best_current_angle(void)
{
    /* 250 A at standstill, by scanning the current angle. Interpolation between the map's points,
     * 32.8 Nm apart, costs less than 0.5 %, the current reserve another 0.5 %. */
    config = salient_vehicle();
    config.motor.max_phase_current_mA = 250000;
    double best_nm = 0.0;
    for (double angle = 0.0; angle < 1.57; angle += 1e-4) {
        best_nm =
            fmax(best_nm, 1.5 * 4.0 * (0.09 + 0.4e-3 * 250.0 * sin(angle)) * 250.0 * cos(angle));
    }
    const limit_t limit = at_speed(0).driving;
    TEST_ASSERT_EQUAL_INT(REASON_PHASE_CURRENT, limit.reason);
    TEST_ASSERT_TRUE(limit.torque_mNm <= best_nm * 1e3 + 30.0);
    TEST_ASSERT_TRUE(limit.torque_mNm >= best_nm * 990.0);
    TEST_ASSERT_EQUAL_INT32(limit.torque_mNm, at_speed(0).regenerating.torque_mNm);
}

void test_current_of_the_torque_limit_of_a_salient_motor_is_within_the_current_circle(void)
{
    random_t random = random_seeded(6);
    config = salient_vehicle();
    int bounded = 0;
    for (int n = 0; n < 20000; n++) {
        random_salient_conditions(&random);
        const motor_model_t model =
            model_at(&config, random_between(&random, -1200000, 1200000), winding_temperature_cC);
        const int32_t forward = model.speed_mrad_s >= 0 ? 1 : -1;
        const bounds_t out = bounds_of(&model);
        const limit_t limits[] = {out.driving, out.regenerating};
        for (int k = 0; k < 2; k++) {
            if (limits[k].torque_mNm == 0) {
                continue; /* i_d alone may take the whole current circle */
            }
            const int32_t torque_mNm = limits[k].torque_mNm * forward * (k == 0 ? 1 : -1);
            const motor_current_t i = currents_of(&model, torque_mNm);
            const double share = hypot(i.d_mA, i.q_mA) / config.motor.max_phase_current_mA;
            TEST_ASSERT_TRUE(share <= 1.002);
            if (limits[k].reason == REASON_PHASE_CURRENT) {
                bounded++;
                TEST_ASSERT_TRUE(share >= 0.99); /* the limit uses the current circle */
            }
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(2000, bounded);
}

void test_torque_limits_of_a_salient_motor_keep_the_battery_within_its_currents(void)
{
    random_t random = random_seeded(7);
    config = salient_vehicle();
    config.rotor.sensor = CONFIG_ROTOR_ANGLE; /* no power reserve for an angle error */
    int charging = 0;
    int draining = 0;
    for (int n = 0; n < 20000; n++) {
        random_salient_conditions(&random);
        const motor_model_t model =
            model_at(&config, random_between(&random, 60000, 1150000), winding_temperature_cC);
        const bounds_t out = bounds_of(&model);
        const double volts = conditions.bus_voltage_mV * 1e-3;
        const double returned_w = -power_of_torque_w(&model, -out.regenerating.torque_mNm);
        const double drawn_w = power_of_torque_w(&model, out.driving.torque_mNm);
        const double most_returned_w =
            fmin(conditions.bms_charge_current_mA, 4.0 * 2000000) * 0.25e-3 * volts;
        const double most_drawn_w =
            fmin(conditions.bms_discharge_current_mA, 4.0 * 2000000) * 0.25e-3 * volts;
        /* 0.1 % of 80 kW: roundings, and charge power too small to be limited. */
        TEST_ASSERT_TRUE(returned_w <= most_returned_w + 80.0);
        if (out.regenerating.reason == REASON_CHARGE_CURRENT && returned_w > 0.0) {
            charging++;
            TEST_ASSERT_TRUE(returned_w >= most_returned_w - 80.0);
        }
        if (out.driving.torque_mNm > 0) {
            TEST_ASSERT_TRUE(drawn_w <= most_drawn_w + 80.0);
            if (out.driving.reason == REASON_DISCHARGE_CURRENT) {
                draining++;
                TEST_ASSERT_TRUE(drawn_w >= most_drawn_w - 80.0);
            }
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(1000, charging);
    TEST_ASSERT_GREATER_THAN_INT(1000, draining);
}
