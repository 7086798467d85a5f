/* SPDX-License-Identifier: Apache-2.0 */
/*
 * modes_rig.h: the state machine of the modes after init, the case `in` that it sees, and the
 * sequence of cases that leads to each mode. Included once in a program.
 */
#ifndef MODES_RIG_H
#define MODES_RIG_H

#include "core/q15.h"
#include "modes/modes.h"
#include "paper_vehicle.h"
#include "unity.h"

enum { ROLLING_mrad_s = 100000 /* well above the hand-over speed */ };

/* What modes_step() reads of its records. */
typedef struct {
    bool config_accepted, selftest_passed;
    bool offsets_done, offsets_plausible;
    bool angle_valid;
    angle_by_t angle_by;
    int32_t bound_mrad_s; /* the speed upper bound */
    bool at_rest;
    bool enable;
    bool demand_lost; /* older than its timeout */
    reason_t demand_reason;
    bool drive_demanded, brake_demanded;
    bool neutral; /* no drive direction is engaged */
    bool fault_reset;
    finding_t warning; /* a row of another part's check; FINDING_COUNT: none */
    reason_t fault;    /* a trip of the fast monitor */
    bool emf_conducts;
    bridge_mode_t bridge;
} modes_case_t;

/* No fault, no demand, standstill. */
static const modes_case_t CALM = {
    .config_accepted = true,
    .selftest_passed = true,
    .offsets_done = true,
    .offsets_plausible = true,
    .angle_valid = true,
    .at_rest = true,
    .warning = FINDING_COUNT,
    .bridge = BRIDGE_OFF,
};

static config_t config;
static modes_state_t state;
static findings_t findings;
static modes_case_t in;
static finding_t warning_before;

/* Each row is found at once and ends at once: times are those of the checks. */
static inline void start(void)
{
    config = paper_vehicle();
    modes_init(&state);
    finding_times_t times[FINDING_COUNT];
    for (int row = 0; row < FINDING_COUNT; row++) {
        times[row].qualify_steps = 1;
        times[row].heal_steps = 1;
    }
    findings_init(&findings, times, false);
    in = CALM;
    warning_before = FINDING_COUNT;
}

static inline void set_warning(void)
{
    if (warning_before != in.warning && warning_before != FINDING_COUNT) {
        findings_set(&findings, warning_before, false);
    }
    if (in.warning != FINDING_COUNT) {
        findings_set(&findings, in.warning, true);
        warning_before = in.warning;
    }
}

static inline slow_input_t demanded(void)
{
    const slow_input_t out = {
        .demand = {.drive_torque_mNm = in.drive_demanded ? 1 : 0,
                   .brake_torque_mNm = in.brake_demanded ? 1 : 0,
                   .direction = DRIVE_DIRECTION_FORWARD,
                   .enable = in.enable,
                   .fault_reset = in.fault_reset,
                   .reason = in.demand_reason},
        .demand_age_ms = (uint32_t)config.brake.demand_timeout_ms + (in.demand_lost ? 1U : 0U),
        .selftest_passed = in.selftest_passed,
        .config_accepted = in.config_accepted,
    };
    return out;
}

static inline modes_output_t step_with(const slow_input_t *slow_in)
{
    const fast_report_t report = {.offsets_done = in.offsets_done, .bridge = in.bridge};
    const measured_t now = {
        .report = &report, .angle_valid = in.angle_valid, .angle_by = in.angle_by};
    const monitored_t watch = {.bound_mrad_s = in.bound_mrad_s,
                               .at_rest = in.at_rest,
                               .emf_conducts = in.emf_conducts,
                               .offsets_plausible = in.offsets_plausible};
    const last_t last = {.engaged = in.neutral ? DRIVE_DIRECTION_NEUTRAL : DRIVE_DIRECTION_FORWARD};
    set_warning();
    findings_trip(&findings, in.fault);
    return modes_step(&state, &config, &now, &watch, &last, slow_in, &findings);
}

static inline modes_output_t step(void)
{
    const slow_input_t slow_in = demanded();
    return step_with(&slow_in);
}

static inline modes_output_t run(int milliseconds)
{
    for (int n = 1; n < milliseconds; n++) {
        step();
    }
    return step();
}

/* Starts and steps to a mode. Leaves `in` as it must be to stay in that mode. */
static inline void start_in(operating_mode_t mode)
{
    start();
    switch (mode) {
    case MODE_BOOT:
        in.config_accepted = false;
        break;
    case MODE_SELFTEST:
        in.selftest_passed = false;
        step();
        break;
    case MODE_OFFSET_CAL:
        in.offsets_done = false;
        run(2);
        break;
    case MODE_READY:
        run(10);
        break;
    case MODE_RUN:
        in.enable = true;
        run(10);
        break;
    case MODE_LIMP:
        in.enable = true;
        in.warning = FINDING_ROTOR_READING;
        run(10);
        break;
    case MODE_FAULT:
        run(10);
        in.fault = REASON_OVERCURRENT;
        step();
        in.fault = REASON_NONE;
        break;
    }
    TEST_ASSERT_EQUAL_INT(mode, state.mode);
}

static inline void assert_mode(operating_mode_t mode, modes_output_t out)
{
    TEST_ASSERT_EQUAL_STRING(operating_mode_text(mode), operating_mode_text(out.mode));
}

#endif
