/* SPDX-License-Identifier: Apache-2.0 */
/*
 * unit_functions.h: a unit through the functions of the standard, FMI 2.0 (unit_fmi2.c) or 3.0
 * (unit_fmi3.c), so that the same questions can be asked of both. True: the standard's OK.
 */
#ifndef UNIT_FUNCTIONS_H
#define UNIT_FUNCTIONS_H

#include "fmu/model.h"

enum { UNIT_MESSAGE_LENGTH = 400 };

extern const size_t unit_version;              /* 2 or 3 */
extern char unit_message[UNIT_MESSAGE_LENGTH]; /* the last one that was logged */

void *unit_new(const char *token);    /* NULL: refused */
void *unit_new_of_another_kind(void); /* model exchange, with the right token */
void *unit_new_without_log(const char *token);
void unit_delete(void *unit);

bool unit_begin(void *unit, double start_s);
bool unit_enter(void *unit, double start_s);
bool unit_exit(void *unit);
bool unit_step(void *unit, double from_s, double step_s);
bool unit_terminate(void *unit);
bool unit_reset(void *unit);

bool unit_get(void *unit, uint32_t reference, model_type_t type, double *value);
bool unit_set(void *unit, uint32_t reference, model_type_t type, double value);

bool unit_get_state(void *unit, void **state);
bool unit_set_state(void *unit, void *state);
void unit_free_state(void *unit, void **state);
size_t unit_state_bytes(void *unit, void *state);
bool unit_to_bytes(void *unit, void *state, unsigned char *bytes, size_t size);
bool unit_from_bytes(void *unit, const unsigned char *bytes, size_t size, void **state);

/* Calls what the unit does not offer; the first function that was not refused, or NULL. */
const char *unit_offers_too_much(void *unit);

#endif
