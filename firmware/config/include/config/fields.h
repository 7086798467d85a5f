/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fields.h: the fields of config_t one after another, each with name, values and range, for whoever
 * shows or checks them all. From the lists of config.h; never called in a control step.
 */
#ifndef CONFIG_FIELDS_H
#define CONFIG_FIELDS_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"

/* A field of config_t: one value or several, each an int32_t, or a map of int16_t. */
typedef struct {
    const char *section; /* with its dot: "motor." */
    const char *name;    /* "pole_pairs" */
    uint32_t
        offset_bytes; /* in config_t, a multiple of four; the next field follows without a gap */
    uint32_t count;   /* values; more than CONFIG_FIELD_VALUES_MAX in a map */
    uint32_t number;  /* from 0 on, in the order of config_t */
    int32_t lowest;   /* accepted values */
    int32_t highest;
} config_field_t;

enum { CONFIG_FIELD_VALUES_MAX = 8 };

/* The first field of config_t. */
config_field_t config_field_first(void);

/* Goes on to the next field. False behind the last one, which then stays. */
bool config_field_next(config_field_t *field);

/* The field that begins at this place of config_t, 0 .. offsetof(config_t, crc32) - 4; the next one
 * where none does, the last one behind it. */
config_field_t config_field_at(uint32_t offset_bytes);

/* One of the field's values in a configuration, 0 <= place < field->count. Every field begins at a
 * multiple of four bytes, so the image may be read as an array of words or of half-words. */
int32_t config_field_value(const config_t *config, const config_field_t *field, uint32_t place);

#endif
