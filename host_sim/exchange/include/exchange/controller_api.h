/* SPDX-License-Identifier: Apache-2.0 */
/*
 * controller_api.h: one controller as a library for other languages, for use with a plant model of
 * the caller.
 *
 * Plain declarations only, so that a foreign-function reader (cffi and the like) can take this file
 * as it is, less the lines that begin with '#'. Part of the same library as bench/engine.h. No
 * function prints, exits or keeps state outside the handle; any number of handles may be used at
 * the same time, one thread each.
 *
 * Inputs and outputs are arrays in the order of hubsim_variable_name(port, 0 ...), in engineering
 * units (double) or raw (int32_t, the firmware's values). An engineering value beyond its
 * range saturates, as a converter does; a value that is no number, or a raw value out of range, is
 * refused and no step is made. Functions that can fail return 0 or a negative number;
 * hubsim_controller_error() then returns the reason as one line.
 */
#ifndef EXCHANGE_CONTROLLER_API_H
#define EXCHANGE_CONTROLLER_API_H

#include <stdint.h>

enum {
    HUBSIM_PORT_FAST_INPUT = 0,
    HUBSIM_PORT_FAST_OUTPUT = 1,
    HUBSIM_PORT_SLOW_INPUT = 2,
    HUBSIM_PORT_SLOW_OUTPUT = 3,
    HUBSIM_PORT_FAST_VIEW = 4 /* of tools that measure, no array of a step */
};

enum { HUBSIM_TYPE_REAL = 0, HUBSIM_TYPE_FLAG = 1, HUBSIM_TYPE_CODE = 2 };

/* port: one of the above; 0 <= index < count. NULL, 0 outside. */
int hubsim_variable_count(int port);
const char *hubsim_variable_name(int port, int index);
const char *hubsim_variable_raw_name(int port, int index);
const char *hubsim_variable_unit(int port, int index);
const char *hubsim_variable_text(int port, int index);
int hubsim_variable_type(int port, int index);
int32_t hubsim_variable_lowest_raw(int port, int index);
int32_t hubsim_variable_highest_raw(int port, int index);
int32_t hubsim_variable_start_raw(int port, int index); /* of an input */

/* The member of fast_input_t, slow_input_t and so on, such as "demand.enable". */
const char *hubsim_variable_member(int port, int index);

typedef struct hubsim_controller hubsim_controller_t;

/* NULL when there is no memory. */
hubsim_controller_t *hubsim_controller_new(void);
void hubsim_controller_delete(hubsim_controller_t *controller);

/* The last failure as text; never NULL, valid until the next call on this handle. */
const char *hubsim_controller_error(const hubsim_controller_t *controller);

/* Initialises the controller with an image of config_t; fails if the firmware's validator refuses
 * it. */
int hubsim_controller_load_config(hubsim_controller_t *controller, const void *image,
                                  uint32_t size_bytes);

/* raw = zero + engineering * per_unit, after a configuration was loaded. */
int hubsim_controller_scale(const hubsim_controller_t *controller, int port, int index,
                            double *zero, double *per_unit);

/* PWM frequency of the configuration; 0 if none is loaded. */
int32_t hubsim_controller_fast_rate_hz(const hubsim_controller_t *controller);

/* One step each; in and out in engineering units or raw. */
int hubsim_controller_fast_step(hubsim_controller_t *controller, const double *in, double *out);
int hubsim_controller_slow_step(hubsim_controller_t *controller, const double *in, double *out);
int hubsim_controller_fast_step_raw(hubsim_controller_t *controller, const int32_t *in,
                                    int32_t *out);
int hubsim_controller_slow_step_raw(hubsim_controller_t *controller, const int32_t *in,
                                    int32_t *out);

/* The whole state of the controller as bytes, valid for the same build of this library only. */
uint32_t hubsim_controller_state_bytes(void);
int hubsim_controller_save(const hubsim_controller_t *controller, void *state);
int hubsim_controller_restore(hubsim_controller_t *controller, const void *state);

#endif
