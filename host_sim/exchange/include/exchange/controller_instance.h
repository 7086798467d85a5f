/* SPDX-License-Identifier: Apache-2.0 */
/*
 * controller_instance.h: one controller with its configuration and the setpoint from its slow to
 * its fast step, driven through arrays in the order of variables.h.
 *
 * A value without pointers: it can be copied, compared and written to a file as bytes, and a copy
 * continues with identical results. The caller provides the timing that controller.h asks for: the
 * fast step at the PWM rate, the slow step at 1 kHz, first in the period in which a millisecond
 * begins.
 */
#ifndef EXCHANGE_CONTROLLER_INSTANCE_H
#define EXCHANGE_CONTROLLER_INSTANCE_H

#include "controller/controller.h"
#include "exchange/variables.h"

typedef struct {
    config_t config;
    controller_t controller;
    fast_setpoint_t to_fast;
} controller_instance_t;

/* config: accepted by config_validate(). */
void controller_instance_init(controller_instance_t *instance, const config_t *config);

/* in: variables_count() raw values of the port, each within its raw range. out: as many as the
 * output port has. */
void controller_instance_fast_step(controller_instance_t *instance, const int32_t *in,
                                   int32_t *out);
void controller_instance_slow_step(controller_instance_t *instance, const int32_t *in,
                                   int32_t *out);

#endif
