/* SPDX-License-Identifier: Apache-2.0 */
/*
 * torque_limits_rig.h: the table of torque limits with a cool motor on a battery that neither
 * charge nor discharge current bounds: only the motor's own limits act until a test changes
 * `conditions` or `config`. Included once in a program.
 */
#ifndef TORQUE_LIMITS_RIG_H
#define TORQUE_LIMITS_RIG_H

#include "paper_vehicle.h"
#include "torque_limits_case.h"
#include "torque_model.h"

/* The tightest lines of a step. */
typedef struct {
    limit_t driving;      /* torque in the direction of rotation */
    limit_t regenerating; /* braking torque without the lines of a strategy */
    limit_t optimal;      /* braking torque including the loss optimum */
} bounds_t;

static config_t config;
static torque_limits_case_t conditions;
static int32_t winding_temperature_cC;
static int32_t phase_mV;
static torque_limits_state_t state;
static torque_limits_t table;

/* One step of the table; the fold-back's state is left as it was, and the battery management's
 * limits have not fallen before. */
static inline bounds_t bounds_of(const motor_model_t *model)
{
    config.brake.loss_braking = 0; /* test_loss_braking.c */
    torque_limits_state_t copy = state;
    copy.charge_rise = slow_rise_init();
    copy.discharge_rise = slow_rise_init();
    const feasible_set_t set = feasible_set_at(model, phase_mV);
    torque_limits_case_step(&copy, &set, &conditions, &table);
    const bounds_t out = {
        .driving = torque_limits_tightest(table.driving, 0, TORQUE_LINE_COUNT),
        .regenerating = torque_limits_tightest(table.braking, 0, TORQUE_LINE_LOSS_OPTIMUM),
        .optimal = torque_limits_tightest(table.braking, 0, TORQUE_LINE_ELECTRIC_RATED),
    };
    return out;
}

static inline bounds_t at_speed(int32_t speed_mrad_s)
{
    const motor_model_t model = model_at(&config, speed_mrad_s, winding_temperature_cC);
    return bounds_of(&model);
}

/* Steps at standstill under the present conditions, until the fold-back is in its steady state. */
static inline void settle_foldback(int steps)
{
    const motor_model_t model = model_at(&config, 0, 2500);
    const feasible_set_t set = feasible_set_at(&model, phase_mV);
    for (int n = 0; n < steps; n++) {
        torque_limits_case_step(&state, &set, &conditions, &table);
    }
}

/* Half a second at a bus voltage far from both ends, with battery limits above any that a test
 * sets: the fold-back then bounds no current. */
static inline void open_foldback(void)
{
    const config_battery_t battery = config.battery;
    config.battery.max_charge_current_mA = 2000000;
    config.battery.max_discharge_current_mA = 2000000;
    settle_foldback(500);
    config.battery = battery;
}

static inline void rig_up(config_t vehicle)
{
    config = vehicle;
    config.battery.resistance_uOhm = 0;    /* the bus voltage is what a test says */
    config.drive.loss_per_ampere_uW_A = 0; /* test_feasible_power.c */
    config.drive.loss_resistance_uOhm = 0;
    winding_temperature_cC = 2500;
    phase_mV = 1000000; /* no voltage limit: test_feasible_torque.c */
    const torque_limits_case_t calm = {
        .bus_voltage_mV = 53000,
        .bms_charge_current_mA = 1000000,
        .bms_discharge_current_mA = 1000000,
        .switch_temperature_cC = 2500,
        .angle_valid = true,
        .torque_enable = {.drive_q15 = Q15_ONE, .brake_q15 = Q15_ONE, .reason = REASON_NONE},
    };
    conditions = calm;
    torque_limits_init(&state, &table);
    open_foldback();
}

#endif
