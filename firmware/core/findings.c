/* SPDX-License-Identifier: Apache-2.0 */
#include "core/findings.h"

#include "core/scaled.h"
#include "core/words.h"

/* ---- the table ---- */

#define BIT(row) (UINT64_C(1) << FINDING_##row)
#define BATTERY_BITS (BIT(BUS_JUMPED) | BIT(BATTERY_LEFT) | BIT(BATTERY_UNKNOWN))

/* X(name, rows): what explains a row. */
#define EXPLANATIONS(X)                                                                            \
    X(NONE, 0)                                                                                     \
    X(STEPS, BIT(STEPS))                                                                           \
    X(BATTERY, BATTERY_BITS)                                                                       \
    X(BATTERY_OR_STEPS, BATTERY_BITS | BIT(STEPS))                                                 \
    X(BY_STEPS, BIT(READING_BY_STEPS))                                                             \
    X(BUS_READING, BIT(BUS_CONTRADICTED))

/* Some rows: a bit each, in two words. */
typedef struct {
    uint32_t word[FINDING_WORDS];
} rows_t;

#define ROWS_OF(bits)                                                                              \
    {                                                                                              \
        {                                                                                          \
            (uint32_t)((bits)&UINT32_MAX), (uint32_t)((uint64_t)(bits) >> 32)                      \
        }                                                                                          \
    }
#define EXPLAINING_ROWS(name, bits) ROWS_OF(bits),
#define EXPLANATION_ENUM(name, bits) EXPLAINED_BY_##name,
static const rows_t EXPLAINING[] = {EXPLANATIONS(EXPLAINING_ROWS)};
enum { EXPLANATIONS(EXPLANATION_ENUM) EXPLANATION_COUNT };
_Static_assert(FINDING_COUNT <= 32 * FINDING_WORDS, "a bit a row");

typedef struct {
    uint8_t reason, reaction, explained_by;
} row_t;

#define ROW(check, name, evidence, qualify, heal, explanation, reacts)                             \
    {REASON_##name, FINDING_REACTION_##reacts, EXPLAINED_BY_##explanation},
static const row_t ROWS[FINDING_COUNT] = {FINDING_LIST(ROW)};

#define ONE_MORE(check, name, evidence, qualify, heal, explanation, reacts) +1
enum { FIRST_WARNING = FINDING_FAULTS(ONE_MORE) };

finding_row_t findings_row(finding_t row)
{
    const bool known = row < FINDING_COUNT;
    const finding_row_t out = {
        .time = finding_text(row),
        .reason = known ? (reason_t)ROWS[row].reason : REASON_NONE,
        .reaction = findings_reaction(row),
    };
    return out;
}

finding_reaction_t findings_reaction(finding_t row)
{
    return row < FINDING_COUNT ? (finding_reaction_t)ROWS[row].reaction : FINDING_REACTION_NONE;
}

#define REACTION_TEXT(identifier, text) text "\0"
const char *findings_reaction_text(finding_reaction_t reaction)
{
    return words_at(FINDING_REACTION_LIST(REACTION_TEXT), (uint32_t)reaction);
}

/* ---- the record ---- */

void findings_init(findings_t *findings, const finding_times_t times[FINDING_COUNT],
                   bool no_other_brake)
{
    const debounce_t quiet = {.count = 0};
    const finding_returns_t never = {.quiet_steps = 0};
    for (int word = 0; word < FINDING_WORDS; word++) {
        findings->active[word] = 0U;
        findings->present[word] = 0U;
        findings->suspected[word] = 0U;
    }
    findings->trip = REASON_NONE;
    findings->braking_kept = no_other_brake;
    for (int row = 0; row < FINDING_COUNT; row++) {
        findings->debounce[row] = quiet;
        findings->returns[row] = never;
        findings->times[row] = times[row];
    }
}

static uint32_t with_bit(uint32_t word, uint32_t bit, bool set)
{
    return set ? word | bit : word & ~bit;
}

/* Faults are latched by modes, and what has no name only explains. */
static bool heals_slower(const findings_t *findings, finding_t row)
{
    const bool kept = findings->braking_kept && findings_reaction(row) == FINDING_REACTION_OFF;
    return (int)row >= FIRST_WARNING && ROWS[row].reason != (uint8_t)REASON_NONE && !kept;
}

/* At a return the heal time doubles. */
static void note_presence(finding_returns_t *returns, bool came, uint16_t heal_steps)
{
    if (came && returns->quiet_steps > 0U) {
        const int32_t before = q_max(returns->heal_steps, heal_steps);
        returns->heal_steps = (uint16_t)q_clamp(2 * before, FINDING_RETURN_STEPS,
                                                q_max(FINDING_QUIET_STEPS, heal_steps));
    }
    returns->quiet_steps = FINDING_QUIET_STEPS;
}

static void note_absence(finding_returns_t *returns)
{
    returns->quiet_steps = (uint16_t)q_max(returns->quiet_steps - 1, 0);
    returns->heal_steps = returns->quiet_steps > 0U ? returns->heal_steps : 0U;
}

static uint32_t heal_steps_of(finding_returns_t *returns, const finding_times_t *times,
                              const debounce_t *debounce, bool present, bool condition)
{
    const bool came = !present && condition && debounce->count + 1U >= times->qualify_steps;
    if (came || present) {
        note_presence(returns, came, times->heal_steps);
    } else {
        note_absence(returns);
    }
    return returns->heal_steps > 0U ? returns->heal_steps : times->heal_steps;
}

void findings_step(findings_t *findings, finding_t row, bool condition)
{
    const finding_times_t *times = &findings->times[row];
    finding_returns_t *returns = &findings->returns[row];
    debounce_t *debounce = &findings->debounce[row];
    const uint32_t bit = findings_bit(row);
    const uint32_t word = (uint32_t)row / 32U;
    const bool before = (findings->present[word] & bit) != 0U;
    const uint32_t heal_steps = heals_slower(findings, row)
                                    ? heal_steps_of(returns, times, debounce, before, condition)
                                    : times->heal_steps;
    const bool present = debounce_step(debounce, condition, times->qualify_steps, heal_steps);
    findings->present[word] = with_bit(findings->present[word], bit, present);
    findings->active[word] = with_bit(findings->active[word], bit,
                                      present || debounce->count > 0U || returns->quiet_steps > 0U);
}

void findings_name(findings_t *findings, finding_t first, finding_t last, reason_t reason)
{
    for (uint32_t row = first; row <= (uint32_t)last; row++) {
        const bool named = reason != REASON_NONE && reason == (reason_t)ROWS[row].reason;
        findings_set(findings, (finding_t)row, named);
    }
}

bool findings_explained(const findings_t *findings, finding_t row)
{
    const uint32_t *by = EXPLAINING[ROWS[row].explained_by].word;
    return (((findings->present[0] | findings->suspected[0]) & by[0]) |
            ((findings->present[1] | findings->suspected[1]) & by[1])) != 0U;
}

static bool any_present(const findings_t *findings, const rows_t *rows)
{
    return ((findings->present[0] & rows->word[0]) | (findings->present[1] & rows->word[1])) != 0U;
}

/* The first present row of some. */
static finding_t first_of(const findings_t *findings, const rows_t *rows)
{
    if (!any_present(findings, rows)) {
        return FINDING_COUNT;
    }
    for (uint32_t word = 0; word < FINDING_WORDS; word++) {
        uint32_t left = findings->present[word] & rows->word[word];
        while (left != 0U) {
            const uint32_t lowest = left & (0U - left);
            const finding_t row = (finding_t)(32U * word + 31U - scaled_leading_zeros(lowest));
            if (!findings_explained(findings, row)) {
                return row;
            }
            left &= left - 1U;
        }
    }
    return FINDING_COUNT;
}

#define IF_FAULT(check, name, evidence, qualify, heal, explanation, reacts) | BIT(check)
#define IF_SHOWN(check, name, evidence, qualify, heal, explanation, reacts)                        \
    | (REASON_##name == REASON_NONE ? UINT64_C(0) : BIT(check))
#define IF_LIMITING(check, name, evidence, qualify, heal, explanation, reacts)                     \
    | (REASON_##name == REASON_NONE || FINDING_REACTION_##reacts == FINDING_REACTION_NONE          \
           ? UINT64_C(0)                                                                           \
           : BIT(check))
#define IF_OFF(check, name, evidence, qualify, heal, explanation, reacts)                          \
    | (FINDING_REACTION_##reacts == FINDING_REACTION_OFF ? BIT(check) : UINT64_C(0))

static const rows_t FAULTS = ROWS_OF(UINT64_C(0) FINDING_FAULTS(IF_FAULT));
static const rows_t SHOWN = ROWS_OF(UINT64_C(0) FINDING_WARNINGS(IF_SHOWN));
static const rows_t LIMITING = ROWS_OF(UINT64_C(0) FINDING_WARNINGS(IF_LIMITING));
static const rows_t OFF = ROWS_OF(UINT64_C(0) FINDING_WARNINGS(IF_OFF));

finding_t findings_fault(const findings_t *findings)
{
    return first_of(findings, &FAULTS);
}

finding_t findings_warning(const findings_t *findings)
{
    return first_of(findings, &SHOWN);
}

finding_t findings_limiting(const findings_t *findings)
{
    return first_of(findings, &LIMITING);
}

bool findings_off(const findings_t *findings)
{
    return any_present(findings, &OFF);
}

reason_t findings_reason(const findings_t *findings, finding_t row)
{
    if (row == FINDING_TRIP) {
        return findings->trip;
    }
    return row < FINDING_COUNT ? (reason_t)ROWS[row].reason : REASON_NONE;
}
