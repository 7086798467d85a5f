/* SPDX-License-Identifier: Apache-2.0 */
/*
 * findings.h: what is wrong, as one record and one table. Slow loop, 1 kHz.
 *
 * Each check of monitor, measurement, blending, bridge choice and modes has a row. It calls
 *
 *     findings_set(findings, FINDING_BUS_LOW, condition)
 *
 * once a step and decides nothing else: the row says how long the condition has to last and how
 * long its end, what explains it away, and what happens. modes executes the reactions; CAN, shell,
 * journal and black box show the reason of the first row that is present.
 *
 * The order of the rows is the order of causes: a finding that another one may cause stands behind
 * it. A finding that is set after modes_step() acts in the next step.
 */
#ifndef CORE_FINDINGS_H
#define CORE_FINDINGS_H

#include <stdbool.h>
#include <stdint.h>

#include "core/debounce.h"
#include "core/reason.h"

/* X(identifier, text): what happens to the motor's torque while the finding is present. Where there
 * is less of it the hydraulic brake has the rest of a braking demand. */
#define FINDING_REACTION_LIST(X)                                                                   \
    X(NONE, "none, it is only reported")                                                           \
    X(LIMIT, "less driving torque, whole braking torque")                                          \
    X(LEAST, "less driving torque; the bridge that brakes least")                                  \
    X(OFF, "freewheel at once, or short circuit if safer, until it ends")                          \
    X(HAND_OVER, "no driving torque; the brake system takes over")                                 \
    X(RAMP, "torque ramps to zero, then safe state")                                               \
    X(SAFE_STATE, "freewheel at once, or short circuit if safer")                                  \
    X(TRIP, "freewheel at once, or short circuit on a stuck side")

#define FINDING_REACTION_ENUM(identifier, text) FINDING_REACTION_##identifier,
typedef enum { FINDING_REACTION_LIST(FINDING_REACTION_ENUM) } finding_reaction_t;
#undef FINDING_REACTION_ENUM

/* clang-format off */
/*
 * X(check, reason, evidence, qualify time, heal time, explained by, reaction)
 *
 * Evidence is of the check, not of the reason. MEASURED: a line, a counter, an end of a range,
 * measurements of one thing that contradict each other now, a current against its own reference.
 * INFERRED: a model with parameters says so; it may warn, choose the safer of two values and lower
 * a deferrable line that the hydraulic brake fills, but latches nothing and ends no braking.
 * EXCEPTION: inferred, but waiting would make torque of the wrong sign or destroy the bridge;
 * README of the monitor has the reason of each.
 *
 * A time is AT_ONCE; MS(n); FIELD(section, name), a field of the configuration in ms; RAMP(section,
 * name), such a field behind the time in which the torque ramps out; NEVER; or OWN(text): the check
 * has a filter of its own, which takes so long.
 *
 * Explained by: findings that silence this one while they are present or suspected. NONE: no other.
 *
 * The reason NONE: the fast monitor gives that of TRIP (findings_trip()); BATTERY_UNKNOWN has none
 * yet; READING_BY_STEPS only explains others: a rotor reading that steps out of order explain.
 */
#define FINDING_FAULTS(X)                                                                          \
    X(STATE_DAMAGED, MEMORY, MEASURED, AT_ONCE, NEVER, NONE, SAFE_STATE)                           \
    X(TRIP_PHASE_OPEN, PHASE_OPEN, MEASURED, OWN("3 ms"), AT_ONCE, NONE, SAFE_STATE)               \
    X(TRIP, NONE, MEASURED, OWN("1 PWM period and more"), AT_ONCE, NONE, TRIP)                     \
    X(STEPS, PROGRAM_FLOW, MEASURED, OWN("9 ms"), AT_ONCE, NONE, SAFE_STATE)                       \
    X(NO_CURRENT_SUM, CURRENT_SUM, MEASURED, OWN("3 ms"), AT_ONCE, NONE, SAFE_STATE)               \
    X(NO_CURRENT_PHASE, PHASE_OPEN, MEASURED, OWN("3 ms"), AT_ONCE, NONE, SAFE_STATE)              \
    X(CURRENT_RAIL, CURRENT_SENSOR, MEASURED, FIELD(monitor, sensor_fault_time_ms), AT_ONCE,       \
      NONE, SAFE_STATE)                                                                            \
    X(CURRENT_MISSING, CURRENT_SENSOR, MEASURED, OWN("3 ms"), AT_ONCE, NONE, SAFE_STATE)           \
    X(SUM, CURRENT_SUM, MEASURED, FIELD(monitor, sensor_fault_time_ms), AT_ONCE, NONE,             \
      SAFE_STATE)                                                                                  \
    X(SUM_UNDETERMINED, CURRENT_SUM, MEASURED, OWN("8 PWM periods"), AT_ONCE, NONE, SAFE_STATE)    \
    X(BUS_LOW, BUS_UNDERVOLTAGE, MEASURED,                                                         \
      OWN("monitor.battery_message_time_ms + monitor.voltage_fault_time_ms"), AT_ONCE, NONE,       \
      SAFE_STATE)                                                                                  \
    X(BUS_HIGH, BUS_OVERVOLTAGE, MEASURED, OWN("monitor.battery_message_time_ms"), AT_ONCE,        \
      NONE, TRIP)                                                                                  \
    X(ANGLE_MISSING, ROTOR_LOST, MEASURED, RAMP(monitor, rotor_fault_time_ms), AT_ONCE, NONE,      \
      RAMP)                                                                                        \
    X(ANGLE, ROTOR_IMPLAUSIBLE, EXCEPTION, OWN("monitor.angle_fault_time_ms"), AT_ONCE, NONE,      \
      SAFE_STATE)                                                                                  \
    X(TORQUE, TORQUE_IMPLAUSIBLE, EXCEPTION, FIELD(monitor, torque_fault_time_ms), AT_ONCE,        \
      NONE, SAFE_STATE)                                                                            \
    X(SWITCH_STUCK, HARDWARE_BREAK, EXCEPTION, OWN("5 to 22 ms"), AT_ONCE, NONE, TRIP)             \
    X(CONFIGURATION, CONFIG_INVALID, MEASURED, AT_ONCE, AT_ONCE, NONE, SAFE_STATE)                 \
    X(SELFTEST, SELFTEST_FAILED, MEASURED, OWN("modes.selftest_timeout_ms"), AT_ONCE, NONE,        \
      SAFE_STATE)                                                                                  \
    X(OFFSETS_WRONG, OFFSET_IMPLAUSIBLE, MEASURED, OWN("at calibration"), AT_ONCE, NONE,           \
      SAFE_STATE)

#define FINDING_WARNINGS(X)                                                                        \
    X(BUS_JUMPED, BUS_SENSOR, MEASURED, AT_ONCE, OWN("100 ms"), NONE, OFF)                         \
    X(BATTERY_LEFT, BATTERY_DISCONNECTED, EXCEPTION, AT_ONCE, OWN("100 ms"), NONE, OFF)            \
    X(BATTERY_UNKNOWN, NONE, EXCEPTION, AT_ONCE, OWN("100 ms"), NONE, OFF)                         \
    X(WINDING_HOT, WINDING_OVERTEMPERATURE, MEASURED, FIELD(monitor, sensor_fault_time_ms),        \
      MS(1000), NONE, OFF)                                                                         \
    X(SWITCH_HOT, SWITCH_OVERTEMPERATURE, MEASURED, FIELD(monitor, sensor_fault_time_ms),          \
      MS(1000), NONE, OFF)                                                                         \
    X(CURRENT_A, CURRENT_SENSOR_A, EXCEPTION, OWN("2 PWM periods"), OWN("20 ms and more"),         \
      BATTERY, LIMIT)                                                                              \
    X(CURRENT_B, CURRENT_SENSOR_B, EXCEPTION, OWN("2 PWM periods"), OWN("20 ms and more"),         \
      BATTERY, LIMIT)                                                                              \
    X(CURRENT_C, CURRENT_SENSOR_C, EXCEPTION, OWN("2 PWM periods"), OWN("20 ms and more"),         \
      BATTERY, LIMIT)                                                                              \
    X(WINDING_THERMISTOR, WINDING_SENSOR, MEASURED, FIELD(monitor, sensor_fault_time_ms),          \
      MS(1000), BATTERY, NONE)                                                                     \
    X(SWITCH_THERMISTOR, SWITCH_SENSOR, MEASURED, FIELD(monitor, sensor_fault_time_ms),            \
      MS(1000), BATTERY, NONE)                                                                     \
    X(ROTOR_READING, ROTOR_UNCERTAIN, MEASURED, AT_ONCE, FIELD(monitor, rotor_warning_time_ms),    \
      BATTERY_OR_STEPS, LIMIT)                                                                     \
    X(ROTOR_GLITCH, ROTOR_UNCERTAIN, MEASURED, AT_ONCE, MS(1000), BATTERY_OR_STEPS, NONE)          \
    X(ROTOR_STOPS, ROTOR_UNCERTAIN, INFERRED, AT_ONCE, MS(1000), BATTERY_OR_STEPS, NONE)           \
    X(READING_BY_STEPS, NONE, MEASURED, AT_ONCE, AT_ONCE, NONE, NONE)                              \
    X(FORCED_TORQUE, OVERSPEED, EXCEPTION, OWN("2 ms"), MS(1000), BY_STEPS, LEAST)                 \
    X(ROTOR_SLIPS, ROTOR_SLIPPED, EXCEPTION, OWN("12 ms"),                                         \
      OWN("monitor.rotor_warning_time_ms"), BY_STEPS, LIMIT)                                       \
    X(ROTOR_FREEZES, ROTOR_FROZEN, EXCEPTION, OWN("2 ms"),                                         \
      OWN("monitor.rotor_warning_time_ms"), BY_STEPS, LIMIT)                                       \
    X(ROTOR_REVERSES, ROTOR_REVERSED, EXCEPTION, OWN("2 ms"),                                      \
      OWN("monitor.rotor_warning_time_ms"), BY_STEPS, LIMIT)                                       \
    X(ROTOR_UNNAMED, ROTOR_UNCERTAIN, EXCEPTION, OWN("2 ms"),                                      \
      OWN("monitor.rotor_warning_time_ms"), STEPS, LIMIT)                                          \
    X(OBSERVER_IN_USE, ROTOR_UNCERTAIN, MEASURED, MS(200), AT_ONCE, STEPS, LIMIT)                  \
    X(BRAKE_DEAD, HYDRAULIC_DEAD, MEASURED, MS(1000), MS(1000), NONE, NONE)                        \
    X(BRAKE_WEAK, HYDRAULIC_WEAK, MEASURED, MS(250), MS(1000), NONE, NONE)                         \
    X(BRAKE_STUCK, HYDRAULIC_STUCK, MEASURED, MS(250), MS(1000), NONE, NONE)                       \
    X(BRAKE_STRONG, HYDRAULIC_STRONG, MEASURED, MS(250), MS(1000), NONE, NONE)                     \
    X(BRAKE_LATE, HYDRAULIC_LATE, MEASURED, AT_ONCE, MS(10000), NONE, NONE)                        \
    X(BRAKE_REPORT, HYDRAULIC_FEEDBACK, MEASURED, OWN("brake.hydraulic_timeout_ms"),               \
      OWN("1000 ms"), NONE, NONE)                                                                  \
    X(HOLD_FAILS, HOLD_FAILED, MEASURED, OWN("1000 ms"), MS(1000), NONE, NONE)                     \
    X(ACCELERATOR, ACCELERATOR_SENSOR, MEASURED, OWN("pedals.fault_time_ms"),                      \
      OWN("pedals.fault_time_ms"), NONE, LIMIT)                                                    \
    X(BRAKE_PEDAL, BRAKE_PEDAL_SENSOR, MEASURED, OWN("pedals.fault_time_ms"),                      \
      OWN("pedals.fault_time_ms"), NONE, LIMIT)                                                    \
    X(DEMAND_OLD, DEMAND_TIMEOUT, MEASURED, OWN("brake.demand_timeout_ms"), AT_ONCE, NONE,         \
      HAND_OVER)                                                                                   \
    X(FRAMES_UNSENT, TRANSMIT_TIMEOUT, MEASURED, OWN("50 ms"), OWN("20 ms and more"), NONE,        \
      HAND_OVER)                                                                                   \
    X(DEMAND_SENDERS, DEMAND_CONTRADICTED, MEASURED, AT_ONCE, OWN("1000 ms"), NONE, LIMIT)         \
    X(DEMAND_REFUSED, DEMAND_IMPLAUSIBLE, MEASURED, AT_ONCE, OWN("1000 ms"), NONE, NONE)           \
    X(BUS_CONTRADICTED, BUS_SENSOR, MEASURED, OWN("200 ms"), OWN("200 ms"), NONE, LIMIT)           \
    X(FLUX_LOW, FLUX_WEAK, INFERRED, OWN("200 ms"), OWN("200 ms"), BUS_READING, NONE)              \
    X(FLUX_HIGH, BUS_SENSOR, INFERRED, OWN("200 ms"), OWN("200 ms"), BUS_READING, NONE)            \
    X(GAIN, CURRENT_GAIN, INFERRED, OWN("a window of charge"), OWN("a window of charge"), NONE,    \
      NONE)                                                                                        \
    X(OFFSETS_OLD, OFFSETS_STORED, MEASURED, OWN("modes.offset_wait_ms"),                          \
      OWN("at calibration"), NONE, LIMIT)
/* clang-format on */

#define FINDING_LIST(X) FINDING_FAULTS(X) FINDING_WARNINGS(X)
#define FINDING_ENUM(check, reason, evidence, qualify, heal, explained_by, reaction)               \
    FINDING_##check,
typedef enum { FINDING_LIST(FINDING_ENUM) FINDING_COUNT } finding_t;
#undef FINDING_ENUM

/* Of one row, in slow steps, at least 1. */
typedef struct {
    uint16_t qualify_steps, heal_steps;
} finding_times_t;

/* A named warning that comes and goes heals more slowly at every return within FINDING_QUIET_STEPS
 * of its last presence: twice as slowly as before, at least FINDING_RETURN_STEPS, at most
 * FINDING_QUIET_STEPS, after which it is forgotten. So a loose contact makes no more than five
 * changes a second: the sixth is the third time that it comes, 334 + 668 ms after the first at
 * least. */
enum { FINDING_WORDS = 2, FINDING_RETURN_STEPS = 334, FINDING_QUIET_STEPS = 10000 };

/* How a row comes and goes. */
typedef struct {
    uint16_t heal_steps;  /* now; 0: those of its times */
    uint16_t quiet_steps; /* left until its returns are forgotten */
} finding_returns_t;

typedef struct {
    uint32_t active[FINDING_WORDS]; /* a bit a row: present, or its times or returns run */
    uint32_t present[FINDING_WORDS];
    uint32_t suspected[FINDING_WORDS];
    reason_t trip; /* REASON_NONE: none */
    debounce_t debounce[FINDING_COUNT];
    finding_returns_t returns[FINDING_COUNT];
    finding_times_t times[FINDING_COUNT];
    bool braking_kept; /* there is no other brake: what takes the motor's away heals at once */
} findings_t;

/* Nothing is found. times: of every row. no_other_brake: rows with the reaction OFF heal after
 * their own time however often they come. */
void findings_init(findings_t *findings, const finding_times_t times[FINDING_COUNT],
                   bool no_other_brake);

/* For findings_set(): a step of the row's debounce. */
void findings_step(findings_t *findings, finding_t row, bool condition);

static inline uint32_t findings_bit(finding_t row)
{
    return UINT32_C(1) << ((uint32_t)row % 32U);
}

/* The condition of a row in this step. */
static inline void findings_set(findings_t *findings, finding_t row, bool condition)
{
    if (condition || (findings->active[(uint32_t)row / 32U] & findings_bit(row)) != 0U) {
        findings_step(findings, row, condition);
    }
}

/* For findings_set_named(): a step of each of the rows. */
void findings_name(findings_t *findings, finding_t first, finding_t last, reason_t reason);

/* Of the neighbouring rows first to last, whose reasons differ, that with this reason in this step;
 * REASON_NONE: none of them. */
static inline void findings_set_named(findings_t *findings, finding_t first, finding_t last,
                                      reason_t reason)
{
    const uint64_t rows = (UINT64_C(2) << (uint32_t)last) - (UINT64_C(1) << (uint32_t)first);
    const uint32_t active =
        (findings->active[0] & (uint32_t)rows) | (findings->active[1] & (uint32_t)(rows >> 32U));
    if (reason != REASON_NONE || active != 0U) {
        findings_name(findings, first, last, reason);
    }
}

/* A row that is on its way, and as a cause already explains others. */
static inline void findings_suspect(findings_t *findings, finding_t row, bool suspected)
{
    uint32_t *word = &findings->suspected[(uint32_t)row / 32U];
    *word = suspected ? *word | findings_bit(row) : *word & ~findings_bit(row);
}

static inline bool findings_suspected(const findings_t *findings, finding_t row)
{
    return (findings->suspected[(uint32_t)row / 32U] & findings_bit(row)) != 0U;
}

/* The row TRIP, with its reason; REASON_NONE: no trip. */
static inline void findings_trip(findings_t *findings, reason_t reason)
{
    findings->trip = reason;
    findings_set(findings, FINDING_TRIP, reason != REASON_NONE);
}

/* True while the row is qualified, whether another one explains it or not. */
static inline bool findings_qualified(const findings_t *findings, finding_t row)
{
    return (findings->present[(uint32_t)row / 32U] & findings_bit(row)) != 0U;
}

/* True while one of the neighbouring rows first to last is. */
static inline bool findings_any_qualified(const findings_t *findings, finding_t first,
                                          finding_t last)
{
    const uint64_t rows = (UINT64_C(2) << (uint32_t)last) - (UINT64_C(1) << (uint32_t)first);
    return ((findings->present[0] & (uint32_t)rows) |
            (findings->present[1] & (uint32_t)(rows >> 32U))) != 0U;
}

/* For findings_present(). */
bool findings_explained(const findings_t *findings, finding_t row);

/* True if the row is qualified and not explained by another one. */
static inline bool findings_present(const findings_t *findings, finding_t row)
{
    return findings_qualified(findings, row) && !findings_explained(findings, row);
}

/* The first present row of the faults, and of the warnings with a reason; FINDING_COUNT: none. */
finding_t findings_fault(const findings_t *findings);
finding_t findings_warning(const findings_t *findings);

/* The first present row of those warnings that leave less torque; FINDING_COUNT: none. */
finding_t findings_limiting(const findings_t *findings);

/* True while a row with the reaction OFF is present, named or not. */
bool findings_off(const findings_t *findings);

/* Reason of a row; REASON_NONE for FINDING_COUNT. */
reason_t findings_reason(const findings_t *findings, finding_t row);

/* How long a row must be present and absent: configuration fields, or words such as "9 ms"; "its
 * time" on a port without these texts. Never NULL. */
typedef struct {
    const char *qualify, *heal;
} finding_text_t;

/* Columns of the table, for shell and documents. */
typedef struct {
    finding_text_t time;
    reason_t reason;
    finding_reaction_t reaction;
} finding_row_t;

finding_reaction_t findings_reaction(finding_t row);
finding_row_t findings_row(finding_t row);
finding_text_t finding_text(finding_t row);
const char *findings_reaction_text(finding_reaction_t reaction);

#endif
