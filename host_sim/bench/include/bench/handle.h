/* SPDX-License-Identifier: Apache-2.0 */
/*
 * handle.h: what the handle refers to, of engine.h and external.h, for the files that implement
 * them.
 */
#ifndef BENCH_HANDLE_H
#define BENCH_HANDLE_H

#include <stdbool.h>

#include "bench/bench.h"
#include "bench/engine.h"
#include "bench/recorder.h"

enum { HANDLE_ERROR_LENGTH = 400 };

/* One wheel with an external controller. */
typedef struct {
    fast_input_t sampled; /* by the sensors, at the last top of the count */
    fast_output_t given;  /* bridge command of the next period */
    double hydraulic_nm;  /* command of the hydraulic brake */
} external_wheel_t;

typedef struct {
    bool at_work;
    bool delayed; /* what is given acts one period later, as the firmware's own */
    wheel_coupling_t coupling[BENCH_WHEELS_MAX];
    external_wheel_t wheel[BENCH_WHEELS_MAX];
} external_t;

/* The whole application in the place of every wheel's controller. */
typedef struct {
    void *context;
    /* After bench_init(): boots one in each wheel. NULL, or why it cannot. */
    const char *(*start)(void *context, bench_t *bench);
    void (*close)(void *context);
} application_link_t;

struct hubsim {
    bench_params_t params;
    config_t config;
    driver_trace_t trace;
    double *trace_memory;
    energy_map_t energy_map; /* where params.motor points to, if at all */
    double *energy_memory;
    bool has_config, has_started;
    hubsim_t *rear; /* whose drives the rear axle has; NULL: all are alike */
    recorder_t recorder;
    char error[HANDLE_ERROR_LENGTH];
    external_t external;
    processor_t processor; /* with has_processor */
    bool has_processor;
    application_link_t application; /* with has_application */
    bool has_application;
    bench_t bench;
};

/* Notes the message for hubsim_error() and returns the code. */
int handle_fail(hubsim_t *sim, int code, const char *format, ...);

/* Whether the vehicle can go on: HUBSIM_OK or HUBSIM_FAILED. */
int handle_after_period(hubsim_t *sim);

#endif
