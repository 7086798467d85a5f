/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_bus.h: the bus voltage against what a battery does. Slow loop, 1 kHz. First the sensor
 * against the voltage of the battery's message.
 *
 * A message is as old as its cycle, so it is compared with all that the sensor has shown since
 * then: the sensor is wrong if the message lies beyond the lowest or the highest reading of the
 * last MONITOR_BUS_WINDOW_STEPS to twice as many milliseconds by more than
 * 1/MONITOR_BUS_TOLERANCE_SHARE of the voltage, for MONITOR_BUS_QUALIFY_STEPS. README, Flux and bus
 * voltage.
 */
#ifndef MONITOR_MONITOR_BUS_H
#define MONITOR_MONITOR_BUS_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"

enum {
    MONITOR_BUS_WINDOW_STEPS = 128,   /* more than the message's cycle */
    MONITOR_BUS_QUALIFY_STEPS = 200,  /* qualify and heal time: two messages */
    MONITOR_BUS_TOLERANCE_SHARE = 20, /* both sensors, and the cable between them */
    MONITOR_BUS_MOST_mV = 2000000,    /* larger readings count as this */
    MONITOR_BUS_SWING_LOG2 = 3,       /* time constant of the movement: 8 ms */
    MONITOR_BUS_JUMP_Q7 = 7           /* of the largest voltage, that one step counts at most: a
                                         sensor whose reading jumps, in two means, is no battery
                                         lost */
};

typedef struct {
    int32_t lowest_mV[2], highest_mV[2]; /* of the window that runs and of the one before */
    uint16_t steps;                      /* of the window that runs */
    uint16_t windows;                    /* complete ones, up to 1 */
    uint16_t level;                      /* contradicting less agreeing steps */
    bool wrong;
} monitor_bus_state_t;

/* True while the sensor is wrong (qualified). reading_mV: mean of this millisecond. battery_mV: of
 * the latest message; 0: none, or the contactor is not known to be closed.
 *
 * @pre every(i, 2, is_within(state->lowest_mV[i], 0, MONITOR_BUS_MOST_mV) &&
 * is_within(state->highest_mV[i], 0, MONITOR_BUS_MOST_mV))
 *
 * @pre state->steps <= MONITOR_BUS_WINDOW_STEPS && state->level <= MONITOR_BUS_QUALIFY_STEPS
 *
 * @post every(i, 2, is_within(state->lowest_mV[i], 0, MONITOR_BUS_MOST_mV) &&
 * is_within(state->highest_mV[i], 0, MONITOR_BUS_MOST_mV))
 *
 * @post state->steps <= MONITOR_BUS_WINDOW_STEPS && state->level <= MONITOR_BUS_QUALIFY_STEPS
 *
 * @post battery_mV > 0 || !result
 *
 * @post !result || state->wrong
 *
 * @post !result || old(state->wrong) || state->level == MONITOR_BUS_QUALIFY_STEPS
 *
 * @post state->level <= old(state->level) + 1
 */
bool monitor_bus_step(monitor_bus_state_t *state, int32_t reading_mV, int32_t battery_mV);

/* How far the bus has moved up and down, forgotten with a time constant of 8 ms. */
typedef struct {
    int32_t last_mV;
    int32_t swing_mV; /* >= 0 */
    bool watching;
} monitor_swing_state_t;

/* True where the bus has moved further than a connected battery lets it: by more than an eighth
 * beyond its resistance times the change from full charging to full discharging current, and by
 * more than 7/64 of its largest voltage. README, Bus. Never with battery.resistance zero.
 * reading_mV: mean of this millisecond. watched: PWM on a battery that is not known to have left;
 * otherwise the movement begins anew. */
bool monitor_bus_swings(monitor_swing_state_t *state, const config_battery_t *battery,
                        int32_t reading_mV, bool watched);

#endif
