/* SPDX-License-Identifier: Apache-2.0 */
/* A unit that is one controller: both steps at their own rates, inputs constant between
 * communication points. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "config/validate.h"
#include "exchange/controller_instance.h"
#include "exchange/variables.h"
#include "fmu/model.h"

enum { NAME_LENGTH = 80, STEP_PORTS = EXCHANGE_PORT_SLOW_OUTPUT + 1 };
static const double ROUNDING = 1e-6; /* of a period: periods are counted, not added up */

static const char *const PORT_NAME[STEP_PORTS] = {"fast_input", "fast_output", "slow_input",
                                                  "slow_output"};

/* What changes while it runs. */
typedef struct {
    controller_instance_t controller;
    int64_t periods, slow_steps;
    int32_t raw[STEP_PORTS][EXCHANGE_PORT_MAX];
} running_t;

struct model {
    running_t run;
    int index[STEP_PORTS][EXCHANGE_PORT_MAX]; /* of a port's variable in the table; -1: not in it */
    const char *error;
};

model_t *model_new(void)
{
    model_t *model = calloc(1, sizeof(*model));
    if (model != NULL) {
        model->error = "";
    }
    return model;
}

void model_delete(model_t *model)
{
    free(model);
}

const char *model_error(const model_t *model)
{
    return model->error;
}

static int index_of(const char *port, const char *name)
{
    char wanted[NAME_LENGTH];
    snprintf(wanted, sizeof(wanted), "%s.%s", port, name);
    for (int k = 0; k < MODEL_VARIABLE_COUNT; k++) {
        if (strcmp(MODEL_VARIABLES[k].name, wanted) == 0) {
            return k;
        }
    }
    return -1;
}

static variables_affine_t affine_of(const model_t *model, const variable_info_t *info)
{
    return variables_affine(info->scale, &model->run.controller.config);
}

static double setting(const char *wanted)
{
    for (int k = 0; k < MODEL_SETTING_COUNT; k++) {
        if (strcmp(MODEL_SETTINGS[k].name, wanted) == 0) {
            return MODEL_SETTINGS[k].value;
        }
    }
    return 0.0;
}

/* A variable that is not in the table has the value of a setting of its name. */
static void read_inputs(model_t *model, exchange_port_t port, const double *values)
{
    for (int k = 0; k < variables_count(port); k++) {
        const variable_info_t info = variables_info(port, k);
        const int index = model->index[port][k];
        const double value = index >= 0 ? values[index] : setting(info.name);
        model->run.raw[port][k] = variables_to_raw(&info, affine_of(model, &info), value);
    }
}

static void write_outputs(const model_t *model, exchange_port_t port, double *values)
{
    for (int k = 0; k < variables_count(port); k++) {
        const variable_info_t info = variables_info(port, k);
        if (model->index[port][k] >= 0) {
            values[model->index[port][k]] =
                variables_from_raw(affine_of(model, &info), model->run.raw[port][k]);
        }
    }
}

bool model_begin(model_t *model, double *values)
{
    config_t config;
    memset(&config, 0, sizeof(config));
    memcpy(&config, MODEL_CONFIG,
           MODEL_CONFIG_BYTES < sizeof(config) ? MODEL_CONFIG_BYTES : sizeof(config));
    if (config_validate(&config, MODEL_CONFIG_BYTES).code != CONFIG_RESULT_OK) {
        model->error = "the unit's configuration is refused by the firmware: the unit is damaged";
        return false;
    }
    controller_instance_init(&model->run.controller, &config);
    for (int port = 0; port < STEP_PORTS; port++) {
        for (int k = 0; k < variables_count((exchange_port_t)port); k++) {
            model->index[port][k] =
                index_of(PORT_NAME[port], variables_info((exchange_port_t)port, k).name);
        }
    }
    write_outputs(model, EXCHANGE_PORT_FAST_OUTPUT, values);
    write_outputs(model, EXCHANGE_PORT_SLOW_OUTPUT, values);
    return true;
}

bool model_set(model_t *model, int index, double value)
{
    (void)model; /* inputs are read when a step begins */
    (void)index;
    (void)value;
    return true;
}

bool model_advance(model_t *model, double until_s, double *values)
{
    running_t *run = &model->run;
    const double rate_hz = run->controller.config.drive.pwm_frequency_Hz;
    const double per_slow = rate_hz / CONTROLLER_SLOW_RATE_HZ;
    read_inputs(model, EXCHANGE_PORT_FAST_INPUT, values);
    read_inputs(model, EXCHANGE_PORT_SLOW_INPUT, values);
    while ((double)run->periods + ROUNDING < until_s * rate_hz) {
        if ((double)run->periods + ROUNDING >= (double)run->slow_steps * per_slow) {
            run->slow_steps++;
            controller_instance_slow_step(&run->controller, run->raw[EXCHANGE_PORT_SLOW_INPUT],
                                          run->raw[EXCHANGE_PORT_SLOW_OUTPUT]);
        }
        controller_instance_fast_step(&run->controller, run->raw[EXCHANGE_PORT_FAST_INPUT],
                                      run->raw[EXCHANGE_PORT_FAST_OUTPUT]);
        run->periods++;
    }
    write_outputs(model, EXCHANGE_PORT_FAST_OUTPUT, values);
    write_outputs(model, EXCHANGE_PORT_SLOW_OUTPUT, values);
    return true;
}

size_t model_state_bytes(void)
{
    return sizeof(running_t);
}

bool model_save(model_t *model, void *state)
{
    memcpy(state, &model->run, sizeof(model->run));
    return true;
}

bool model_restore(model_t *model, const void *state)
{
    memcpy(&model->run, state, sizeof(model->run));
    return true;
}
