/* SPDX-License-Identifier: Apache-2.0 */
/*
 * validate.h: checks whether the firmware may run with a configuration.
 *
 * Called once in BOOT and by every host tool that loads an image; never in a control step. Checks,
 * in this order: magic, format version, size, CRC-32, name (printable), the range of every field
 * (the ranges of config.h), then the relations between fields that no single range can express. The
 * first failure is reported.
 */
#ifndef CONFIG_VALIDATE_H
#define CONFIG_VALIDATE_H

#include <stddef.h>

#include "config/config.h"

typedef enum {
    CONFIG_RESULT_OK = 0,
    CONFIG_RESULT_MAGIC,
    CONFIG_RESULT_VERSION,
    CONFIG_RESULT_SIZE,
    CONFIG_RESULT_CRC,
    CONFIG_RESULT_NAME,
    CONFIG_RESULT_RANGE,
    CONFIG_RESULT_RELATION
} config_result_code_t;

/* The first failed check. */
typedef struct {
    config_result_code_t code;
    const char *field;   /* behind the section: "pole_pairs", or the broken relation; never NULL */
    int32_t value;       /* RANGE: the value found; otherwise 0 */
    int32_t lowest;      /* RANGE: smallest accepted value */
    int32_t highest;     /* RANGE: largest accepted value */
    const char *section; /* "motor."; NULL where the field has none */
} config_result_t;

/* "motor.", or "" without a section: what to print in front of the field. */
static inline const char *config_result_section(const config_result_t *result)
{
    return result->section != NULL ? result->section : "";
}

/* A field of config_t: one value or several, each an int32_t. */
typedef struct {
    const char *name;      /* "pole_pairs" */
    uint16_t offset_bytes; /* in config_t */
    uint16_t count;        /* values; more than CONFIG_FIELD_VALUES_MAX in a map */
    int32_t lowest;        /* accepted values */
    int32_t highest;
} config_field_t;

enum { CONFIG_FIELD_VALUES_MAX = 8 };

/* The field with this index, in the order of config_t; NULL beyond the last one. */
const config_field_t *config_field(uint32_t index);

/* The section of a field, with its dot: "motor.". The flash holds each once. */
const char *config_field_section(const config_field_t *field);

/* The field's values in a configuration. */
const int32_t *config_field_values(const config_t *config, const config_field_t *field);

/* size_bytes: number of readable bytes from `config` on; fewer than sizeof(config_t) is refused
 * without being read. */
config_result_t config_validate(const config_t *config, uint32_t size_bytes);

/* CRC-32 (IEEE 802.3) of size bytes; crc32("123456789") = 0xCBF43926. Bitwise: small, for boot time
 * only. */
uint32_t config_crc32(const void *data, uint32_t size_bytes);

/* The CRC-32 of data whose first part has the CRC-32 `before`, from the next part; 0: there is none
 * before. */
uint32_t config_crc32_continue(uint32_t before, const void *data, uint32_t size_bytes);

#endif
