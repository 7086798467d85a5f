/* SPDX-License-Identifier: Apache-2.0 */
/*
 * variables.h: the table of signals (core/signals.h) for programs on a host: each variable's
 * description, and conversions between messages, raw and engineering values.
 * variables_affine() returns the coefficients of a scale: raw = zero + engineering * per_unit.
 */
#ifndef EXCHANGE_VARIABLES_H
#define EXCHANGE_VARIABLES_H

#include <stddef.h>
#include <stdint.h>

#include "controller/controller.h"
#include "core/signals.h"

enum { EXCHANGE_PORT_MAX = 32 /* no port has more variables */ };

typedef enum {
    EXCHANGE_PORT_FAST_INPUT = 0,
    EXCHANGE_PORT_FAST_OUTPUT = 1,
    EXCHANGE_PORT_SLOW_INPUT = 2,
    EXCHANGE_PORT_SLOW_OUTPUT = 3,
    EXCHANGE_PORT_FAST_VIEW = 4 /* no message of a step */
} exchange_port_t;
enum { EXCHANGE_PORTS = 5 };

typedef enum { EXCHANGE_REAL, EXCHANGE_FLAG, EXCHANGE_CODE } exchange_type_t;
typedef enum {
    EXCHANGE_PLAIN,        /* the number itself */
    EXCHANGE_MILLI,        /* thousandths */
    EXCHANGE_CENTI,        /* hundredths */
    EXCHANGE_TURN,         /* 65 536 to a turn, wrapping */
    EXCHANGE_CURRENT_CODE, /* converter codes around 2048 */
    EXCHANGE_VOLTAGE_CODE, /* converter codes from 0 */
    EXCHANGE_CURRENT_PU,   /* Q15 of the current base */
    EXCHANGE_SHARE,        /* Q15 of one */
    EXCHANGE_DUTY          /* timer counts of a period */
} exchange_scale_t;

typedef struct {
    const char *name, *raw_name, *unit, *text;
    exchange_type_t type;
    exchange_scale_t scale;
    int32_t lowest_raw, highest_raw, start_raw;
    const char *member; /* of the port's message */
    size_t offset, bytes;
} variable_info_t;

/* 0 <= index < variables_count(port) */
int variables_count(exchange_port_t port);
variable_info_t variables_info(exchange_port_t port, int index);

/* Conversion between a port's message and its raw values in the order of the list. raw:
 * variables_count() values, each within its range. */
void variables_to_message(exchange_port_t port, const int32_t *raw, void *message);
void variables_from_message(exchange_port_t port, const void *message, int32_t *raw);

/* raw = zero + engineering * per_unit, with the full scales of a configuration. */
typedef struct {
    double zero, per_unit;
} variables_affine_t;
variables_affine_t variables_affine(exchange_scale_t scale, const config_t *config);

/* Rounds to the nearest raw value, halves up. Values outside the raw range saturate as in a
 * converter; an angle wraps. NaN becomes the lowest raw value; the caller checks for
 * it before. */
int32_t variables_to_raw(const variable_info_t *info, variables_affine_t affine, double value);

double variables_from_raw(variables_affine_t affine, int32_t raw);

#endif
