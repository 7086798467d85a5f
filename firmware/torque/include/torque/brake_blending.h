/* SPDX-License-Identifier: Apache-2.0 */
/*
 * brake_blending.h: how a braking demand is split between motor and hydraulic brake. 1 kHz.
 *
 * The motor brakes up to its torque limits (torque_limits.h, which hold the strategy as well), the
 * hydraulic brake is asked for the rest, up to its own limit. Motor torque that was asked for and
 * did not come, beyond brake.shortfall_band, is moved to the hydraulic brake at once.
 *
 * The hydraulic brake is late, and its torque is estimated (hydraulic_model.h). So
 *   - electric <= demand - estimate: the motor comes back no faster than the hydraulic brake goes;
 *   - the hydraulic command goes ahead: the motor's limit counts as much lower as it will have
 *     fallen in dead time plus lag, if it goes on falling as in the last 64 ms;
 *   - the motor is counted on for what it can reach within brake.motor_arrival, so one whose
 *     torque does not grow, for want of voltage, for what it is commanded.
 * Figures: README, Two brakes. Source: Lu et al. 2013 section 3.2; in region I of its Fig. 5 the
 * motor keeps T_opt instead of leaving everything to the friction brake, which never returns less.
 */
#ifndef TORQUE_BRAKE_BLENDING_H
#define TORQUE_BRAKE_BLENDING_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/filter.h"
#include "core/torque_enable.h"
#include "torque/hydraulic_model.h"
#include "torque/torque_limits.h"

typedef struct {
    hydraulic_model_t hydraulic;
    filter_t limit_lp_mNm; /* the strategy's limit, as it was lately */
} brake_blending_state_t;

typedef struct {
    int32_t demand_mNm;         /* magnitude >= 0 */
    int32_t speed_mrad_s;       /* mechanical, signed */
    int32_t motor_command_mNm;  /* of the last step, signed */
    int32_t motor_growth_mNm;   /* by which its magnitude may change in a step, negative: it must
                                   shrink */
    int32_t motor_achieved_mNm; /* estimated from measured currents, signed */
    torque_enable_t torque_enable;
} brake_blending_input_t;

typedef struct {
    int32_t electric_mNm;  /* what the motor is asked for, magnitude >= 0, before the torque rate;
                              within `available` */
    int32_t hydraulic_mNm; /* magnitude >= 0 */
    limit_t available; /* what the motor could take over under this strategy, and what bounds it */
    reason_t reason;   /* why electric is less than the demand; REASON_NONE when it is not */
    reason_t hydraulic_reason; /* REASON_HYDRAULIC_LIMIT when the two together fall short of the
                                  demand */
} brake_blending_out_t;

void brake_blending_init(brake_blending_state_t *state);

brake_blending_out_t brake_blending_step(brake_blending_state_t *state, const config_t *config,
                                         const torque_limits_t *limits,
                                         const brake_blending_input_t *in);

#endif
