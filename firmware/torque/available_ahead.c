/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/available_ahead.h"

#include <stddef.h>

#include "core/q15.h"
#include "motor/feasible_torque.h"
#include "motor/loss_maps.h"

enum {
    FILTER_LOG2 = 3,                          /* 8 rounds of 16 ms */
    LAG_ms = 7 * AVAILABLE_AHEAD_ROUND_steps, /* of a low-pass behind a ramp */
    AGE_ms = 22,                              /* of results: 14 to 30 ms */
    AHEAD_q5 = 32 * (AVAILABLE_AHEAD_ms + AGE_ms) / LAG_ms,
    PHASE_steps = 2, /* of a round's eight phases */
    MOST_SOLVED = 1, /* bounds of a step that has effort left */
    MOST_VALUE = 1 << 25,
    STEP_LOG2 = 4,           /* of max_torque: a bound that changes by more in a round steps */
    TEMPERATURE_STEP_cC = 50 /* in a round: a sensor, not a motor */
};

/* RETURNED_PEAK is never below RETURNED. */
static const torque_line_t SLOPED[AVAILABLE_SLOPED_LINES] = {
    TORQUE_LINE_MAX_POWER, TORQUE_LINE_PHASE_CURRENT, TORQUE_LINE_VOLTAGE, TORQUE_LINE_DRAWN,
    TORQUE_LINE_RETURNED};

/* Lines that are taken for their present bounds. */
enum { PRESENT = true, EXPECTED = false };
#define LINE_STAYS(name, deferrable, ahead) [TORQUE_LINE_##name] = (ahead),
static const bool STAYS[TORQUE_LINE_COUNT] = {TORQUE_LINES(LINE_STAYS)};

void available_ahead_init(available_ahead_state_t *state)
{
    const available_t none = {.driving = limit_init(0, REASON_TORQUE_ENABLE),
                              .braking = limit_init(0, REASON_TORQUE_ENABLE)};
    const available_slope_t unknown = {.known = false};
    const available_inputs_t zero = {.speed_mrad_s = 0};
    state->step = 0;
    state->expected = zero;
    state->speed = unknown;
    state->voltage = unknown;
    state->winding = unknown;
    state->switches = unknown;
    state->returned = unknown;
    state->drawn = unknown;
    state->returned_b = 0;
    state->drawn_b = 0;
    for (int i = 0; i < AVAILABLE_SLOPED_LINES; i++) {
        state->driving[i] = unknown;
        state->braking[i] = unknown;
    }
    for (torque_line_t line = 0; line < TORQUE_LINE_COUNT; line++) {
        state->driving_lines[line] = limit_init(FEASIBLE_UNBOUNDED, REASON_NONE);
        state->braking_lines[line] = state->driving_lines[line];
    }
    state->now = none;
    state->ahead = none;
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

/* The first value of a bound that was expected before: with the slope that leads there. */
static void slope_begin(available_slope_t *slope, int32_t value, int32_t expected)
{
    /* The low-pass is about to move by an eighth of its distance: 8/7 32/92 = 512/161 eighths. */
    const int32_t rise = expected - value;
    slope->known = true;
    slope->value = value;
    slope->low_passed_q3 = value * (1 << FILTER_LOG2) - rise / 161 * 512;
}

/* One round further; no bound as long as there is none. The bound by returned power has two parts,
 * of which the slope of the first alone counts: that of the map's i_d, and loss braking. */
static void carry(available_slope_t slopes[AVAILABLE_SLOPED_LINES], limit_t *expected,
                  const limit_t *now, const loss_braking_t *losses, int32_t step_mNm)
{
    for (int i = 0; i < AVAILABLE_SLOPED_LINES; i++) {
        const torque_line_t line = SLOPED[i];
        const bool returned = line == TORQUE_LINE_RETURNED && losses != NULL;
        const int32_t value_mNm = returned ? losses->by_map_mNm : now[line].torque_mNm;
        if (value_mNm > MOST_VALUE) { /* solve() expects something of it */
            slopes[i].known = false;
            expected[line].reason = now[line].reason;
            continue;
        }
        if (!slopes[i].known && expected[line].torque_mNm <= MOST_VALUE) {
            slope_begin(&slopes[i], value_mNm, expected[line].torque_mNm);
        }
        const int32_t then_mNm = slope_sample(&slopes[i], value_mNm, step_mNm);
        expected[line] =
            limit_init(returned ? q_max(then_mNm, losses->torque_mNm) : then_mNm, now[line].reason);
    }
}

/* ---- the steps of a round ---- */

static void expect_inputs(available_ahead_state_t *state, const config_t *config,
                          const torque_limits_t *limits, const measured_t *now,
                          int32_t phase_voltage_mV, int32_t brake_torque_mNm)
{
    const int32_t speed_mrad_s = slope_sample(&state->speed, now->speed_mrad_s, INT32_MAX);
    const bool rolls_on =
        now->speed_mrad_s > 0 ? speed_mrad_s > 0 : now->speed_mrad_s < 0 && speed_mrad_s < 0;
    const int32_t fastest_mrad_s = q_max(config->motor.max_speed_mrad_s / 4 * 5,
                                         q_limit(q_abs(now->speed_mrad_s), MOST_VALUE));
    state->expected.speed_mrad_s = rolls_on ? q_limit(speed_mrad_s, fastest_mrad_s) : 0;
    state->expected.phase_voltage_mV =
        q_clamp(slope_sample(&state->voltage, phase_voltage_mV, INT32_MAX), 0, MOST_VALUE);
    state->expected.winding_temperature_cC =
        slope_sample(&state->winding, now->winding_temperature_cC, TEMPERATURE_STEP_cC);
    state->expected.switch_temperature_cC =
        slope_sample(&state->switches, now->switch_temperature_cC, TEMPERATURE_STEP_cC);
    state->returned_b = q_clamp(
        slope_sample(&state->returned, limits->losses.returned.power_b, INT32_MAX), 0, MOST_VALUE);
    state->drawn_b =
        q_clamp(slope_sample(&state->drawn, limits->drawn_b, INT32_MAX), 0, MOST_VALUE);
    state->expected.brake_torque_mNm = q_max(brake_torque_mNm, 0);
}

static bool is_bounded(const limit_t *lines)
{
    return lines[TORQUE_LINE_PHASE_CURRENT].torque_mNm != FEASIBLE_UNBOUNDED ||
           lines[TORQUE_LINE_VOLTAGE].torque_mNm != FEASIBLE_UNBOUNDED;
}

/* The bounds that took the effort of this step. */
static int solved_bounds(const torque_limits_t *limits)
{
    return (is_bounded(limits->driving) ? 1 : 0) + (is_bounded(limits->braking) ? 1 : 0) +
           (limits->driving[TORQUE_LINE_DRAWN].torque_mNm != FEASIBLE_UNBOUNDED ? 1 : 0) +
           (limits->braking[TORQUE_LINE_RETURNED].torque_mNm != FEASIBLE_UNBOUNDED ? 1 : 0);
}

/* A line without a bound now: whether the largest torque, inside circle and ellipse now, still will
 * be; where they bound it, whether the battery will; otherwise none is expected. What was expected
 * of a line that has just got a bound stays for its slope to begin with. */
static void solve(available_ahead_state_t *state, const motor_constants_t *motor,
                  const config_t *config, const torque_limits_t *limits, side_t sign)
{
    const bool drives = sign == SIDE_DRIVING;
    const limit_t *now = drives ? limits->driving : limits->braking;
    limit_t *expected = drives ? state->driving_lines : state->braking_lines;
    for (int i = 0; i < AVAILABLE_SLOPED_LINES; i++) {
        if (now[SLOPED[i]].torque_mNm > MOST_VALUE) {
            expected[SLOPED[i]].torque_mNm = FEASIBLE_UNBOUNDED;
        }
    }
    const torque_line_t battery = drives ? TORQUE_LINE_DRAWN : TORQUE_LINE_RETURNED;
    const bool bounded = is_bounded(now);
    if (solved_bounds(limits) - (bounded ? 1 : 0) > MOST_SOLVED ||
        (bounded && now[battery].torque_mNm != FEASIBLE_UNBOUNDED)) {
        return;
    }
    const motor_model_t model = motor_model_at(motor, config, state->expected.speed_mrad_s,
                                               state->expected.winding_temperature_cC);
    const feasible_set_t set = feasible_set_at(&model, state->expected.phase_voltage_mV);
    int32_t cap_mNm =
        q_min(config->motor.max_torque_mNm, expected[TORQUE_LINE_MAX_POWER].torque_mNm);
    if (bounded) {
        cap_mNm = q_min(cap_mNm, q_min(expected[TORQUE_LINE_PHASE_CURRENT].torque_mNm,
                                       expected[TORQUE_LINE_VOLTAGE].torque_mNm));
    }
    feasible_side_t side = feasible_side_at(&set, sign, cap_mNm);
    if (!bounded) {
        feasible_circle_t circle = {.known = false};
        const feasible_bounds_t ends = feasible_by_voltage_and_current(&side, &circle);
        expected[TORQUE_LINE_PHASE_CURRENT].torque_mNm = ends.current_mNm;
        expected[TORQUE_LINE_VOLTAGE].torque_mNm = ends.voltage_mNm;
    }
    if (now[battery].torque_mNm != FEASIBLE_UNBOUNDED) {
        return;
    }
    if (drives) {
        expected[battery].torque_mNm = feasible_by_drawn_mNm(&side, state->drawn_b);
    } else {
        loss_braking_t losses = limits->losses;
        losses.returned = (feasible_returned_t){
            .power_b = state->returned_b,
            .margin_b = limits->losses.returned.margin_b,
        };
        expected[battery].torque_mNm = loss_braking_torque_mNm(
            &side, &losses, feasible_by_returned_mNm(&side, losses.returned));
    }
}

static void expect_strategy(available_ahead_state_t *state, const config_t *config,
                            const torque_limits_t *limits)
{
    const available_slope_t *speed = &state->speed;
    const available_inputs_t *then = &state->expected;
    int32_t optimum_mNm = limits->braking[TORQUE_LINE_LOSS_OPTIMUM].torque_mNm;
    if (optimum_mNm != FEASIBLE_UNBOUNDED) { /* of the shaft: with the friction of now */
        optimum_mNm +=
            loss_maps_torque_mNm(config, then->speed_mrad_s, then->winding_temperature_cC) -
            loss_maps_torque_mNm(config, speed->value, state->winding.value);
    }
    torque_limits_strategy(state->braking_lines, config, then->speed_mrad_s, optimum_mNm,
                           then->brake_torque_mNm);
}

/* Deratings at the expected temperatures and speed; what has no slope as it is now. */
static void expect_other_lines(available_ahead_state_t *state, const config_t *config,
                               const torque_limits_t *limits)
{
    const available_inputs_t *then = &state->expected;
    limit_t *braking = state->braking_lines;
    for (torque_line_t line = 0; line < TORQUE_LINE_COUNT; line++) {
        if (STAYS[line]) {
            state->driving_lines[line] = limits->driving[line];
            braking[line] = limits->braking[line];
        }
    }
    limit_t *driving = state->driving_lines;
    driving[TORQUE_LINE_WINDING] = torque_limits_winding(config, then->winding_temperature_cC);
    driving[TORQUE_LINE_SWITCH] = torque_limits_switch(config, then->switch_temperature_cC);
    braking[TORQUE_LINE_WINDING] =
        torque_limits_braking_hot(driving[TORQUE_LINE_WINDING], limits->least_winding_mNm);
    braking[TORQUE_LINE_SWITCH] =
        torque_limits_braking_hot(driving[TORQUE_LINE_SWITCH], limits->least_switch_mNm);
    state->driving_lines[TORQUE_LINE_MAX_SPEED] =
        torque_limits_max_speed(config, then->speed_mrad_s);
}

static available_t available_of(const limit_t *driving, const limit_t *braking)
{
    const available_t out = {
        .driving = torque_limits_tightest(driving, 0, TORQUE_LINE_COUNT),
        .braking = torque_limits_tightest(braking, 0, TORQUE_LINE_COUNT),
    };
    return out;
}

void available_ahead_step(available_ahead_state_t *state, const motor_constants_t *motor,
                          const config_t *config, const torque_limits_t *limits,
                          const measured_t *now, int32_t phase_voltage_mV, int32_t brake_torque_mNm)
{
    const int32_t step_mNm = q_max(config->motor.max_torque_mNm >> STEP_LOG2, 1);
    const bool idle = state->step % PHASE_steps != 0;
    const uint32_t phase = state->step / PHASE_steps;
    state->step = (state->step + 1U) % AVAILABLE_AHEAD_ROUND_steps;
    if (idle) {
        return;
    }
    switch (phase) {
    case 0:
        expect_inputs(state, config, limits, now, phase_voltage_mV, brake_torque_mNm);
        break;
    case 1:
        carry(state->braking, state->braking_lines, limits->braking, &limits->losses, step_mNm);
        break;
    case 2:
        solve(state, motor, config, limits, SIDE_BRAKING);
        break;
    case 3:
        carry(state->driving, state->driving_lines, limits->driving, NULL, step_mNm);
        break;
    case 4:
        solve(state, motor, config, limits, SIDE_DRIVING);
        break;
    case 5:
        expect_strategy(state, config, limits);
        break;
    case 6:
        expect_other_lines(state, config, limits);
        break;
    default:
        state->now = available_of(limits->driving, limits->braking);
        state->ahead = available_of(state->driving_lines, state->braking_lines);
        break;
    }
}
