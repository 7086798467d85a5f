/* SPDX-License-Identifier: Apache-2.0 */
/*
 * validate.h: checks whether the firmware may run with a configuration.
 *
 * Called once in BOOT and by every host tool that loads an image; never in a control step. Checks,
 * in this order: magic, format version, size, CRC-32, name (printable), the range of every field
 * (the ranges of config.h), the relations between fields that no single range can express, then the
 * fields that follow from others (derived.h), whose range is what they follow from. The first
 * failure is reported.
 */
#ifndef CONFIG_VALIDATE_H
#define CONFIG_VALIDATE_H

#include <stdbool.h>
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

/* The first failed check. No text is NULL; one that does not apply is "". */
typedef struct {
    config_result_code_t code;
    const char *section;       /* "motor." */
    const char *field;         /* behind the section: "pole_pairs"; or a broken relation in words */
    const char *relation;      /* RELATION of two fields: " < " or " <= ", with what follows it */
    const char *upper_section; /* "battery." */
    const char *upper_field;
    int32_t value;   /* RANGE: the value found; otherwise 0 */
    int32_t lowest;  /* RANGE: smallest accepted value */
    int32_t highest; /* RANGE: largest accepted value */
} config_result_t;

/* The five texts of a result as arguments of a format with five %s, which say what was refused. */
#define CONFIG_RESULT_TEXTS(result)                                                                \
    (result)->section, (result)->field, (result)->relation, (result)->upper_section,               \
        (result)->upper_field

/* size_bytes: number of readable bytes from `config` on; fewer than sizeof(config_t) is refused
 * without being read. */
config_result_t config_validate(const config_t *config, uint32_t size_bytes);

/* True if an image still says where its wheel is on CAN although it was refused with this code:
 * magic, version, size and CRC hold, and the fields of the address are in their ranges. */
bool config_has_address(const config_t *config, config_result_code_t code);

/* The refusal of a value outside lowest .. highest, for the checks of a board too. section and
 * field are kept as pointers. */
config_result_t config_result_range(const char *section, const char *field, int32_t value,
                                    int32_t lowest, int32_t highest);

/* CRC-32 (IEEE 802.3) of size bytes; crc32("123456789") = 0xCBF43926. Bitwise: small, for boot time
 * only. */
uint32_t config_crc32(const void *data, uint32_t size_bytes);

/* The CRC-32 of data whose first part has the CRC-32 `before`, from the next part; 0: there is none
 * before. */
uint32_t config_crc32_continue(uint32_t before, const void *data, uint32_t size_bytes);

#endif
