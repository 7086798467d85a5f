/* SPDX-License-Identifier: Apache-2.0 */
/*
 * brake_blending.h: who brakes how much.
 *
 *     parallel_ratio         electric = share * demand, never above the rated electric braking
 * torque parallel_free_travel   electric first, up to the rated electric braking torque
 *     series_optimal         electric up to the torque that returns the most energy at this speed
 * and temperature
 *
 * Whatever the strategy, hard limits of the motor apply, the electric part fades out between the
 * two blend-out speeds (a parallel strategy's as a whole; the best torque is kept until the fading
 * limit of the motor falls below it), and the hydraulic brake is asked for the rest of the demand,
 * unless it is at its own limit. Motor torque that was asked for and did not come (beyond a
 * tolerance band) is moved to the hydraulic brake at once. Electric braking never holds a standing
 * vehicle.
 *
 * The hydraulic brake is late, and its torque is estimated (hydraulic_model.h). So
 *
 *   - the motor takes no more than the hydraulic brake has left: electric <= demand - estimate. It
 * comes back no faster than the other one goes, and if the estimate is wrong by a share of itself,
 * the two together are wrong by as much of the hydraulic part, for as long as that part changes: at
 * rest the split is exact again.
 *   - the hydraulic command goes ahead: the motor's limit is taken for as much lower as it will
 * have fallen in dead time plus lag, if it goes on falling as in the last 64 ms (a ramp is delayed
 * by just that). And a motor that must leave is counted on for as much less as it will have left
 * within the dead time; before that the hydraulic brake cannot move.
 *   - a motor whose torque does not grow, for want of voltage, is counted on for what it is
 * commanded, not for what it may give.
 *
 * Sources: Lu et al. 2013 section 3.2; for the optimum in region I of its Fig. 5 the motor keeps
 * T_opt instead of leaving everything to the friction brake, which never returns less.
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
