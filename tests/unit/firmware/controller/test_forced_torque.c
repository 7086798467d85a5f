/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The monitor's coarse bound of the torque that the voltage forces contains the feasible set of the
 * torque limits: where that has no zero torque, the monitor tolerates braking.
 */
#include <math.h>
#include <stdio.h>

#include "controller/controller.h"
#include "random_values.h"
#include "torque/current_setpoint.h"
#include "unity.h"

extern const config_t CONFIG_LU2013, CONFIG_EBIKE36V, CONFIG_SCOOTER48V, CONFIG_IPM400V;
static const config_t *const CONFIGS[] = {&CONFIG_LU2013, &CONFIG_EBIKE36V, &CONFIG_SCOOTER48V,
                                          &CONFIG_IPM400V};
enum { CONFIGS_COUNT = 4, STATES = 20000 };

void setUp(void) {}

void tearDown(void) {}

/* The largest phase voltage that the torque limits count on: the circle less target and reserve. */
static int32_t phase_mV(const config_t *config, int32_t bus_mV)
{
    const config_current_loop_t *loop = &config->current_loop;
    const double share = foc_modulation_limit_q15(config) / 32768.0 *
                         (loop->modulation_target_pu_q15 - loop->modulation_reserve_pu_q15) /
                         32768.0;
    return (int32_t)lround(share * bus_mV / sqrt(3.0));
}

void test_where_zero_torque_is_not_feasible_the_monitor_tolerates_braking(void)
{
    random_t random = random_seeded(1);
    int infeasible = 0;
    for (int n = 0; n < CONFIGS_COUNT * STATES; n++) {
        const config_t *config = CONFIGS[n % CONFIGS_COUNT];
        motor_constants_t constants;
        motor_constants_init(&constants, config);
        const int32_t direction = random_chance(&random, 0.5) ? 1 : -1;
        const int32_t speed_mrad_s =
            direction * random_between(&random, 0, 2 * config->motor.max_speed_mrad_s);
        const int32_t bus_mV =
            random_between(&random, config->battery.min_voltage_mV, config->battery.max_voltage_mV);
        const motor_model_t model =
            motor_model_at(&constants, config, speed_mrad_s, random_between(&random, -2000, 14000));
        const feasible_set_t set = feasible_set_at(&model, phase_mV(config, bus_mV));
        const bool feasible = current_setpoint_step(&set, 0, 0).feasible;
        const int32_t forced_mNm = monitor_forced_torque_mNm(config, speed_mrad_s, bus_mV);
        char text[100];
        snprintf(text, sizeof text, "%s %d mrad/s %d mV", config->name, (int)speed_mrad_s,
                 (int)bus_mV);
        TEST_ASSERT_TRUE_MESSAGE(feasible || forced_mNm == config->motor.max_torque_mNm, text);
        infeasible += feasible ? 0 : 1;
    }
    TEST_ASSERT_GREATER_THAN_INT(STATES / 2, infeasible);
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
