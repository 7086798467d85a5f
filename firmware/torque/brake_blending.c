/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/brake_blending.h"

#include "core/fade.h"
#include "core/q15.h"
#include "core/scaled.h"
#include "torque/demand.h"

enum {
    ONE_Q6 = 64,
    SHORT_SHOWN_SHARE = 8,
    STEP_SHARE = 16,        /* a limit that falls by a larger part of itself in a step */
    LIMIT_FILTER_LOG2 = 6,  /* 64 ms: filters the noise of the extrapolation */
    MOST_FILTERED = 8388608 /* largest input of the filters */
};

void brake_blending_init(brake_blending_state_t *state, const config_t *config)
{
    hydraulic_model_init(&state->hydraulic);
    hydraulic_feedback_init(&state->feedback, config);
    state->bridged_q6_mNm = 0;
    state->within_q6_mNm = 0;
    state->bridging_ms = 0;
    state->covered_mNm = 0;
    state->slower_mrad_s = 0;
    state->open_steps = 0;
    filter_reset(&state->limit_lp_mNm, 0, LIMIT_FILTER_LOG2);
    filter_reset(&state->speed_lp_mrad_s, 0, LIMIT_FILTER_LOG2);
}

/* Electric braking as a magnitude: torque against the rotation, 0 when it drives. */
static int32_t braking_part(int32_t torque_mNm, int32_t speed_mrad_s)
{
    return q_max(speed_mrad_s >= 0 ? -torque_mNm : torque_mNm, 0);
}

/* Zero current keeps every deferrable line, and with series_optimal the motor, which would drive
 * against its own drag else, does not fall below that but in the blend-out. */
static int32_t not_below_coasting_mNm(const config_t *config, const torque_limits_t *limits,
                                      int32_t bound_mNm, int32_t coasting_mNm)
{
    const bool series = config->brake.strategy == CONFIG_STRATEGY_SERIES_OPTIMAL;
    const int32_t least_mNm =
        q_min(coasting_mNm, limits->braking[TORQUE_LINE_BLEND_OUT].torque_mNm);
    return series ? q_max(bound_mNm, least_mNm) : bound_mNm;
}

/* What a value is expected to be some milliseconds later; unchanged while it rises. A low-pass of a
 * ramp lags it by the slope times the time constant. */
static int32_t expected(filter_t *low_pass, int32_t value, int32_t ahead_ms)
{
    const int32_t within = q_min(value, MOST_FILTERED);
    const int32_t lag = filter_step(low_pass, within, LIMIT_FILTER_LOG2) - within;
    return q_max(value - (int32_t)(((int64_t)q_max(lag, 0) * ahead_ms) >> LIMIT_FILTER_LOG2), 0);
}

/* Motor limit when the hydraulic brake responds. The line BLEND_OUT binds from one speed on, which
 * its slope before does not show: it is taken at the speed expected when the hydraulic brake has
 * all but a seventh of its lag over (DERIVATIONS.md, Blend-out). */
static int32_t expected_limit_mNm(brake_blending_state_t *state, const config_t *config,
                                  int32_t limit_mNm, int32_t speed_mrad_s)
{
    const config_brake_t *brake = &config->brake;
    const int32_t lag_ms = brake->hydraulic_time_constant_ms;
    const int32_t responds_ms = brake->hydraulic_dead_time_ms + lag_ms;
    /* Measured torque may come later than configured, and what is early the motor takes back. */
    const int32_t lags = hydraulic_feedback_used(&state->feedback) ? 2 : 1;
    const int32_t made_ms = responds_ms + lags * lag_ms;
    const int32_t by_slope_mNm = expected(&state->limit_lp_mNm, limit_mNm, responds_ms);
    state->slower_mrad_s = expected(&state->speed_lp_mrad_s, q_abs(speed_mrad_s), made_ms);
    return q_min(by_slope_mNm, torque_limits_blend_out(config, state->slower_mrad_s).torque_mNm);
}

/* Motor torque available when the hydraulic brake responds, and the shortfall of the present motor
 * torque below its command. */
typedef struct {
    int32_t expected_mNm, shortfall_mNm;
} motor_share_t;

static motor_share_t motor_share(const brake_blending_state_t *state, const config_t *config,
                                 const measured_t *now, const last_t *last, bool enabled,
                                 const motor_now_t *motor, int32_t electric_mNm, bool measured)
{
    motor_share_t out = {.expected_mNm = 0, .shortfall_mNm = 0};
    const int32_t achieved_mNm = braking_part(motor->achieved_mNm, now->speed_mrad_s);
    if (!enabled || state->open_steps > BRAKE_BLENDING_CLOSING_STEPS) {
        /* The model knows what a shorted motor brakes with. Its currents, which may be beyond the
         * sensors' range, only show that it does. */
        out.expected_mNm =
            achieved_mNm >= motor->short_mNm / SHORT_SHOWN_SHARE ? motor->short_mNm : 0;
        return out;
    }
    const int32_t commanded_mNm = braking_part(last->torque_command_mNm, now->speed_mrad_s);
    const int32_t build_up_ms =
        config->brake.hydraulic_dead_time_ms + config->brake.hydraulic_time_constant_ms;
    /* A brake that leaves earlier than configured must not leave before the motor has come. */
    const int32_t arrival_ms = measured ? q_min(config->brake.motor_arrival_ms, build_up_ms / 2 + 1)
                                        : config->brake.motor_arrival_ms;
    const int32_t reachable_mNm =
        q_saturate64((int64_t)commanded_mNm + (int64_t)motor->growth_mNm * arrival_ms);
    /* What it cannot release in the time in which the hydraulic torque builds up. */
    const int32_t released_mNm =
        q_saturate64((int64_t)demand_rate_mNm_per_step(config) * build_up_ms);
    out.expected_mNm =
        q_max(q_min(electric_mNm, reachable_mNm), q_max(commanded_mNm - released_mNm, 0));
    if (out.expected_mNm > 0) {
        out.shortfall_mNm =
            q_max(commanded_mNm - achieved_mNm - config->brake.shortfall_band_mNm, 0);
    }
    return out;
}

/* A motor that is counted on has a bridge that closes for the demand. One that closes for moments
 * only takes as many steps to be counted on again. */
static void count_open(brake_blending_state_t *state, bool bridge_open, int32_t brake_torque_mNm)
{
    if (bridge_open && brake_torque_mNm > 0) {
        state->open_steps = (uint8_t)q_min(state->open_steps + 1, 2 * BRAKE_BLENDING_CLOSING_STEPS);
    } else if (state->open_steps > 0) {
        state->open_steps--;
    }
}

/* A deferrable limit as the motor leaves it: at once where it rises; where it falls, kept for the
 * dead time, then with the lag. In the blend-out range what is kept fades as well. The motor torque
 * never rises above the limit by it. */
static int32_t bridged_mNm(brake_blending_state_t *state, const config_brake_t *brake,
                           int32_t limit_mNm, int32_t motor_command_mNm, int32_t speed_mrad_s,
                           bool measured)
{
    const int32_t within_q6 = q_min(limit_mNm, MOST_FILTERED) * ONE_Q6;
    const int32_t made_mNm = q_min(braking_part(motor_command_mNm, speed_mrad_s), MOST_FILTERED);
    /* A limit that sinks slowly is followed with the lag; one that steps is bridged anew. */
    const bool steps = state->within_q6_mNm - within_q6 > state->bridged_q6_mNm / STEP_SHARE;
    state->within_q6_mNm = within_q6;
    state->bridging_ms = steps ? 0 : state->bridging_ms;
    if (state->bridging_ms == 0) {
        state->bridged_q6_mNm = q_min(state->bridged_q6_mNm, made_mNm * ONE_Q6);
    }
    if (within_q6 >= state->bridged_q6_mNm) {
        state->bridged_q6_mNm = within_q6;
        state->bridging_ms = 0;
        return limit_mNm;
    }
    const int32_t slower = measured ? 2 : 1;
    const int32_t dead_ms = q_min(brake->hydraulic_dead_time_ms, brake->bridging_time_ms) * slower;
    const int32_t rest_ms = brake->bridging_time_ms * slower - dead_ms;
    int32_t above_q6 = state->bridged_q6_mNm - within_q6;
    if (state->bridging_ms < dead_ms) {
        state->bridging_ms++;
    } else {
        /* exp(-2.3) is a tenth */
        above_q6 -= q_min(above_q6 / (rest_ms * 10 / 23 + 1) + 1, above_q6);
    }
    state->bridged_q6_mNm = within_q6 + above_q6;
    const int32_t above_mNm = q_clamp(made_mNm - limit_mNm, 0, above_q6 / ONE_Q6);
    const int32_t end_mrad_s = brake->blend_out_end_mrad_s;
    const int32_t share_q15 = fade_q15(
        q_abs(speed_mrad_s), q_max(brake->blend_out_start_mrad_s, end_mrad_s + 1), end_mrad_s);
    const int32_t faded_mNm = (int32_t)(((int64_t)above_mNm * share_q15) >> 15);
    return limit_mNm + (share_q15 < Q15_ONE ? faded_mNm : above_mNm);
}

/* The command that makes a torque, of a brake of the learned gain. While that may be less, it is
 * larger by what the motor can take back; while it may be more, smaller by what the motor can
 * make up for and could not take back. */
static int32_t command_mNm(const hydraulic_feedback_state_t *brake, int32_t required_mNm,
                           int32_t motor_mNm, int32_t most_mNm)
{
    const int32_t nominal_mNm = scaled_ratio(required_mNm, brake->gain_q15 * 512);
    if (!hydraulic_feedback_used(brake)) {
        return nominal_mNm;
    }
    const int32_t missing_mNm =
        q_min(q15_product(required_mNm, brake->gain_q15 - brake->least_q15), motor_mNm);
    const int32_t excess_mNm =
        q_max(q15_product(nominal_mNm, brake->most_q15 - brake->gain_q15) - motor_mNm, 0);
    int32_t less_mNm = 0;
    if (excess_mNm > 0 && most_mNm > motor_mNm) {
        less_mNm = q_min(scaled_ratio(excess_mNm, brake->most_q15 * 512), most_mNm - motor_mNm);
    }
    return q_add(q_subtract(nominal_mNm, less_mNm), missing_mNm - missing_mNm / 4);
}

/* What the motor may make beside the torque that the hydraulic brake makes now; beside one that
 * takes its own path, what that does not make yet. */
static int32_t uncovered_mNm(const config_t *config, const demand_t *demand, int32_t covered_mNm,
                             int32_t motor_command_mNm, int32_t speed_mrad_s)
{
    if (!demand->handed_over) {
        return demand->brake_torque_mNm - covered_mNm;
    }
    const int32_t made_mNm = braking_part(motor_command_mNm, speed_mrad_s);
    return made_mNm - demand_handed_over_mNm(config, made_mNm);
}

/* What the motor makes beyond the lines of the strategy ends between a quarter of the end of the
 * blend-out and standstill. */
static int32_t faded_mNm(const config_t *config, int32_t torque_mNm, int32_t speed_abs_mrad_s)
{
    const int32_t end_mrad_s = config->brake.blend_out_end_mrad_s / 4 + 1;
    const int32_t share_q15 = fade_q15(speed_abs_mrad_s, end_mrad_s, 0);
    return share_q15 < Q15_ONE
               ? q_min(torque_mNm, q15_share_of(config->motor.max_torque_mNm, (int16_t)share_q15))
               : torque_mNm;
}

/* The tightest line but those of the strategy. */
static int32_t least_beyond_mNm(const torque_limits_t *limits)
{
    const limit_t least = torque_limits_tightest(limits->braking, 0, TORQUE_LINE_CURRENT_GAIN);
    return q_min(least.torque_mNm, limits->braking[TORQUE_LINE_ABS].torque_mNm);
}

/* A bound of the motor, higher by what the hydraulic brake may miss of its commands while the
 * interval of its gain is wide. */
static int32_t raised_mNm(const brake_blending_state_t *state, int32_t bound_mNm,
                          int32_t beyond_mNm)
{
    const hydraulic_feedback_state_t *feedback = &state->feedback;
    const int32_t missing_mNm = q15_product(hydraulic_model_torque_mNm(&state->hydraulic),
                                            feedback->most_q15 - feedback->least_q15);
    return q_max(bound_mNm, q_min(q_add(bound_mNm, missing_mNm), beyond_mNm));
}

/* Bound of the motor's braking torque: hard lines at once, deferrable ones bridged. beyond_mNm:
 * that without the lines of the strategy. */
static int32_t motor_bound_mNm(brake_blending_state_t *state, const config_t *config,
                               const torque_limits_t *limits, const torque_limits_classes_t *bounds,
                               int32_t beyond_mNm, int32_t last_command_mNm, int32_t speed_mrad_s,
                               bool measured)
{
    const int32_t share_mNm = limits->braking[TORQUE_LINE_ELECTRIC_SHARE].torque_mNm;
    const int32_t bound_mNm = q_min(q_min(bounds->hard_mNm, share_mNm),
                                    bridged_mNm(state, &config->brake, bounds->deferrable_mNm,
                                                last_command_mNm, speed_mrad_s, measured));
    return measured
               ? raised_mNm(state, bound_mNm, faded_mNm(config, beyond_mNm, q_abs(speed_mrad_s)))
               : bound_mNm;
}

brake_blending_out_t brake_blending_step(brake_blending_state_t *state, const config_t *config,
                                         const torque_limits_t *limits, const measured_t *now,
                                         const last_t *last, const hydraulic_feedback_t *report,
                                         const torque_enable_t *enable, const demand_t *demand,
                                         const motor_now_t *motor)
{
    const config_brake_t *brake = &config->brake;
    const int32_t speed_mrad_s = now->speed_mrad_s;
    const int32_t brake_torque_mNm = q_max(demand->brake_torque_mNm, 0);
    torque_limits_classes_t bounds = torque_limits_classes(limits->braking);
    const int32_t share_mNm = limits->braking[TORQUE_LINE_ELECTRIC_SHARE].torque_mNm;
    limit_t available = torque_limits_at_most(
        limits->braking, q_min(q_min(bounds.hard_mNm, bounds.deferrable_mNm), share_mNm));
    bounds.deferrable_mNm =
        not_below_coasting_mNm(config, limits, bounds.deferrable_mNm, motor->coasting_mNm);
    /* Tightest of the lines that do not depend on the demand. */
    const int32_t independent_mNm = q_min(bounds.hard_mNm, bounds.deferrable_mNm);
    available.torque_mNm = q_min(independent_mNm, share_mNm);
    const int32_t predicted_mNm = expected_limit_mNm(state, config, independent_mNm, speed_mrad_s);
    /* The anti-lock system's bound steps, so its slope says nothing; nor does a slipping wheel's.
     */
    const bool anti_lock = limits->braking[TORQUE_LINE_ABS].torque_mNm <= independent_mNm;
    const int32_t later_mNm = anti_lock ? independent_mNm : predicted_mNm;
    const bool measured = hydraulic_feedback_used(&state->feedback);
    count_open(state, motor->bridge_open, brake_torque_mNm);
    const int32_t seen_mNm = brake_torque_mNm - q15_product(brake_torque_mNm, motor->missing_q15);
    const motor_share_t share =
        motor_share(state, config, now, last, torque_enable_any(*enable), motor,
                    q_min(q_min(seen_mNm, available.torque_mNm), later_mNm), measured);
    const int32_t required_mNm = q_min(
        q_max(brake_torque_mNm - share.expected_mNm + share.shortfall_mNm, 0), brake_torque_mNm);
    const int32_t beyond_mNm = measured ? least_beyond_mNm(limits) : 0;
    const int32_t most_mNm = measured ? faded_mNm(config, beyond_mNm, state->slower_mrad_s) : 0;
    const int32_t commanded_mNm =
        command_mNm(&state->feedback, required_mNm, share.expected_mNm, most_mNm);
    const int32_t hydraulic_mNm = q_min(commanded_mNm, brake->max_hydraulic_torque_mNm);
    hydraulic_model_step(&state->hydraulic, config, hydraulic_mNm + last->hydraulic_added_mNm);
    const bool commanded = limits->braking[TORQUE_LINE_ABS].torque_mNm == FEASIBLE_UNBOUNDED;
    const hydraulic_feedback_out_t made =
        hydraulic_feedback_step(&state->feedback, config, &state->hydraulic, report, commanded);
    const int32_t bound_mNm = motor_bound_mNm(state, config, limits, &bounds, beyond_mNm,
                                              last->torque_command_mNm, speed_mrad_s, made.used);
    limit_t electric = limit_init(brake_torque_mNm, REASON_NONE);
    limit_tighten(&electric, bound_mNm, available.reason);
    /* Hydraulic torque that covers a motor shortfall does not reduce the motor command. */
    const int32_t covered_mNm =
        q_max(made.torque_mNm - share.shortfall_mNm - last->hydraulic_apart_mNm, 0);
    const int32_t left_mNm =
        uncovered_mNm(config, demand, covered_mNm, last->torque_command_mNm, speed_mrad_s);
    /* The hydraulic brake makes what a limit leaves it; without one it has not left yet. */
    const reason_t beside =
        available.torque_mNm < brake_torque_mNm ? available.reason : REASON_TORQUE_RATE;
    limit_tighten(&electric, left_mNm, motor->missing_q15 > 0 ? REASON_CURRENT_GAIN : beside);
    /* On its own path the brake arrives without a command that the model would know. */
    const int32_t rise_mNm =
        demand->handed_over ? brake_torque_mNm : q_max(covered_mNm - state->covered_mNm, 0);
    state->covered_mNm = covered_mNm;

    const bool beyond = commanded_mNm > brake->max_hydraulic_torque_mNm;
    const brake_blending_out_t out = {
        .electric_mNm = electric.torque_mNm,
        .hydraulic_mNm = hydraulic_mNm,
        .slower_mrad_s = state->slower_mrad_s,
        .made_mNm = made.torque_mNm,
        .uncovered_mNm = q_max(left_mNm, 0),
        .rise_mNm = rise_mNm,
        .hard_mNm = bounds.hard_mNm,
        .available = available,
        .reason = electric.reason,
        .hydraulic_reason = beyond ? REASON_HYDRAULIC_LIMIT : REASON_NONE,
    };
    return out;
}

reason_t brake_blending_report(const brake_blending_state_t *state, findings_t *findings)
{
    const hydraulic_feedback_state_t *feedback = &state->feedback;
    const reason_t shows = feedback->shows;
    const bool used = hydraulic_feedback_used(feedback);
    const bool came = used && shows == REASON_NONE &&
                      findings_qualified(findings, FINDING_BRAKE_WEAK) &&
                      feedback->short_ms < HYDRAULIC_FEEDBACK_LATE_ms;
    findings_set(findings, FINDING_BRAKE_DEAD, shows == REASON_HYDRAULIC_DEAD);
    findings_set(findings, FINDING_BRAKE_WEAK, hydraulic_feedback_is_short(feedback));
    findings_set(findings, FINDING_BRAKE_STUCK, shows == REASON_HYDRAULIC_STUCK);
    findings_set(findings, FINDING_BRAKE_STRONG, shows == REASON_HYDRAULIC_STRONG);
    findings_set(findings, FINDING_BRAKE_LATE, came);
    findings_set(findings, FINDING_BRAKE_REPORT, feedback->seen && !used);
    if (!findings_any_qualified(findings, FINDING_BRAKE_DEAD, FINDING_BRAKE_REPORT)) {
        return REASON_NONE;
    }
    for (finding_t row = FINDING_BRAKE_DEAD; row <= FINDING_BRAKE_REPORT; row++) {
        if (findings_present(findings, row)) {
            return findings_reason(findings, row);
        }
    }
    return REASON_NONE;
}
