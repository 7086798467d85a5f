/* SPDX-License-Identifier: Apache-2.0 */
/*
 * joined.h: one controller with its configuration and the structures that travel between its two
 * steps, driven through arrays in the order of variables.h.
 *
 * A value without pointers: copied, compared and written to a file as bytes, it goes on exactly
 * where it was. The caller provides the timing that controller.h asks for: joined_fast() at the PWM
 * rate, joined_slow() at 1 kHz, the slow step first in the period in which a millisecond begins.
 */
#ifndef EXCHANGE_JOINED_H
#define EXCHANGE_JOINED_H

#include "controller/controller.h"
#include "exchange/variables.h"

typedef struct {
    config_t config;
    controller_t controller;
    fast_setpoint_t to_fast;
} joined_t;

/* config: accepted by config_validate(). */
void joined_init(joined_t *joined, const config_t *config);

/* in: variables_count() raw values of the port, each within its raw range. out: as many as the
 * output port has. */
void joined_fast(joined_t *joined, const int32_t *in, int32_t *out);
void joined_slow(joined_t *joined, const int32_t *in, int32_t *out);

#endif
