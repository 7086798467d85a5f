/* SPDX-License-Identifier: Apache-2.0 */
/*
 * processor.h: another processor that executes the steps of all controllers of a bench, faults of
 * the program (injection.h) included, instead of direct calls. Everything else stays as it is.
 *
 * Order of a PWM period: slow() of every wheel if a millisecond begins, fast() of every wheel at
 * the top of the count, the plant, finish() of every wheel. So the other processor may compute
 * while the plant does; the result is the same, because what a fast step returns acts one period
 * later.
 */
#ifndef BENCH_PROCESSOR_H
#define BENCH_PROCESSOR_H

#include "controller/controller.h"
#include "plant/fault.h"

typedef struct {
    void *context;
    /* The configuration of all controllers from now on. No step is under way. */
    void (*configure)(void *context, const config_t *config);
    /* The controllers of so many wheels start anew. */
    void (*begin)(void *context, int wheels);
    /* fault: that are injected into this wheel's program; NULL: none. */
    void (*fast)(void *context, int wheel, const fault_params_t *fault, const fast_input_t *in);
    /* next: what the bridge does from the next period on. shown: what signals.c reads of a
     * controller is written there. */
    void (*finish)(void *context, int wheel, fast_output_t *next, controller_t *shown);
    slow_output_t (*slow)(void *context, int wheel, const fault_params_t *fault,
                          const slow_input_t *in, controller_t *shown);
    /* Why the run cannot go on, in one line; NULL: it can. */
    const char *(*objection)(const void *context);
    void (*close)(void *context);
} processor_t;

#endif
