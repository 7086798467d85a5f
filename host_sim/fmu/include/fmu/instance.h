/* SPDX-License-Identifier: Apache-2.0 */
/*
 * instance.h: one instance of the unit: values of all variables, what may be done when, state as a
 * whole.
 *
 * The functions of the standard (fmi2.c, fmi3.c) are conversions of types around these. Functions
 * return false after telling the importer's log why.
 */
#ifndef FMU_INSTANCE_H
#define FMU_INSTANCE_H

#include "fmu/model.h"

typedef void instance_log_t(void *context, const char *message);

typedef struct instance instance_t;
typedef struct instance_state instance_state_t;

/* NULL, with a message, when the token is another unit's or there is no memory. log may be NULL. */
instance_t *instance_new(const char *token, instance_log_t *log, void *context);
void instance_delete(instance_t *instance);

/* As after instance_new(). */
bool instance_reset(instance_t *instance);

bool instance_enter_initialization(instance_t *instance, double start_s);
bool instance_exit_initialization(instance_t *instance);
bool instance_terminate(instance_t *instance);

/* reference: see model.h; type: as declared. During initialization outputs are those the present
 * inputs lead to. */
bool instance_get(instance_t *instance, uint32_t reference, model_type_t type, double *value);
bool instance_set(instance_t *instance, uint32_t reference, model_type_t type, double value);

/* from_s has to be where the last step ended. */
bool instance_step(instance_t *instance, double from_s, double step_s);

/* For features of the standard that are not supported: logs it and returns false. */
bool instance_refuse(instance_t *instance, const char *what);

/* A state in bytes carries a check: bytes that are damaged or another unit's are refused. */
bool instance_get_state(instance_t *instance,
                        instance_state_t **state); /* makes one if *state is NULL */
bool instance_set_state(instance_t *instance, const instance_state_t *state);
void instance_free_state(instance_state_t *state);
size_t instance_state_bytes(void);
void instance_state_to_bytes(const instance_state_t *state, void *bytes);
bool instance_state_from_bytes(instance_t *instance, const void *bytes, size_t size,
                               instance_state_t **state);

#endif
