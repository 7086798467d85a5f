/* SPDX-License-Identifier: Apache-2.0 */
/*
 * demand.h: checks the demanded torques and replaces a demand that is out of date. 1 kHz.
 *
 * Negative braking demands count as zero. A braking demand sets the driving torque to zero. After
 * brake.demand_timeout without a new demand the torques fall to zero at the torque rate; the
 * driver's hydraulic circuit is independent of this controller.
 */
#ifndef TORQUE_DEMAND_H
#define TORQUE_DEMAND_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"

typedef struct {
    int32_t drive_mNm;
    int32_t brake_mNm;
} demand_state_t;

typedef struct {
    int32_t drive_mNm; /* signed, positive forward; 0 while braking is demanded */
    int32_t brake_mNm; /* magnitude >= 0 */
    bool timed_out;
} demand_t;

void demand_init(demand_state_t *state);

demand_t demand_step(demand_state_t *state, const config_t *config, int32_t drive_mNm,
                     int32_t brake_mNm, uint32_t age_ms);

/* Largest change of a torque in one slow step, mNm, at least 1. */
int32_t demand_rate_mNm_per_step(const config_t *config);

#endif
