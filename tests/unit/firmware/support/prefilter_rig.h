/* SPDX-License-Identifier: Apache-2.0 */
/*
 * prefilter_rig.h: reference prefilter and current predictor as foc.c connects them, and the
 * designed response in double precision.
 */
#ifndef PREFILTER_RIG_H
#define PREFILTER_RIG_H

#include <math.h>

#include "current_predictor.h"
#include "random_values.h"
#include "unity.h"

extern const config_t CONFIG_LU2013;
static config_t config;
static reference_prefilter_t prefilter;
static current_predictor_t predictor;

static const double PI = 3.14159265358979323846;
static const int32_t BANDWIDTHS_Hz[] = {60, 250, 500, 1000, 1590}; /* at 20 kHz */

enum { BANDWIDTHS = sizeof(BANDWIDTHS_Hz) / sizeof(BANDWIDTHS_Hz[0]), FREQUENCY_Hz = 20000 };

static inline void rig_up(void)
{
    config = CONFIG_LU2013;
    config.drive.pwm_frequency_Hz = FREQUENCY_Hz;
}

static inline void start(void)
{
    reference_prefilter_init(&prefilter, &config);
    current_predictor_init(&predictor, &config);
}

typedef struct {
    dq_t reference_pu; /* for the controller */
    dq_t target_pu;    /* of the delay compensation */
} shaped_t;

/* One period of the reference as foc.c computes it. */
static inline shaped_t shape(reference_prefilter_t *of, current_predictor_t *by, dq_t reference,
                             dq_t settled)
{
    const reference_change_t change = reference_prefilter_take(of, reference);
    current_predictor_change(by, &change, settled, !of->settled);
    const shaped_t out = {
        .reference_pu = reference_prefilter_output(of, &change),
        .target_pu = current_predictor_target(by, &change),
    };
    return out;
}

static inline shaped_t apply(dq_t reference)
{
    return shape(&prefilter, &predictor, reference, reference);
}

/* exp(-w T/2) */
static inline double half_period(int32_t bandwidth_Hz)
{
    return exp(-PI * bandwidth_Hz / FREQUENCY_Hz);
}

/* Share of a change that has come n samples after the one that met it first, n not necessarily
 * whole. */
static inline double designed(double b, double n)
{
    return n > 1.5 ? 1.0 - pow(b, 2.0 * (n - 1.5)) : 0.0;
}

#endif
