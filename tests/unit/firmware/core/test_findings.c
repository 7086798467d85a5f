/* SPDX-License-Identifier: Apache-2.0 */
/* The table of checks and the record of what they found: order, explanation, times, words. */
#include "core/findings.h"

#include <string.h>

#include "core/fault.h"
#include "random_values.h"
#include "unity.h"

static findings_t findings;

static void init_with(uint16_t qualify_steps, uint16_t heal_steps)
{
    finding_times_t times[FINDING_COUNT];
    for (int row = 0; row < FINDING_COUNT; row++) {
        times[row].qualify_steps = qualify_steps;
        times[row].heal_steps = heal_steps;
    }
    findings_init(&findings, times, false);
}

/* Every row at once, and for as long as its condition. */
void setUp(void)
{
    init_with(1, 1);
}

void tearDown(void) {}

static void find(finding_t row)
{
    findings_set(&findings, row, true);
}

/* ---- the table ---- */

/* In the order of causes: what may cause another one stands before it. */
static const finding_t FAULTS[] = {
    FINDING_STATE_DAMAGED,
    FINDING_TRIP_PHASE_OPEN,
    FINDING_TRIP,
    FINDING_STEPS,
    FINDING_NO_CURRENT_SUM,
    FINDING_NO_CURRENT_PHASE,
    FINDING_CURRENT_RAIL,
    FINDING_CURRENT_MISSING,
    FINDING_SUM,
    FINDING_SUM_UNDETERMINED,
    FINDING_BUS_LOW,
    FINDING_BUS_HIGH,
    FINDING_ANGLE_MISSING,
    FINDING_ANGLE,
    FINDING_TORQUE,
    FINDING_SWITCH_STUCK,
    FINDING_CONFIGURATION,
    FINDING_SELFTEST,
    FINDING_OFFSETS_WRONG,
};
static const finding_t WARNINGS[] = {
    FINDING_BUS_JUMPED,
    FINDING_BATTERY_LEFT,
    FINDING_BATTERY_UNKNOWN,
    FINDING_WINDING_HOT,
    FINDING_SWITCH_HOT,
    FINDING_CURRENT_A,
    FINDING_CURRENT_B,
    FINDING_CURRENT_C,
    FINDING_WINDING_THERMISTOR,
    FINDING_SWITCH_THERMISTOR,
    FINDING_ROTOR_READING,
    FINDING_ROTOR_GLITCH,
    FINDING_ROTOR_STOPS,
    FINDING_READING_BY_STEPS,
    FINDING_FORCED_TORQUE,
    FINDING_ROTOR_SLIPS,
    FINDING_ROTOR_FREEZES,
    FINDING_ROTOR_REVERSES,
    FINDING_ROTOR_UNNAMED,
    FINDING_OBSERVER_IN_USE,
    FINDING_BRAKE_DEAD,
    FINDING_BRAKE_WEAK,
    FINDING_BRAKE_STUCK,
    FINDING_BRAKE_STRONG,
    FINDING_BRAKE_LATE,
    FINDING_BRAKE_REPORT,
    FINDING_HOLD_FAILS,
    FINDING_ACCELERATOR,
    FINDING_BRAKE_PEDAL,
    FINDING_DEMAND_OLD,
    FINDING_FRAMES_UNSENT,
    FINDING_DEMAND_SENDERS,
    FINDING_DEMAND_REFUSED,
    FINDING_BUS_CONTRADICTED,
    FINDING_FLUX_LOW,
    FINDING_FLUX_HIGH,
    FINDING_GAIN,
    FINDING_OFFSETS_OLD,
};
enum {
    FAULT_COUNT = sizeof FAULTS / sizeof FAULTS[0],
    WARNING_COUNT = sizeof WARNINGS / sizeof WARNINGS[0]
};

/* Causes without a reason of their own. */
static bool is_shown(finding_t row)
{
    return row != FINDING_BATTERY_UNKNOWN && row != FINDING_READING_BY_STEPS;
}

static bool is_one_of(finding_t row, const finding_t *rows, int count)
{
    for (int k = 0; k < count; k++) {
        if (rows[k] == row) {
            return true;
        }
    }
    return false;
}

/* What a wrong reading explains: the rows that are inferred with it. */
static bool is_explained(finding_t row, finding_t by)
{
    static const finding_t BATTERY[] = {FINDING_BUS_JUMPED, FINDING_BATTERY_LEFT,
                                        FINDING_BATTERY_UNKNOWN};
    static const finding_t WITHOUT_BATTERY[] = {
        FINDING_CURRENT_A,          FINDING_CURRENT_B,         FINDING_CURRENT_C,
        FINDING_WINDING_THERMISTOR, FINDING_SWITCH_THERMISTOR, FINDING_ROTOR_READING,
        FINDING_ROTOR_GLITCH,       FINDING_ROTOR_STOPS};
    static const finding_t IN_ORDER[] = {FINDING_ROTOR_READING, FINDING_ROTOR_GLITCH,
                                         FINDING_ROTOR_STOPS, FINDING_ROTOR_UNNAMED,
                                         FINDING_OBSERVER_IN_USE};
    static const finding_t BY_STEPS[] = {FINDING_FORCED_TORQUE, FINDING_ROTOR_SLIPS,
                                         FINDING_ROTOR_FREEZES, FINDING_ROTOR_REVERSES};
    return (is_one_of(row, BY_STEPS, 4) && by == FINDING_READING_BY_STEPS) ||
           (is_one_of(row, WITHOUT_BATTERY, 8) && is_one_of(by, BATTERY, 3)) ||
           (is_one_of(row, IN_ORDER, 5) && by == FINDING_STEPS) ||
           ((row == FINDING_FLUX_LOW || row == FINDING_FLUX_HIGH) &&
            by == FINDING_BUS_CONTRADICTED);
}

#define ROW(check, name, evidence, qualify_time, heal_time, explained_by, reacts)                  \
    {FINDING_##check,           REASON_##name, EVIDENCE_##evidence,                                \
     FINDING_REACTION_##reacts, qualify_time,  heal_time},
typedef enum { EVIDENCE_MEASURED, EVIDENCE_INFERRED, EVIDENCE_EXCEPTION } evidence_t;
#define AT_ONCE "at once"
#define NEVER "never"
#define MS(n) #n " ms"
#define FIELD(section, name) #section "." #name
#define RAMP(section, name) "torque ramp + " #section "." #name
#define OWN(text) text
/* The list again, as the enumeration is made of it. */
static const struct {
    finding_t row;
    reason_t reason;
    evidence_t evidence;
    finding_reaction_t reaction;
    const char *qualify, *heal;
} ROWS[] = {FINDING_LIST(ROW)};

void test_every_row_has_its_reason_reaction_and_times(void)
{
    TEST_ASSERT_EQUAL_INT(FINDING_COUNT, sizeof ROWS / sizeof ROWS[0]);
    for (int k = 0; k < FINDING_COUNT; k++) {
        const finding_row_t row = findings_row(ROWS[k].row);
        TEST_ASSERT_EQUAL_INT(k, ROWS[k].row);
        TEST_ASSERT_EQUAL_INT(ROWS[k].reason, row.reason);
        TEST_ASSERT_EQUAL_INT(ROWS[k].reaction, row.reaction);
        TEST_ASSERT_EQUAL_INT(ROWS[k].reaction, findings_reaction(ROWS[k].row));
        TEST_ASSERT_EQUAL_STRING(ROWS[k].qualify, row.time.qualify);
        TEST_ASSERT_EQUAL_STRING(ROWS[k].heal, row.time.heal);
    }
}

void test_a_number_beyond_the_table_has_no_reason_and_no_reaction(void)
{
    const finding_row_t none = findings_row(FINDING_COUNT);
    TEST_ASSERT_EQUAL_STRING("unknown", none.time.qualify);
    TEST_ASSERT_EQUAL_STRING("unknown", none.time.heal);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, none.reason);
    TEST_ASSERT_EQUAL_INT(FINDING_REACTION_NONE, none.reaction);
    TEST_ASSERT_EQUAL_INT(FINDING_REACTION_NONE, findings_reaction(FINDING_COUNT));
    TEST_ASSERT_EQUAL_INT(REASON_NONE, findings_reason(&findings, FINDING_COUNT));
}

#define REACTION_TEXT(identifier, text) text,

void test_every_reaction_has_its_text(void)
{
    static const char *const TEXTS[] = {FINDING_REACTION_LIST(REACTION_TEXT)};
    const int count = sizeof TEXTS / sizeof TEXTS[0];
    for (int k = 0; k < count; k++) {
        TEST_ASSERT_EQUAL_STRING(TEXTS[k], findings_reaction_text((finding_reaction_t)k));
    }
    TEST_ASSERT_EQUAL_STRING("none, it is only reported",
                             findings_reaction_text(FINDING_REACTION_NONE));
    TEST_ASSERT_EQUAL_STRING("unknown", findings_reaction_text((finding_reaction_t)count));
}

/* The rule of evidence: what is only inferred warns, but for a closed list. */
void test_what_is_inferred_takes_no_torque(void)
{
    static const finding_t EXCEPTIONS[] = {
        FINDING_ANGLE,           FINDING_TORQUE,      FINDING_SWITCH_STUCK,  FINDING_BATTERY_LEFT,
        FINDING_BATTERY_UNKNOWN, FINDING_CURRENT_A,   FINDING_CURRENT_B,     FINDING_CURRENT_C,
        FINDING_FORCED_TORQUE,   FINDING_ROTOR_SLIPS, FINDING_ROTOR_FREEZES, FINDING_ROTOR_REVERSES,
        FINDING_ROTOR_UNNAMED};
    const int count = sizeof EXCEPTIONS / sizeof EXCEPTIONS[0];
    for (int k = 0; k < FINDING_COUNT; k++) {
        const bool exception = is_one_of(ROWS[k].row, EXCEPTIONS, count);
        TEST_ASSERT_EQUAL_INT(exception, ROWS[k].evidence == EVIDENCE_EXCEPTION);
        if (ROWS[k].evidence == EVIDENCE_INFERRED) {
            TEST_ASSERT_EQUAL_INT(FINDING_REACTION_NONE, ROWS[k].reaction);
            TEST_ASSERT_TRUE(k >= FAULT_COUNT);
        }
    }
}

static bool is_latched(reason_t reason)
{
    const fault_clearing_t clearing = fault_clearing(reason);
    return clearing == FAULT_CLEARING_ACKNOWLEDGED || clearing == FAULT_CLEARING_RESTART;
}

/* modes latches the reason of a fault, so it takes the torque and does not end by itself. */
void test_a_fault_takes_the_torque_and_is_latched_and_a_warning_ends_by_itself(void)
{
    for (int row = 0; row < FINDING_COUNT; row++) {
        const finding_row_t columns = findings_row((finding_t)row);
        if (row < FAULT_COUNT) {
            TEST_ASSERT_TRUE(columns.reaction == FINDING_REACTION_SAFE_STATE ||
                             columns.reaction == FINDING_REACTION_TRIP ||
                             columns.reaction == FINDING_REACTION_RAMP);
            TEST_ASSERT_TRUE(row == FINDING_TRIP || is_latched(columns.reason));
        } else {
            TEST_ASSERT_TRUE(columns.reaction != FINDING_REACTION_SAFE_STATE &&
                             columns.reaction != FINDING_REACTION_TRIP &&
                             columns.reaction != FINDING_REACTION_RAMP);
            TEST_ASSERT_FALSE(is_latched(columns.reason));
            TEST_ASSERT_TRUE(strcmp(columns.time.heal, "never") != 0);
        }
    }
}

/* Of an over-current nobody but the fast monitor knows: FINDING_TRIP. */
void test_every_reason_of_a_fault_has_a_check_that_finds_it(void)
{
    reason_t reason = REASON_NONE;
    for (uint32_t place = 0; fault_listed(place, &reason); place++) {
        bool found = false;
        for (int row = 0; row < FINDING_COUNT; row++) {
            found = found || findings_row((finding_t)row).reason == reason;
        }
        TEST_ASSERT_EQUAL_MESSAGE(reason != REASON_OVERCURRENT, found, reason_name(reason));
    }
}

/* ---- what is present ---- */

void test_without_a_condition_nothing_is_found(void)
{
    for (int row = 0; row < FINDING_COUNT; row++) {
        findings_set(&findings, (finding_t)row, false);
        TEST_ASSERT_FALSE(findings_present(&findings, (finding_t)row));
        TEST_ASSERT_FALSE(findings_suspected(&findings, (finding_t)row));
    }
    TEST_ASSERT_EQUAL_INT(FINDING_COUNT, findings_fault(&findings));
    TEST_ASSERT_EQUAL_INT(FINDING_COUNT, findings_warning(&findings));
    TEST_ASSERT_FALSE(findings_off(&findings));
}

void test_a_row_is_present_alone_with_its_reason_and_as_fault_or_warning(void)
{
    for (int row = 0; row < FINDING_COUNT; row++) {
        setUp();
        find((finding_t)row);
        for (int other = 0; other < FINDING_COUNT; other++) {
            TEST_ASSERT_EQUAL_INT(other == row, findings_present(&findings, (finding_t)other));
        }
        const bool is_fault = is_one_of((finding_t)row, FAULTS, FAULT_COUNT);
        const bool is_warning = !is_fault && is_shown((finding_t)row);
        TEST_ASSERT_EQUAL_INT(is_fault ? row : FINDING_COUNT, findings_fault(&findings));
        TEST_ASSERT_EQUAL_INT(is_warning ? row : FINDING_COUNT, findings_warning(&findings));
        TEST_ASSERT_EQUAL_INT(ROWS[row].reason, findings_reason(&findings, (finding_t)row));
        findings_set(&findings, (finding_t)row, false);
        TEST_ASSERT_FALSE(findings_present(&findings, (finding_t)row));
    }
}

/* Of the rows that exclude each other: as if each were set with its own condition. */
void test_of_neighbouring_rows_that_with_the_reason_is_found_and_no_other(void)
{
    static const struct {
        finding_t first, last;
    } NEIGHBOURS[] = {{FINDING_BUS_LOW, FINDING_BUS_HIGH},
                      {FINDING_CURRENT_A, FINDING_CURRENT_C},
                      {FINDING_ROTOR_SLIPS, FINDING_ROTOR_UNNAMED},
                      {FINDING_ACCELERATOR, FINDING_DEMAND_REFUSED}};
    findings_t one_by_one = findings;
    for (int k = 0; k < (int)(sizeof NEIGHBOURS / sizeof NEIGHBOURS[0]); k++) {
        const finding_t first = NEIGHBOURS[k].first;
        const finding_t last = NEIGHBOURS[k].last;
        for (int reason = 0; reason <= UINT8_MAX; reason++) {
            findings_set_named(&findings, first, last, (reason_t)reason);
            for (finding_t row = first; row <= last; row++) {
                findings_set(&one_by_one, row, reason != 0 && (int)ROWS[row].reason == reason);
            }
            TEST_ASSERT_EQUAL_MEMORY(&one_by_one, &findings, sizeof findings);
        }
        findings_set_named(&findings, first, last, REASON_NONE);
        for (finding_t row = first; row <= last; row++) {
            findings_set(&one_by_one, row, false);
            TEST_ASSERT_FALSE(findings_qualified(&findings, row));
        }
    }
}

void test_the_record_begins_anew_whatever_was_found(void)
{
    for (int row = 0; row < FINDING_COUNT; row++) {
        find((finding_t)row);
        findings_suspect(&findings, (finding_t)row, true);
    }
    findings_trip(&findings, REASON_OVERCURRENT);
    init_with(2, 1);
    test_without_a_condition_nothing_is_found();
    TEST_ASSERT_EQUAL_INT(REASON_NONE, findings_reason(&findings, FINDING_TRIP));
    find(FINDING_TORQUE); /* the count as well */
    TEST_ASSERT_FALSE(findings_present(&findings, FINDING_TORQUE));
}

/* ---- order ---- */

void test_the_first_fault_in_the_order_of_causes_is_shown(void)
{
    TEST_ASSERT_EQUAL_INT(FINDING_COUNT, FAULT_COUNT + WARNING_COUNT);
    for (int k = FAULT_COUNT - 1; k >= 0; k--) { /* the consequences first */
        find(FAULTS[k]);
        TEST_ASSERT_EQUAL_INT(FAULTS[k], findings_fault(&findings));
    }
    for (int k = 0; k < FAULT_COUNT; k++) {
        TEST_ASSERT_EQUAL_INT(FAULTS[k], findings_fault(&findings));
        findings_set(&findings, FAULTS[k], false);
    }
    TEST_ASSERT_EQUAL_INT(FINDING_COUNT, findings_fault(&findings));
}

/* Of any two warnings the first, unless the second one explains it or it has no reason. */
void test_the_first_warning_that_is_not_explained_is_shown(void)
{
    for (int first = 0; first < WARNING_COUNT; first++) {
        for (int second = first + 1; second < WARNING_COUNT; second++) {
            setUp();
            find(WARNINGS[second]);
            find(WARNINGS[first]);
            const bool shows_first =
                is_shown(WARNINGS[first]) && !is_explained(WARNINGS[first], WARNINGS[second]);
            const bool shows_second =
                is_shown(WARNINGS[second]) && !is_explained(WARNINGS[second], WARNINGS[first]);
            TEST_ASSERT_EQUAL_INT(shows_first    ? WARNINGS[first]
                                  : shows_second ? WARNINGS[second]
                                                 : FINDING_COUNT,
                                  findings_warning(&findings));
        }
    }
}

/* A warning that is only reported hides none that leaves less torque. */
void test_the_first_warning_that_leaves_less_torque_is_limiting(void)
{
    find(FINDING_BATTERY_UNKNOWN);
    find(FINDING_WINDING_THERMISTOR);
    TEST_ASSERT_EQUAL_INT(FINDING_COUNT, findings_limiting(&findings));
    find(FINDING_BRAKE_PEDAL);
    TEST_ASSERT_EQUAL_INT(FINDING_BRAKE_PEDAL, findings_limiting(&findings));
    setUp();
    find(FINDING_WINDING_THERMISTOR);
    find(FINDING_ACCELERATOR);
    TEST_ASSERT_EQUAL_INT(FINDING_WINDING_THERMISTOR, findings_warning(&findings));
    TEST_ASSERT_EQUAL_INT(FINDING_ACCELERATOR, findings_limiting(&findings));
}

void test_faults_and_warnings_are_shown_side_by_side(void)
{
    find(FINDING_FLUX_LOW);
    find(FINDING_SWITCH_STUCK);
    TEST_ASSERT_EQUAL_INT(FINDING_SWITCH_STUCK, findings_fault(&findings));
    TEST_ASSERT_EQUAL_INT(FINDING_FLUX_LOW, findings_warning(&findings));
}

/* ---- explanation ---- */

void test_a_row_is_explained_by_a_present_or_a_suspected_cause_of_its_own_only(void)
{
    for (int row = 0; row < FINDING_COUNT; row++) {
        for (int by = 0; by < FINDING_COUNT; by++) {
            const bool explained = is_explained((finding_t)row, (finding_t)by);
            setUp();
            find((finding_t)row);
            find((finding_t)by);
            TEST_ASSERT_EQUAL_INT(!explained, findings_present(&findings, (finding_t)row));
            setUp();
            find((finding_t)row);
            findings_suspect(&findings, (finding_t)by, true);
            TEST_ASSERT_EQUAL_INT(!explained, findings_present(&findings, (finding_t)row));
            TEST_ASSERT_EQUAL_INT(row == by, findings_present(&findings, (finding_t)by));
            findings_suspect(&findings, (finding_t)by, false);
            TEST_ASSERT_TRUE(findings_present(&findings, (finding_t)row));
        }
    }
}

void test_a_row_shows_again_once_its_cause_has_healed(void)
{
    find(FINDING_FLUX_LOW);
    find(FINDING_BUS_CONTRADICTED);
    TEST_ASSERT_FALSE(findings_present(&findings, FINDING_FLUX_LOW));
    findings_set(&findings, FINDING_BUS_CONTRADICTED, false);
    TEST_ASSERT_EQUAL_INT(FINDING_FLUX_LOW, findings_warning(&findings));
}

void test_a_suspicion_alone_is_no_finding(void)
{
    for (int row = 0; row < FINDING_COUNT; row++) {
        findings_suspect(&findings, (finding_t)row, true);
        for (int other = 0; other < FINDING_COUNT; other++) {
            TEST_ASSERT_EQUAL_INT(other <= row, findings_suspected(&findings, (finding_t)other));
        }
    }
    TEST_ASSERT_EQUAL_INT(FINDING_COUNT, findings_fault(&findings));
    TEST_ASSERT_EQUAL_INT(FINDING_COUNT, findings_warning(&findings));
}

/* ---- the trip and the bus ---- */

void test_a_trip_has_the_name_that_the_fast_monitor_gave_it(void)
{
    static const reason_t NAMES[] = {REASON_OVERCURRENT, REASON_HARDWARE_BREAK, REASON_MEMORY};
    for (int k = 0; k < 3; k++) {
        findings_trip(&findings, NAMES[k]);
        TEST_ASSERT_EQUAL_INT(FINDING_TRIP, findings_fault(&findings));
        TEST_ASSERT_EQUAL_INT(NAMES[k], findings_reason(&findings, FINDING_TRIP));
    }
    findings_trip(&findings, REASON_NONE);
    TEST_ASSERT_EQUAL_INT(FINDING_COUNT, findings_fault(&findings));
    TEST_ASSERT_EQUAL_INT(REASON_NONE, findings_reason(&findings, FINDING_TRIP));
}

void test_a_bus_without_a_battery_and_a_hot_part_switch_off_named_or_not(void)
{
    for (int row = 0; row < FINDING_COUNT; row++) {
        const bool off = row == FINDING_BUS_JUMPED || row == FINDING_BATTERY_LEFT ||
                         row == FINDING_BATTERY_UNKNOWN || row == FINDING_WINDING_HOT ||
                         row == FINDING_SWITCH_HOT;
        setUp();
        find((finding_t)row);
        TEST_ASSERT_EQUAL_INT(off, findings_off(&findings));
        TEST_ASSERT_EQUAL_INT(off, findings_reaction((finding_t)row) == FINDING_REACTION_OFF);
    }
}

/* ---- times ---- */

void test_a_row_counts_and_heals_after_its_own_times(void)
{
    finding_times_t times[FINDING_COUNT];
    for (int row = 0; row < FINDING_COUNT; row++) {
        times[row].qualify_steps = (uint16_t)(2 + row);
        times[row].heal_steps = (uint16_t)(100 - row);
    }
    for (int row = 0; row < FINDING_COUNT; row++) {
        findings_init(&findings, times, false);
        for (int n = 1; n < 2 + row; n++) {
            find((finding_t)row);
            TEST_ASSERT_FALSE(findings_present(&findings, (finding_t)row));
        }
        find((finding_t)row);
        for (int n = 1; n < 100 - row; n++) {
            TEST_ASSERT_TRUE(findings_present(&findings, (finding_t)row));
            findings_set(&findings, (finding_t)row, false);
        }
        TEST_ASSERT_TRUE(findings_present(&findings, (finding_t)row));
        findings_set(&findings, (finding_t)row, false);
        TEST_ASSERT_FALSE(findings_present(&findings, (finding_t)row));
    }
}

void test_a_step_without_the_condition_begins_the_qualify_time_anew(void)
{
    init_with(3, 1);
    for (int n = 0; n < 10; n++) {
        find(FINDING_SUM);
        find(FINDING_SUM);
        findings_set(&findings, FINDING_SUM, false);
        TEST_ASSERT_FALSE(findings_present(&findings, FINDING_SUM));
    }
}

/* Rows without anything to count are passed over: it makes no difference. Of faults, which do not
 * heal more slowly each time. */
void test_every_row_is_its_debounce_in_any_sequence(void)
{
    random_t random = random_seeded(1);
    debounce_t expected[FINDING_COUNT];
    memset(expected, 0, sizeof expected);
    init_with(3, 4);
    for (int n = 0; n < 20000; n++) {
        const finding_t row = (finding_t)random_between(&random, 0, FAULT_COUNT - 1);
        const bool condition = random_chance(&random, 0.6);
        const bool present = debounce_step(&expected[row], condition, 3, 4);
        findings_set(&findings, row, condition);
        const uint32_t bit = findings.present[(uint32_t)row / 32U] & findings_bit(row);
        TEST_ASSERT_EQUAL_INT(present, bit != 0U);
    }
}

/* ---- what comes and goes ---- */

/* Steps without the condition until the row is gone; from when it is present. */
static int heal_steps_of(finding_t row)
{
    int steps = 0;
    while (findings_qualified(&findings, row)) {
        findings_set(&findings, row, false);
        steps++;
    }
    return steps;
}

static void rest(finding_t row, int steps)
{
    for (int n = 0; n < steps; n++) {
        findings_set(&findings, row, false);
    }
}

/* 334 ms at the first return, twice as long at each one, ten seconds in the end. */
void test_a_warning_that_returns_heals_twice_as_slowly_each_time(void)
{
    static const int EXPECTED[] = {1, 334, 668, 1336, 2672, 5344, 10000, 10000};
    for (int k = 0; k < (int)(sizeof EXPECTED / sizeof EXPECTED[0]); k++) {
        find(FINDING_BATTERY_LEFT);
        TEST_ASSERT_EQUAL_INT(EXPECTED[k], heal_steps_of(FINDING_BATTERY_LEFT));
        rest(FINDING_BATTERY_LEFT, 5);
    }
    rest(FINDING_BATTERY_LEFT, FINDING_QUIET_STEPS);
    find(FINDING_BATTERY_LEFT);
    TEST_ASSERT_EQUAL_INT(1, heal_steps_of(FINDING_BATTERY_LEFT));
}

/* 5 and 25 Hz, half of the time, for five seconds: five changes in any second. */
void test_a_loose_contact_makes_at_most_five_changes_a_second(void)
{
    static const int HALF_PERIODS_ms[] = {1, 20, 50, 100, 250};
    for (int k = 0; k < 5; k++) {
        setUp();
        int changes_at_ms[64];
        int changes = 0;
        bool before = false;
        for (int ms = 0; ms < 5000; ms++) {
            findings_set(&findings, FINDING_BATTERY_LEFT, ms / HALF_PERIODS_ms[k] % 2 == 0);
            const bool now = findings_present(&findings, FINDING_BATTERY_LEFT);
            if (now != before) {
                TEST_ASSERT_LESS_THAN_INT(64, changes);
                changes_at_ms[changes++] = ms;
                if (changes > 5) {
                    TEST_ASSERT_GREATER_OR_EQUAL_INT(1000, ms - changes_at_ms[changes - 6]);
                }
            }
            before = now;
        }
        TEST_ASSERT_GREATER_THAN_INT(1, changes);
    }
}

/* Its condition is there again for a step as soon as it has healed. */
void test_the_worst_contact_makes_at_most_five_changes_a_second(void)
{
    int changes_at_ms[64];
    int changes = 0;
    bool before = false;
    for (int ms = 0; ms < 30000; ms++) {
        findings_set(&findings, FINDING_BATTERY_LEFT, !before);
        const bool now = findings_present(&findings, FINDING_BATTERY_LEFT);
        if (now != before) {
            TEST_ASSERT_LESS_THAN_INT(64, changes);
            changes_at_ms[changes++] = ms;
            if (changes > 5) {
                TEST_ASSERT_GREATER_OR_EQUAL_INT(1000, ms - changes_at_ms[changes - 6]);
            }
        }
        before = now;
    }
    TEST_ASSERT_GREATER_THAN_INT(10, changes);
}

/* Faults are latched elsewhere, what has no name only explains, and without another brake nothing
 * takes the motor's braking away for longer than its cause. */
void test_what_must_end_with_its_cause_does_so_however_often_it_comes(void)
{
    static const finding_t ROWS_AT_ONCE[] = {FINDING_SUM, FINDING_BATTERY_UNKNOWN,
                                             FINDING_READING_BY_STEPS, FINDING_BATTERY_LEFT};
    for (int k = 0; k < 4; k++) {
        setUp();
        findings.braking_kept = true;
        for (int n = 0; n < 10; n++) {
            find(ROWS_AT_ONCE[k]);
            TEST_ASSERT_EQUAL_INT(1, heal_steps_of(ROWS_AT_ONCE[k]));
        }
    }
    setUp();
    findings.braking_kept = true; /* less driving torque may last */
    find(FINDING_BUS_CONTRADICTED);
    rest(FINDING_BUS_CONTRADICTED, 2);
    find(FINDING_BUS_CONTRADICTED);
    TEST_ASSERT_EQUAL_INT(334, heal_steps_of(FINDING_BUS_CONTRADICTED));
}
