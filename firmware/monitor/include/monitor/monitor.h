/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor.h: independent monitoring. It checks measurements and steps with its own arithmetic and
 * bounds, reports findings (core/findings.h), and selects the bridge's safe state. It computes no
 * torque. Manual: README; why each bound has its value: DERIVATIONS.md.
 *
 * Fast part (every PWM period): length of the current vector, bus over-voltage, the power stage's
 * fault line. A trip is latched, and the bridge goes to the safe state in the same period,
 * independently of the slow loop. Slow part (1 kHz): sum of currents, saturated sensors, bus
 * voltage, temperatures, rotor, its angle against the back-EMF (monitor_emf.h), torque against the
 * command, program flow (each loop counts the other's steps), and the upper bound of the wheel
 * speed (monitor_speed.h), which decides between freewheel and active short circuit.
 */
#ifndef MONITOR_MONITOR_H
#define MONITOR_MONITOR_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/bridge.h"
#include "core/debounce.h"
#include "core/findings.h"
#include "core/frames.h"
#include "core/last.h"
#include "core/measured.h"
#include "core/monitored.h"
#include "core/reason.h"
#include "monitor/monitor_bus.h"
#include "monitor/monitor_current.h"
#include "monitor/monitor_emf.h"
#include "monitor/monitor_gain.h"
#include "monitor/monitor_open.h"
#include "monitor/monitor_speed.h"
#include "monitor/monitor_stuck.h"
#include "monitor/safe_state.h"

enum {
    /* Milliseconds without a slow step after which the fast loop trips. */
    MONITOR_STALE_STEPS = 4,
    /* Milliseconds without torque after a bus has come back from beyond a trip, or its contactor
     * has closed: one that bounces does not take the hydraulic torque back with every contact. */
    MONITOR_BUS_RETURN_STEPS = 100,
    /* Since the last reading that a healthy rotor sensor cannot give, until the rotor may be at
     * rest: halls whose lines contradict each other count no speed. */
    MONITOR_READING_STEPS = 1000,
    /* Weights of a slow step with a wrong number of fast steps and of one with the right number,
     * and their sum that is a fault: three wrong ones in a row, or five of nine; two in a row with
     * twice the number, before halls contradict an angle that runs ahead. */
    MONITOR_FLOW_WRONG = 2,
    MONITOR_FLOW_TWICE = 3,
    MONITOR_FLOW_RIGHT = -1,
    MONITOR_FLOW_FAULT = 6,
    /* Milliseconds that an open bridge waits for PWM before a short circuit that surges. */
    MONITOR_SHORT_WAIT_STEPS = 150,
    /* Square of the current that a dead sensor may show, Q30: six codes of a 12-bit converter. */
    MONITOR_DEAD_SQUARE = 96 * 96,
    /* A smaller current has to be gone for so many qualify times: 64 codes, Q30 of its square. */
    MONITOR_DEAD_SMALL_SQUARE = 1024 * 1024,
    MONITOR_DEAD_SMALL_TIMES = 4,
    /* More than a bus rises in one period, Q15 of the voltage base: 5/64, of a capacitor that is
     * charged from half of the range to all of it in six periods; less of a larger one that the
     * configuration gives (monitor_fast_init()), at least 1/64. */
    MONITOR_BUS_JUMP_PU = 2560,
    MONITOR_BUS_LEAST_JUMP_PU = 512,
    /* Less than what drives a current through a motor, so no motor empties a bus so far: 1/64. */
    MONITOR_BUS_EMPTY_SHARE = 64
};

/* ---- fast ---- */

typedef struct {
    /* Computed once from the configuration. */
    uint32_t overcurrent_square; /* Q30 of the current base */
    int32_t overvoltage_pu;      /* Q15 of the voltage base */
    int32_t jump_pu;             /* largest rise of a bus in a period, likewise */
    int32_t stale_limit_periods; /* PWM periods without a slow step */
    int32_t trip_periods;        /* qualify time of an over-current */
    int32_t dead_periods;        /* qualify time of a current that has vanished */
    /* State. */
    reason_t trip;
    uint32_t inverted_trip; /* ~trip: a bit that flips in RAM is found (monitor_fast_intact()) */
    int32_t
        current_periods;  /* above the trip; negative: at zero since the latest one that was not */
    int32_t periods_left; /* left until PROGRAM_FLOW without a slow step */
    int32_t last_v_dc_pu; /* of the period before */
    uint16_t last_slow_step;
} monitor_fast_state_t;

typedef struct {
    dq16_t i_pu;     /* Q15 of the current base, components saturated */
    int32_t v_dc_pu; /* Q15 of the voltage base, 0 .. 65 536 */
    bool power_stage_fault;
    bool switching;  /* PWM: slow steps must come, and no current may exceed its limit */
    bool clear_trip; /* the fault has been acknowledged */
    uint16_t slow_step_count;
    uint32_t least_square; /* Q30, of the current vector at the present setpoint; below the trip */
} monitor_fast_input_t;

/* From a configuration that config_validate() has accepted: no trip, and no rise of the bus in the
 * first period. Divides; once at start, and for monitor_fast_intact(). */
void monitor_fast_init(monitor_fast_state_t *state, const config_t *config);

/* Background: false if the trip differs from its inverted copy, or a limit from what the
 * configuration makes it. A trip that comes in the middle of the comparison may look like damage:
 * two calls in a row decide. */
bool monitor_fast_intact(const monitor_fast_state_t *state, const config_t *config);

/* monitor_fast_step() is in monitor_fast.h. */

/* ---- slow ---- */

typedef struct {
    debounce_t bus;      /* beyond a trip and not back */
    uint16_t flow_level; /* weighted sum of wrong and right steps */
    uint16_t last_fast_step;
    uint16_t last_rotor_faults, last_sudden_stops;
    uint16_t reading_steps; /* until the rotor may be at rest, since an impossible reading */
    uint16_t steps;         /* step count, wrapping: the watchdog is fed only while it advances */
    bool release_trip;      /* the bus is back from above its trip */
    uint16_t return_steps;  /* left until torque returns after that */
    uint16_t open_steps;    /* likewise, after a contactor reported open */
    uint16_t short_steps;   /* for which a short circuit would have surged */
    monitor_emf_state_t emf;
    monitor_current_state_t current;
    monitor_speed_state_t speed;
    monitor_stuck_state_t stuck;
    monitor_open_state_t open;
    monitor_window_t contradiction; /* of bus and battery voltage */
    monitor_gain_state_t gain;
    bool bus_was_low;      /* of the latest bus beyond a trip */
    bool bus_sensor_wrong; /* its reading went where no bus goes */
    bool started;
    monitor_swing_state_t swing;
} monitor_state_t;

/* Nothing is suspected; the wheel is at standstill until a sensor or a current shows otherwise. */
void monitor_init(monitor_state_t *state);

/* 1 kHz, behind measure_step() and before modes_step(). Sets every row of the findings that is the
 * monitor's, and returns speed upper bound, rest, and the safe state, which is never PWM. It trusts
 * no measurement: values beyond their range saturate. last->reference_pu: 16 bits; the report's
 * i_d_weakening_pu: -32 768 .. 0. The invariant monitor_state_holds() is in
 * tests/proofs/invariants.h. */
monitored_t monitor_step(monitor_state_t *state, const config_t *config, const measured_t *now,
                         const last_t *last, findings_t *findings);

/* Braking torque that the voltage may force whatever is commanded: 0 or motor.max_torque. Speed:
 * mechanical, of either sign; a bus voltage below zero counts as zero. DERIVATIONS.md, Forced
 * torque. */
int32_t monitor_forced_torque_mNm(const config_t *config, int32_t speed_mrad_s,
                                  int32_t bus_voltage_mV);

#endif
