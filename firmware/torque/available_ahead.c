/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/available_ahead.h"

#include "core/q15.h"
#include "motor/feasible_torque.h"

enum {
    FILTER_LOG2 = 3,                          /* 8 rounds of 16 ms */
    LAG_ms = 7 * AVAILABLE_AHEAD_ROUND_steps, /* of a low-pass behind a ramp */
    AGE_ms = 22,                              /* of results: 14 to 30 ms */
    AHEAD_q5 = 32 * (AVAILABLE_AHEAD_ms + AGE_ms) / LAG_ms,
    PART_steps = 2, /* of a round: a part of the table in every other step */
    MOST_VALUE = 1 << 25,
    /* What changes by more in a round steps, and has no slope. */
    STEP_LOG2 = 4,            /* of the battery's highest voltage */
    STEP_POWER = 64,          /* thousandths of motor.max_power */
    TEMPERATURE_STEP_cC = 50, /* a sensor, not a motor */
    NO_STEP = INT32_MAX
};

/* Of a round, in this order. */
typedef enum {
    PART_INPUTS,
    PART_PLAIN,
    PART_DRIVING_ENDS,
    PART_DRIVING_DRAWN,
    PART_BRAKING_ENDS,
    PART_BRAKING_DRAWN,
    PART_BRAKING_RETURNED,
    PART_RESULTS
} part_t;

void available_ahead_init(available_ahead_state_t *state)
{
    const available_ahead_state_t fresh = {
        .now = {.driving = limit_init(0, REASON_TORQUE_ENABLE),
                .braking = limit_init(0, REASON_TORQUE_ENABLE)},
        .ahead = {.driving = limit_init(0, REASON_TORQUE_ENABLE),
                  .braking = limit_init(0, REASON_TORQUE_ENABLE)},
    };
    *state = fresh;
    torque_limits_clear(&state->table);
}

/* ---- slopes ---- */

static int32_t slope_ahead(const available_slope_t *slope)
{
    const int32_t lag = slope->value - (slope->low_passed_q3 >> FILTER_LOG2);
    return q_saturate64(slope->value + (((int64_t)lag * AHEAD_q5) >> 5));
}

/* Once a round; returns the value expected. A change beyond `step` moves the low-pass along. */
static int32_t slope_sample(available_slope_t *slope, int32_t value, int32_t step)
{
    const int32_t within = q_limit(value, MOST_VALUE);
    const int32_t change = within - slope->value;
    if (!slope->known) {
        slope->low_passed_q3 = within * (1 << FILTER_LOG2);
        slope->known = true;
    } else if (q_abs(change) > step) {
        slope->low_passed_q3 += change * (1 << FILTER_LOG2);
    }
    slope->value = within;
    slope->low_passed_q3 += within - (slope->low_passed_q3 >> FILTER_LOG2);
    return slope_ahead(slope);
}

/* A wheel comes to rest, but does not turn round; beyond the highest speed no faster than now. */
static int32_t expected_speed_mrad_s(available_slope_t *slope, const config_t *config,
                                     int32_t now_mrad_s)
{
    const int32_t then_mrad_s = slope_sample(slope, now_mrad_s, NO_STEP);
    const bool rolls_on = now_mrad_s > 0 ? then_mrad_s > 0 : now_mrad_s < 0 && then_mrad_s < 0;
    const int32_t fastest_mrad_s =
        q_max(config->motor.max_speed_mrad_s / 4 * 5, q_limit(q_abs(now_mrad_s), MOST_VALUE));
    return rolls_on ? q_limit(then_mrad_s, fastest_mrad_s) : 0;
}

/* A voltage or a power: >= 0. */
static int32_t expected_magnitude(available_slope_t *slope, int32_t value, int32_t step)
{
    return q_clamp(slope_sample(slope, value, step), 0, MOST_VALUE);
}

/* ---- the parts of a round ---- */

/* What is not evaluated anew stays as it is now. */
static void expect_inputs(available_ahead_state_t *state, const motor_constants_t *motor,
                          const config_t *config, const torque_limits_t *limits,
                          const measured_t *now, int32_t phase_voltage_mV)
{
    const int32_t power_step_b = q_saturate64((int64_t)STEP_POWER * motor->negligible_power_b);
    state->expected.speed_mrad_s = expected_speed_mrad_s(&state->speed, config, now->speed_mrad_s);
    state->expected.phase_voltage_mV = expected_magnitude(
        &state->voltage, phase_voltage_mV, config->battery.max_voltage_mV >> STEP_LOG2);
    state->expected.winding_temperature_cC =
        slope_sample(&state->winding, now->winding_temperature_cC, TEMPERATURE_STEP_cC);
    state->expected.switch_temperature_cC =
        slope_sample(&state->switches, now->switch_temperature_cC, TEMPERATURE_STEP_cC);
    state->table = *limits;
    const int32_t returned_b = limits->losses.returned.power_b;
    state->table.losses.returned.power_b = q_clamp(
        slope_sample(&state->returned, returned_b, power_step_b), q_min(returned_b, 0), MOST_VALUE);
    state->table.drawn_b = expected_magnitude(&state->drawn, limits->drawn_b, power_step_b);
}

static motor_model_t model_then(const available_ahead_state_t *state,
                                const motor_constants_t *motor, const config_t *config,
                                motor_current_t around)
{
    return motor_model_around(motor, config, state->expected.speed_mrad_s,
                              state->expected.winding_temperature_cC, around);
}

static void evaluate_plain(available_ahead_state_t *state, const motor_constants_t *motor,
                           const config_t *config, int32_t brake_torque_mNm)
{
    const motor_model_t model = model_then(state, motor, config, state->table.at.braking.end);
    torque_limits_plain(&state->table, &model, state->expected.switch_temperature_cC,
                        brake_torque_mNm);
}

/* What is solved of the table, at the inputs of the round. */
static void evaluate_solved(available_ahead_state_t *state, const motor_constants_t *motor,
                            const config_t *config, part_t part)
{
    const bool drives = part == PART_DRIVING_ENDS || part == PART_DRIVING_DRAWN;
    motor_model_t model = model_then(
        state, motor, config, drives ? state->table.at.driving.end : state->table.at.braking.end);
    feasible_set_t set = feasible_set_at(&model, state->expected.phase_voltage_mV);
    const side_t sign = drives ? SIDE_DRIVING : SIDE_BRAKING;
    const feasible_side_t side = {.set = &set, .sign = (int32_t)sign, .cap = state->cap};
    if (part == PART_DRIVING_ENDS || part == PART_BRAKING_ENDS) {
        feasible_circle_t circle = {.known = false};
        state->cap = torque_limits_ends(&state->table, &model, &set, sign, &circle).cap;
        return;
    }
    const feasible_cap_power_t cap = feasible_cap_power(&side);
    if (part == PART_BRAKING_RETURNED) {
        torque_limits_returned(&state->table, &model, &set, &side, &cap);
    } else {
        torque_limits_drawn(&state->table, &model, &set, &side, &cap);
    }
}

static available_t available_of(const torque_limits_t *table)
{
    const available_t out = {
        .driving = torque_limits_tightest(table->driving, 0, TORQUE_LINE_COUNT),
        .braking = torque_limits_tightest(table->braking, 0, TORQUE_LINE_COUNT),
    };
    return out;
}

void available_ahead_step(available_ahead_state_t *state, const motor_constants_t *motor,
                          const config_t *config, const torque_limits_t *limits,
                          const measured_t *now, int32_t phase_voltage_mV, int32_t brake_torque_mNm)
{
    const bool idle = state->step % PART_steps != 0;
    const part_t part = (part_t)(state->step / PART_steps);
    state->step = (state->step + 1U) % AVAILABLE_AHEAD_ROUND_steps;
    if (idle) {
        return;
    }
    switch (part) {
    case PART_INPUTS:
        expect_inputs(state, motor, config, limits, now, phase_voltage_mV);
        break;
    case PART_PLAIN:
        evaluate_plain(state, motor, config, brake_torque_mNm);
        break;
    case PART_RESULTS:
        state->now = available_of(limits);
        state->ahead = available_of(&state->table);
        break;
    case PART_DRIVING_ENDS:
    case PART_DRIVING_DRAWN:
    case PART_BRAKING_ENDS:
    case PART_BRAKING_DRAWN:
    case PART_BRAKING_RETURNED:
    default:
        evaluate_solved(state, motor, config, part);
        break;
    }
}
