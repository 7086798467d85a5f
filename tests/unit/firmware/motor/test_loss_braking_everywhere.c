/* SPDX-License-Identifier: Apache-2.0 */
/* Loss braking beside braking by the map alone, in every shipped configuration: never less torque
 * at the same limit, and the setpoint makes it. */
#include "motor/loss_braking.h"
#include "torque_model.h"
#include "unity.h"

extern const config_t CONFIG_LU2013;
extern const config_t CONFIG_EBIKE36V;
extern const config_t CONFIG_SCOOTER48V;
extern const config_t CONFIG_IPM400V;
extern const config_t CONFIG_WHEEL24V;

static const config_t *const SHIPPED[] = {&CONFIG_LU2013, &CONFIG_EBIKE36V, &CONFIG_SCOOTER48V,
                                          &CONFIG_IPM400V, &CONFIG_WHEEL24V};
enum { SHIPPED_COUNT = 5, SPEEDS = 44, LIMITS = 9, HALF_PERCENT = 200 };

void setUp(void) {}

void tearDown(void) {}

typedef struct {
    int32_t speed_mrad_s, limit_mA, winding_cC;
    int32_t bound_mNm, made_mNm; /* magnitudes of shaft torque */
} braked_t;

/* Bound and setpoint with or without loss braking, as torque_limits_step() solves them. */
static void brake(config_t *config, bool by_losses, braked_t *at)
{
    static motor_model_t model;
    static feasible_set_t set;
    config->brake.loss_braking = by_losses ? 1 : 0;
    const int32_t bus_mV = config->battery.max_voltage_mV;
    model = model_at(config, at->speed_mrad_s, at->winding_cC);
    set = feasible_set_at(&model, (int32_t)(bus_mV * 0.54));
    feasible_side_t side = feasible_side_at(&set, SIDE_BRAKING, config->motor.max_torque_mNm);
    feasible_circle_t circle = {.known = false};
    const feasible_bounds_t ends = feasible_by_voltage_and_current(&side, &circle);
    const feasible_returned_t returned = {.power_b =
                                              feasible_power_b(&model, at->limit_mA, bus_mV)};
    loss_braking_t losses = loss_braking_at(&model, returned, Q15_ONE);
    const int32_t by_power_mNm =
        loss_braking_torque_mNm(&side, &losses, feasible_by_returned_mNm(&side, returned));
    at->bound_mNm = q_min(q_min(ends.voltage_mNm, ends.current_mNm),
                          q_min(by_power_mNm, config->motor.max_torque_mNm));
    const current_setpoint_t current = loss_braking_setpoint(
        &set, &losses, -at->bound_mNm, current_setpoint_step(&set, -at->bound_mNm, 0));
    const motor_current_t i = {.d_mA = current.i_d_mA, .q_mA = current.i_q_mA};
    at->made_mNm = -motor_model_torque_mNm(&model, motor_model_point(&model, i));
}

/* 0 to 110 % of the highest speed, 0 to the whole charge current, -20 to 120 degC. */
void test_loss_braking_never_makes_less_torque_than_the_map_at_the_same_limit(void)
{
    for (int n = 0; n < SHIPPED_COUNT; n++) {
        static config_t config;
        config = *SHIPPED[n];
        const int32_t tolerance_mNm = config.motor.max_torque_mNm / HALF_PERCENT;
        for (int speed = 1; speed <= SPEEDS; speed++) {
            for (int limit = 0; limit < LIMITS; limit++) {
                for (int32_t winding_cC = -2000; winding_cC <= 12000; winding_cC += 3500) {
                    braked_t plain = {
                        .speed_mrad_s = config.motor.max_speed_mrad_s / 40 * speed,
                        /* 0, 1/128 .. 1 of it */
                        .limit_mA = limit == 0 ? 0
                                               : config.battery.max_charge_current_mA >>
                                                     (LIMITS - 1 - limit),
                        .winding_cC = winding_cC,
                    };
                    braked_t losses = plain;
                    brake(&config, false, &plain);
                    brake(&config, true, &losses);
                    TEST_ASSERT_GREATER_OR_EQUAL_INT32(plain.bound_mNm, losses.bound_mNm);
                    TEST_ASSERT_GREATER_OR_EQUAL_INT32(plain.made_mNm - tolerance_mNm,
                                                       losses.made_mNm);
                }
            }
        }
    }
}
