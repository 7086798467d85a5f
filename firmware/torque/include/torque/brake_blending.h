/* SPDX-License-Identifier: Apache-2.0 */
/*
 * brake_blending.h: splits a braking demand between motor and hydraulic brake. 1 kHz.
 *
 * The motor brakes up to its torque limits (torque_limits.h, which hold the strategy as well), the
 * hydraulic brake is asked for the rest, up to its own limit. The part of the
 * motor torque command that the motor does not make, beyond brake.shortfall_band, is added to the
 * hydraulic command at once.
 *
 * The hydraulic brake is late, and its torque is estimated (hydraulic_model.h). So
 *   - electric <= demand - estimate: the motor torque rises no faster than the hydraulic torque
 *     falls;
 *   - the hydraulic command is predictive: it uses the motor limit expected after dead time plus
 *     lag, if the limit goes on falling as in the last 64 ms;
 *   - the motor counts with the torque that it can reach within brake.motor_arrival, which is its
 *     present command if the torque cannot rise for lack of voltage.
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
    filter_t limit_lp_mNm; /* low-passed limit of the strategy */
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
    int32_t electric_mNm;  /* torque demanded of the motor, magnitude >= 0, before the torque rate
                              limit; at most `available` */
    int32_t hydraulic_mNm; /* magnitude >= 0 */
    limit_t available;     /* largest electric torque under this strategy, and its reason */
    reason_t reason;       /* why electric is below the demand; REASON_NONE if it is not */
    reason_t hydraulic_reason; /* REASON_HYDRAULIC_LIMIT when the two together fall short of the
                                  demand */
} brake_blending_out_t;

void brake_blending_init(brake_blending_state_t *state);

brake_blending_out_t brake_blending_step(brake_blending_state_t *state, const config_t *config,
                                         const torque_limits_t *limits,
                                         const brake_blending_input_t *in);

#endif
