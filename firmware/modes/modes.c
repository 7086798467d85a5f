/* SPDX-License-Identifier: Apache-2.0 */
#include "modes/modes.h"

#include "core/fault.h"
#include "core/q15.h"

static uint32_t inverted_copy(const modes_state_t *state)
{
    return ~((uint32_t)state->mode << 16 | (uint32_t)state->fault);
}

void modes_init(modes_state_t *state)
{
    state->mode = MODE_BOOT;
    state->fault = REASON_NONE;
    state->warning = REASON_NONE;
    state->steps = 0;
    state->acknowledge_steps = 0;
    state->reset_before = false;
    state->fault_persists = false;
    state->offsets_stored = false;
    state->inverted = inverted_copy(state);
}

static void enter(modes_state_t *state, operating_mode_t mode)
{
    state->mode = mode;
    state->steps = 0;
    state->quiet_steps = 0;
}

static void fail(modes_state_t *state, reason_t fault)
{
    if (state->fault == REASON_NONE) {
        state->fault = fault;
        state->fault_persists = false;
    }
    enter(state, MODE_FAULT);
}

/* A rising edge of fault_reset is accepted only at rest and without a torque demand, and never for
 * a fault that only a restart clears. It stays pending for some steps, because the fast loop must
 * clear its trip and check again before the monitor reports no fault. */
static bool acknowledgement_pending(modes_state_t *state, const modes_input_t *in)
{
    const bool edge = in->fault_reset && !state->reset_before;
    state->reset_before = in->fault_reset;
    const bool quiet = !in->torque_demanded && in->at_rest;
    const bool allowed = state->mode == MODE_FAULT && quiet &&
                         fault_clearing(state->fault) != FAULT_CLEARING_RESTART;
    if (edge && quiet) {
        state->warning = REASON_NONE;
    }
    if (!allowed) {
        state->acknowledge_steps = 0;
    } else if (edge) {
        state->acknowledge_steps = MODES_ACKNOWLEDGE_STEPS;
        state->fault_persists = false;
    } else if (state->acknowledge_steps > 0) {
        state->acknowledge_steps--;
        state->fault_persists = state->acknowledge_steps == 0;
    }
    return state->acknowledge_steps > 0;
}

static void latch_warning(modes_state_t *state, const modes_input_t *in)
{
    const bool runs = state->mode == MODE_RUN || state->mode == MODE_LIMP;
    if (runs && in->enable && in->demand_lost) {
        state->warning = in->lost_reason;
    }
}

static void calibrate(modes_state_t *state, const config_modes_t *config, const modes_input_t *in)
{
    if (in->emf_conducts) { /* no zero to be seen: after a while the stored offsets serve */
        state->quiet_steps = 0;
        if (state->steps >= config->offset_wait_ms) {
            state->offsets_stored = true;
            enter(state, MODE_READY);
        }
        return;
    }
    state->quiet_steps = (uint16_t)q_min(state->quiet_steps + 1, UINT16_MAX);
    if (state->quiet_steps < MODES_CALIBRATION_SETTLE_STEPS) {
        return; /* the fast loop has not read the request yet: its result would be that of the
                   last calibration */
    }
    if (in->offsets_done) {
        if (in->offsets_plausible) {
            state->offsets_stored = false;
            enter(state, MODE_READY);
        } else {
            fail(state, REASON_OFFSET_IMPLAUSIBLE);
        }
    } else if (state->quiet_steps >= MODES_CALIBRATION_TIMEOUT_STEPS) {
        fail(state, REASON_OFFSET_IMPLAUSIBLE);
    }
}

static void advance(modes_state_t *state, const config_modes_t *config, const modes_input_t *in,
                    bool acknowledged)
{
    switch (state->mode) {
    case MODE_BOOT:
        if (in->config_accepted) {
            enter(state, MODE_SELFTEST);
        }
        break;
    case MODE_SELFTEST:
        if (in->selftest_passed) {
            enter(state, MODE_OFFSET_CAL);
        } else if (state->steps >= config->selftest_timeout_ms) {
            fail(state, REASON_SELFTEST_FAILED);
        }
        break;
    case MODE_OFFSET_CAL:
        calibrate(state, config, in);
        break;
    case MODE_READY:
        if (in->enable && !in->demand_lost && !in->drive_demanded && in->rotor_valid) {
            enter(state, MODE_RUN);
        }
        break;
    case MODE_RUN:
    case MODE_LIMP:
        if (!in->enable && !in->rolling) {
            enter(state, MODE_READY); /* never while rolling: switching off must not take the
                                         electric brake away */
        } else {
            const bool warning =
                (in->warning && fault_reaction(in->warning_reason) != FAULT_REACTION_NONE) ||
                state->offsets_stored;
            if (warning != (state->mode == MODE_LIMP)) {
                enter(state, warning ? MODE_LIMP : MODE_RUN);
            }
        }
        break;
    case MODE_FAULT:
        if (acknowledged) { /* and no fault is present: modes_step() */
            state->fault = REASON_NONE;
            state->acknowledge_steps = 0;
            enter(state, MODE_SELFTEST);
        }
        break;
    }
}

static reason_t present_warning(const modes_state_t *state, const modes_input_t *in)
{
    return !in->warning && state->offsets_stored ? REASON_OFFSETS_STORED : in->warning_reason;
}

static torque_enable_t torque_enable_of(const modes_state_t *state, const config_modes_t *config,
                                        const modes_input_t *in)
{
    torque_enable_t out = {.drive_q15 = 0, .brake_q15 = 0, .reason = REASON_TORQUE_ENABLE};
    switch (state->mode) {
    case MODE_RUN:
        out.drive_q15 = Q15_ONE;
        out.brake_q15 = Q15_ONE;
        out.reason = REASON_NONE;
        if (!in->enable) { /* switched off while rolling: braking only */
            out.drive_q15 = 0;
            out.reason = REASON_TORQUE_ENABLE;
        }
        break;
    case MODE_LIMP:
        out.drive_q15 = (int16_t)(in->enable ? config->limp_drive_share_q15 : 0);
        out.brake_q15 = Q15_ONE;
        out.reason = present_warning(state, in);
        break;
    case MODE_FAULT:
        out.reason = state->fault;
        break;
    case MODE_BOOT:
        out.reason = REASON_CONFIG_INVALID;
        break;
    case MODE_SELFTEST:
    case MODE_OFFSET_CAL:
        break;
    case MODE_READY:
        out.reason = in->rotor_valid ? REASON_TORQUE_ENABLE : REASON_ROTOR_UNCERTAIN;
        break;
    }
    if (in->battery_lost && torque_enable_any(out)) {
        out.drive_q15 = 0;
        out.brake_q15 = 0;
        /* Without a name in the first millisecond. */
        out.reason = in->warning_reason != REASON_NONE ? in->warning_reason : REASON_TORQUE_ENABLE;
    }
    return out;
}

/* What keeps READY from RUN, and then what keeps RUN from driving. */
static waits_for_t of_the_driver(const modes_input_t *in)
{
    if (!in->enable) {
        return WAITS_FOR_ENABLE;
    }
    return in->demand_lost ? WAITS_FOR_DEMAND_LINK : WAITS_FOR_NONE;
}

static waits_for_t waits_for(const modes_state_t *state, const modes_input_t *in)
{
    waits_for_t out = WAITS_FOR_NONE;
    switch (state->mode) {
    case MODE_BOOT:
        return WAITS_FOR_CONFIGURATION;
    case MODE_SELFTEST:
        return WAITS_FOR_SELFTEST;
    case MODE_OFFSET_CAL:
        return in->emf_conducts ? WAITS_FOR_LOWER_SPEED : WAITS_FOR_OFFSETS;
    case MODE_READY:
        out = of_the_driver(in);
        if (out == WAITS_FOR_NONE && in->drive_demanded) {
            out = WAITS_FOR_PEDAL_RELEASE;
        }
        return out == WAITS_FOR_NONE && !in->rotor_valid ? WAITS_FOR_ROTOR_ANGLE : out;
    case MODE_RUN:
    case MODE_LIMP:
        out = in->battery_lost ? WAITS_FOR_BATTERY : of_the_driver(in);
        return out == WAITS_FOR_NONE && in->neutral ? WAITS_FOR_DIRECTION : out;
    case MODE_FAULT:
        if (fault_clearing(state->fault) == FAULT_CLEARING_RESTART) {
            return WAITS_FOR_RESTART;
        }
        if (in->torque_demanded || !in->at_rest) {
            return WAITS_FOR_REST;
        }
        return state->fault_persists ? WAITS_FOR_FAULT_CAUSE : WAITS_FOR_ACKNOWLEDGEMENT;
    }
    return out;
}

/* Stored offsets are replaced by measured ones as soon as the open bridge of a coasting wheel shows
 * zero current. */
static bool calibrates_offsets(const modes_state_t *state, const modes_input_t *in)
{
    const bool coasts = state->offsets_stored && in->bridge == BRIDGE_OFF;
    return (state->mode == MODE_OFFSET_CAL || coasts) && !in->emf_conducts;
}

/* The monitor's fault, or what was good at the start and is withdrawn. */
static reason_t present_fault(const modes_state_t *state, const modes_input_t *in)
{
    if (in->fault == REASON_NONE && !in->config_accepted) {
        return REASON_CONFIG_INVALID;
    }
    const bool was_passed = state->mode != MODE_SELFTEST;
    return in->fault == REASON_NONE && was_passed && !in->selftest_passed ? REASON_SELFTEST_FAILED
                                                                          : in->fault;
}

modes_output_t modes_step(modes_state_t *state, const config_t *config, const modes_input_t *in)
{
    if (state->inverted != inverted_copy(state)) {
        state->fault = REASON_MEMORY;
        enter(state, MODE_FAULT);
    }
    const bool acknowledged = acknowledgement_pending(state, in);
    state->steps = (uint16_t)q_min(state->steps + 1, UINT16_MAX);
    if (state->offsets_stored && in->offsets_done && in->offsets_plausible) {
        state->offsets_stored = false;
    }
    const reason_t fault = present_fault(state, in);
    if (fault != REASON_NONE && state->mode != MODE_BOOT) {
        fail(state, fault);
    } else {
        advance(state, &config->modes, in, acknowledged);
    }
    latch_warning(state, in);
    state->inverted = inverted_copy(state);
    const reason_t present = present_warning(state, in);
    const modes_output_t out = {
        .mode = state->mode,
        .fault = state->fault,
        .warning = state->warning != REASON_NONE ? state->warning : present,
        .present_warning = present,
        .torque_enable = torque_enable_of(state, &config->modes, in),
        .waits_for = waits_for(state, in),
        .calibrate_offsets = calibrates_offsets(state, in),
        .clear_trip = acknowledged,
    };
    return out;
}
