/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/demand.h"

#include "core/q15.h"
#include "core/ramp.h"

enum { SLOW_STEPS_PER_S = 1000, LARGEST_DEMAND_mNm = 100000000 };

void demand_init(demand_state_t *state)
{
    const demand_state_t none = {.lost_ms = INT32_MAX, .engaged = DRIVE_DIRECTION_NEUTRAL};
    *state = none;
}

int32_t demand_rate_mNm_per_step(const config_t *config)
{
    return q_max(config->brake.torque_rate_mNm_s / SLOW_STEPS_PER_S, 1);
}

/* An engaged direction stays, at any speed; another one is refused while the wheel turns against
 * it. */
static drive_direction_t engage(drive_direction_t engaged, drive_direction_t direction,
                                int32_t speed_mrad_s, int32_t largest_mrad_s)
{
    const int32_t sign = drive_direction_sign(direction);
    const bool turns_against =
        sign > 0 ? speed_mrad_s < -largest_mrad_s : speed_mrad_s > largest_mrad_s;
    const bool accepted = sign != 0 && (direction == engaged || !turns_against);
    return accepted ? direction : DRIVE_DIRECTION_NEUTRAL;
}

int32_t demand_handed_over_mNm(const config_t *config, int32_t left_mNm)
{
    const config_brake_t *brake = &config->brake;
    const int32_t most_mNm = q_max(brake->hydraulic_rate_mNm_s / SLOW_STEPS_PER_S, 1);
    return q_min(left_mNm / q_divisor(brake->hydraulic_time_constant_ms + 1), most_mNm - 1) + 1;
}

/* Lift-off braking falls first, then what the pedal demands. */
static void fall(demand_state_t *state, const config_t *config)
{
    const int32_t step_mNm =
        demand_handed_over_mNm(config, state->brake_torque_mNm + state->lift_off_mNm);
    const int32_t lift_off_mNm = ramp_step(state->lift_off_mNm, 0, step_mNm);
    const int32_t left_mNm = step_mNm - (state->lift_off_mNm - lift_off_mNm);
    state->lift_off_mNm = lift_off_mNm;
    state->brake_torque_mNm = ramp_step(state->brake_torque_mNm, 0, left_mNm);
}

static demand_t lost_demand(demand_state_t *state, const config_t *config,
                            const wheel_demand_t *wheel)
{
    const config_driver_t *driver = &config->driver;
    const bool unsent = wheel->reason == REASON_TRANSMIT_TIMEOUT;
    state->lost_ms = q_add(state->lost_ms, 1);
    if (unsent) { /* the brake system does not wait either */
        state->lost_ms = q_max(state->lost_ms, driver->lost_hold_ms + 1);
    }
    const bool kept = state->lost_ms <= driver->lost_hold_ms || driver->no_other_brake != 0;
    /* The brake system's own path has a dead time as well. */
    const int32_t dead_time_ms = config->brake.hydraulic_dead_time_ms;
    const bool handed_over = !kept && state->lost_ms > driver->lost_hold_ms + dead_time_ms;
    if (handed_over) {
        fall(state, config);
    }
    const demand_t out = {
        .lift_off_mNm = wheel->abs_active ? 0 : state->lift_off_mNm,
        .brake_torque_mNm = state->brake_torque_mNm,
        .engaged = state->engaged,
        .reason = unsent ? REASON_TRANSMIT_TIMEOUT : REASON_DEMAND_TIMEOUT,
        .drive_withdrawn = true,
        .hydraulic_valid = kept,
        .handed_over = handed_over,
    };
    return out;
}

static demand_t valid_demand(demand_state_t *state, const config_t *config,
                             const wheel_demand_t *wheel, int32_t speed_mrad_s)
{
    const int32_t wanted_mNm =
        q_clamp(wheel->drive_torque_mNm, -LARGEST_DEMAND_mNm, LARGEST_DEMAND_mNm);
    state->engaged = engage(state->engaged, wheel->direction, speed_mrad_s,
                            config->driver.direction_change_mrad_s);
    const int32_t sign = drive_direction_sign(state->engaged);
    const int32_t along_mNm = wanted_mNm * sign;
    state->lost_ms = 0;
    state->brake_torque_mNm = q_clamp(wheel->brake_torque_mNm, 0, LARGEST_DEMAND_mNm);
    state->received_brake_torque_mNm = state->brake_torque_mNm;
    state->lift_off_mNm = wheel->abs_active ? 0 : q_max(-along_mNm, 0);
    const bool withdrawn = state->brake_torque_mNm > 0 || sign == 0;
    demand_t out = {
        .drive_torque_mNm = withdrawn || along_mNm < 0 ? 0 : wanted_mNm,
        .lift_off_mNm = state->lift_off_mNm,
        .brake_torque_mNm = state->brake_torque_mNm,
        .engaged = state->engaged,
        .reason = wheel->reason,
        .drive_withdrawn = withdrawn,
        .hydraulic_valid = true,
    };
    if (sign == 0 && wanted_mNm != 0) {
        out.reason = REASON_DRIVE_DIRECTION;
    } else if (withdrawn && along_mNm > 0) {
        out.reason = REASON_BRAKE_PRIORITY;
    } else if (along_mNm < 0 && wheel->abs_active) {
        out.reason = REASON_ABS;
    }
    return out;
}

demand_t demand_step(demand_state_t *state, const config_t *config, const slow_input_t *in,
                     int32_t speed_mrad_s)
{
    return demand_is_lost(config, in->demand_age_ms)
               ? lost_demand(state, config, &in->demand)
               : valid_demand(state, config, &in->demand, speed_mrad_s);
}
