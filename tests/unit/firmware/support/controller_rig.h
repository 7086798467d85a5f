/* SPDX-License-Identifier: Apache-2.0 */
/*
 * controller_rig.h: a controller whose two steps are called at their rates, with the messages
 * between them.
 *
 * There is no motor: a test sets the codes, or selects those of the setpoint's current (`follows`).
 * Only the rotor angle advances. With a motor: tests/closed_loop.
 */
#ifndef CONTROLLER_RIG_H
#define CONTROLLER_RIG_H

#include <math.h>
#include <string.h>

#include "config/bases.h"
#include "controller/controller.h"
#include "paper_vehicle.h"

enum { RIG_FAST_PER_SLOW = 20 /* 20 kHz over 1 kHz */ };

/* 300 r/min in 29 ms: what an absolute angle's check for jumps follows. */
#define RIG_TURN_PER_PERIOD_SQUARED 1e-5

typedef struct {
    config_t config;
    controller_t controller;
    fast_setpoint_t to_fast;
    fast_report_t to_slow;
    slow_input_t slow_in;
    fast_input_t fast_in;
    slow_output_t out;
    fast_output_t pwm;
    double angle_turn;
    double turn_per_period;
    double wanted_turn_per_period;
    bool follows;          /* the phase currents are the reference's */
    double wrong_codes[3]; /* what the sensors show too much, with `follows` */
    double dither_codes;   /* what the converter rounds, evenly over the code */
    int noise_codes;       /* of two phases, without `follows` */
} rig_t;

static inline uint16_t rig_bus_code(const rig_t *rig, double volts)
{
    return (uint16_t)lround(volts * 4096e3 / rig->config.drive.voltage_full_scale_mV);
}

/* A charged battery, cool, switched off, nothing demanded, a standing wheel with an absolute angle
 * sensor. */
static inline void rig_start(rig_t *rig)
{
    memset(rig, 0, sizeof *rig);
    rig->config = paper_vehicle();
    rig->config.rotor.sensor = CONFIG_ROTOR_ANGLE;
    rig->config.modes.coast_delay_ms = 0; /* the bridge switches without demand as well */
    rig->config.monitor.current_missing_pu_q15 = 1000000000; /* no motor, no current */
    rig->config.monitor.current_dead_periods = 40000;
    controller_init(&rig->controller, &rig->config, BASES_MODEL_TIMER_Hz);
    rig->to_fast = controller_initial_setpoint(&rig->config, BASES_MODEL_TIMER_Hz);
    controller_fast_report(&rig->controller.fast, &rig->to_slow);
    rig->slow_in.bms.charge_current_mA = 1000000;
    rig->slow_in.bms.discharge_current_mA = 1000000;
    rig->slow_in.temperature.winding_cC = 2500;
    rig->slow_in.temperature.switch_cC = 2500;
    rig->slow_in.demand.direction = DRIVE_DIRECTION_FORWARD;
    rig->slow_in.selftest_passed = true;
    rig->slow_in.config_accepted = true;
    rig->fast_in.bus_voltage_code = rig_bus_code(rig, 53.0);
    for (int x = 0; x < 3; x++) {
        rig->fast_in.phase_current_code[x] = 2048;
    }
}

static inline void rig_set_speed_rpm(rig_t *rig, double rpm)
{
    rig->wanted_turn_per_period =
        rpm / 60.0 * rig->config.motor.pole_pairs / rig->config.drive.pwm_frequency_Hz;
}

static inline void rig_slow(rig_t *rig)
{
    rig->out = controller_slow_step(&rig->controller.slow, &rig->config, &rig->to_slow,
                                    &rig->slow_in, &rig->to_fast);
}

static inline void rig_follow(rig_t *rig)
{
    const dq_t i = rig->to_fast.i_reference_pu;
    rig->dither_codes += 0.618;
    rig->dither_codes -= floor(rig->dither_codes);
    for (int x = 0; x < 3; x++) {
        const double angle = 2.0 * 3.14159265358979 * (rig->angle_turn - x / 3.0);
        const double codes = (i.d * cos(angle) - i.q * sin(angle)) / 16.0;
        rig->fast_in.phase_current_code[x] =
            (uint16_t)(2048.0 + floor(codes + rig->wrong_codes[x] + rig->dither_codes));
    }
}

static inline void rig_period(rig_t *rig)
{
    const double wanted = rig->wanted_turn_per_period - rig->turn_per_period;
    rig->turn_per_period +=
        fmax(fmin(wanted, RIG_TURN_PER_PERIOD_SQUARED), -RIG_TURN_PER_PERIOD_SQUARED);
    rig->angle_turn += rig->turn_per_period;
    rig->angle_turn -= floor(rig->angle_turn);
    rig->fast_in.rotor_angle_turn = (uint16_t)(uint32_t)(rig->angle_turn * 65536.0);
    if (rig->follows) {
        rig_follow(rig);
    }
    rig->pwm =
        *controller_fast_step(&rig->controller.fast, &rig->config, &rig->to_fast, &rig->fast_in);
    controller_fast_report(&rig->controller.fast, &rig->to_slow);
}

/* Without a motor no current answers the voltage: while the bridge switches the noise of two
 * sensors shows that the readings are not frozen. Looks at them are 4 or 5 periods apart. */
static inline void rig_fast(rig_t *rig)
{
    uint16_t codes[3];
    memcpy(codes, rig->fast_in.phase_current_code, sizeof codes);
    if (rig->pwm.bridge == BRIDGE_PWM) {
        rig->noise_codes = rig->noise_codes < 1 ? rig->noise_codes + 1 : -1;
        rig->fast_in.phase_current_code[1] = (uint16_t)(codes[1] + rig->noise_codes);
        rig->fast_in.phase_current_code[2] = (uint16_t)(codes[2] - rig->noise_codes);
    }
    rig_period(rig);
    if (!rig->follows) {
        memcpy(rig->fast_in.phase_current_code, codes, sizeof codes);
    }
}

static inline void rig_run(rig_t *rig, int milliseconds)
{
    for (int n = 0; n < milliseconds; n++) {
        for (int k = 0; k < RIG_FAST_PER_SLOW; k++) {
            rig_fast(rig);
        }
        rig_slow(rig);
    }
}

/* Started, calibrated, switched on. */
static inline void rig_start_running(rig_t *rig)
{
    rig_start(rig);
    rig->slow_in.demand.enable = true;
    rig_run(rig, 100);
}

/* Reports of a torque that is more than the commands, in every step from now on, and less than a
 * sensor's error: a brake that is found by them where the wheel rolls. */
static inline void rig_report_brake(rig_t *rig, int32_t torque_mNm)
{
    rig->config.brake.hydraulic_timeout_ms = 50;
    rig->config.brake.hydraulic_gain_band_q15 = 8192;
    rig->config.brake.hydraulic_tolerance_mNm = 1000;
    rig->slow_in.hydraulic.torque_mNm = torque_mNm;
    rig->slow_in.hydraulic.age_ms = 0;
    rig->slow_in.hydraulic.valid = true;
}

#endif
