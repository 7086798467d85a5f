/* SPDX-License-Identifier: Apache-2.0 */
/*
 * face.h: a unit through the functions of the standard, FMI 2.0 (face_fmi2.c) or 3.0 (face_fmi3.c),
 * so that the same questions can be asked of both. True: the standard's OK.
 */
#ifndef FACE_H
#define FACE_H

#include "fmu/model.h"

enum { FACE_MESSAGE_LENGTH = 400 };

extern char face_message[FACE_MESSAGE_LENGTH]; /* the last one that was logged */

void *face_new(const char *token);    /* NULL: refused */
void *face_new_of_another_kind(void); /* model exchange, with the right token */
void *face_new_without_log(const char *token);
void face_delete(void *unit);

bool face_begin(void *unit, double start_s);
bool face_enter(void *unit, double start_s);
bool face_exit(void *unit);
bool face_step(void *unit, double from_s, double step_s);
bool face_terminate(void *unit);
bool face_reset(void *unit);

bool face_get(void *unit, uint32_t reference, model_type_t type, double *value);
bool face_set(void *unit, uint32_t reference, model_type_t type, double value);

bool face_get_state(void *unit, void **state);
bool face_set_state(void *unit, void *state);
void face_free_state(void *unit, void **state);
size_t face_state_bytes(void *unit, void *state);
bool face_to_bytes(void *unit, void *state, unsigned char *bytes, size_t size);
bool face_from_bytes(void *unit, const unsigned char *bytes, size_t size, void **state);

/* Calls what the unit does not offer; the first function that was not refused, or NULL. */
const char *face_offers_too_much(void *unit);

#endif
