/* SPDX-License-Identifier: Apache-2.0 */
/*
 * torque_rig.h: the slow loop of the paper's vehicle with an ideal motor: the measured current of
 * the next step is this step's setpoint. A test changes the input `in` between steps. Included once
 * in a program.
 */
#ifndef SUPPORT_TORQUE_RIG_H
#define SUPPORT_TORQUE_RIG_H

#include "config/finding_times.h"
#include "paper_vehicle.h"
#include "reference_motor.h"
#include "torque/torque.h"

/* What torque_step() reads of its records. */
typedef struct {
    /* Demand */
    int32_t drive_torque_mNm; /* signed, positive forward */
    int32_t brake_torque_mNm; /* magnitude >= 0 */
    uint32_t demand_age_ms;
    drive_direction_t direction;
    bool abs_active;
    uint8_t abs_share_percent;
    bool fault_reset;
    /* Measured */
    int32_t speed_mrad_s, sensor_mrad_s;
    motor_current_t current;
    int32_t i_d_weakening_mA;
    bool voltage_limited;
    bool starts; /* the current sensors' offsets are not known yet */
    int32_t voltage_use_q15;
    bridge_mode_t bridge;
    bool angle_valid, sensor_wrong;
    angle_by_t angle_by;
    int32_t bus_voltage_mV;
    int32_t phase_voltage_mV;
    int32_t winding_temperature_cC, switch_temperature_cC;
    /* By the monitor */
    bool standstill, at_rest;
    int32_t flux_missing_q15, current_missing_q15;
    safe_state_t safe;
    /* From outside */
    int32_t bms_charge_current_mA, bms_discharge_current_mA;
    int32_t battery_voltage_mV;
    hydraulic_feedback_t hydraulic;
    torque_enable_t torque_enable;
} torque_case_t;

static config_t config;
static torque_state_t state;
static torque_case_t in;
static last_t last;
static findings_t findings;

static const torque_enable_t FULL_ENABLE = {
    .drive_q15 = Q15_ONE, .brake_q15 = Q15_ONE, .reason = REASON_NONE};

/* The slow loop begins anew, with the present configuration. */
static inline void torque_rig_start(void)
{
    const last_t none = {.torque_command_mNm = 0};
    finding_times_t times[FINDING_COUNT];
    finding_times(&config, times);
    findings_init(&findings, times, false);
    torque_init(&state, &config);
    last = none;
}

/* 150 r/min, no limit within reach, everything enabled, no demand. */
static inline void torque_rig_reset(void)
{
    const torque_case_t rolling = {
        .speed_mrad_s = mrad_s_of_rpm(150.0),
        .bus_voltage_mV = 53000,
        .phase_voltage_mV = 1000000,
        .bms_charge_current_mA = 1000000,
        .bms_discharge_current_mA = 1000000,
        .winding_temperature_cC = 2500,
        .switch_temperature_cC = 2500,
        .angle_valid = true,
        .bridge = BRIDGE_PWM,
        .torque_enable = FULL_ENABLE,
        .direction = DRIVE_DIRECTION_FORWARD,
    };
    config = paper_vehicle();
    config.brake.loss_braking = 0;
    torque_rig_start();
    in = rolling;
}

static inline slow_input_t torque_case_slow_input(void)
{
    const slow_input_t out = {
        .demand = {.drive_torque_mNm = in.drive_torque_mNm,
                   .brake_torque_mNm = in.brake_torque_mNm,
                   .direction = in.direction,
                   .abs_active = in.abs_active,
                   .abs_motor_share_percent = in.abs_share_percent,
                   .fault_reset = in.fault_reset},
        .demand_age_ms = in.demand_age_ms,
        .bms = {.charge_current_mA = in.bms_charge_current_mA,
                .discharge_current_mA = in.bms_discharge_current_mA,
                .voltage_mV = in.battery_voltage_mV},
        .hydraulic = in.hydraulic,
    };
    return out;
}

/* Terminal power at the measured current, W, from the circuit i = i_t + v(i_t) / R_i. Each
 * iteration reduces the error by w L / R_i, a hundredth. */
static inline reference_point_t torque_rig_point(void)
{
    const reference_motor_t m =
        reference_motor(&config, in.speed_mrad_s, in.winding_temperature_cC);
    double i_dt = in.current.d_mA * 1e-3;
    double i_qt = in.current.q_mA * 1e-3;
    for (int n = 0; n < 10; n++) {
        const double v_d = -m.w_rad_s * m.l_q_h * i_qt;
        const double v_q = m.w_rad_s * (m.l_d_h * i_dt + m.psi_wb);
        i_dt = in.current.d_mA * 1e-3 - v_d * m.iron_siemens;
        i_qt = in.current.q_mA * 1e-3 - v_q * m.iron_siemens;
    }
    return reference_point(&m, i_dt, i_qt);
}

/* Of the applied voltage, which shows motor and switches, but not what switching loses. */
static inline int32_t torque_rig_bus_current_mA(void)
{
    const reference_point_t at = torque_rig_point();
    const double current_a = hypot(at.i_d_a, at.i_q_a);
    const double power_w =
        at.power_w + 1.5e-6 * config.drive.loss_resistance_uOhm * current_a * current_a;
    const double bus_v = 1e-3 * q_clamp(in.bus_voltage_mV, 1000, 1000000);
    return (int32_t)lround(1e3 * fmax(fmin(power_w / bus_v, 1e5), -1e5));
}

/* A step with the currents of `in`. */
static inline torque_output_t torque_case_step(void)
{
    const slow_input_t sent = torque_case_slow_input();
    const fast_report_t report = {
        .voltage_use_q15 = in.voltage_use_q15,
        .voltage_limited = in.voltage_limited,
        .offsets_done = !in.starts,
        .bridge = in.bridge,
    };
    const measured_t now = {
        .report = &report,
        .in = &sent,
        .battery = &sent.bms,
        .angle_valid = in.angle_valid,
        .angle_by = in.angle_by,
        .sensor_wrong = in.sensor_wrong,
        .speed_mrad_s = in.speed_mrad_s,
        .sensor_mrad_s = in.sensor_mrad_s,
        .i_d_mA = in.current.d_mA,
        .i_q_mA = in.current.q_mA,
        .bus_voltage_mV = in.bus_voltage_mV,
        .bus_current_mA = torque_rig_bus_current_mA(),
        .i_d_weakening_mA = in.i_d_weakening_mA,
        .phase_voltage_mV = in.phase_voltage_mV,
        .winding_temperature_cC = in.winding_temperature_cC,
        .switch_temperature_cC = in.switch_temperature_cC,
        .sensed = {.winding_cC = in.winding_temperature_cC, .switch_cC = in.switch_temperature_cC},
    };
    const monitored_t watch = {
        .safe = in.safe,
        .standstill = in.standstill,
        .at_rest = in.at_rest,
        .flux_missing_q15 = in.flux_missing_q15,
        .current_missing_q15 = in.current_missing_q15,
    };
    const torque_output_t out =
        torque_step(&state, &config, &now, &last, &sent, &watch, &in.torque_enable, &findings);
    last.torque_command_mNm = out.command_mNm;
    last.hydraulic_added_mNm = out.hydraulic_added_mNm;
    last.hydraulic_apart_mNm = out.hydraulic_apart_mNm;
    return out;
}

static inline torque_output_t step(void)
{
    const torque_output_t out = torque_case_step();
    in.current.d_mA = out.current.i_d_mA + in.i_d_weakening_mA;
    in.current.q_mA = out.current.i_q_mA;
    return out;
}

static inline torque_output_t run(int milliseconds)
{
    for (int n = 1; n < milliseconds; n++) {
        step();
    }
    return step();
}

#endif
