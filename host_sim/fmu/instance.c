/* SPDX-License-Identifier: Apache-2.0 */
#include "fmu/instance.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MESSAGE_LENGTH = 500 };
static const double CLOCK_ROUNDING_S = 1e-9;
static const double CLOCK_ROUNDING =
    4.0 * DBL_EPSILON; /* of the time: importers add up or multiply their steps */

typedef enum { STAGE_FRESH, STAGE_INITIALIZING, STAGE_RUNNING, STAGE_ENDED } stage_t;

/* Everything that is not the model's own: with the model's bytes after it, a state. */
typedef struct {
    stage_t stage;
    bool has_begun; /* the model; in STAGE_INITIALIZING: and no value was set since */
    double start_s, time_s;
} progress_t;

struct instance {
    model_t *model;
    instance_log_t *log;
    void *context;
    progress_t progress;
    double values[]; /* MODEL_VARIABLE_COUNT */
};

struct instance_state {
    progress_t progress;
    double rest[]; /* values, then the model's bytes; double, so that everything in it is aligned */
};

static size_t values_bytes(void)
{
    return (size_t)MODEL_VARIABLE_COUNT * sizeof(double);
}

static bool complain(const instance_t *instance, const char *format, ...)
{
    char message[MESSAGE_LENGTH];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof(message), format, arguments);
    va_end(arguments);
    if (instance->log != NULL) {
        instance->log(instance->context, message);
    }
    return false;
}

bool instance_refuse(instance_t *instance, const char *what)
{
    return complain(instance, "%s: not offered by this unit", what);
}

instance_t *instance_new(const char *token, instance_log_t *log, void *context)
{
    if (token == NULL || strcmp(token, MODEL_TOKEN) != 0) {
        if (log != NULL) {
            log(context, "the token is not this unit's: model description and binary do not belong "
                         "together");
        }
        return NULL;
    }
    instance_t *instance = calloc(1, sizeof(instance_t) + values_bytes());
    if (instance == NULL) {
        return NULL;
    }
    instance->log = log;
    instance->context = context;
    if (!instance_reset(instance)) {
        free(instance);
        return NULL;
    }
    return instance;
}

void instance_delete(instance_t *instance)
{
    if (instance != NULL) {
        model_delete(instance->model);
        free(instance);
    }
}

bool instance_reset(instance_t *instance)
{
    model_delete(instance->model);
    const progress_t fresh = {.stage = STAGE_FRESH};
    instance->progress = fresh;
    for (int k = 0; k < MODEL_VARIABLE_COUNT; k++) {
        instance->values[k] = MODEL_VARIABLES[k].start;
    }
    instance->model = model_new();
    return instance->model != NULL || complain(instance, "no memory");
}

static bool begin(instance_t *instance)
{
    if (instance->progress.has_begun) {
        return true;
    }
    model_delete(instance->model);
    instance->model = model_new();
    if (instance->model == NULL) {
        return complain(instance, "no memory");
    }
    if (!model_begin(instance->model, instance->values)) {
        return complain(instance, "%s", model_error(instance->model));
    }
    instance->progress.has_begun = true;
    return true;
}

bool instance_enter_initialization(instance_t *instance, double start_s)
{
    if (instance->progress.stage != STAGE_FRESH || !isfinite(start_s)) {
        return complain(
            instance,
            "initialization: once after instantiation or reset, with a finite start time");
    }
    instance->progress.stage = STAGE_INITIALIZING;
    instance->progress.start_s = start_s;
    instance->progress.time_s = start_s;
    return true;
}

bool instance_exit_initialization(instance_t *instance)
{
    if (instance->progress.stage != STAGE_INITIALIZING) {
        return complain(instance, "initialization has not been entered");
    }
    if (!begin(instance)) {
        return false;
    }
    instance->progress.stage = STAGE_RUNNING;
    return true;
}

bool instance_terminate(instance_t *instance)
{
    if (instance->progress.stage != STAGE_RUNNING) {
        return complain(instance, "nothing runs that could be terminated");
    }
    instance->progress.stage = STAGE_ENDED;
    return true;
}

static const model_variable_t *variable(const instance_t *instance, uint32_t reference,
                                        model_type_t type)
{
    if (reference < 1 || reference > (uint32_t)MODEL_VARIABLE_COUNT ||
        MODEL_VARIABLES[reference - 1].type != type) {
        complain(instance, "value reference %lu: no variable of this type",
                 (unsigned long)reference);
        return NULL;
    }
    return &MODEL_VARIABLES[reference - 1];
}

bool instance_get(instance_t *instance, uint32_t reference, model_type_t type, double *value)
{
    if (reference == 0 && type == MODEL_REAL) {
        *value = instance->progress.time_s;
        return true;
    }
    const model_variable_t *found = variable(instance, reference, type);
    if (found == NULL) {
        return false;
    }
    if (found->role == MODEL_OUTPUT && instance->progress.stage == STAGE_INITIALIZING &&
        !begin(instance)) {
        return false;
    }
    *value = instance->values[reference - 1];
    return true;
}

bool instance_set(instance_t *instance, uint32_t reference, model_type_t type, double value)
{
    const model_variable_t *found = variable(instance, reference, type);
    if (found == NULL) {
        return false;
    }
    const bool running = instance->progress.stage == STAGE_RUNNING;
    if (found->role == MODEL_OUTPUT || instance->progress.stage == STAGE_ENDED ||
        (running && found->role == MODEL_FIXED)) {
        return complain(instance, "%s: cannot be set%s", found->name,
                        running ? " during a run" : "");
    }
    if (!isfinite(value)) {
        return complain(instance, "%s: not a finite number", found->name);
    }
    if (running && value != instance->values[reference - 1] &&
        !model_set(instance->model, (int)reference - 1, value)) {
        return complain(instance, "%s", model_error(instance->model));
    }
    instance->values[reference - 1] = value;
    if (!running) {
        instance->progress.has_begun = false;
    }
    return true;
}

bool instance_step(instance_t *instance, double from_s, double step_s)
{
    progress_t *progress = &instance->progress;
    if (progress->stage != STAGE_RUNNING) {
        return complain(instance, "a step comes after initialization");
    }
    const double rounding_s = CLOCK_ROUNDING_S + CLOCK_ROUNDING * fabs(progress->time_s);
    if (!(fabs(from_s - progress->time_s) < rounding_s) || !(step_s > 0.0) || !isfinite(step_s)) {
        return complain(instance, "a step of %g s from %g s: the last one ended at %g s", step_s,
                        from_s, progress->time_s);
    }
    const double until_s = from_s + step_s;
    if (!model_advance(instance->model, until_s - progress->start_s, instance->values)) {
        return complain(instance, "%s", model_error(instance->model));
    }
    progress->time_s = until_s;
    return true;
}

static size_t state_bytes(void)
{
    return sizeof(instance_state_t) + values_bytes() + model_state_bytes();
}

/* FNV-1a, 64 bits, over the unit's token and the bytes: a state is good for the unit it was taken
 * from, and for no other. */
static uint64_t fingerprint(const unsigned char *bytes, size_t count)
{
    const uint64_t prime = 1099511628211U;
    uint64_t out = 14695981039346656037U;
    for (const char *token = MODEL_TOKEN; *token != '\0'; token++) {
        out = (out ^ (unsigned char)*token) * prime;
    }
    for (size_t k = 0; k < count; k++) {
        out = (out ^ bytes[k]) * prime;
    }
    return out;
}

size_t instance_state_bytes(void)
{
    return sizeof(uint64_t) + state_bytes();
}

static unsigned char *model_part(instance_state_t *state)
{
    return (unsigned char *)state->rest + values_bytes();
}

bool instance_get_state(instance_t *instance, instance_state_t **state)
{
    if (*state == NULL) {
        *state = calloc(1, state_bytes());
    }
    if (*state == NULL) {
        return complain(instance, "no memory for a state");
    }
    (*state)->progress = instance->progress;
    memcpy((*state)->rest, instance->values, values_bytes());
    if (instance->progress.has_begun && !model_save(instance->model, model_part(*state))) {
        return complain(instance, "%s", model_error(instance->model));
    }
    return true;
}

bool instance_set_state(instance_t *instance, const instance_state_t *state)
{
    if (state == NULL) {
        return complain(instance, "no state was given");
    }
    if (state->progress.has_begun) {
        /* A model that has not begun does so with the state's values; then it takes on what it had
         * become. */
        const double *values = state->rest;
        memcpy(instance->values, values, values_bytes());
        if (!begin(instance) ||
            !model_restore(instance->model, (const unsigned char *)values + values_bytes())) {
            return complain(instance, "%s", model_error(instance->model));
        }
    }
    instance->progress = state->progress;
    memcpy(instance->values, state->rest, values_bytes());
    return true;
}

void instance_free_state(instance_state_t *state)
{
    free(state);
}

void instance_state_to_bytes(const instance_state_t *state, void *bytes)
{
    unsigned char *const rest = (unsigned char *)bytes + sizeof(uint64_t);
    memcpy(rest, state, state_bytes());
    const uint64_t found = fingerprint(rest, state_bytes());
    memcpy(bytes, &found, sizeof(found));
}

bool instance_state_from_bytes(instance_t *instance, const void *bytes, size_t size,
                               instance_state_t **state)
{
    if (size != instance_state_bytes()) {
        return complain(instance, "a state has %lu bytes, not %lu",
                        (unsigned long)instance_state_bytes(), (unsigned long)size);
    }
    const unsigned char *const rest = (const unsigned char *)bytes + sizeof(uint64_t);
    uint64_t kept = 0;
    memcpy(&kept, bytes, sizeof(kept));
    if (kept != fingerprint(rest, state_bytes())) {
        return complain(instance, "a state that is damaged, or another unit's");
    }
    if (*state == NULL) {
        *state = malloc(state_bytes());
    }
    if (*state == NULL) {
        return complain(instance, "no memory for a state");
    }
    memcpy(*state, rest, state_bytes());
    return true;
}
