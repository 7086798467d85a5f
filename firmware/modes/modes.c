/* SPDX-License-Identifier: Apache-2.0 */
#include "modes/modes.h"

#include "config/demand_age.h"
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
    state->released = false;
    state->fault_persists = false;
    state->offsets_stored = false;
    state->braking = slow_rise_init();
    state->taken_by = REASON_NONE;
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

/* What the driver asks for in this step. */
typedef struct {
    bool enable;
    bool lost;   /* the demand is older than its timeout */
    bool drives; /* driving alone, no lift-off braking: must end once before RUN */
    bool quiet;  /* at rest without a torque demand */
} request_t;

/* Lift-off braking, against the direction, is no driving: a released accelerator may demand it. */
static bool drive_demanded(const wheel_demand_t *demand)
{
    const int32_t sign = drive_direction_sign(demand->direction);
    const int32_t drive_mNm = demand->drive_torque_mNm;
    return sign > 0 ? drive_mNm > 0 : sign < 0 ? drive_mNm < 0 : drive_mNm != 0;
}

/* The warnings of this step. */
typedef struct {
    reason_t reason;    /* of the first one; REASON_NONE: there is none */
    finding_t limiting; /* the first one that leaves less torque; FINDING_COUNT: none does */
    reason_t limiting_reason;
    bool off; /* a finding takes all torque away, named or not */
} warning_t;

static warning_t warning_of(const findings_t *findings)
{
    const finding_t limiting = findings_limiting(findings);
    const warning_t out = {.reason = findings_reason(findings, findings_warning(findings)),
                           .limiting = limiting,
                           .limiting_reason = findings_reason(findings, limiting),
                           .off = findings_off(findings)};
    return out;
}

static request_t request_of(const config_t *config, const slow_input_t *in, bool at_rest)
{
    const bool drives = drive_demanded(&in->demand);
    const request_t out = {
        .enable = in->demand.enable,
        .lost = demand_is_lost(config, in->demand_age_ms),
        .drives = drives,
        .quiet = at_rest && !drives && in->demand.brake_torque_mNm <= 0,
    };
    return out;
}

/* The rotor's angle may be used for torque, or an observer will find it as soon as the bridge
 * switches. */
static bool angle_ready(const config_t *config, const measured_t *now, const monitored_t *watch)
{
    return now->angle_valid || (now->angle_by == ANGLE_BY_OBSERVER &&
                                watch->bound_mrad_s >= config->rotor.observer_speed_mrad_s);
}

/* A rising edge of fault_reset is accepted only at rest and without a torque demand, and never for
 * a fault that only a restart clears. It stays pending for some steps, because the fast loop must
 * clear its trip and check again before no fault is present. */
static bool acknowledgement_pending(modes_state_t *state, bool reset, bool quiet)
{
    const bool edge = reset && !state->reset_before;
    state->reset_before = reset;
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

/* Why a demand was lost: its timeout, or the sensor that made it be lost. */
static void latch_warning(modes_state_t *state, const request_t *request, reason_t demand_reason)
{
    const bool runs = state->mode == MODE_RUN || state->mode == MODE_LIMP;
    if (runs && request->enable && request->lost) {
        const bool sensor = (int)demand_reason >= REASON_FIRST_FAULT;
        state->warning = sensor ? demand_reason : REASON_DEMAND_TIMEOUT;
    }
}

/* While the EMF drives a current there is no zero to be seen: after a while the stored offsets
 * serve. */
static bool offsets_waited(const modes_state_t *state, const config_modes_t *config,
                           const monitored_t *watch)
{
    return state->mode == MODE_OFFSET_CAL && watch->emf_conducts &&
           state->steps >= config->offset_wait_ms;
}

static void calibrate(modes_state_t *state, const config_modes_t *config, const monitored_t *watch,
                      bool offsets_done)
{
    state->quiet_steps =
        (uint16_t)(watch->emf_conducts ? 0 : q_min(state->quiet_steps + 1, UINT16_MAX));
    const bool measured = state->quiet_steps >= MODES_CALIBRATION_SETTLE_STEPS && offsets_done;
    if (measured || offsets_waited(state, config, watch)) {
        enter(state, MODE_READY);
    }
}

/* RUN and LIMP. Never to READY while rolling: switching off must not take the electric brake
 * away. */
static void run(modes_state_t *state, const request_t *request, bool rolling, bool limited)
{
    if (!request->enable && !rolling) {
        enter(state, MODE_READY);
        return;
    }
    const bool limps = limited || state->offsets_stored;
    if (limps != (state->mode == MODE_LIMP)) {
        enter(state, limps ? MODE_LIMP : MODE_RUN);
    }
}

/* The accelerator that was held while switched on, at standstill or rolling, has been released. */
static void await_release(modes_state_t *state, const request_t *request)
{
    state->released = request->enable && (state->released || (!request->lost && !request->drives));
}

static void advance(modes_state_t *state, const config_t *config, const measured_t *now,
                    const monitored_t *watch, const slow_input_t *in, const request_t *request,
                    bool acknowledged, bool limited)
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
        }
        break;
    case MODE_OFFSET_CAL:
        calibrate(state, &config->modes, watch, now->report->offsets_done);
        break;
    case MODE_READY:
        if (state->released && !request->lost && !request->drives &&
            angle_ready(config, now, watch)) {
            enter(state, MODE_RUN);
        }
        break;
    case MODE_RUN:
    case MODE_LIMP:
        run(state, request, watch->bound_mrad_s > config->brake.blend_out_end_mrad_s, limited);
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

static torque_enable_t torque_enable_of(const modes_state_t *state, const config_modes_t *config,
                                        bool ready, const warning_t *warning)
{
    torque_enable_t out = {.drive_q15 = 0, .brake_q15 = 0, .reason = REASON_TORQUE_ENABLE};
    switch (state->mode) {
    case MODE_RUN:
        out.drive_q15 = Q15_ONE;
        out.brake_q15 = Q15_ONE;
        out.reason = REASON_NONE;
        if (!state->released) { /* switched off while rolling: braking only */
            out.drive_q15 = 0;
            out.reason = REASON_TORQUE_ENABLE;
        }
        break;
    case MODE_LIMP:
        out.drive_q15 = (int16_t)(state->released ? config->limp_drive_share_q15 : 0);
        out.brake_q15 = Q15_ONE;
        out.reason = warning->limiting_reason;
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
        out.reason = ready ? REASON_TORQUE_ENABLE : REASON_ROTOR_UNCERTAIN;
        break;
    }
    if (warning->off && torque_enable_any(out)) {
        out.drive_q15 = 0;
        out.brake_q15 = 0;
        /* Without a name in the first millisecond; stored offsets take no torque away. */
        out.reason = warning->limiting < FINDING_OFFSETS_OLD ? warning->limiting_reason
                                                             : REASON_TORQUE_ENABLE;
    }
    return out;
}

/* Braking torque that a finding has taken away comes back slowly: the other brake, which has it
 * then, follows a finding that comes and goes with its delay. */
static torque_enable_t returning(modes_state_t *state, torque_enable_t enable, bool taken)
{
    state->taken_by = taken ? enable.reason : state->taken_by;
    const int32_t share_q15 = slow_rise_step(&state->braking, taken ? 0 : Q15_ONE, Q15_ONE);
    if (share_q15 < enable.brake_q15) {
        enable.brake_q15 = (int16_t)share_q15;
        enable.reason = enable.reason == REASON_NONE ? state->taken_by : enable.reason;
    }
    return enable;
}

/* What torque waits for that a finding takes away; NONE: none does. */
static waits_for_t off_waits_for(const warning_t *warning)
{
    const bool hot =
        warning->limiting == FINDING_WINDING_HOT || warning->limiting == FINDING_SWITCH_HOT;
    return !warning->off ? WAITS_FOR_NONE : hot ? WAITS_FOR_COOLING : WAITS_FOR_BATTERY;
}

/* What keeps READY from RUN, or RUN from driving. */
static waits_for_t of_the_driver(const request_t *request, bool pedal)
{
    if (!request->enable) {
        return WAITS_FOR_ENABLE;
    }
    if (request->lost) {
        return WAITS_FOR_DEMAND_LINK;
    }
    return pedal ? WAITS_FOR_PEDAL_RELEASE : WAITS_FOR_NONE;
}

static waits_for_t waits_for(const modes_state_t *state, const monitored_t *watch,
                             const request_t *request, bool ready, waits_for_t off, bool neutral)
{
    waits_for_t out = WAITS_FOR_NONE;
    switch (state->mode) {
    case MODE_BOOT:
        return WAITS_FOR_CONFIGURATION;
    case MODE_SELFTEST:
        return WAITS_FOR_SELFTEST;
    case MODE_OFFSET_CAL:
        return watch->emf_conducts ? WAITS_FOR_LOWER_SPEED : WAITS_FOR_OFFSETS;
    case MODE_READY:
        out = of_the_driver(request, request->drives);
        return out == WAITS_FOR_NONE && !ready ? WAITS_FOR_ROTOR_ANGLE : out;
    case MODE_RUN:
    case MODE_LIMP:
        out = off != WAITS_FOR_NONE ? off : of_the_driver(request, !state->released);
        return out == WAITS_FOR_NONE && neutral ? WAITS_FOR_DIRECTION : out;
    case MODE_FAULT:
        if (fault_clearing(state->fault) == FAULT_CLEARING_RESTART) {
            return WAITS_FOR_RESTART;
        }
        if (!request->quiet) {
            return WAITS_FOR_REST;
        }
        return state->fault_persists ? WAITS_FOR_FAULT_CAUSE : WAITS_FOR_ACKNOWLEDGEMENT;
    }
    return out;
}

/* Stored offsets are replaced by measured ones as soon as the open bridge of a coasting wheel shows
 * zero current. */
static bool calibrates_offsets(const modes_state_t *state, bool open, bool emf_conducts)
{
    const bool coasts = state->offsets_stored && open;
    return (state->mode == MODE_OFFSET_CAL || coasts) && !emf_conducts;
}

/* Offsets that are implausible, or whose averaging does not come to its end. In its first steps the
 * fast loop has not read the request yet: its result would be that of the last calibration. */
static bool calibration_fails(const modes_state_t *state, const monitored_t *watch,
                              bool offsets_done)
{
    const int32_t quiet_steps = state->quiet_steps + 1;
    if (state->mode != MODE_OFFSET_CAL || watch->emf_conducts ||
        quiet_steps < MODES_CALIBRATION_SETTLE_STEPS) {
        return false;
    }
    return offsets_done ? !watch->offsets_plausible
                        : quiet_steps >= MODES_CALIBRATION_TIMEOUT_STEPS;
}

/* What the start lacks, also when it is withdrawn later. */
static reason_t start_fails(const modes_state_t *state, const config_modes_t *config,
                            const slow_input_t *in, bool calibration_failed)
{
    const bool over = state->mode != MODE_SELFTEST || state->steps >= config->selftest_timeout_ms;
    if (!in->config_accepted) {
        return REASON_CONFIG_INVALID;
    }
    if (over && !in->selftest_passed) {
        return REASON_SELFTEST_FAILED;
    }
    return calibration_failed ? REASON_OFFSET_IMPLAUSIBLE : REASON_NONE;
}

modes_output_t modes_step(modes_state_t *state, const config_t *config, const measured_t *now,
                          const monitored_t *watch, const last_t *last, const slow_input_t *in,
                          findings_t *findings)
{
    const bool damaged = state->inverted != inverted_copy(state);
    if (damaged) {
        state->fault = REASON_MEMORY;
        enter(state, MODE_FAULT);
    }
    const request_t request = request_of(config, in, watch->at_rest);
    await_release(state, &request);
    const bool acknowledged = acknowledgement_pending(state, in->demand.fault_reset, request.quiet);
    const bool measured = now->report->offsets_done && watch->offsets_plausible;
    state->steps = (uint16_t)q_min(state->steps + 1, UINT16_MAX);
    const bool calibration_failed = calibration_fails(state, watch, now->report->offsets_done);
    findings_set_named(findings, FINDING_CONFIGURATION, FINDING_OFFSETS_WRONG,
                       start_fails(state, &config->modes, in, calibration_failed));
    findings_set_named(findings, FINDING_ACCELERATOR, FINDING_DEMAND_REFUSED, in->demand.reason);
    findings_set(findings, FINDING_STATE_DAMAGED, damaged);
    const finding_t fault = findings_fault(findings);
    state->offsets_stored =
        (state->offsets_stored && !measured) ||
        (fault == FINDING_COUNT && offsets_waited(state, &config->modes, watch));
    findings_set(findings, FINDING_OFFSETS_OLD, state->offsets_stored);
    const warning_t warning = warning_of(findings);
    if (fault != FINDING_COUNT && state->mode != MODE_BOOT) {
        fail(state, findings_reason(findings, fault));
    } else {
        advance(state, config, now, watch, in, &request, acknowledged,
                warning.limiting != FINDING_COUNT);
    }
    latch_warning(state, &request, in->demand.reason);
    state->inverted = inverted_copy(state);

    const bool ready = angle_ready(config, now, watch);
    const torque_enable_t enable = torque_enable_of(state, &config->modes, ready, &warning);
    const bool alone = config->driver.no_other_brake != 0;
    const modes_output_t out = {
        .mode = state->mode,
        .fault = state->fault,
        .warning = state->warning != REASON_NONE ? state->warning : warning.reason,
        .present_warning = warning.reason,
        .torque_enable = alone ? enable : returning(state, enable, warning.off),
        .waits_for = waits_for(state, watch, &request, ready, off_waits_for(&warning),
                               last->engaged == DRIVE_DIRECTION_NEUTRAL),
        .calibrate_offsets =
            calibrates_offsets(state, now->report->bridge == BRIDGE_OFF, watch->emf_conducts),
        .clear_trip = acknowledged,
    };
    return out;
}
