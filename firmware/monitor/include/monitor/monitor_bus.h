/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_bus.h: the bus voltage against what a battery does. Slow loop, 1 kHz. First the sensor
 * against the voltage of the battery's message, then how the bus moves.
 *
 * The sensor is wrong if the message lies beyond all of the window's readings (monitor_window.h) by
 * more than 1/MONITOR_BUS_TOLERANCE_SHARE of the voltage. DERIVATIONS.md, Flux and bus voltage.
 */
#ifndef MONITOR_MONITOR_BUS_H
#define MONITOR_MONITOR_BUS_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "monitor/monitor_window.h"

enum {
    MONITOR_BUS_TOLERANCE_SHARE = 20, /* both sensors, and the cable between them */
    MONITOR_BUS_MOST_mV = 2000000,    /* larger readings count as this */
    MONITOR_BUS_SWING_LOG2 = 3,       /* time constant of the movement: 8 ms */
    MONITOR_BUS_JUMP_Q7 = 7           /* of the largest voltage, that one step counts at most: a
                                         sensor whose reading jumps, in two means, is no battery
                                         lost */
};

/* True while the sensor is wrong (qualified and healed by monitor_window_judge()). reading_mV: mean
 * of this millisecond, below zero as zero. battery_mV: of the latest message; 0 or less: none, or
 * the contactor is not known to be closed, which forgets the window. */
bool monitor_bus_step(monitor_window_t *window, int32_t reading_mV, int32_t battery_mV);

/* How far the bus has moved up and down, forgotten with a time constant of 8 ms. */
typedef struct {
    int32_t last_mV;
    int32_t swing_mV; /* >= 0 */
    bool watching;
} monitor_swing_state_t;

/* True where the bus has moved further than a connected battery lets it: by more than an eighth
 * beyond its resistance times the change from full charging to full discharging current, and by
 * more than 7/64 of its largest voltage. DERIVATIONS.md, Bus. Never with battery.resistance zero.
 * reading_mV: mean of this millisecond. watched: PWM on a battery that is not known to have left;
 * otherwise the movement begins anew. */
bool monitor_bus_swings(monitor_swing_state_t *state, const config_battery_t *battery,
                        int32_t reading_mV, bool watched);

#endif
