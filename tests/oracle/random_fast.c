/* SPDX-License-Identifier: Apache-2.0 */
/*
 * random_fast FIRST END: random lives of both steps, each from controller_init() on, around a
 * motor (motor.h). Entries FIRST to the one before END, of
 * RUNS_AN_ENTRY runs each.
 *
 * A run draws a configuration with its rotor sensor, a speed and its changes, demands, and at most
 * two faults of what the fast step is given: converter codes, rotor sensors, setpoints. Every
 * report is hashed, not only those of the slow steps.
 */
#include <stdio.h>
#include <stdlib.h>

#include "config/bases.h"
#include "configurations.h"
#include "controller/controller.h"
#include "motor.h"
#include "numbers.h"
#include "program.h"
#include "random.h"

enum { RUNS_AN_ENTRY = 25, FAULTS_MOST = 2 };
static const uint64_t SEED = 1974;

enum {
    FAULT_CURRENT_STUCK,
    FAULT_CURRENT_GAIN,
    FAULT_CURRENT_NOISE,
    FAULT_CURRENTS_FROZEN,
    FAULT_BUS_STUCK,
    FAULT_BUS_JUMP,
    FAULT_HALL_STUCK,
    FAULT_ROTOR_NOISE,
    FAULT_ROTOR_FROZEN,
    FAULT_ROTOR_SLIPPED,
    FAULT_INDEX_LOST,
    FAULT_INDEX_WRONG,
    FAULT_POWER_STAGE,
    FAULT_SETPOINT_STALE,
    FAULT_SETPOINT_FORCED,
    FAULT_BATTERY_OPEN,
    FAULT_KINDS
};

typedef struct {
    int32_t kind, begin, end; /* FAULT_..., periods */
    int32_t number;
    double amount; /* -1 .. 1 */
} fault_t;

typedef struct {
    config_t config;
    random_t random;
    controller_t controller;
    fast_setpoint_t setpoint, forced;
    slow_input_t in;
    slow_output_t out;
    fast_output_t active;
    fast_input_t last;
    fault_t fault[FAULTS_MOST];
    int32_t faults, period, periods, periods_a_ms, phase_left_ms;
    motor_t motor;
} life_t;

static bool chance(life_t *life, int32_t per_mille)
{
    return random_chance(&life->random, per_mille);
}

static int32_t between(life_t *life, int32_t low, int32_t high)
{
    return random_between(&life->random, low, high);
}

static double real(life_t *life, double low, double high)
{
    return random_real(&life->random, low, high);
}

static bool has_fault(const life_t *life, int32_t kind)
{
    for (int32_t k = 0; k < life->faults; k++) {
        const fault_t *fault = &life->fault[k];
        if (fault->kind == kind && life->period >= fault->begin && life->period < fault->end) {
            return true;
        }
    }
    return false;
}

/* ---- the fast step ---- */

static void disturb_currents(life_t *life, const fault_t *fault, fast_input_t *in)
{
    uint16_t *code = &in->phase_current_code[fault->number % 3];
    switch (fault->kind) {
    case FAULT_CURRENT_STUCK:
        *code = motor_code(MOTOR_CODE_MID + MOTOR_CODE_MID * fault->amount);
        break;
    case FAULT_CURRENT_GAIN:
        *code = motor_code(MOTOR_CODE_MID + (*code - MOTOR_CODE_MID) * (1.0 + fault->amount));
        break;
    case FAULT_CURRENT_NOISE:
        *code = chance(life, 100) ? motor_code(between(life, 0, MOTOR_CODE_MOST)) : *code;
        break;
    case FAULT_CURRENTS_FROZEN:
        for (int x = 0; x < 3; x++) {
            in->phase_current_code[x] = life->last.phase_current_code[x];
        }
        break;
    case FAULT_BUS_STUCK:
        in->bus_voltage_code = motor_code(MOTOR_CODE_MID + MOTOR_CODE_MID * fault->amount);
        break;
    case FAULT_BUS_JUMP:
        in->bus_voltage_code = chance(life, 100) ? motor_code(between(life, 0, MOTOR_CODE_MOST))
                                                 : in->bus_voltage_code;
        break;
    default:
        break;
    }
}

static void disturb_rotor(life_t *life, const fault_t *fault, fast_input_t *in)
{
    switch (fault->kind) {
    case FAULT_HALL_STUCK:
        in->hall_state =
            (uint8_t)(fault->amount > 0.0 ? in->hall_state | (1 << fault->number % 3)
                                          : in->hall_state & ~(1 << fault->number % 3));
        break;
    case FAULT_ROTOR_NOISE:
        if (chance(life, 20)) {
            in->hall_state = (uint8_t)between(life, 0, 7);
            in->rotor_angle_turn = (uint16_t)between(life, 0, UINT16_MAX);
            in->encoder.count = (uint16_t)between(life, 0, UINT16_MAX);
        }
        break;
    case FAULT_ROTOR_FROZEN:
        in->hall_state = life->last.hall_state;
        in->rotor_angle_turn = life->last.rotor_angle_turn;
        in->encoder.count = life->last.encoder.count;
        break;
    case FAULT_ROTOR_SLIPPED:
        in->rotor_angle_turn =
            (uint16_t)(in->rotor_angle_turn + numbers_whole(32767.0 * fault->amount));
        in->encoder.count = (uint16_t)(in->encoder.count + fault->number % 4096);
        break;
    case FAULT_INDEX_LOST:
        in->encoder.index = false;
        break;
    case FAULT_INDEX_WRONG:
        in->encoder.index_count = (uint16_t)(in->encoder.index_count + fault->number % 512);
        in->encoder.index = in->encoder.index || chance(life, 2);
        break;
    case FAULT_POWER_STAGE:
        in->power_stage_fault = life->period == fault->begin || chance(life, 2);
        break;
    default:
        break;
    }
}

static void step_fast(life_t *life)
{
    fast_input_t in = motor_sampled(&life->motor, &life->random);
    const fast_setpoint_t *setpoint = &life->setpoint;
    for (int32_t k = 0; k < life->faults; k++) {
        const fault_t *fault = &life->fault[k];
        if (life->period < fault->begin || life->period >= fault->end) {
            continue;
        }
        disturb_currents(life, fault, &in);
        disturb_rotor(life, fault, &in);
        if (fault->kind == FAULT_SETPOINT_FORCED) {
            if (life->period % life->periods_a_ms == 0) {
                life->forced = life->setpoint;
                life->forced.torque_enabled = true;
                life->forced.clear_trip = chance(life, 500);
                life->forced.observer.used = chance(life, 100);
                life->forced.i_reference_pu.d = between(life, -32768, 32767);
                life->forced.i_reference_pu.q = between(life, -32768, 32767);
            }
            setpoint = &life->forced;
        }
    }
    life->last = in;
    const fast_output_t next =
        *controller_fast_step(&life->controller.fast, &life->config, setpoint, &in);
    motor_step(&life->motor, &life->active, has_fault(life, FAULT_BATTERY_OPEN));
    life->active = next;
}

/* ---- the millisecond ---- */

static void draw_phase(life_t *life)
{
    wheel_demand_t *demand = &life->in.demand;
    const int32_t most_mNm = life->config.motor.max_torque_mNm;
    const bool begins = life->period < 60 * life->periods_a_ms;
    life->phase_left_ms = between(life, 5, 80);
    demand->enable = true;
    demand->drive_torque_mNm = !begins && chance(life, 500) ? between(life, 0, most_mNm) : 0;
    demand->brake_torque_mNm = !begins && chance(life, 400) ? between(life, 0, 2 * most_mNm) : 0;
    demand->direction =
        life->motor.speed_rad_s >= 0.0 ? DRIVE_DIRECTION_FORWARD : DRIVE_DIRECTION_REVERSE;
    demand->drive_torque_mNm *= life->motor.speed_rad_s >= 0.0 ? 1 : -1;
    life->motor.acceleration_rad_s2 = chance(life, 500) ? 0.0 : real(life, -5000.0, 5000.0);
}

static void step_slow(life_t *life)
{
    if (life->phase_left_ms-- <= 0) {
        draw_phase(life);
    }
    life->in.demand.fault_reset = life->out.mode == MODE_FAULT && chance(life, 200);
    fast_report_t report;
    controller_fast_report(&life->controller.fast, &report);
    fast_setpoint_t setpoint = life->setpoint;
    life->out =
        controller_slow_step(&life->controller.slow, &life->config, &report, &life->in, &setpoint);
    if (!has_fault(life, FAULT_SETPOINT_STALE)) {
        life->setpoint = setpoint;
    }
}

static void begin_life(life_t *life, const config_t *shipped, uint64_t number)
{
    const life_t fresh = {.random = random_for(SEED, number)};
    *life = fresh;
    config_t *config = &life->config;
    *config = *shipped;
    configuration_vary(config, &life->random, chance(life, 600) ? 12 : 0);
    const int32_t own = config->rotor.sensor;
    config->rotor.sensor = between(life, 0, 2);
    if (!configuration_is_accepted(config)) {
        config->rotor.sensor = own;
    }
    motor_t *motor = &life->motor;
    motor_init(motor, config);
    motor->speed_rad_s = chance(life, 200) ? 0.0 : real(life, -0.4, 1.0) * motor->top_rad_s;
    motor->angle_turn = real(life, 0.0, 1.0);
    motor->battery_v =
        real(life, 1e-3 * config->battery.min_voltage_mV, 1e-3 * config->battery.max_voltage_mV);
    motor->bus_v = motor->battery_v;
    life->periods_a_ms = config->drive.pwm_frequency_Hz / 1000;
    life->periods = life->periods_a_ms * between(life, 100, 600);
    life->in.config_accepted = true;
    life->in.selftest_passed = true;
    life->in.bms.charge_current_mA = 1000000;
    life->in.bms.discharge_current_mA = 1000000;
    life->in.temperature.winding_cC = 2500;
    life->in.temperature.switch_cC = 2500;
    life->in.hydraulic.age_ms = 1000000;
    controller_init(&life->controller, config, BASES_MODEL_TIMER_Hz);
    life->setpoint = controller_initial_setpoint(config, BASES_MODEL_TIMER_Hz);
    life->faults = between(life, 0, FAULTS_MOST);
    for (int32_t k = 0; k < life->faults; k++) {
        fault_t *fault = &life->fault[k];
        fault->kind = between(life, 0, FAULT_KINDS - 1);
        fault->begin = between(life, 0, life->periods);
        fault->end = fault->begin + (chance(life, 500) ? between(life, 1, 200) : life->periods);
        fault->number = (int32_t)(random_bits(&life->random) >> 33);
        fault->amount = real(life, -1.0, 1.0);
    }
}

int main(int count, char **arguments)
{
    if (count < 3 || !program_begin(count, arguments, 3, 1)) {
        fprintf(stderr, "usage: random_fast FIRST END [OPTION...]\n");
        return 2;
    }
    const int first = atoi(arguments[1]);
    const int end = atoi(arguments[2]);
    static life_t life;
    for (int entry = first; entry < end; entry++) {
        const int index = entry % CONFIGURATIONS;
        for (int run = 0; run < RUNS_AN_ENTRY; run++) {
            begin_life(&life, configuration_shipped(index),
                       (uint64_t)entry * RUNS_AN_ENTRY + (uint64_t)run);
            for (life.period = 0; life.period < life.periods; life.period++) {
                step_fast(&life);
                if (life.period % life.periods_a_ms == life.periods_a_ms - 1) {
                    step_slow(&life);
                }
            }
        }
        char name[40];
        snprintf(name, sizeof name, "%s %d", configuration_name(index), entry);
        program_entry(name);
    }
    program_end();
    return 0;
}
