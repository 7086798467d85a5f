/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/torque_command.h"

#include "core/q15.h"
#include "core/ramp.h"
#include "core/scaled.h"
#include "torque/demand.h"

void torque_command_init(torque_command_state_t *state)
{
    state->command_mNm = 0;
    state->braked = false;
}

static bool same_sign(int32_t a, int32_t b)
{
    return (a > 0 && b > 0) || (a < 0 && b < 0);
}

bool torque_command_is_against(int32_t torque_mNm, int32_t speed_mrad_s)
{
    return (speed_mrad_s > 0 && torque_mNm < 0) || (speed_mrad_s < 0 && torque_mNm > 0);
}

/* What is left at once of the last command; the rate has no say in it. */
static int32_t remaining_mNm(const torque_command_state_t *state, const torque_limits_t *limits,
                             const torque_command_input_t *in)
{
    if (torque_command_is_against(state->command_mNm, in->speed_mrad_s)) {
        const int32_t most_mNm = limits->braking[TORQUE_LINE_ABS].torque_mNm;
        return q_clamp(state->command_mNm, -most_mNm, most_mNm);
    }
    const bool is_wanted = same_sign(state->command_mNm, in->drive_mNm);
    /* At zero speed, which may be a stuck hall line, what braked still counts as braking. */
    const bool is_withdrawn = in->drive_withdrawn && !state->braked;
    const bool has_turned_round =
        state->braked && torque_command_is_against(-state->command_mNm, in->speed_mrad_s) &&
        !is_wanted;
    return is_withdrawn || has_turned_round ? 0 : state->command_mNm;
}

/* A driving demand against the rotation, by a wheel that rolls back, obeys the limits of braking
 * but those of the strategy; one along the rotation, or at standstill, obeys those of driving, of
 * which strategy and anti-lock have none. */
static limit_t drive_limit(const torque_limits_t *limits, int32_t speed_mrad_s, int32_t drive_mNm)
{
    if (!torque_command_is_against(drive_mNm, speed_mrad_s)) {
        return torque_limits_tightest(limits->driving, 0, TORQUE_LINE_LOSS_OPTIMUM);
    }
    limit_t out = torque_limits_tightest(limits->braking, 0, TORQUE_LINE_LOSS_OPTIMUM);
    const limit_t anti_lock = limits->braking[TORQUE_LINE_ABS];
    limit_tighten(&out, anti_lock.torque_mNm, anti_lock.reason);
    return out;
}

int32_t torque_command_growth_mNm(const config_t *config, int32_t voltage_use_q15)
{
    const int32_t end_q15 = config->brake.torque_growth_end_q15;
    const int32_t left_q15 = end_q15 - q_clamp(voltage_use_q15, 0, 2 * end_q15);
    const int32_t share = q_limit(left_q15 * config->brake.torque_growth_slope_q9, SCALED_ONE);
    return scaled_multiply(demand_rate_mNm_per_step(config), share);
}

torque_command_out_t torque_command_step(torque_command_state_t *state, const config_t *config,
                                         const torque_limits_t *limits,
                                         const torque_command_input_t *in)
{
    torque_command_out_t out = {.command_mNm = 0, .reason = REASON_NONE};
    limit_t driving = limit_init(q_abs(in->drive_mNm), REASON_NONE);
    if (in->drive_mNm != 0) {
        const limit_t bound = drive_limit(limits, in->speed_mrad_s, in->drive_mNm);
        limit_tighten(&driving, bound.torque_mNm, bound.reason);
    }
    if (!torque_enable_any(in->torque_enable)) {
        out.reason = in->electric_mNm != 0 ? in->torque_enable.reason : driving.reason;
        torque_command_init(state);
        return out;
    }
    state->command_mNm = in->bridge_open ? 0 : remaining_mNm(state, limits, in);
    const int32_t drive_part_mNm = in->drive_mNm >= 0 ? driving.torque_mNm : -driving.torque_mNm;
    const int32_t brake_part_mNm = in->speed_mrad_s >= 0 ? -in->electric_mNm : in->electric_mNm;
    const int32_t target_mNm = drive_part_mNm + brake_part_mNm;

    const int32_t rate_mNm = demand_rate_mNm_per_step(config);
    const int32_t growth_mNm = torque_command_growth_mNm(config, in->voltage_use_q15);
    const int32_t most_mNm = q_max(q_abs(state->command_mNm) + growth_mNm, 0);
    const int32_t within_mNm = q_clamp(target_mNm, -most_mNm, most_mNm);
    const int32_t before_mNm = state->command_mNm;
    state->command_mNm = ramp_step(before_mNm, within_mNm, rate_mNm);
    if (in->arrived_mNm > 0 && in->drive_mNm == 0 &&
        torque_command_is_against(state->command_mNm, in->speed_mrad_s)) {
        const int32_t kept_mNm = q_max(q_abs(before_mNm) - in->arrived_mNm, in->beside_mNm);
        state->command_mNm = q_clamp(state->command_mNm, -kept_mNm, kept_mNm);
    }
    state->braked =
        torque_command_is_against(state->command_mNm, in->speed_mrad_s) ||
        (state->braked && in->speed_mrad_s == 0 && same_sign(before_mNm, state->command_mNm));
    out.command_mNm = state->command_mNm;
    out.falling =
        same_sign(out.command_mNm, target_mNm) && q_abs(out.command_mNm) > q_abs(target_mNm);
    const bool by_voltage = within_mNm != target_mNm && growth_mNm <= 0;
    const reason_t on_the_way = by_voltage ? REASON_VOLTAGE : REASON_TORQUE_RATE;
    out.reason = out.command_mNm != target_mNm ? on_the_way : driving.reason;
    return out;
}
