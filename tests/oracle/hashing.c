/* SPDX-License-Identifier: Apache-2.0 */
#include "hashing.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include "accessors.h"
#include "steps.h"

enum { CONTROLLERS_MAX = 16 };

/* The accessors' places. */
#define PLACE_OF_FAST_OUTPUT(identifier, expression) FAST_OUTPUT_##identifier,
#define PLACE_OF_FAST_REPORT(identifier, expression) FAST_REPORT_##identifier,
#define PLACE_OF_SETPOINT(identifier, expression) SETPOINT_##identifier,
#define PLACE_OF_SLOW_OUTPUT(identifier, expression) SLOW_OUTPUT_##identifier,
#define PLACE_OF_LIMIT(identifier, expression) LIMIT_##identifier,
#define PLACE_OF_EVENT(identifier, expression) EVENT_##identifier,
enum {
    ORACLE_FAST_OUTPUT(PLACE_OF_FAST_OUTPUT) ORACLE_FAST_REPORT(PLACE_OF_FAST_REPORT)
        ORACLE_SETPOINT(PLACE_OF_SETPOINT) ORACLE_SLOW_OUTPUT(PLACE_OF_SLOW_OUTPUT)
            ORACLE_LIMITS(PLACE_OF_LIMIT) PLACES
};
enum { ORACLE_EVENTS(PLACE_OF_EVENT) EVENTS };
#define PLACE_OF_COUNT(identifier, expression) COUNTED_##identifier,
enum { ORACLE_COUNTED(PLACE_OF_COUNT) ORACLE_COUNTED_BY_NUMBER(PLACE_OF_COUNT) COUNTS };

#define NAME_OF_FAST_OUTPUT(identifier, expression) "fast_output." #identifier,
#define NAME_OF_FAST_REPORT(identifier, expression) "fast_report." #identifier,
#define NAME_OF_SETPOINT(identifier, expression) "setpoint." #identifier,
#define NAME_OF_SLOW_OUTPUT(identifier, expression) "slow_output." #identifier,
#define NAME_OF_LIMIT(identifier, expression) "limits." #identifier,
static const char *const NAMES[PLACES] = {
    ORACLE_FAST_OUTPUT(NAME_OF_FAST_OUTPUT) ORACLE_FAST_REPORT(NAME_OF_FAST_REPORT)
        ORACLE_SETPOINT(NAME_OF_SETPOINT) ORACLE_SLOW_OUTPUT(NAME_OF_SLOW_OUTPUT)
            ORACLE_LIMITS(NAME_OF_LIMIT)};
#define NAME_OF_COUNT(identifier, expression) #identifier,
static const char *const COUNT_NAMES[COUNTS] = {ORACLE_COUNTED(NAME_OF_COUNT)
                                                    ORACLE_COUNTED_BY_NUMBER(NAME_OF_COUNT)};

typedef struct {
    uint64_t state, words;
} stream_t;

typedef struct {
    const void *fast, *slow; /* the states that the steps were called with */
    int64_t fast_steps, slow_steps;
    bool has_events;
    int64_t event[EVENTS]; /* latest values */
    bool has_value[PLACES];
    int64_t value[PLACES]; /* latest, while they are listed */
} controller_record_t;

static struct {
    stream_t fast, slow, events, bytes;
    bool with_reports;
    int controllers;
    controller_record_t controller[CONTROLLERS_MAX];
    int64_t fast_steps, slow_steps;
    int64_t reached[COUNTS][ORACLE_NUMBERS];
    bool inspects; /* the values are listed, or one is changed */
    FILE *list;
    int changed_place;
    int64_t changed_step;
} run = {.changed_place = -1};

/* ---- the hash ---- */

static uint64_t rotated(uint64_t x, unsigned left)
{
    return (x << left) | (x >> (64U - left));
}

/* A round of xxHash64 (Collet): another value gives another state, another state too. */
static void add(stream_t *stream, int64_t value)
{
    const uint64_t mixed = (uint64_t)value * UINT64_C(0xC2B2AE3D27D4EB4F);
    stream->state = rotated(stream->state + mixed, 31) * UINT64_C(0x9E3779B185EBCA87);
    stream->words++;
}

/* MurmurHash3's finalizer (Appleby, 64 bits). */
static uint64_t finished(const stream_t *stream)
{
    uint64_t x = stream->state ^ stream->words;
    x = (x ^ (x >> 33)) * UINT64_C(0xFF51AFD7ED558CCD);
    x = (x ^ (x >> 33)) * UINT64_C(0xC4CEB9FE1A85EC53);
    return x ^ (x >> 33);
}

/* ---- inspection ---- */

static int64_t inspected(controller_record_t *record, int place, int64_t step, int64_t value)
{
    const int64_t given =
        place == run.changed_place && step == run.changed_step ? value + 1 : value;
    if (run.list != NULL && (!record->has_value[place] || record->value[place] != given)) {
        fprintf(run.list, "%lld %d %s %lld\n", (long long)step, (int)(record - run.controller),
                NAMES[place], (long long)given);
        record->has_value[place] = true;
        record->value[place] = given;
    }
    return given;
}

static void take(stream_t *stream, controller_record_t *record, int place, int64_t step,
                 int64_t value)
{
    add(stream, run.inspects ? inspected(record, place, step, value) : value);
}

/* ---- the controllers ---- */

static controller_record_t *record_of(const void *fast, const void *slow)
{
    for (int k = 0; k < run.controllers; k++) {
        controller_record_t *record = &run.controller[k];
        if (fast != NULL ? record->fast == fast : record->slow == slow) {
            return record;
        }
    }
    for (int k = 0; k < run.controllers; k++) { /* known by its other step so far */
        controller_record_t *record = &run.controller[k];
        if (fast != NULL && record->fast == NULL) {
            record->fast = fast;
            return record;
        }
        if (slow != NULL && record->slow == NULL) {
            record->slow = slow;
            return record;
        }
    }
    if (run.controllers == CONTROLLERS_MAX) {
        fprintf(stderr, "oracle: more than %d controllers in a run\n", CONTROLLERS_MAX);
        abort();
    }
    controller_record_t *record = &run.controller[run.controllers++];
    const controller_record_t fresh = {.fast = fast, .slow = slow};
    *record = fresh;
    return record;
}

static void take_report(controller_record_t *record, const fast_report_t *report)
{
    const int64_t step = record->fast_steps - 1;
#define TAKE(identifier, expression)                                                               \
    take(&run.fast, record, FAST_REPORT_##identifier, step, (int64_t)(expression));
    ORACLE_FAST_REPORT(TAKE)
#undef TAKE
}

void oracle_fast(const controller_fast_t *fast, const fast_output_t *output)
{
    controller_record_t *record = record_of(fast, NULL);
    const int64_t step = record->fast_steps++;
    run.fast_steps++;
#define TAKE(identifier, expression)                                                               \
    take(&run.fast, record, FAST_OUTPUT_##identifier, step, (int64_t)(expression));
    ORACLE_FAST_OUTPUT(TAKE)
#undef TAKE
    if (run.with_reports) {
        fast_report_t report;
        controller_fast_report(fast, &report);
        take_report(record, &report);
    }
}

static void note_events(controller_record_t *record, int64_t step, const int64_t now[EVENTS])
{
    for (int k = 0; k < EVENTS; k++) {
        if (!record->has_events || record->event[k] != now[k]) {
            add(&run.events, record - run.controller);
            add(&run.events, step);
            add(&run.events, k);
            add(&run.events, now[k]);
            record->event[k] = now[k];
        }
    }
    record->has_events = true;
}

void oracle_slow(const controller_slow_t *slow, const fast_report_t *report,
                 const slow_output_t *output, const fast_setpoint_t *setpoint,
                 const torque_limits_t *limits)
{
    controller_record_t *record = record_of(NULL, slow);
    const int64_t step = record->slow_steps++;
    run.slow_steps++;
    if (record->fast_steps > 0) { /* otherwise it was made by the generator of a run */
        take_report(record, report);
    }
#define TAKE(identifier, expression)                                                               \
    take(&run.slow, record, SETPOINT_##identifier, step, (int64_t)(expression));
    ORACLE_SETPOINT(TAKE)
#undef TAKE
#define TAKE(identifier, expression)                                                               \
    take(&run.slow, record, SLOW_OUTPUT_##identifier, step, (int64_t)(expression));
    ORACLE_SLOW_OUTPUT(TAKE)
#undef TAKE
#define TAKE(identifier, expression)                                                               \
    take(&run.slow, record, LIMIT_##identifier, step, (int64_t)(expression));
    ORACLE_LIMITS(TAKE)
#undef TAKE
#define NOW(identifier, expression) [EVENT_##identifier] = (int64_t)(expression),
    const int64_t now[EVENTS] = {ORACLE_EVENTS(NOW)};
#undef NOW
    note_events(record, step, now);
#define COUNT(identifier, expression) run.reached[COUNTED_##identifier][0] += (expression) ? 1 : 0;
    ORACLE_COUNTED(COUNT)
#undef COUNT
#define COUNT(identifier, expression)                                                              \
    run.reached[COUNTED_##identifier][(unsigned)(expression) % ORACLE_NUMBERS]++;
    ORACLE_COUNTED_BY_NUMBER(COUNT)
#undef COUNT
}

/* ---- the interface ---- */

void oracle_begin(int with_reports)
{
    const stream_t fresh = {.state = UINT64_C(0x68756266)};
    run.fast = fresh;
    run.slow = fresh;
    run.events = fresh;
    run.bytes = fresh;
    run.with_reports = with_reports != 0;
    run.controllers = 0;
    run.fast_steps = 0;
    run.slow_steps = 0;
}

void oracle_bytes(const void *data, uint32_t size_bytes)
{
    const unsigned char *byte = data;
    for (uint32_t k = 0; k < size_bytes; k++) {
        add(&run.bytes, byte[k]);
    }
}

oracle_hashes_t oracle_end(void)
{
    const oracle_hashes_t out = {
        .fast = finished(&run.fast),
        .slow = finished(&run.slow),
        .events = finished(&run.events),
        .bytes = finished(&run.bytes),
        .fast_steps = run.fast_steps,
        .slow_steps = run.slow_steps,
    };
    run.changed_place = -1;
    run.inspects = run.list != NULL;
    return out;
}

int oracle_reached_lists(void)
{
    return COUNTS;
}

const char *oracle_reached_name(int list)
{
    return list >= 0 && list < COUNTS ? COUNT_NAMES[list] : NULL;
}

int64_t oracle_reached(int list, int number)
{
    return run.reached[list][number];
}

int oracle_value_count(void)
{
    return PLACES;
}

const char *oracle_value_name(int place)
{
    return place >= 0 && place < PLACES ? NAMES[place] : NULL;
}

int oracle_list_values(const char *path)
{
    if (run.list != NULL) {
        fclose(run.list);
    }
    run.list = path != NULL ? fopen(path, "w") : NULL;
    run.inspects = run.list != NULL || run.changed_place >= 0;
    return path == NULL || run.list != NULL ? 1 : 0;
}

void oracle_change(int place, int64_t step)
{
    run.changed_place = place;
    run.changed_step = step;
    run.inspects = true;
}
