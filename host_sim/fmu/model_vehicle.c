/* SPDX-License-Identifier: Apache-2.0 */
/* A unit that is the whole simulated vehicle: the bench with the same interface that Python uses.
 */
#include <stdlib.h>
#include <string.h>

#include "bench/engine.h"
#include "fmu/model.h"

enum { NAME_LENGTH = 96 };

struct model {
    hubsim_t *sim;
    int outputs;
    int *indices; /* in the table, of the outputs in the order they are sampled */
    double *row;
    const char *error;
};

model_t *model_new(void)
{
    model_t *model = calloc(1, sizeof(*model));
    if (model == NULL) {
        return NULL;
    }
    model->error = "";
    model->sim = hubsim_new();
    model->indices = calloc((size_t)MODEL_VARIABLE_COUNT, sizeof(*model->indices));
    model->row = calloc((size_t)MODEL_VARIABLE_COUNT, sizeof(*model->row));
    if (model->sim == NULL || model->indices == NULL || model->row == NULL) {
        model_delete(model);
        return NULL;
    }
    return model;
}

void model_delete(model_t *model)
{
    if (model != NULL) {
        hubsim_delete(model->sim);
        free(model->indices);
        free(model->row);
        free(model);
    }
}

const char *model_error(const model_t *model)
{
    return model->error;
}

static bool succeeded(model_t *model, int status)
{
    if (status < HUBSIM_OK) {
        model->error = hubsim_error(model->sim);
    }
    return status >= HUBSIM_OK;
}

static bool set_everything(model_t *model, const double *values)
{
    bool out = succeeded(model, hubsim_set_voltage_curve(model->sim, MODEL_CURVE_SOC, MODEL_CURVE_V,
                                                         MODEL_CURVE_POINTS)) &&
               succeeded(model, hubsim_load_config(model->sim, MODEL_CONFIG, MODEL_CONFIG_BYTES));
    for (int k = 0; out && k < MODEL_SETTING_COUNT; k++) {
        out = succeeded(model,
                        hubsim_set(model->sim, MODEL_SETTINGS[k].name, MODEL_SETTINGS[k].value));
    }
    for (int k = 0; out && k < MODEL_VARIABLE_COUNT; k++) {
        if (MODEL_VARIABLES[k].role != MODEL_OUTPUT) {
            out = succeeded(model, hubsim_set(model->sim, MODEL_VARIABLES[k].name, values[k]));
        }
    }
    return out;
}

/* Number of the signal with a name, or their count. The search begins at `from` and wraps. */
static int signal_of(const model_t *model, const char *wanted, int from)
{
    const int count = hubsim_signal_count(model->sim);
    for (int k = 0; k < count; k++) {
        const int signal = (from + k) % count;
        char name[NAME_LENGTH];
        if (hubsim_signal_name(model->sim, signal, name, NAME_LENGTH) == HUBSIM_OK &&
            strcmp(name, wanted) == 0) {
            return signal;
        }
    }
    return count;
}

/* The signals are sampled in the order of the library; the table may have them in another. It
 * rarely does, so each search begins after the signal that was found before. */
static bool choose_outputs(model_t *model)
{
    int *chosen = calloc((size_t)MODEL_VARIABLE_COUNT, sizeof(*chosen));
    if (chosen == NULL) {
        model->error = "no memory";
        return false;
    }
    int signal = -1;
    model->outputs = 0;
    for (int k = 0; k < MODEL_VARIABLE_COUNT; k++) {
        if (MODEL_VARIABLES[k].role != MODEL_OUTPUT) {
            continue;
        }
        signal = signal_of(model, MODEL_VARIABLES[k].name, signal + 1);
        chosen[model->outputs] = signal; /* one that is not there is out of range, and refused */
        model->indices[model->outputs] = k;
        model->outputs++;
    }
    const bool out = succeeded(model, hubsim_choose(model->sim, chosen, model->outputs));
    free(chosen);
    return out;
}

static bool sample(model_t *model, double *values)
{
    if (!succeeded(model, hubsim_sample(model->sim, model->row))) {
        return false;
    }
    for (int k = 0; k < model->outputs; k++) {
        values[model->indices[k]] = model->row[k];
    }
    return true;
}

bool model_begin(model_t *model, double *values)
{
    return set_everything(model, values) && succeeded(model, hubsim_start(model->sim)) &&
           choose_outputs(model) && sample(model, values);
}

bool model_set(model_t *model, int index, double value)
{
    return succeeded(model, hubsim_set(model->sim, MODEL_VARIABLES[index].name, value));
}

bool model_advance(model_t *model, double until_s, double *values)
{
    return succeeded(model, hubsim_advance(model->sim, until_s)) && sample(model, values);
}

size_t model_state_bytes(void)
{
    return hubsim_state_bytes();
}

bool model_save(model_t *model, void *state)
{
    return succeeded(model, hubsim_save(model->sim, state));
}

bool model_restore(model_t *model, const void *state)
{
    return succeeded(model, hubsim_restore(model->sim, state));
}
