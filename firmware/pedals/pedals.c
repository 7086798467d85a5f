/* SPDX-License-Identifier: Apache-2.0 */
#include "pedals/pedals.h"

#include "config/demand_age.h"
#include "core/q15.h"

enum { ONE_q15 = 32768, ACCELERATOR = 0, BRAKE = 2 };

/* Of the valid channels of one pedal. */
typedef struct {
    int32_t smaller_q15, larger_q15; /* travel; whole and 0 without a valid channel */
    int valid;
    bool plausible; /* all wired channels are valid and agree */
} travel_t;

void pedals_init(pedals_state_t *state)
{
    const pedals_state_t none = {.no_brake_ms = INT32_MAX, .must_release = true};
    *state = none;
}

/* From the end of the dead band on, 0 .. 32 768. */
static int32_t channel_travel_q15(const config_pedals_t *pedals, int channel, int32_t ratio_q15)
{
    const int32_t released_q15 = pedals->released_q15[channel];
    const int32_t travel_q15 = q_clamp(
        q_scale(ratio_q15 - released_q15, ONE_q15, pedals->pressed_q15[channel] - released_q15), 0,
        ONE_q15);
    return q_max(
        q_scale(travel_q15 - pedals->dead_band_q15, ONE_q15, ONE_q15 - pedals->dead_band_q15), 0);
}

static travel_t read_pedal(const config_pedals_t *pedals, const pedals_input_t *in, int first,
                           int32_t wired, bool sampled)
{
    travel_t out = {.smaller_q15 = ONE_q15};
    for (int channel = first; channel < first + wired; channel++) {
        const int32_t ratio_q15 = in->ratio_q15[channel];
        if (!sampled || ratio_q15 < pedals->lowest_q15[channel] ||
            ratio_q15 > pedals->highest_q15[channel]) {
            continue;
        }
        const int32_t travel_q15 = channel_travel_q15(pedals, channel, ratio_q15);
        out.smaller_q15 = q_min(out.smaller_q15, travel_q15);
        out.larger_q15 = q_max(out.larger_q15, travel_q15);
        out.valid++;
    }
    out.plausible =
        out.valid == wired && out.larger_q15 - out.smaller_q15 <= pedals->difference_q15;
    return out;
}

/* Debounce: a fault from fault_time on, until as many plausible milliseconds have passed. On the
 * way to it a plausible one takes half a millisecond back: a loose contact is a fault, too. */
static bool qualify(int32_t *fault_halves, bool before, bool plausible, int32_t fault_time_ms)
{
    const int32_t change = !plausible ? 2 : before ? -2 : -1;
    *fault_halves = q_clamp(*fault_halves + change, 0, 2 * fault_time_ms);
    return before ? *fault_halves > 0 : *fault_halves == 2 * fault_time_ms;
}

/* Positive: driving torque of the smaller travel; negative: lift-off braking of the larger. */
static int32_t accelerator_mNm(const config_pedals_t *pedals, const travel_t *travel)
{
    const int32_t zero_q15 = pedals->lift_off_torque_mNm > 0 ? pedals->lift_off_travel_q15 : 0;
    if (travel->larger_q15 < zero_q15) {
        return -q_scale(pedals->lift_off_torque_mNm, zero_q15 - travel->larger_q15, zero_q15);
    }
    return q_scale(pedals->drive_torque_mNm, q_max(travel->smaller_q15 - zero_q15, 0),
                   ONE_q15 - zero_q15);
}

int32_t pedals_brake_torque_mNm(const config_pedals_t *pedals, int32_t travel_q15)
{
    const int32_t full_mNm = pedals->brake_torque_mNm;
    if (pedals->interpretation != CONFIG_PEDAL_FREE_TRAVEL) {
        return q_scale(full_mNm, travel_q15, ONE_q15);
    }
    const int32_t end_q15 = pedals->free_travel_q15;
    const int32_t end_mNm = pedals->free_travel_torque_mNm;
    return travel_q15 <= end_q15
               ? q_scale(end_mNm, travel_q15, end_q15)
               : end_mNm + q_scale(full_mNm - end_mNm, travel_q15 - end_q15, ONE_q15 - end_q15);
}

/* The travel that counts; sets no_brake_ms. */
static int32_t brake_travel_q15(pedals_state_t *state, const travel_t *travel)
{
    if (travel->valid > 0) {
        state->no_brake_ms = 0;
        state->brake_travel_q15 = travel->larger_q15;
    } else {
        state->no_brake_ms = q_min(state->no_brake_ms, INT32_MAX - 1) + 1;
    }
    return state->brake_travel_q15;
}

/* Direction, switches and flags come by CAN. A vehicle without CAN is on and drives forward; one
 * whose messages have ended is neutral. */
static wheel_demand_t switches(pedals_state_t *state, const config_t *config,
                               const pedals_input_t *in)
{
    const bool fresh = !demand_is_lost(config, in->received_age_ms);
    state->was_received = state->was_received || fresh;
    if (fresh) {
        return in->received;
    }
    const wheel_demand_t alone = {
        .direction = state->was_received ? DRIVE_DIRECTION_NEUTRAL : DRIVE_DIRECTION_FORWARD,
        .enable = true,
        .reason = state->was_received ? REASON_DEMAND_TIMEOUT : REASON_NONE,
    };
    return alone;
}

static void apply_accelerator(pedals_state_t *state, const config_pedals_t *pedals,
                              const travel_t *travel, pedals_output_t *out)
{
    state->accelerator_fault = qualify(&state->accelerator_fault_halves, state->accelerator_fault,
                                       travel->plausible, pedals->fault_time_ms);
    const bool usable = travel->valid == pedals->accelerator_channels && !state->accelerator_fault;
    const bool overridden =
        out->demand.brake_torque_mNm > 0 && travel->larger_q15 > pedals->override_q15;
    const bool released = usable && travel->larger_q15 == 0;
    state->must_release =
        (state->must_release && !released) || state->accelerator_fault || overridden;

    const int32_t wanted_mNm = usable ? accelerator_mNm(pedals, travel) : 0;
    const int32_t along_mNm = state->must_release ? q_min(wanted_mNm, 0) : wanted_mNm;
    out->demand.drive_torque_mNm = along_mNm * drive_direction_sign(out->demand.direction);
    if (state->accelerator_fault) {
        out->demand.reason = REASON_ACCELERATOR_SENSOR;
    } else if (wanted_mNm > along_mNm && out->demand.reason == REASON_NONE) {
        out->demand.reason = REASON_ACCELERATOR_LOCKED;
    }
}

pedals_output_t pedals_step(pedals_state_t *state, const config_t *config, const pedals_input_t *in)
{
    const config_pedals_t *pedals = &config->pedals;
    const bool sampled = !demand_is_lost(config, in->age_ms);
    pedals_output_t out = {.demand = switches(state, config, in)};
    /* A brake pedal elsewhere must keep sending, unless there has never been a message. */
    out.age_ms = state->was_received ? in->received_age_ms : 0;
    if (pedals->brake_channels > 0) {
        const travel_t travel = read_pedal(pedals, in, BRAKE, pedals->brake_channels, sampled);
        state->brake_fault = qualify(&state->brake_fault_halves, state->brake_fault,
                                     travel.plausible, pedals->fault_time_ms);
        out.demand.brake_torque_mNm =
            pedals_brake_torque_mNm(pedals, brake_travel_q15(state, &travel));
        out.age_ms = state->no_brake_ms >= pedals->fault_time_ms ? UINT32_MAX : 0;
    }
    if (pedals->accelerator_channels > 0) {
        const travel_t travel =
            read_pedal(pedals, in, ACCELERATOR, pedals->accelerator_channels, sampled);
        apply_accelerator(state, pedals, &travel, &out);
    }
    out.demand.reason = state->brake_fault ? REASON_BRAKE_PEDAL_SENSOR : out.demand.reason;
    return out;
}

wheel_demand_t pedals_wheel_demand(const config_t *config, const wheel_demand_t *demand,
                                   int32_t wheel)
{
    wheel_demand_t out = *demand;
    if (config->pedals.accelerator_channels > 0) {
        out.drive_torque_mNm =
            q_scale(demand->drive_torque_mNm, config->pedals.drive_share_q15[wheel], ONE_q15);
    }
    if (config->pedals.brake_channels > 0) {
        out.brake_torque_mNm =
            q_scale(demand->brake_torque_mNm, config->pedals.brake_share_q15[wheel], ONE_q15);
    }
    return out;
}
