/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The monitor's coarse bound of the torque that the voltage forces contains the feasible set of the
 * torque limits: where that has no zero torque, the monitor tolerates braking.
 */
#include <math.h>
#include <stdio.h>

#include "config/bases.h"
#include "controller/controller.h"
#include "motor/current_setpoint.h"
#include "random_values.h"
#include "reference_motor.h"
#include "unity.h"

extern const config_t CONFIG_LU2013, CONFIG_EBIKE36V, CONFIG_SCOOTER48V, CONFIG_IPM400V;
static const config_t *const CONFIGS[] = {&CONFIG_LU2013, &CONFIG_EBIKE36V, &CONFIG_SCOOTER48V,
                                          &CONFIG_IPM400V};
enum { CONFIGS_COUNT = 4, STATES = 20000 };

static motor_constants_t constants[CONFIGS_COUNT];

static void init_constants(void)
{
    for (int k = 0; k < CONFIGS_COUNT; k++) {
        motor_constants_init(&constants[k], CONFIGS[k]);
    }
}

void setUp(void) {}

void tearDown(void) {}

/* The largest phase voltage that the torque limits count on: the circle less target and reserve. */
static int32_t phase_mV(const config_t *config, int32_t bus_mV)
{
    const config_current_loop_t *loop = &config->current_loop;
    const double share = foc_modulation_limit_q15(config, BASES_MODEL_TIMER_Hz) / 32768.0 *
                         (loop->modulation_target_pu_q15 - loop->modulation_reserve_pu_q15) /
                         32768.0;
    return (int32_t)lround(share * bus_mV / sqrt(3.0));
}

void test_where_zero_torque_is_not_feasible_the_monitor_tolerates_braking(void)
{
    random_t random = random_seeded(1);
    int infeasible = 0;
    init_constants();
    for (int n = 0; n < CONFIGS_COUNT * STATES; n++) {
        const config_t *config = CONFIGS[n % CONFIGS_COUNT];
        const int32_t direction = random_chance(&random, 0.5) ? 1 : -1;
        const int32_t speed_mrad_s =
            direction * random_between(&random, 0, 2 * config->motor.max_speed_mrad_s);
        const int32_t bus_mV =
            random_between(&random, config->battery.min_voltage_mV, config->battery.max_voltage_mV);
        const motor_model_t model =
            motor_model_at(&constants[n % CONFIGS_COUNT], config, speed_mrad_s,
                           random_between(&random, -2000, 14000));
        const feasible_set_t set = feasible_set_at(&model, phase_mV(config, bus_mV));
        const current_setpoint_t none = current_setpoint_step(&set, 0, 0);
        const bool feasible = none.feasible && none.forced_mNm == 0;
        const int32_t forced_mNm = monitor_forced_torque_mNm(config, speed_mrad_s, bus_mV);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(forced_mNm + config->monitor.torque_tolerance_mNm,
                                        none.forced_mNm);
        char text[100];
        snprintf(text, sizeof text, "%s %d mrad/s %d mV", config->name, (int)speed_mrad_s,
                 (int)bus_mV);
        TEST_ASSERT_TRUE_MESSAGE(feasible || forced_mNm == config->motor.max_torque_mNm, text);
        infeasible += feasible ? 0 : 1;
    }
    TEST_ASSERT_GREATER_THAN_INT(STATES / 2, infeasible);
}

/* Over the overcurrent trip no setpoint goes either. */
void test_no_setpoint_exceeds_the_monitor_s_current(void)
{
    random_t random = random_seeded(3);
    init_constants();
    for (int n = 0; n < CONFIGS_COUNT * STATES; n++) {
        const config_t *config = CONFIGS[n % CONFIGS_COUNT];
        const int32_t most_mNm = config->motor.max_torque_mNm;
        const int32_t top_mrad_s = config->motor.max_speed_mrad_s / 10 * 11;
        const motor_model_t model = motor_model_at(&constants[n % CONFIGS_COUNT], config,
                                                   random_between(&random, -top_mrad_s, top_mrad_s),
                                                   random_between(&random, -2000, 14000));
        const int32_t bus_mV =
            random_between(&random, config->battery.min_voltage_mV, config->battery.max_voltage_mV);
        const feasible_set_t set = feasible_set_at(&model, phase_mV(config, bus_mV));
        const current_setpoint_t out =
            current_setpoint_step(&set, random_between(&random, -most_mNm, most_mNm), 0);
        const double trip_mA =
            config->monitor.overcurrent_pu_q15 / 32768.0 * config->drive.current_full_scale_mA;
        TEST_ASSERT_TRUE(hypot(out.i_d_mA, out.i_q_mA) < trip_mA);
    }
}

/* |u| of terminal currents. */
static double voltage_of(const reference_motor_t *m, double i_d_a, double i_q_a)
{
    const double g = m->w_rad_s * m->iron_siemens;
    const double i_qt_a =
        (i_q_a - g * (m->l_d_h * i_d_a + m->psi_wb)) / (1.0 + g * g * m->l_d_h * m->l_q_h);
    const double i_dt_a = i_d_a + g * m->l_q_h * i_qt_a;
    return hypot(m->resistance_ohm * i_d_a - m->w_rad_s * m->l_q_h * i_qt_a,
                 m->resistance_ohm * i_q_a + m->w_rad_s * (m->l_d_h * i_dt_a + m->psi_wb));
}

/* The angle along the circle, from zero torque towards braking, at which the voltage first
 * suffices, or is least; by steps of a milliradian in the circuit. */
static double first_angle(const reference_motor_t *m, double most_a, double begin, double limit_v)
{
    const double along = cos(1e-3);
    const double across = sin(1e-3);
    double least_v = INFINITY;
    double least_at = begin;
    double d_a = -most_a * cos(begin);
    double q_a = -most_a * sin(begin);
    for (double at = begin; at < begin + 0.6; at += 1e-3) {
        const double u_v = voltage_of(m, d_a, q_a);
        const double turned_a = d_a * along - q_a * across;
        q_a = d_a * across + q_a * along;
        d_a = turned_a;
        if (u_v <= limit_v) {
            return at;
        }
        if (u_v < least_v) {
            least_v = u_v;
            least_at = at;
        }
    }
    return least_at;
}

/* Where voltage forces a torque, the setpoint is the one of least braking on the current circle. */
void test_forced_torque_is_the_least_that_the_voltage_allows(void)
{
    random_t random = random_seeded(4);
    int forced = 0;
    int within = 0;
    init_constants();
    for (int n = 0; n < 10 * STATES; n++) {
        const config_t *config = CONFIGS[n % 3]; /* ipm400v's circle covers -psi/L_d */
        const int32_t bus_mV =
            random_between(&random, config->battery.min_voltage_mV, config->battery.max_voltage_mV);
        const int32_t top_mrad_s = config->motor.max_speed_mrad_s;
        const int32_t speed_mrad_s = random_between(&random, top_mrad_s / 2, 2 * top_mrad_s);
        const int32_t winding_cC = random_between(&random, -2000, 9000);
        const motor_model_t model =
            motor_model_at(&constants[n % 3], config, speed_mrad_s, winding_cC);
        const feasible_set_t set = feasible_set_at(&model, phase_mV(config, bus_mV));
        const current_setpoint_t out = current_setpoint_step(&set, 0, 0);
        if (out.forced_mNm == 0) {
            continue;
        }
        forced++;
        const reference_motor_t m = reference_motor(config, speed_mrad_s, winding_cC);
        const double most_a = config->motor.max_phase_current_mA * 1e-3 * 255.0 / 256.0;
        /* Zero torque takes the iron current. */
        const double iron_a = m.w_rad_s * m.iron_siemens * (m.psi_wb - m.l_d_h * most_a);
        const double limit_v = phase_mV(config, bus_mV) * 1e-3 * sqrt(17.0 / 16.0 - 1.0 / 256.0);
        const double expected = first_angle(&m, most_a, -asin(iron_a / most_a), limit_v);
        const double found = atan2(-out.i_q_mA, -out.i_d_mA);
        char text[120];
        snprintf(text, sizeof text, "%s %d mrad/s %d mV %d cC", config->name, (int)speed_mrad_s,
                 (int)bus_mV, (int)winding_cC);
        /* Near its minimum the voltage hardly depends on the angle. */
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.05, expected, found, text);
        const double u_v = voltage_of(&m, -most_a * cos(expected), -most_a * sin(expected));
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(
            3e-3 * u_v, u_v, voltage_of(&m, out.i_d_mA * 1e-3, out.i_q_mA * 1e-3), text);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(5e-3 * most_a * 1e3, most_a * 1e3,
                                          hypot(out.i_d_mA, out.i_q_mA), text);
        within += out.feasible ? 1 : 0;
    }
    TEST_ASSERT_GREATER_THAN_INT(1000, forced);
    TEST_ASSERT_GREATER_THAN_INT(100, within);
}

/* And is zero where the EMF is half of the voltage circle. */
void test_ample_voltage_forces_no_torque(void)
{
    for (int k = 0; k < CONFIGS_COUNT; k++) {
        const config_motor_t *motor = &CONFIGS[k]->motor;
        for (int32_t bus_mV = CONFIGS[k]->battery.min_voltage_mV;
             bus_mV <= CONFIGS[k]->battery.max_voltage_mV; bus_mV += 100) {
            const double w = 0.5 * bus_mV * 1e-3 / sqrt(3.0) / (motor->flux_linkage_nWb * 1e-9);
            const int32_t speed_mrad_s = (int32_t)(1e3 * w / motor->pole_pairs);
            TEST_ASSERT_EQUAL_INT32(0, monitor_forced_torque_mNm(CONFIGS[k], speed_mrad_s, bus_mV));
        }
    }
}
