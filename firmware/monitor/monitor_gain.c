/* SPDX-License-Identifier: Apache-2.0 */
#include "monitor/monitor_gain.h"

#include "core/q15.h"
#include "core/scaled.h"

enum { MOST_BUS_mV = 2000000, CHARGE_LOG2 = 10 };

void monitor_gain_restart(monitor_gain_state_t *state)
{
    const monitor_gain_state_t fresh = {.wrong = false};
    *state = fresh;
}

/* The sums of the window as well, which the next one clears: add(). */
static void forget(monitor_gain_state_t *state)
{
    state->steps = 0;
    state->follows = false;
    state->wrong = false;
    state->missing_q15 = 0;
}

static int32_t delay_ms(const config_t *config)
{
    return config->battery.current_filter_ms + MONITOR_GAIN_MESSAGE_ms;
}

/* The charges of a window, in units of 1024 uC, which fit 32 bits. */
static int32_t charge(int64_t charge_uC)
{
    return (int32_t)(charge_uC >> CHARGE_LOG2);
}

static void add(monitor_gain_state_t *state, int32_t loop_mA, int32_t battery_mA)
{
    if (state->steps == 0) {
        state->loop_uC = 0;
        state->battery_uC = 0;
        state->moved_uC = 0;
        state->loop_low_mA = loop_mA;
        state->loop_high_mA = loop_mA;
        state->battery_low_mA = battery_mA;
        state->battery_high_mA = battery_mA;
        state->begin_mA = battery_mA;
    }
    state->loop_uC += loop_mA; /* 1 mA for 1 ms is 1 uC */
    state->battery_uC += battery_mA;
    state->moved_uC += q_abs(loop_mA);
    state->loop_low_mA = q_min(state->loop_low_mA, loop_mA);
    state->loop_high_mA = q_max(state->loop_high_mA, loop_mA);
    state->battery_low_mA = q_min(state->battery_low_mA, battery_mA);
    state->battery_high_mA = q_max(state->battery_high_mA, battery_mA);
    state->steps++;
}

/* The difference of the charges less what a delay of the message explains: none of it, or all of
 * it, times the change of the battery's current. */
typedef struct {
    int64_t least, most; /* magnitude for any delay between */
} unexplained_t;

static int64_t magnitude(int64_t x)
{
    return x < 0 ? -x : x;
}

static unexplained_t unexplained(const monitor_gain_state_t *state, const config_t *config,
                                 int32_t battery_mA)
{
    const int64_t change_mA = (int64_t)battery_mA - state->begin_mA;
    const int64_t in_time = (int64_t)charge(state->loop_uC) - charge(state->battery_uC);
    const int64_t late = in_time - charge(change_mA * delay_ms(config));
    const int64_t one = magnitude(in_time);
    const int64_t other = magnitude(late);
    const unexplained_t out = {
        .least = (in_time > 0) != (late > 0) ? 0
                 : one < other               ? one
                                             : other,
        .most = one > other ? one : other,
    };
    return out;
}

/* A share of the current that flows by the battery; none where it is less than the loop's. */
static int32_t missing_q15(const monitor_gain_state_t *state)
{
    const int32_t flows = q_abs(charge(state->battery_uC));
    const int32_t missing = flows - q_abs(charge(state->loop_uC));
    return missing <= 0 ? 0
                        : q_min(scaled_ratio(missing, flows) >> 9, MONITOR_GAIN_MOST_MISSING_Q15);
}

/* At the end of a window. mA mV = uW = mN m mrad/s, and 1024 uC mV = 1024 nJ. */
static void judge(monitor_gain_state_t *state, const config_t *config, int32_t battery_mA,
                  int64_t bus_mV)
{
    const int64_t rated_uW =
        (int64_t)config->motor.rated_torque_mNm * config->motor.max_speed_mrad_s;
    const int64_t rated = (rated_uW >> CHARGE_LOG2) * state->steps;
    const int32_t loop_span_mA = state->loop_high_mA - state->loop_low_mA;
    const int32_t battery_span_mA = state->battery_high_mA - state->battery_low_mA;
    if (loop_span_mA * bus_mV >= rated_uW / MONITOR_GAIN_MOVES) {
        state->follows = battery_span_mA >= loop_span_mA / MONITOR_GAIN_FOLLOWS;
    }
    const int64_t moved = charge(state->moved_uC);
    if (!state->follows) {
        state->wrong = false;
    } else if (moved * bus_mV >= rated / MONITOR_GAIN_LEAST) {
        const unexplained_t beyond = unexplained(state, config, battery_mA);
        const int64_t extra = rated / MONITOR_GAIN_EXTRA * MONITOR_GAIN_TOLERANCE;
        const bool contradicts = (beyond.least * MONITOR_GAIN_TOLERANCE - moved) * bus_mV > extra;
        const bool agrees = (beyond.most * MONITOR_GAIN_TOLERANCE - moved) * bus_mV <= extra;
        state->missing_q15 = contradicts ? missing_q15(state) : state->missing_q15;
        state->wrong = contradicts || (state->wrong && !agrees);
    }
    state->missing_q15 = state->wrong ? state->missing_q15 : 0;
}

bool monitor_gain_step(monitor_gain_state_t *state, const config_t *config, const measured_t *now,
                       bool known)
{
    if (!now->battery->current_given || measured_battery_open(now) ||
        config->battery.driven_wheels != 1) {
        forget(state);
        return false;
    }
    if (!known) {
        state->steps = 0;
        return state->wrong;
    }
    const int32_t battery_mA = q_limit(now->battery->current_mA, MONITOR_GAIN_MOST_mA);
    const int32_t loop_mA = q_limit(now->bus_current_mA, MONITOR_GAIN_MOST_mA);
    add(state, measured_switching(now) ? loop_mA : 0, battery_mA);
    if (state->steps >= MONITOR_GAIN_WINDOW * delay_ms(config)) {
        judge(state, config, battery_mA, q_clamp(now->bus_voltage_mV, 0, MOST_BUS_mV));
        state->steps = 0;
    }
    return state->wrong;
}
