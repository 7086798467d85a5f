/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/hill_hold.h"

#include "core/q15.h"
#include "core/ramp.h"

enum {
    TOLERANCE_SHARE = 8, /* of the demand: what the road is known to */
    SLOWER_SHARE = 3     /* of the speed: hall edges show a stop late */
};

void hill_hold_init(hill_hold_state_t *state)
{
    const hill_hold_state_t none = {.holds = false};
    *state = none;
}

/* What the motor torque along the engaged direction leaves of the hold torque. */
static int32_t left_by_motor_mNm(const config_t *config, int32_t along_mNm)
{
    const int32_t whole_mNm = config->driver.hold_torque_mNm;
    const int32_t released_mNm = q_min(whole_mNm, config->motor.max_torque_mNm / 4 * 3);
    const int32_t left_mNm = q_max(released_mNm - q_max(along_mNm, 0), 0);
    return q_scale(whole_mNm, left_mNm, q_max(released_mNm, 1));
}

static int32_t by_time_mNm(const config_driver_t *driver, int32_t release_ms)
{
    return q_scale(driver->hold_torque_mNm, driver->hold_release_ms - release_ms,
                   driver->hold_release_ms);
}

static void release(hill_hold_state_t *state, const config_t *config, drive_direction_t engaged,
                    int32_t command_mNm, int32_t speed_mrad_s)
{
    const int32_t sign = drive_direction_sign(engaged);
    const int32_t along_mrad_s = q_limit(speed_mrad_s, INT32_MAX) * sign;
    state->caught = state->caught || along_mrad_s < -config->monitor.standstill_mrad_s;
    state->release_ms = q_min(state->release_ms + 1, config->driver.hold_release_ms);
    const int32_t left_mNm = left_by_motor_mNm(config, q_limit(command_mNm, INT32_MAX) * sign);
    const int32_t timed_mNm = by_time_mNm(&config->driver, state->release_ms);
    state->torque_mNm = state->caught ? left_mNm : q_min(left_mNm, timed_mNm);
    state->holds = state->torque_mNm > 0 && along_mrad_s <= config->monitor.standstill_mrad_s;
}

/* Before standstill, as long as the driver brakes and the wheel is slow. */
static bool is_ahead(hill_hold_state_t *state, int32_t slower_mrad_s, int32_t road_mNm,
                     int32_t braking_mNm, bool drives, int32_t speed_abs_mrad_s)
{
    const bool brakes = braking_mNm > 0 && !drives;
    const bool rolls_off = road_mNm > braking_mNm - braking_mNm / TOLERANCE_SHARE;
    if (!brakes || speed_abs_mrad_s / 2 > state->begun_mrad_s) {
        state->begun_mrad_s = 0;
    }
    if (brakes && rolls_off && slower_mrad_s <= speed_abs_mrad_s / SLOWER_SHARE &&
        state->begun_mrad_s == 0) {
        state->begun_mrad_s = speed_abs_mrad_s;
    }
    return state->begun_mrad_s > 0;
}

int32_t hill_hold_step(hill_hold_state_t *state, const config_t *config, const demand_t *demand,
                       const brake_blending_out_t *split, int32_t road_mNm, int32_t command_mNm,
                       int32_t speed_mrad_s, bool standstill)
{
    const int32_t braking_mNm = demand->brake_torque_mNm + demand->lift_off_mNm;
    const bool drives = demand->drive_torque_mNm != 0;
    const bool neutral = demand->engaged == DRIVE_DIRECTION_NEUTRAL;
    if (!state->holds && standstill && braking_mNm > 0 && !neutral) {
        const hill_hold_state_t begun = {.holds = true};
        *state = begun;
    }
    /* Without a hold torque the result is the same, at less cost. */
    if (!state->holds && !neutral && config->driver.hold_torque_mNm > 0 &&
        is_ahead(state, split->slower_mrad_s, road_mNm, braking_mNm, drives, q_abs(speed_mrad_s))) {
        state->torque_mNm = config->driver.hold_torque_mNm;
    } else if (!state->holds || neutral) {
        state->holds = false;
        state->torque_mNm = ramp_step(state->torque_mNm, 0, demand_rate_mNm_per_step(config));
    } else if (drives) {
        release(state, config, demand->engaged, command_mNm, speed_mrad_s);
    } else {
        state->torque_mNm = config->driver.hold_torque_mNm;
        state->release_ms = 0;
        state->caught = false;
    }
    return state->torque_mNm;
}
