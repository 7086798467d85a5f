/* SPDX-License-Identifier: Apache-2.0 */
/*
 * slow_life.h: a random life of the slow step, and what is drawn for it: configuration, vehicle,
 * faults, and phase by phase what the driver wants, what the battery permits, what the road does.
 */
#ifndef ORACLE_SLOW_LIFE_H
#define ORACLE_SLOW_LIFE_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "controller/controller.h"
#include "random.h"
#include "slow_faults.h"
#include "surrogate.h"

enum { LIFE_FAULTS_MOST = 3 };

/* What takes long and a steady vehicle to be found. */
typedef enum {
    STUDY_NONE,
    STUDY_BRAKE,   /* long stops with a faulty hydraulic brake, or faulty reports of it */
    STUDY_HEAT,    /* load without a good sensor of temperature */
    STUDY_SENSORS, /* one driven wheel, a gain error of all current sensors */
    STUDY_FLUX,    /* weak magnets at speed */
    STUDY_SHORT,   /* beyond the EMF limit */
    STUDY_HOLD     /* to rest on a slope, and off again */
} study_t;

typedef struct {
    config_t config;
    random_t random;
    controller_t controller;
    fast_setpoint_t setpoint;
    slow_input_t in;
    slow_output_t out;
    surrogate_t wheel;
    fault_t fault[LIFE_FAULTS_MOST];
    int32_t faults, step, steps;
    int32_t boot_ms, selftest_ms, phase_left_ms, release_ms;
    int32_t winding_cC, switch_cC;
    int32_t demand_left_ms, report_left_ms, report_mNm;
    int32_t drive_to_mNm, brake_to_mNm, drive_ramp_mNm, brake_ramp_mNm;
    bool has_brake_reports, gives_current;
    study_t study;
} life_t;

/* Begins life `number` with a configuration that comes along, or a variation of it. */
void life_begin(life_t *life, const config_t *shipped, uint64_t number);

/* The next phase; before the step in which life->phase_left_ms falls below zero. */
void life_draw_phase(life_t *life);

/* Forward, reverse or neutral. */
drive_direction_t life_drawn_direction(life_t *life);

static inline bool chance(life_t *life, int32_t per_mille)
{
    return random_chance(&life->random, per_mille);
}

static inline int32_t between(life_t *life, int32_t low, int32_t high)
{
    return random_between(&life->random, low, high);
}

static inline double real(life_t *life, double low, double high)
{
    return random_real(&life->random, low, high);
}

#endif
