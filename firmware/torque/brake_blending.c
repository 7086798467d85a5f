/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/brake_blending.h"

#include "core/q15.h"
#include "torque/demand.h"

enum {
    LIMIT_FILTER_LOG2 = 6,   /* 64 ms: filters the noise of the extrapolation */
    MOST_LIMIT_mNm = 8388608 /* largest input of the filter */
};

void brake_blending_init(brake_blending_state_t *state)
{
    hydraulic_model_init(&state->hydraulic);
    filter_reset(&state->limit_lp_mNm, 0, LIMIT_FILTER_LOG2);
}

/* Electric braking as a magnitude: torque against the rotation, 0 when it drives. */
static int32_t braking_part(int32_t torque_mNm, int32_t speed_mrad_s)
{
    return q_max(speed_mrad_s >= 0 ? -torque_mNm : torque_mNm, 0);
}

/* Expected fall of a limit within the delay of the hydraulic brake; 0 while it rises. */
static int32_t expected_fall_mNm(brake_blending_state_t *state, const config_brake_t *brake,
                                 int32_t limit_mNm)
{
    const int32_t within_mNm = q_min(limit_mNm, MOST_LIMIT_mNm);
    /* A low-pass of a ramp lags it by the slope times the time constant. */
    const int32_t lag_mNm =
        filter_step(&state->limit_lp_mNm, within_mNm, LIMIT_FILTER_LOG2) - within_mNm;
    const int32_t ahead_ms = brake->hydraulic_dead_time_ms + brake->hydraulic_time_constant_ms;
    return (int32_t)(((int64_t)q_max(lag_mNm, 0) * ahead_ms) >> LIMIT_FILTER_LOG2);
}

/* Motor torque available when the hydraulic brake responds, and the shortfall of the present motor
 * torque below its command. */
typedef struct {
    int32_t expected_mNm, shortfall_mNm;
} motor_share_t;

static motor_share_t motor_share(const config_t *config, const brake_blending_input_t *in,
                                 int32_t electric_mNm)
{
    motor_share_t out = {.expected_mNm = 0, .shortfall_mNm = 0};
    if (!torque_enable_any(in->torque_enable)) {
        return out;
    }
    const int32_t commanded_mNm = braking_part(in->motor_command_mNm, in->speed_mrad_s);
    const int32_t achieved_mNm = braking_part(in->motor_achieved_mNm, in->speed_mrad_s);
    const int32_t reachable_mNm = q_saturate64(
        (int64_t)commanded_mNm + (int64_t)in->motor_growth_mNm * config->brake.motor_arrival_ms);
    const int32_t released_mNm = q_saturate64((int64_t)demand_rate_mNm_per_step(config) *
                                              config->brake.hydraulic_dead_time_ms);
    out.expected_mNm =
        q_max(q_min(electric_mNm, reachable_mNm), q_max(commanded_mNm - released_mNm, 0));
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

    /* Tightest of the lines that do not depend on the demand. */
    const limit_t independent =
        torque_limits_tightest(limits->braking, 0, TORQUE_LINE_ELECTRIC_SHARE);
    const int32_t fall_mNm = expected_fall_mNm(state, brake, independent.torque_mNm);
    const limit_t others =
        torque_limits_tightest(limits->braking, TORQUE_LINE_ELECTRIC_SHARE, TORQUE_LINE_COUNT);
    limit_t available = independent;
    limit_tighten(&available, others.torque_mNm, others.reason);

    limit_t electric = limit_init(demand_mNm, REASON_NONE);
    limit_tighten(&electric, available.torque_mNm, available.reason);

    const int32_t expected_limit_mNm =
        q_min(electric.torque_mNm, q_max(independent.torque_mNm - fall_mNm, 0));
    const motor_share_t motor = motor_share(config, in, expected_limit_mNm);
    const int32_t required_mNm =
        q_min(q_max(demand_mNm - motor.expected_mNm + motor.shortfall_mNm, 0), demand_mNm);
    const int32_t hydraulic_mNm = q_min(required_mNm, brake->max_hydraulic_torque_mNm);
    /* Hydraulic torque that covers a motor shortfall does not reduce the motor command. */
    hydraulic_model_step(&state->hydraulic, config, hydraulic_mNm);
    const int32_t estimated_mNm =
        q_max(hydraulic_model_torque_mNm(&state->hydraulic) - motor.shortfall_mNm, 0);
    limit_tighten(&electric, demand_mNm - estimated_mNm, REASON_TORQUE_RATE);

    const brake_blending_out_t out = {
        .electric_mNm = electric.torque_mNm,
        .hydraulic_mNm = hydraulic_mNm,
        .available = available,
        .reason = electric.reason,
        .hydraulic_reason =
            required_mNm > brake->max_hydraulic_torque_mNm ? REASON_HYDRAULIC_LIMIT : REASON_NONE,
    };
    return out;
}
