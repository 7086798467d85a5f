/* SPDX-License-Identifier: Apache-2.0 */
/*
 * safe_state_case.h: what the choice of the safe state sees, as one value that a test writes down,
 * and what the bridge does with all switches open, whether that is chosen or not.
 */
#ifndef SAFE_STATE_CASE_H
#define SAFE_STATE_CASE_H

#include "monitor/safe_state.h"
#include "monitor_case.h"

typedef struct {
    int32_t bound_mrad_s; /* the speed upper bound */
    int32_t winding_temperature_cC, bus_voltage_mV;
    int32_t charge_current_mA; /* that the battery takes from this wheel */
    int32_t latest_i_d_mA, latest_i_q_mA;
    int32_t turning_mrad_s; /* by the sensor that gives the angle of that current; 0: unknown */
    bridge_mode_t before;   /* safe state of the step before */
    bool battery_gone;
} safe_state_case_t;

static inline const measured_t *safe_state_measured(const config_t *vehicle,
                                                    const safe_state_case_t *at)
{
    const int64_t all_wheels_mA = (int64_t)at->charge_current_mA * vehicle->battery.driven_wheels;
    const bool known = at->turning_mrad_s != 0;
    const monitor_case_t seen = {
        .battery = {.charge_current_mA = q_saturate64(all_wheels_mA)},
        .now = {.angle_valid = known,
                .speed_mrad_s = at->turning_mrad_s,
                .winding_temperature_cC = at->winding_temperature_cC,
                .bus_voltage_mV = at->bus_voltage_mV,
                .latest_i_d_mA = at->latest_i_d_mA,
                .latest_i_q_mA = at->latest_i_q_mA},
    };
    return measured_of(&seen);
}

static inline safe_state_t choice_of(const config_t *vehicle, const safe_state_case_t *at)
{
    return safe_state_step(vehicle, safe_state_measured(vehicle, at), at->before, at->bound_mrad_s,
                           at->battery_gone);
}

static inline steady_state_t short_of(const config_t *vehicle, const safe_state_case_t *at)
{
    return safe_state_short(vehicle, safe_state_measured(vehicle, at), at->bound_mrad_s);
}

static inline steady_state_t freewheel_of(const config_t *vehicle, const safe_state_case_t *at)
{
    safe_state_case_t open = *at;
    open.before = BRIDGE_OFF;
    return choice_of(vehicle, &open).freewheel;
}

static inline bool short_surges(const config_t *vehicle, const safe_state_case_t *at,
                                const steady_state_t *freewheel)
{
    return safe_state_short_surges(vehicle, safe_state_measured(vehicle, at), at->bound_mrad_s,
                                   freewheel);
}

#endif
