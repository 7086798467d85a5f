/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_rig.h: the slow monitor of the paper's vehicle and the case `in` that it sees, which a
 * test changes between steps. recover() restores that of a healthy drive. Included once in a
 * program.
 */
#ifndef MONITOR_RIG_H
#define MONITOR_RIG_H

#include "config/finding_times.h"
#include "monitor/monitor.h"
#include "monitor_case.h"
#include "paper_vehicle.h"
#include "unity.h"

enum { FAST_PER_SLOW = 20 /* 20 kHz over 1 kHz */, MID_OFFSET_Q4 = 2048 * 16 };

/* At standstill. */
static const monitor_case_t SWITCHING = {
    .report = {.offsets_done = true,
               .offset_q4 = {MID_OFFSET_Q4, MID_OFFSET_Q4, MID_OFFSET_Q4},
               .bridge = BRIDGE_PWM},
    .now = {.angle_valid = true, .bus_voltage_mV = 53000, .winding_temperature_cC = 2500},
    .shown = {.winding_cC = 2500, .switch_cC = 2500},
};

/* At 30 rad/s, with 10 N m as commanded. */
static const monitor_case_t TURNING = {
    .report = {.offsets_done = true,
               .offset_q4 = {MID_OFFSET_Q4, MID_OFFSET_Q4, MID_OFFSET_Q4},
               .bridge = BRIDGE_PWM},
    .now = {.angle_valid = true,
            .bus_voltage_mV = 53000,
            .speed_mrad_s = 30000,
            .winding_temperature_cC = 2500,
            .latest_u_q_mV = 14076}, /* 30 rad/s * 23 * 20.4 mWb */
    .shown = {.winding_cC = 2500, .switch_cC = 2500},
    .last = {.torque_command_mNm = 10000, .torque_estimate_mNm = 10000},
};

/* What the monitor concludes, and what of its findings is shown. */
typedef struct {
    monitored_t monitored;
    reason_t fault, warning;
    reason_t flux_warning; /* what back-EMF and battery say of flux and bus voltage */
    bool battery_lost;
    int32_t charging_mA; /* in the safe state */
} shown_t;

static config_t config;
static monitor_state_t state;
static findings_t findings;
static monitor_case_t in;
static monitor_case_t healthy;
static uint16_t fast_steps_per_slow;

static inline void rig_up(const monitor_case_t *as_healthy)
{
    config = paper_vehicle();
    monitor_init(&state);
    finding_times_t times[FINDING_COUNT];
    finding_times(&config, times);
    findings_init(&findings, times, false);
    healthy = *as_healthy;
    in = healthy;
    fast_steps_per_slow = FAST_PER_SLOW;
}

static inline reason_t flux_warning(void)
{
    static const finding_t ROWS[] = {FINDING_BUS_CONTRADICTED, FINDING_FLUX_LOW, FINDING_FLUX_HIGH};
    for (int k = 0; k < 3; k++) {
        if (findings_present(&findings, ROWS[k])) {
            return findings_reason(&findings, ROWS[k]);
        }
    }
    return REASON_NONE;
}

/* With the times of the configuration as the test has it now. */
static inline shown_t step_at_count(void)
{
    finding_times(&config, findings.times);
    shown_t out = {.monitored =
                       monitor_step(&state, &config, measured_of(&in), &in.last, &findings)};
    out.fault = findings_reason(&findings, findings_fault(&findings));
    out.warning = findings_reason(&findings, findings_warning(&findings));
    out.flux_warning = flux_warning();
    out.battery_lost = findings_off(&findings);
    out.charging_mA = safe_state_charging_mA(&out.monitored.safe);
    in.last.safe_bridge = out.monitored.safe.bridge;
    return out;
}

static inline shown_t step(void)
{
    in.report.sequence = (uint16_t)(in.report.sequence + fast_steps_per_slow);
    return step_at_count();
}

static inline shown_t run(int milliseconds)
{
    for (int n = 1; n < milliseconds; n++) {
        step();
    }
    return step();
}

/* Back to the healthy case, in which the fast loop has counted on and the bridge been chosen. */
static inline void recover(void)
{
    const uint16_t count = in.report.sequence;
    const bridge_mode_t safe_bridge = in.last.safe_bridge;
    in = healthy;
    in.report.sequence = count;
    in.last.safe_bridge = safe_bridge;
}

/* The condition in `in` is a fault after exactly `milliseconds`, and no fault after recover(). */
static inline void assert_fault_after(int milliseconds, reason_t fault)
{
    for (int n = 1; n < milliseconds; n++) {
        TEST_ASSERT_EQUAL_INT(REASON_NONE, step().fault);
    }
    TEST_ASSERT_EQUAL_INT(fault, step().fault);
    TEST_ASSERT_EQUAL_INT(fault, run(100).fault);
    recover();
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().fault); /* modes latches a fault, not the monitor */
}

static inline void assert_never_a_fault(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000).fault);
    recover();
}

#endif
