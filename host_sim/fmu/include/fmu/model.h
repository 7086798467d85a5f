/* SPDX-License-Identifier: Apache-2.0 */
/*
 * model.h: the model in an FMU for co-simulation, for any version of the standard.
 *
 * A unit is one model (model_controller.c or model_vehicle.c) and one table of its variables,
 * written when the unit is built (hubsim.fmu). instance.h keeps the values of the variables and
 * implements the state machine of the standard; a model gets arrays of all values in the order of
 * the table, reads the inputs in them and writes the outputs.
 */
#ifndef FMU_MODEL_H
#define FMU_MODEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum { MODEL_REAL, MODEL_FLAG, MODEL_CODE } model_type_t;

typedef enum {
    MODEL_FIXED,   /* a parameter that is read when the run begins */
    MODEL_TUNABLE, /* a parameter that may change during the run */
    MODEL_INPUT,
    MODEL_OUTPUT
} model_role_t;

/* The value reference of the standard is the place in the table plus one; 0 is the independent
 * variable, time. */
typedef struct {
    const char *name;
    model_type_t type;
    model_role_t role;
    double start;
} model_variable_t;

/* Written when the unit is built. MODEL_SETTINGS are fixed parameters of the model: names and
 * values. */
typedef struct {
    const char *name;
    double value;
} model_setting_t;

extern const char MODEL_TOKEN[];
extern const int MODEL_VARIABLE_COUNT;
extern const model_variable_t MODEL_VARIABLES[];
extern const int MODEL_SETTING_COUNT;
extern const model_setting_t MODEL_SETTINGS[];
extern const uint32_t MODEL_CONFIG_BYTES;
extern const unsigned char MODEL_CONFIG[]; /* the image of config_t */
extern const int
    MODEL_CURVE_POINTS; /* open-circuit voltage over state of charge; 0 without a battery */
extern const double MODEL_CURVE_SOC[];
extern const double MODEL_CURVE_V[];

typedef struct model model_t;

/* NULL without memory. */
model_t *model_new(void);
void model_delete(model_t *model);

/* The last failure in one line; never NULL. */
const char *model_error(const model_t *model);

/* Begin a run at time 0 with these values, and write the outputs of that moment. False:
 * model_error() says why. */
bool model_begin(model_t *model, double *values);

/* A tunable parameter or an input has a new value. */
bool model_set(model_t *model, int index, double value);

/* Run until a time since the beginning, and write the outputs of that moment. */
bool model_advance(model_t *model, double until_s, double *values);

/* A model that runs, as bytes; restored into one that has begun with any values it goes on where it
 * was. */
size_t model_state_bytes(void);
bool model_save(model_t *model, void *state);
bool model_restore(model_t *model, const void *state);

#endif
