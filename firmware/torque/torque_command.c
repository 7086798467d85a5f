/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/torque_command.h"

#include "core/q15.h"
#include "core/ramp.h"
#include "core/scaled.h"
#include "torque/demand.h"

/* What a torque that has grown counts for, and how fast that fades: DERIVATIONS.md, Torque growth.
 */
enum { MOVING_TIMES = 4, MOVING_STEPS = 4 };

void torque_command_init(torque_command_state_t *state)
{
    state->braked = false;
    state->moving_mNm = 0;
}

static bool same_sign(int32_t a, int32_t b)
{
    return (a > 0 && b > 0) || (a < 0 && b < 0);
}

bool torque_command_is_against(int32_t torque_mNm, int32_t speed_mrad_s)
{
    return (speed_mrad_s > 0 && torque_mNm < 0) || (speed_mrad_s < 0 && torque_mNm > 0);
}

/* What is left at once of the last command; the rate has no say in it. With the observer's angle
 * that is what keeps it right: on the way there it would be lost. Without any the torque ramps. */
static int32_t remaining_mNm(bool braked, const torque_limits_t *limits, const measured_t *now,
                             int32_t last_mNm, const demand_t *demand)
{
    const int32_t speed_mrad_s = now->speed_mrad_s;
    const bool is_against = torque_command_is_against(last_mNm, speed_mrad_s);
    const limit_t *line = is_against ? limits->braking : limits->driving;
    const int32_t observed_mNm =
        now->angle_valid ? line[TORQUE_LINE_ROTOR].torque_mNm : FEASIBLE_UNBOUNDED;
    const int32_t command_mNm = q_clamp(last_mNm, -observed_mNm, observed_mNm);
    if (is_against) {
        const int32_t most_mNm = limits->braking[TORQUE_LINE_ABS].torque_mNm;
        return q_clamp(command_mNm, -most_mNm, most_mNm);
    }
    const bool is_wanted = same_sign(command_mNm, demand->drive_torque_mNm);
    /* At zero speed, which may be a stuck hall line, what braked still counts as braking. */
    const bool is_withdrawn = demand->drive_withdrawn && !braked;
    const bool has_turned_round =
        braked && torque_command_is_against(-command_mNm, speed_mrad_s) && !is_wanted;
    return is_withdrawn || has_turned_round ? 0 : command_mNm;
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

/* What has grown, and fades. Clamped: memory is not trusted. */
static int32_t moving_mNm(const torque_command_state_t *state, int32_t rate_mNm)
{
    return q_clamp(state->moving_mNm, 0, MOVING_TIMES * rate_mNm);
}

/* The voltage of a torque that has just grown moves the current besides: it stops the growth, but
 * takes torque away only beyond that. */
static int32_t growth_mNm(const torque_command_state_t *state, const config_t *config,
                          const measured_t *now, int32_t rate_mNm)
{
    const int32_t by_voltage_mNm = torque_command_growth_mNm(config, now->report->voltage_use_q15);
    return by_voltage_mNm < 0 ? q_min(by_voltage_mNm + moving_mNm(state, rate_mNm), 0)
                              : by_voltage_mNm;
}

static void watch_growth(torque_command_state_t *state, int32_t before_mNm, int32_t command_mNm,
                         int32_t rate_mNm)
{
    const int32_t grown_mNm = q_clamp(q_abs(command_mNm) - q_abs(before_mNm), 0, rate_mNm);
    const int32_t moves_mNm = moving_mNm(state, rate_mNm);
    const int32_t left_mNm = q_max(moves_mNm - moves_mNm / MOVING_STEPS - 1, 0);
    state->moving_mNm = q_max(left_mNm, MOVING_TIMES * grown_mNm);
}

torque_command_out_t torque_command_step(torque_command_state_t *state, const config_t *config,
                                         const torque_limits_t *limits, const measured_t *now,
                                         int32_t last_command_mNm, const torque_enable_t *enable,
                                         const demand_t *demand, const motor_braking_t *braking,
                                         bool bridge_open)
{
    const int32_t speed_mrad_s = now->speed_mrad_s;
    const int32_t drive_mNm = demand->drive_torque_mNm;
    torque_command_out_t out = {.command_mNm = 0, .reason = REASON_NONE};
    limit_t driving = limit_init(q_abs(drive_mNm), REASON_NONE);
    if (drive_mNm != 0) {
        const limit_t bound = drive_limit(limits, speed_mrad_s, drive_mNm);
        limit_tighten(&driving, bound.torque_mNm, bound.reason);
    }
    if (!torque_enable_any(*enable)) {
        out.reason = braking->electric_mNm != 0 ? enable->reason : driving.reason;
        torque_command_init(state);
        return out;
    }
    const int32_t before_mNm =
        bridge_open ? 0 : remaining_mNm(state->braked, limits, now, last_command_mNm, demand);
    const int32_t drive_part_mNm = drive_mNm >= 0 ? driving.torque_mNm : -driving.torque_mNm;
    const int32_t brake_part_mNm =
        speed_mrad_s >= 0 ? -braking->electric_mNm : braking->electric_mNm;
    const int32_t target_mNm = drive_part_mNm + brake_part_mNm;

    const int32_t rate_mNm = demand_rate_mNm_per_step(config);
    const int32_t grows_mNm = growth_mNm(state, config, now, rate_mNm);
    const int32_t most_mNm = q_max(q_abs(before_mNm) + grows_mNm, 0);
    const int32_t within_mNm = q_clamp(target_mNm, -most_mNm, most_mNm);
    out.command_mNm = ramp_step(before_mNm, within_mNm, rate_mNm);
    if (braking->rise_mNm > 0 && drive_mNm == 0 &&
        torque_command_is_against(out.command_mNm, speed_mrad_s)) {
        const int32_t least_mNm =
            q_max(q_abs(before_mNm) - braking->rise_mNm, braking->uncovered_mNm);
        out.command_mNm = q_clamp(out.command_mNm, -least_mNm, least_mNm);
    }
    watch_growth(state, before_mNm, out.command_mNm, rate_mNm);
    state->braked = torque_command_is_against(out.command_mNm, speed_mrad_s) ||
                    (state->braked && speed_mrad_s == 0 && same_sign(before_mNm, out.command_mNm));
    out.falling =
        same_sign(out.command_mNm, target_mNm) && q_abs(out.command_mNm) > q_abs(target_mNm);
    const bool by_voltage = within_mNm != target_mNm && grows_mNm <= 0;
    const reason_t on_the_way = by_voltage ? REASON_VOLTAGE : REASON_TORQUE_RATE;
    out.reason = out.command_mNm != target_mNm ? on_the_way : driving.reason;
    return out;
}
