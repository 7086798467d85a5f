/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hill_hold.h: hydraulic torque that holds a vehicle at standstill until it drives off. 1 kHz.
 *
 * It begins when the wheel stands (monitor's speed upper bound) while braking is demanded, and ends
 * by a driving torque in the engaged direction or in neutral. While the motor torque T rises, it
 * falls along driver.hold_torque (1 - T/T_r), T_r = min(driver.hold_torque, 3/4 motor.max_torque),
 * and at the latest within driver.hold_release. A wheel that rolls back meanwhile is caught: full
 * torque again, which only T takes away. Where the road brakes with about as much as is demanded or
 * more, so that the demand may not hold the slope, it begins when the wheel is expected to stand as
 * soon as the hydraulic brake has followed.
 *
 * A motor that may not drive releases nothing, and a wheel that has driven off, no faster than
 * driver.direction_change yet, is held again when its motor may drive no more and it stands or
 * rolls back. A restart resumes the hold, but not on a wheel that is faster than that.
 * DERIVATIONS.md, Hill hold.
 */
#ifndef TORQUE_HILL_HOLD_H
#define TORQUE_HILL_HOLD_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/drive_direction.h"
#include "torque/brake_blending.h"
#include "torque/demand.h"

typedef struct {
    int32_t torque_mNm; /* present hold torque, magnitude; 0: none */
    int32_t release_ms; /* slow steps since the driving demand began, saturating */
    bool holds;
    bool caught;          /* has rolled back during the release */
    bool resumed;         /* since a restart; until the motor may drive or the driver brakes */
    bool leaves;          /* has driven off, and is slow */
    bool lost;            /* could not be resumed on a wheel that rolls */
    int32_t rolls_ms;     /* slow steps in which the wheel has turned although it is held, up to
                             HILL_HOLD_CAUGHT_ms */
    int32_t begun_mrad_s; /* speed at which it began before standstill, magnitude; 0: it did not */
} hill_hold_state_t;

/* Within which a held wheel stands: dead time and lag of a brake, and a start of 1 m/s. */
enum { HILL_HOLD_CAUGHT_ms = 1000 };

void hill_hold_init(hill_hold_state_t *state);

/* What a restart needs of a hold that it interrupts. */
typedef struct {
    drive_direction_t direction; /* engaged while the wheel is held; NEUTRAL: it is not */
    bool leaves;                 /* it has just driven off in that direction */
} hill_hold_kept_t;

hill_hold_kept_t hill_hold_keep(const hill_hold_state_t *state, drive_direction_t engaged);

/* After hill_hold_init(). kept: of before the restart. */
void hill_hold_resume(hill_hold_state_t *state, const hill_hold_kept_t *kept);

/* How the wheel moves, and whether its motor may move it. */
typedef struct {
    int32_t speed_mrad_s; /* mechanical, signed */
    bool standstill;      /* by the monitor's speed upper bound */
    int32_t road_mNm;     /* with which the road brakes, magnitude; 0: not known */
    int32_t command_mNm;  /* motor torque, signed */
    bool seen;            /* a rotor sensor shows how it turns */
    bool may_drive;       /* driving torque is enabled, and the demand is not lost */
} hill_hold_wheel_t;

/* Least torque of the hydraulic brake, magnitude, up to driver.hold_torque_mNm. split: of this
 * step, for the speed to come. */
int32_t hill_hold_step(hill_hold_state_t *state, const config_t *config, const demand_t *demand,
                       const brake_blending_out_t *split, const hill_hold_wheel_t *wheel);

/* True if the wheel is held, and has not been turning for HILL_HOLD_CAUGHT_ms all the same. */
static inline bool hill_hold_works(const hill_hold_state_t *state)
{
    return state->holds && state->torque_mNm > 0 && state->rolls_ms < HILL_HOLD_CAUGHT_ms;
}

/* True while a wheel that was to be held rolls. */
static inline bool hill_hold_fails(const hill_hold_state_t *state)
{
    return state->lost || state->rolls_ms == HILL_HOLD_CAUGHT_ms;
}

#endif
