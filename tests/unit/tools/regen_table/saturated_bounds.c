/* SPDX-License-Identifier: Apache-2.0 */
/* What the firmware's monitor believes of a motor of which it holds three constants. */
#include "config/config.h"
#include "monitor/monitor.h"
#include "monitor/safe_state.h"
#include "monitor/short_exit.h"

typedef struct {
    int32_t pole_pairs, resistance_uOhm, flux_nWb, d_nH, q_nH, most_mA, weakening_mA, device_mV;
    int32_t bus_nF;
} motor_t;

static config_t config;

void hold(const config_t *image, const motor_t *motor)
{
    config = *image;
    config.flux_map.d_points = 3;
    config.motor.pole_pairs = motor->pole_pairs;
    config.motor.phase_resistance_uOhm = motor->resistance_uOhm;
    config.motor.resistance_coefficient_ppm_K = 0;
    config.motor.flux_linkage_nWb = motor->flux_nWb;
    config.motor.d_inductance_nH = motor->d_nH;
    config.motor.q_inductance_nH = motor->q_nH;
    config.motor.max_phase_current_mA = motor->most_mA;
    config.drive.current_full_scale_mA = 2 * motor->most_mA;
    config.drive.device_voltage_mV = motor->device_mV;
    config.drive.voltage_full_scale_mV = motor->device_mV;
    config.drive.bus_capacitance_nF = motor->bus_nF;
    config.drive.diode_drop_mV = 0;
    config.battery.undervoltage_trip_mV = 0;
    config.current_loop.field_weakening_current_pu_q15 =
        (int32_t)((int64_t)motor->weakening_mA * 32768 / (2 * motor->most_mA));
}

static measured_t measured(const battery_limits_t *battery, int32_t bus_mV)
{
    const measured_t now = {.battery = battery, .bus_voltage_mV = bus_mV};
    return now;
}

steady_state_t shorted(int32_t speed_mrad_s)
{
    const battery_limits_t battery = {.charge_current_mA = 0};
    const measured_t now = measured(&battery, 0);
    return safe_state_short(&config, &now, speed_mrad_s);
}

/* Whether an open bridge makes neither torque nor current. */
int quiet(int32_t speed_mrad_s, int32_t bus_mV)
{
    const battery_limits_t battery = {.charge_current_mA = 0};
    const measured_t now = measured(&battery, bus_mV);
    const safe_state_t safe = safe_state_step(&config, &now, BRIDGE_OFF, speed_mrad_s, false);
    return safe.bridge == BRIDGE_OFF && safe.freewheel.current_mA == 0;
}

int forced(int32_t speed_mrad_s, int32_t bus_mV)
{
    return monitor_forced_torque_mNm(&config, speed_mrad_s, bus_mV) > 0;
}

int may_open(int32_t d_mA, int32_t q_mA, int32_t bus_mV)
{
    const short_exit_input_t in = {
        .i_d_mA = d_mA, .i_q_mA = q_mA, .turning_mrad_s = 1, .bus_mV = bus_mV};
    return short_exit_fits(&config, &in);
}

void own(const config_t *image)
{
    config = *image;
}

safe_state_t choose(int32_t speed_mrad_s, int32_t bus_mV, int32_t winding_cC, int32_t charge_mA)
{
    const battery_limits_t battery = {.charge_current_mA = charge_mA};
    measured_t now = measured(&battery, bus_mV);
    now.winding_temperature_cC = winding_cC;
    return safe_state_step(&config, &now, BRIDGE_OFF, speed_mrad_s, false);
}

steady_state_t shorted_at(int32_t speed_mrad_s, int32_t winding_cC)
{
    const battery_limits_t battery = {.charge_current_mA = 0};
    measured_t now = measured(&battery, 0);
    now.winding_temperature_cC = winding_cC;
    return safe_state_short(&config, &now, speed_mrad_s);
}
