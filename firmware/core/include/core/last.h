/* SPDX-License-Identifier: Apache-2.0 */
/*
 * last.h: what a slow step needs of the one before: every unit delay between the parts of the slow
 * loop. The controller writes it at the end of a step (firmware/README.md, The slow step); nothing
 * else is read from the step before. A part's own memory, such as a filter or a debounce, is in its
 * state.
 */
#ifndef CORE_LAST_H
#define CORE_LAST_H

#include <stdbool.h>
#include <stdint.h>

#include "core/bridge.h"
#include "core/drive_direction.h"
#include "core/frames.h"
#include "core/slow_messages.h"

typedef struct {
    int32_t torque_command_mNm;  /* signed */
    int32_t torque_estimate_mNm; /* signed, from measured currents */
    int32_t hydraulic_added_mNm; /* to the hydraulic command of brake blending, >= 0: hill hold,
                                    lift-off, the brake system's own path */
    int32_t hydraulic_apart_mNm; /* of it, what is none of the braking demand */
    dq_t reference_pu;           /* of the latest setpoint, without field weakening, Q15 */
    wheel_temperatures_t temperature; /* in use: shown by the sensors, or estimates */
    bridge_mode_t safe_bridge;        /* freewheel or a short circuit */
    drive_direction_t engaged;        /* in which driving torque is made */
    bool at_rest;                     /* known whatever the rotor sensor shows */
    int32_t current_missing_q15;      /* share of the current that the sensors do not show */
} last_t;

#endif
