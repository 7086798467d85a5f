/* SPDX-License-Identifier: Apache-2.0 */
/*
 * demand.h: what of the demanded torques counts now: validity, priorities, drive direction. 1 kHz.
 *
 * A demand older than brake.demand_timeout is lost. Its driving torque is zero at once. Its braking
 * torque is kept for driver.lost_hold_ms, then the hydraulic command is no longer valid, unless the
 * vehicle is held at standstill (hill_hold.h): the brake system takes its own path, and after the
 * hydraulic dead time the braking torque falls to zero with the lag with which that path arrives.
 * With driver.no_other_brake it is kept as long as no demand arrives, also at standstill. One that
 * is lost by the reason TRANSMIT_TIMEOUT is not kept: the brake system, to which no message of this
 * wheel comes, takes its own path already.
 *
 * Braking has priority over driving. Driving torque acts only in the engaged direction; a driving
 * demand against it is lift-off braking, a magnitude. README, Demand; DERIVATIONS.md, Lost demand.
 */
#ifndef TORQUE_DEMAND_H
#define TORQUE_DEMAND_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "config/demand_age.h"
#include "core/drive_direction.h"
#include "core/reason.h"
#include "core/slow_messages.h"

typedef struct {
    int32_t lift_off_mNm; /* of the last valid demand, falling after its loss */
    int32_t brake_torque_mNm;
    int32_t received_brake_torque_mNm; /* of the last valid demand: what the own path makes */
    int32_t lost_ms;                   /* slow steps since the loss, saturating */
    drive_direction_t engaged;
} demand_state_t;

typedef struct {
    int32_t
        drive_torque_mNm; /* signed, in the engaged direction; 0 while a brake pedal is pressed */
    int32_t lift_off_mNm; /* magnitude >= 0 */
    int32_t brake_torque_mNm; /* magnitude >= 0, without lift_off_mNm */
    drive_direction_t engaged;
    reason_t reason; /* why driving torque is not as demanded, or why the demand is an old one */
    bool drive_withdrawn; /* no driving torque is allowed: it must go at once, not at its rate */
    bool hydraulic_valid; /* false: the brake system takes its own path */
    bool handed_over;     /* it arrives there, and the braking torque falls */
} demand_t;

/* No demand has come yet, which is a lost one of zero; the direction is neutral. */
void demand_init(demand_state_t *state);

/* 1 kHz. in: demand and its age; torques beyond +-100 kN m are clamped. speed_mrad_s: mechanical,
 * signed. A lost demand never drives, and its
 * braking torque never rises. */
demand_t demand_step(demand_state_t *state, const config_t *config, const slow_input_t *in,
                     int32_t speed_mrad_s);

/* Largest change of a torque in one slow step, mNm, at least 1. */
int32_t demand_rate_mNm_per_step(const config_t *config);

/* What the brake system's own path takes over of a braking torque left_mNm >= 0 in one slow step,
 * with the lag and the rate of the hydraulic brake: mNm, at least 1. The torque rate is for comfort
 * and has no say in it: a motor that leaves slower brakes beside what has arrived. */
int32_t demand_handed_over_mNm(const config_t *config, int32_t left_mNm);

#endif
