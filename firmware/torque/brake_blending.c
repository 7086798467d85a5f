/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/brake_blending.h"

#include "core/q15.h"
#include "torque/demand.h"

enum {
    ABS_HOLD_STEPS = 300,     /* ms without anti-lock intervention before the motor brakes again */
    REACH_STEPS = 100,        /* ms within which the motor must come to what it is counted on for */
    LIMIT_FILTER_LOG2 = 6,    /* 64 ms */
    MOST_LIMIT_mNm = 8388608, /* of what is filtered */
    ANY_DEMAND_mNm = 100000000 /* no share of it is below a motor's torque */
};

void brake_blending_init(brake_blending_state_t *state)
{
    state->abs_hold_steps = 0;
    hydraulic_model_init(&state->hydraulic);
    filter_reset(&state->limit_lp_mNm, 0, LIMIT_FILTER_LOG2);
}

/* The strategy's own bound on the electric part, with the hand-over. A rating or a share fades out
 * as a whole; the best torque is kept as long as what fades is larger: giving it up earlier would
 * return less than a parallel strategy does. */
static limit_t strategy_limit(const config_t *config, const torque_limits_t *limits,
                              int32_t demand_mNm, int32_t blend_out_q15)
{
    const config_brake_t *brake = &config->brake;
    limit_t limit = limits->regenerating;
    switch (brake->strategy) {
    case CONFIG_STRATEGY_PARALLEL_RATIO:
        limit_tighten(&limit, brake->electric_rated_torque_mNm, REASON_ELECTRIC_RATED);
        limit_tighten(&limit, q15_share_of(demand_mNm, (int16_t)brake->parallel_electric_share_q15),
                      REASON_ELECTRIC_SHARE);
        limit_derate(&limit, blend_out_q15, REASON_BLEND_OUT);
        break;
    case CONFIG_STRATEGY_PARALLEL_FREE_TRAVEL:
        limit_tighten(&limit, brake->electric_rated_torque_mNm, REASON_ELECTRIC_RATED);
        limit_derate(&limit, blend_out_q15, REASON_BLEND_OUT);
        break;
    default: /* CONFIG_STRATEGY_SERIES_OPTIMAL; config_validate() lets nothing else through */
        limit_derate(&limit, blend_out_q15, REASON_BLEND_OUT);
        limit_tighten(&limit, limits->optimal.torque_mNm, limits->optimal.reason);
        break;
    }
    return limit;
}

static bool motor_must_yield(brake_blending_state_t *state, bool abs_active)
{
    if (abs_active) {
        state->abs_hold_steps = ABS_HOLD_STEPS;
    } else if (state->abs_hold_steps > 0) {
        state->abs_hold_steps--;
    }
    return state->abs_hold_steps > 0;
}

/* What the hand-over leaves: nothing at and below its end, even where it has no width or ends at
 * standstill. */
static int32_t blend_out_share_q15(const config_brake_t *brake, int32_t speed_mrad_s)
{
    const int32_t end_mrad_s = brake->blend_out_end_mrad_s;
    return limit_fade_q15(q_abs(speed_mrad_s), q_max(brake->blend_out_start_mrad_s, end_mrad_s + 1),
                          end_mrad_s);
}

/* Electric braking as a magnitude: torque against the rotation, 0 when it drives. */
static int32_t braking_part(int32_t torque_mNm, int32_t speed_mrad_s)
{
    return q_max(speed_mrad_s >= 0 ? -torque_mNm : torque_mNm, 0);
}

/* By how much a limit will have fallen until the hydraulic brake has answered; 0 while it rises. */
static int32_t coming_fall_mNm(brake_blending_state_t *state, const config_brake_t *brake,
                               int32_t limit_mNm)
{
    const int32_t within_mNm = q_min(limit_mNm, MOST_LIMIT_mNm);
    /* A ramp's low-pass is behind it by the slope times the time constant. */
    const int32_t behind_mNm =
        filter_step(&state->limit_lp_mNm, within_mNm, LIMIT_FILTER_LOG2) - within_mNm;
    const int32_t ahead_ms = brake->hydraulic_dead_time_ms + brake->hydraulic_time_constant_ms;
    return q_scale(q_max(behind_mNm, 0), ahead_ms, 1 << LIMIT_FILTER_LOG2);
}

/* What the motor is counted on for when the hydraulic brake will have begun to answer, and what of
 * its command does not come. */
typedef struct {
    int32_t expected_mNm, shortfall_mNm;
} motor_share_t;

static motor_share_t motor_share(const config_t *config, const brake_blending_input_t *in,
                                 int32_t electric_mNm)
{
    motor_share_t out = {.expected_mNm = 0, .shortfall_mNm = 0};
    if (in->torque_enable.bridge != BRIDGE_PWM) {
        return out;
    }
    const int32_t commanded_mNm = braking_part(in->motor_command_mNm, in->speed_mrad_s);
    const int32_t achieved_mNm = braking_part(in->motor_achieved_mNm, in->speed_mrad_s);
    const int32_t reached_mNm =
        q_saturate64((int64_t)commanded_mNm + (int64_t)in->motor_growth_mNm * REACH_STEPS);
    const int32_t left_mNm =
        q_scale(demand_rate_mNm_per_step(config), config->brake.hydraulic_dead_time_ms, 1);
    out.expected_mNm = q_max(q_min(electric_mNm, reached_mNm), q_max(commanded_mNm - left_mNm, 0));
    if (out.expected_mNm > 0) {
        out.shortfall_mNm =
            q_max(commanded_mNm - achieved_mNm - config->brake.shortfall_band_mNm, 0);
    }
    return out;
}

brake_blending_out_t brake_blending_step(brake_blending_state_t *state, const config_t *config,
                                         const torque_limits_t *limits,
                                         const brake_blending_input_t *in)
{
    const config_brake_t *brake = &config->brake;
    const int32_t demand_mNm = q_max(in->demand_mNm, 0);

    const int32_t blend_out_q15 = blend_out_share_q15(brake, in->speed_mrad_s);
    /* How the limit moves by itself, without the demand that a share is of. */
    const limit_t moving = strategy_limit(config, limits, ANY_DEMAND_mNm, blend_out_q15);
    const int32_t fall_mNm = coming_fall_mNm(state, brake, moving.torque_mNm);
    limit_t available = strategy_limit(config, limits, demand_mNm, blend_out_q15);
    if (motor_must_yield(state, in->abs_active)) {
        limit_tighten(&available, 0, REASON_ABS);
    }
    limit_derate(&available, in->torque_enable.brake_q15, in->torque_enable.reason);

    limit_t electric = limit_init(demand_mNm, REASON_NONE);
    limit_tighten(&electric, available.torque_mNm, available.reason);

    const int32_t coming_mNm = q_min(electric.torque_mNm, q_max(moving.torque_mNm - fall_mNm, 0));
    const motor_share_t motor = motor_share(config, in, coming_mNm);
    const int32_t wanted_mNm =
        q_min(q_max(demand_mNm - motor.expected_mNm + motor.shortfall_mNm, 0), demand_mNm);
    const int32_t hydraulic_mNm = q_min(wanted_mNm, brake->max_hydraulic_torque_mNm);
    /* What stands in for a motor that does not give its torque is not the motor's to take back. */
    hydraulic_model_step(&state->hydraulic, config, hydraulic_mNm);
    const int32_t there_mNm =
        q_max(hydraulic_model_torque_mNm(&state->hydraulic) - motor.shortfall_mNm, 0);
    limit_tighten(&electric, demand_mNm - there_mNm, REASON_TORQUE_RATE);

    const brake_blending_out_t out = {
        .electric_mNm = electric.torque_mNm,
        .hydraulic_mNm = hydraulic_mNm,
        .available = available,
        .reason = electric.reason,
        .hydraulic_reason =
            wanted_mNm > brake->max_hydraulic_torque_mNm ? REASON_HYDRAULIC_LIMIT : REASON_NONE,
    };
    return out;
}
