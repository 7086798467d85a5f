/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_speed.h: upper bound of the wheel speed, independent of the rotor sensor's health. Slow
 * loop, 1 kHz.
 *
 * The bound is the largest of
 *   - the valid sensor's speed, and the bound of the step before less monitor.tyre_grip, or less
 *     monitor.coasting while the sensor is not valid;
 *   - in active short circuit, the speed from the quadrant transitions of the current vector;
 *   - in freewheel, while the sensor is invalid or below the blend-out: the speed at which the
 *     EMF reaches the bus voltage, once a diode current or an overvoltage has been qualified.
 * No current during a short circuit: standstill. DERIVATIONS.md, Speed bound.
 */
#ifndef MONITOR_MONITOR_SPEED_H
#define MONITOR_MONITOR_SPEED_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/bridge.h"
#include "core/measured.h"

/* Length of a measuring window: quadrant transitions or milliseconds, whichever is reached first.
 * It sets the resolution of the measured speed. */
enum { MONITOR_SPEED_WINDOW_QUARTERS = 16, MONITOR_SPEED_WINDOW_STEPS = 100 };

typedef struct {
    int64_t bound_urad_s;
    int64_t rest_urad_s; /* the bound that a stopped sensor does not lower: rest, below */
    bool stopped;        /* the sensor's speed has fallen faster than a tyre can slow the wheel */
    uint16_t moving_steps;
    uint16_t sudden_stops;    /* from above MONITOR_SPEED_SUDDEN hand-over speeds, wrapping */
    int32_t window_mrad_s[2]; /* speeds of the latest two windows of this short circuit;
                                 MONITOR_SPEED_UNKNOWN for an invalid one */
    int64_t peak_square_mA2;  /* of the current in this window */
    int32_t windows;          /* in this short, saturating at 2 */
    int32_t window_steps;
    int32_t diode_steps;
    uint16_t window_quarters,
        window_periods;    /* beginning of the window: transition count and period */
    bool overvoltage_used; /* this overvoltage has already raised the bound */
} monitor_speed_state_t;

enum {
    MONITOR_SPEED_UNKNOWN = -1,
    /* A stopped sensor counts again after it has shown movement for so many steps in a row; before
     * that the stop of one that has begun to move is not sudden. */
    MONITOR_SPEED_MOVING_STEPS = 100,
    /* Hand-over speeds from which a stop is sudden: halls show their last edges' speed until a
     * braked wheel stands. Of the method, not of a vehicle. */
    MONITOR_SPEED_SUDDEN = 4
};

/* Returns the bound: mechanical, magnitude, mrad/s. state->rest_urad_s is never below it: it
 * follows a valid sensor only while that falls no faster than monitor.tyre_grip, so that a frozen
 * one does not show standstill; otherwise it falls by monitor.coasting. In a short circuit neither
 * falls before two windows have measured a speed. The result saturates; currents beyond 10 kA count
 * as that. DERIVATIONS.md, Standstill. */
int32_t monitor_speed_step(monitor_speed_state_t *state, const config_t *config,
                           const measured_t *now);

#endif
