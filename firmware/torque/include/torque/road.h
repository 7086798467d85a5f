/* SPDX-License-Identifier: Apache-2.0 */
/*
 * road.h: torque with which the road, slope and rolling resistance, brakes a wheel. 1 kHz.
 *
 *     road = motor torque - hydraulic torque - inertia * acceleration
 *
 * along the rotation, with the wheel's share of the configured mass: means from one change of the
 * shown speed to the next, as a slow wheel's hall sensors show it in steps, and a low-pass of 64
 * ms. A wrong mass or brake looks like a slope, so this is an estimate, for hill_hold.h, and no
 * finding.
 */
#ifndef TORQUE_ROAD_H
#define TORQUE_ROAD_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"

typedef struct {
    int32_t inertia_g_m2; /* of the wheel's share of the vehicle */
    int32_t torque_mNm;   /* along the rotation; of this step, or when the wheel last rolled */
    int32_t shown_mrad_s; /* magnitude of the speed at its last change */
    int32_t since_ms;     /* that change */
    int64_t known_mNm_ms; /* sum since then: motor less hydraulic torque */
    bool rolls, backwards;
} road_state_t;

void road_init(road_state_t *state, const config_t *config);

/* Braking torque of the road, magnitude; 0 while it pushes or was never known. motor_mNm: from
 * measured currents, at the shaft, signed. hydraulic_mNm: magnitude. trusted: both and the speed
 * are valid, and no wheel slips; while they are not, and below half the end of the blend-out, the
 * result stays. */
int32_t road_step(road_state_t *state, const config_t *config, int32_t speed_mrad_s,
                  int32_t motor_mNm, int32_t hydraulic_mNm, bool trusted);

#endif
