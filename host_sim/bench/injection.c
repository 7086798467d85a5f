/* SPDX-License-Identifier: Apache-2.0 */
#include "bench/injection.h"

#include <math.h>
#include <stddef.h>

#include "config/bases.h"
#include "config/validate.h"

enum { BITS = 8, PHASES = 3 };
static const double ON = 0.5; /* a switch given as a number */

/* Where a bit of the state may flip: fault_params_t.state_part. */
typedef struct {
    size_t at_bytes, size_bytes;
} part_t;

#define PART(member)                                                                               \
    {                                                                                              \
        offsetof(controller_t, member), sizeof(((controller_t *)NULL)->member)                     \
    }
/* An enumeration has one byte on the target, the lowest of those here. */
#define ENUMERATION(member)                                                                        \
    {                                                                                              \
        offsetof(controller_t, member), 1                                                          \
    }

static const part_t PARTS[] = {
    {0, sizeof(controller_t)},
    ENUMERATION(slow.modes.mode),
    ENUMERATION(slow.modes.fault),
    ENUMERATION(fast.monitor.trip),
    PART(fast.monitor.overcurrent_square),
    PART(fast.monitor.overvoltage_pu),
};

enum { PART_COUNT = sizeof(PARTS) / sizeof(PARTS[0]) };

bool injection_present(const fault_params_t *p)
{
#define PRESENT(name, lowest, highest, unit, text) || p->name != 0.0
    return p->hydraulic_late_s != 0.0 PROGRAM_FAULT_PARAMETERS(PRESENT);
#undef PRESENT
}

bool config_watch_step(config_watch_t *watch, const config_t *config)
{
    if (watch->program_ms > 0) {
        watch->program_ms--;
        return watch->damaged;
    }
    const uint32_t size_bytes = (uint32_t)offsetof(config_t, crc32);
    const uint32_t left_bytes = size_bytes - watch->at_bytes;
    const uint32_t part_bytes = left_bytes < CONFIG_WATCH_BYTES ? left_bytes : CONFIG_WATCH_BYTES;
    const unsigned char *bytes = (const unsigned char *)config;
    watch->crc = config_crc32_continue(watch->crc, &bytes[watch->at_bytes], part_bytes);
    watch->at_bytes += part_bytes;
    if (watch->at_bytes == size_bytes) {
        const config_watch_t next = {.program_ms = CONFIG_WATCH_PROGRAM_MS,
                                     .damaged = watch->damaged || watch->crc != config->crc32};
        *watch = next;
    }
    return watch->damaged;
}

/* As the application does, with what its retained memory holds. */
static void restart(const injection_target_t *target, bool cold)
{
    controller_slow_t *slow = &target->controller->slow;
    const int32_t warmest_cC = cold ? TEMPERATURE_NONE_cC : controller_warmest_cC(slow);
    const hill_hold_kept_t none = {.direction = DRIVE_DIRECTION_NEUTRAL};
    const hill_hold_kept_t kept = cold ? none : controller_hold(slow);
    controller_init(target->controller, target->config, BASES_MODEL_TIMER_Hz);
    controller_start_warm(slow, warmest_cC);
    controller_start_hold(slow, kept);
    *target->to_fast = controller_initial_setpoint(target->config, BASES_MODEL_TIMER_Hz);
}

static void flip(controller_t *controller, uint32_t part, uint32_t bit)
{
    const part_t *where = &PARTS[part % PART_COUNT];
    unsigned char *bytes = (unsigned char *)controller;
    bytes[where->at_bytes + bit / BITS % where->size_bytes] ^= (unsigned char)(1U << bit % BITS);
}

/* Whether the rates of both loops are within what the supervisor accepts. */
static bool may_feed(const fault_params_t *p)
{
    return p->slow_stopped < ON && p->slow_doubled < ON && p->fast_stopped < ON &&
           p->fast_doubled < ON;
}

static slow_output_t step(const injection_target_t *target, const slow_input_t *in, bool damaged)
{
    slow_input_t seen = *in;
    seen.selftest_passed = in->selftest_passed && !damaged;
    fast_report_t report;
    controller_fast_report(&target->controller->fast, &report);
    return controller_slow_step(&target->controller->slow, target->config, &report, &seen,
                                target->to_fast);
}

/* The vehicle goes on with the last message until it misses its counter. */
static slow_output_t without_message(const injection_t *state, const slow_output_t *last)
{
    slow_output_t out = {.mode = MODE_BOOT};
    if (!state->in_reset) {
        out = *last;
        if (state->silent_ms >= INJECTION_SLOW_STOPPED_MS) {
            out.mode = MODE_FAULT;
            out.fault_reason = REASON_PROGRAM_FLOW;
        }
    }
    out.hydraulic_torque_mNm = last->hydraulic_torque_mNm;
    out.hydraulic_valid = last->hydraulic_valid && state->silent_ms <= INJECTION_MESSAGES_LOST_MS;
    return out;
}

slow_output_t injection_slow(const fault_params_t *p, injection_t *state,
                             const injection_target_t *target, const slow_input_t *in,
                             const slow_output_t *last)
{
    state->unfed_ms = may_feed(p) ? 0 : state->unfed_ms + 1;
    state->reset_ms = state->reset_ms > 0 ? state->reset_ms - 1 : 0;
    const bool once = p->restart > ON && !state->has_restarted;
    if (state->unfed_ms > INJECTION_WATCHDOG_MS || once) {
        restart(target, once && p->restart_cold > ON);
        state->memory_damaged = false;
        state->reset_ms = once ? (int)lround(p->restart_s * 1e3) : 0;
        state->has_late = false;
    }
    state->has_restarted = p->restart > ON;
    state->in_reset = state->unfed_ms > INJECTION_WATCHDOG_MS || state->reset_ms > 0;
    if (p->slow_stopped < ON) { /* in the slow loop's interrupt */
        const bool off = state->fast_missing_ms >= INJECTION_FAST_STOPPED_MS && !state->in_reset;
        state->fast_missing_ms = p->fast_stopped > ON || off ? state->fast_missing_ms + 1 : 0;
    }
    if (state->has_flipped &&
        !monitor_fast_intact(&target->controller->fast.monitor, target->config)) {
        state->memory_damaged = true;
    }
    if (p->state_bit >= 1.0 && !state->has_flipped) {
        flip(target->controller, (uint32_t)p->state_part, (uint32_t)p->state_bit - 1U);
    }
    state->has_flipped = p->state_bit >= 1.0;
    if (state->in_reset || p->slow_stopped > ON) {
        state->silent_ms++;
        return without_message(state, last);
    }
    state->silent_ms = 0;
    const fast_setpoint_t before = *target->to_fast;
    slow_output_t out = step(target, in, state->memory_damaged);
    if (p->slow_doubled > ON) {
        out = step(target, in, state->memory_damaged);
    }
    if (p->slow_late > ON) {
        const fast_setpoint_t newest = *target->to_fast;
        *target->to_fast = state->has_late ? state->late_setpoint : before;
        state->late_setpoint = newest;
    }
    state->has_late = p->slow_late > ON;
    return out;
}

/* A timer whose compare value is beyond its period keeps the leg high: that is all a wrong one
 * does.
 */
static fast_output_t within_period(const config_t *config, fast_output_t out)
{
    const uint16_t most = (uint16_t)bases_pwm_period_counts(config, BASES_MODEL_TIMER_Hz);
    for (int k = 0; k < PHASES; k++) {
        out.compare_counts[k] = out.compare_counts[k] < most ? out.compare_counts[k] : most;
    }
    return out;
}

/* Latched. */
static bool is_stopped(const injection_t *state)
{
    return state->fast_missing >= INJECTION_STOPPED_PERIODS ||
           state->fast_missing_ms >= INJECTION_FAST_STOPPED_MS;
}

void injection_fast(const fault_params_t *p, injection_t *state, const injection_target_t *target,
                    const fast_input_t *in, fast_output_t *next)
{
    if (state->in_reset) {
        const fast_output_t off = {.compare_counts = {0, 0, 0}, .bridge = BRIDGE_OFF};
        *next = off;
        state->fast_missing = 0;
        return;
    }
    if (p->fast_stopped > ON || is_stopped(state)) {
        state->fast_missing += next->bridge == BRIDGE_PWM ? 1 : 0;
        next->bridge = is_stopped(state) ? BRIDGE_OFF : next->bridge;
        return;
    }
    state->fast_missing = 0;
    controller_fast_t *fast = &target->controller->fast;
    fast_output_t newest = *controller_fast_step(fast, target->config, target->to_fast, in);
    if (p->fast_doubled > ON) {
        newest = *controller_fast_step(fast, target->config, target->to_fast, in);
    }
    newest = within_period(target->config, newest);
    if (p->fast_late > ON) {
        *next = state->late_output;
        state->late_output = newest;
    } else {
        *next = newest;
        state->late_output = newest;
    }
}

double injection_hydraulic_nm(const fault_params_t *p, injection_t *state, double command_nm)
{
    const int length = INJECTION_LATE_MS_MAX + 1;
    state->commands_nm[state->next_command] = command_nm;
    const int late_ms = (int)lround(p->hydraulic_late_s * 1e3);
    const int seen = (state->next_command + length - late_ms) % length;
    state->next_command = (state->next_command + 1) % length;
    return state->commands_nm[seen];
}

void injection_brake_step(const fault_params_t *p, injection_t *state)
{
    state->flickers_ms = p->hydraulic_flicker_s > 0.0 ? state->flickers_ms + 1 : 0;
    state->report_drift += p->hydraulic_report_drift_per_s * 1e-3;
}

/* In turn, from the first moment on. */
static bool is_lost(const fault_params_t *p, const injection_t *state)
{
    return state->flickers_ms > 0 && fmod((state->flickers_ms - 1) * 1e-3,
                                          2.0 * p->hydraulic_flicker_s) < p->hydraulic_flicker_s;
}

double injection_brake_share(const fault_params_t *p, const injection_t *state)
{
    return is_lost(p, state) ? 1.0 - p->hydraulic_flicker_loss : 1.0;
}

double injection_report_nm(const fault_params_t *p, const injection_t *state, double reported_nm,
                           double largest_nm)
{
    const double lost = is_lost(p, state) ? p->hydraulic_report_flicker_loss : 0.0;
    const double shown_nm = reported_nm * (1.0 + state->report_drift - lost);
    return p->hydraulic_report_stuck > ON ? p->hydraulic_report_shown * largest_nm
                                          : shown_nm + p->hydraulic_report_offset * largest_nm;
}
