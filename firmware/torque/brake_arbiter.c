#include "torque/brake_arbiter.h"

#include "core/q15.h"

enum { ABS_HOLD_STEPS = 300 /* ms without anti-lock intervention before the motor brakes again */ };

void brake_arbiter_init(brake_arbiter_state_t *state)
{
    state->abs_hold_steps = 0;
}

/* The strategy's own bound on the electric part, with the hand-over. A rating or a share fades out as a whole; the best torque is
 * kept as long as what fades is larger: giving it up earlier would return less than a parallel strategy does. */
static limit_t strategy_limit(const config_t *config, const capability_t *capability, int32_t demand_mNm,
                              int32_t handover_q15)
{
    const config_brake_t *brake = &config->brake;
    limit_t limit = capability->regenerating;
    switch (brake->strategy) {
    case CONFIG_STRATEGY_PARALLEL_RATIO:
        limit_tighten(&limit, brake->electric_rated_torque_mNm, REASON_ELECTRIC_RATED);
        limit_tighten(&limit, q15_share_of(demand_mNm, (int16_t)brake->parallel_electric_share_q15),
                      REASON_ELECTRIC_SHARE);
        limit_derate(&limit, handover_q15, REASON_HANDOVER);
        break;
    case CONFIG_STRATEGY_PARALLEL_FREE_TRAVEL:
        limit_tighten(&limit, brake->electric_rated_torque_mNm, REASON_ELECTRIC_RATED);
        limit_derate(&limit, handover_q15, REASON_HANDOVER);
        break;
    default: /* CONFIG_STRATEGY_SERIES_OPTIMAL; config_validate() lets nothing else through */
        limit_derate(&limit, handover_q15, REASON_HANDOVER);
        limit_tighten(&limit, capability->optimal.torque_mNm, capability->optimal.reason);
        break;
    }
    return limit;
}

static bool motor_must_yield(brake_arbiter_state_t *state, bool abs_active)
{
    if (abs_active) {
        state->abs_hold_steps = ABS_HOLD_STEPS;
    } else if (state->abs_hold_steps > 0) {
        state->abs_hold_steps--;
    }
    return state->abs_hold_steps > 0;
}

/* What the hand-over leaves: nothing at and below its end, even where it has no width or ends at standstill. */
static int32_t handover_share_q15(const config_brake_t *brake, int32_t speed_mrad_s)
{
    const int32_t end_mrad_s = brake->handover_end_mrad_s;
    return limit_fade_q15(q_abs(speed_mrad_s), q_max(brake->handover_start_mrad_s, end_mrad_s + 1), end_mrad_s);
}

/* Electric braking as a magnitude: torque against the rotation, 0 when it drives. */
static int32_t braking_part(int32_t torque_mNm, int32_t speed_mrad_s)
{
    return q_max(speed_mrad_s >= 0 ? -torque_mNm : torque_mNm, 0);
}

brake_arbiter_out_t brake_arbiter_step(brake_arbiter_state_t *state, const config_t *config,
                                       const capability_t *capability, const brake_arbiter_input_t *in)
{
    const config_brake_t *brake = &config->brake;
    const int32_t demand_mNm = q_max(in->demand_mNm, 0);

    const int32_t handover_q15 = handover_share_q15(brake, in->speed_mrad_s);
    limit_t available = strategy_limit(config, capability, demand_mNm, handover_q15);
    if (motor_must_yield(state, in->abs_active)) {
        limit_tighten(&available, 0, REASON_ABS);
    }
    limit_derate(&available, in->permission.brake_q15, in->permission.reason);

    limit_t electric = limit_init(demand_mNm, REASON_NONE);
    limit_tighten(&electric, available.torque_mNm, available.reason);

    /* Count on the larger of what the motor is asked for now and what it was asked for (it leaves no faster than the
     * torque rate), less what visibly did not come. */
    const int32_t commanded_mNm = braking_part(in->motor_command_mNm, in->speed_mrad_s);
    const int32_t achieved_mNm = braking_part(in->motor_achieved_mNm, in->speed_mrad_s);
    const int32_t counted_mNm = in->permission.bridge == BRIDGE_PWM ? q_max(electric.torque_mNm, commanded_mNm) : 0;
    const int32_t shortfall_mNm =
        counted_mNm > 0 ? q_max(commanded_mNm - achieved_mNm - brake->shortfall_band_mNm, 0) : 0;
    const int32_t hydraulic_mNm = q_max(demand_mNm - (counted_mNm - shortfall_mNm), 0);

    const int32_t wanted_mNm = q_min(hydraulic_mNm, demand_mNm);
    const brake_arbiter_out_t out = {
        .electric_mNm = electric.torque_mNm,
        .hydraulic_mNm = q_min(wanted_mNm, brake->max_hydraulic_torque_mNm),
        .available = available,
        .reason = electric.reason,
        .hydraulic_reason = wanted_mNm > brake->max_hydraulic_torque_mNm ? REASON_HYDRAULIC_LIMIT : REASON_NONE,
    };
    return out;
}
