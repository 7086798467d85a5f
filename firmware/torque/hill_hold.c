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

hill_hold_kept_t hill_hold_keep(const hill_hold_state_t *state, drive_direction_t engaged)
{
    const hill_hold_kept_t out = {
        .direction = state->holds || state->leaves ? engaged : DRIVE_DIRECTION_NEUTRAL,
        .leaves = state->leaves,
    };
    return out;
}

void hill_hold_resume(hill_hold_state_t *state, const hill_hold_kept_t *kept)
{
    state->resumed = kept->direction != DRIVE_DIRECTION_NEUTRAL;
    state->holds = state->resumed && !kept->leaves;
    state->leaves = state->resumed && kept->leaves;
}

static int32_t along(int32_t value, drive_direction_t engaged)
{
    return q_limit(value, INT32_MAX) * drive_direction_sign(engaged);
}

static void release(hill_hold_state_t *state, const config_t *config, drive_direction_t engaged,
                    const hill_hold_wheel_t *wheel)
{
    const int32_t along_mrad_s = along(wheel->speed_mrad_s, engaged);
    state->caught = state->caught || along_mrad_s < -config->monitor.standstill_mrad_s;
    state->release_ms = q_min(state->release_ms + 1, config->driver.hold_release_ms);
    const int32_t left_mNm = left_by_motor_mNm(config, along(wheel->command_mNm, engaged));
    const int32_t timed_mNm = by_time_mNm(&config->driver, state->release_ms);
    state->torque_mNm = state->caught ? left_mNm : q_min(left_mNm, timed_mNm);
    state->holds = state->torque_mNm > 0 && along_mrad_s <= config->monitor.standstill_mrad_s;
    state->leaves = !state->holds;
}

/* Before standstill, as long as the driver brakes and the wheel is slow. */
static bool is_ahead(hill_hold_state_t *state, const config_t *config, int32_t slower_mrad_s,
                     const hill_hold_wheel_t *wheel, int32_t braking_mNm, bool drives)
{
    const int32_t road_mNm = wheel->road_mNm;
    const int32_t speed_abs_mrad_s = q_abs(wheel->speed_mrad_s);
    const bool brakes = braking_mNm > 0 && !drives;
    const bool rolls_off = road_mNm > braking_mNm - braking_mNm / TOLERANCE_SHARE;
    if (!brakes || speed_abs_mrad_s / 2 > state->begun_mrad_s) {
        state->begun_mrad_s = 0;
    }
    if (brakes && rolls_off && slower_mrad_s <= speed_abs_mrad_s / SLOWER_SHARE &&
        state->begun_mrad_s == 0) {
        state->begun_mrad_s = speed_abs_mrad_s;
        state->torque_mNm =
            q_max(state->torque_mNm, q_min(road_mNm, config->driver.hold_torque_mNm));
    }
    return state->begun_mrad_s > 0;
}

/* After it has driven off and before it is faster: the motor is gone, and the wheel stands or rolls
 * back, or nothing shows whether it does. A restart does not know at once that it stands. */
static bool falls_back(hill_hold_state_t *state, const config_t *config, drive_direction_t engaged,
                       int32_t braking_mNm, const hill_hold_wheel_t *wheel)
{
    const int32_t along_mrad_s = along(wheel->speed_mrad_s, engaged);
    const bool slow = along_mrad_s <= config->driver.direction_change_mrad_s;
    state->leaves = state->leaves && slow && braking_mNm == 0 && engaged != DRIVE_DIRECTION_NEUTRAL;
    const bool stands = (wheel->standstill || !wheel->seen) && !state->resumed;
    const bool back = along_mrad_s < -config->monitor.standstill_mrad_s;
    return state->leaves && !wheel->may_drive && (stands || back);
}

/* A hold that a restart has interrupted: on a wheel that rolls it is lost, until the wheel stands
 * or a pedal is pressed. */
static void watch_resumed(hill_hold_state_t *state, const config_t *config, bool may_drive,
                          bool brakes, int32_t speed_abs_mrad_s)
{
    state->resumed = state->resumed && (state->holds || state->leaves) && !may_drive && !brakes;
    if (state->resumed && state->holds &&
        speed_abs_mrad_s > config->driver.direction_change_mrad_s) {
        const hill_hold_state_t lost = {.lost = config->driver.hold_torque_mNm > 0};
        *state = lost;
    }
}

/* Whether the wheel turns although it is held, or was to be. */
static void watch_hold(hill_hold_state_t *state, bool turns, bool drives, bool brakes)
{
    const bool rolls = turns && state->holds && !drives && state->torque_mNm > 0;
    state->rolls_ms = rolls ? q_min(state->rolls_ms + 1, HILL_HOLD_CAUGHT_ms) : 0;
    state->lost = state->lost && turns && !drives && !brakes;
}

int32_t hill_hold_step(hill_hold_state_t *state, const config_t *config, const demand_t *demand,
                       const brake_blending_out_t *split, const hill_hold_wheel_t *wheel)
{
    const int32_t braking_mNm = demand->brake_torque_mNm + demand->lift_off_mNm;
    const bool drives = demand->drive_torque_mNm != 0 && wheel->may_drive;
    const bool neutral = demand->engaged == DRIVE_DIRECTION_NEUTRAL;
    const int32_t speed_abs_mrad_s = q_abs(wheel->speed_mrad_s);
    const bool turns = speed_abs_mrad_s > config->monitor.standstill_mrad_s;
    const bool stops = wheel->standstill && braking_mNm > 0 && !neutral;
    watch_resumed(state, config, wheel->may_drive, braking_mNm > 0, speed_abs_mrad_s);
    const bool back = falls_back(state, config, demand->engaged, braking_mNm, wheel);
    if (!state->holds && (stops || back)) {
        const hill_hold_state_t begun = {.holds = true, .resumed = state->resumed};
        *state = begun;
    }
    if (state->holds && !neutral && drives) {
        release(state, config, demand->engaged, wheel);
    } else if (state->holds && !neutral) {
        state->torque_mNm = config->driver.hold_torque_mNm;
        state->release_ms = 0;
        state->caught = false;
    } else if (neutral || config->driver.hold_torque_mNm == 0 || /* at less cost */
               !is_ahead(state, config, split->slower_mrad_s, wheel, braking_mNm, drives)) {
        state->holds = false;
        state->torque_mNm = ramp_step(state->torque_mNm, 0, demand_rate_mNm_per_step(config));
    }
    watch_hold(state, turns, drives, braking_mNm > 0);
    return state->torque_mNm;
}
