/* SPDX-License-Identifier: Apache-2.0 */
/*
 * demand.h: from what the driver asked to a demand the other modules rely on.
 *
 * Negative braking demands count as zero, a braking demand cuts the driving torque, and a demand
 * that is no longer refreshed decays to zero at the torque rate instead of being held: the driver's
 * own hydraulic circuit does not pass through this controller.
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
