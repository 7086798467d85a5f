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
 * soon as the hydraulic brake has followed. DERIVATIONS.md, Hill hold.
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
    int32_t begun_mrad_s; /* speed at which it began before standstill, magnitude; 0: it did not */
} hill_hold_state_t;

void hill_hold_init(hill_hold_state_t *state);

/* Least torque of the hydraulic brake, magnitude, up to driver.hold_torque_mNm. split: of this
 * step, for the speed to come. road_mNm: with which the road brakes, magnitude; 0: not known.
 * command_mNm: motor torque, signed. standstill: by the monitor's speed upper bound. */
int32_t hill_hold_step(hill_hold_state_t *state, const config_t *config, const demand_t *demand,
                       const brake_blending_out_t *split, int32_t road_mNm, int32_t command_mNm,
                       int32_t speed_mrad_s, bool standstill);

#endif
