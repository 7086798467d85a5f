/* SPDX-License-Identifier: Apache-2.0 */
/*
 * brake_blending.h: splits a braking demand between motor and hydraulic brake. 1 kHz.
 *
 * The motor brakes up to its torque limits (torque_limits.h, which include the strategy); the
 * hydraulic brake gets the rest, up to its own limit. A shortfall of the estimated below the
 * commanded motor torque, beyond brake.shortfall_band, is added to the hydraulic command at once.
 *
 * The hydraulic brake responds with a delay; its torque is estimated (hydraulic_model.h). So
 *   - electric <= demand - estimate: the motor torque rises no faster than the hydraulic torque
 *     falls;
 *   - the hydraulic command is predictive: it uses the motor limit expected after dead time plus
 *     lag, extrapolated with its slope of the last 64 ms;
 *   - the available motor torque is that reached within brake.motor_arrival; it is the present
 *     command if the voltage permits no rise.
 *
 * Figures: README, Brake blending. Source: Lu et al. 2013 section 3.2. Unlike there, in region I of
 * its Fig. 5 the motor brakes with T_opt instead of the friction brake alone, which never returns
 * less energy.
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
    int32_t motor_growth_mNm;   /* permitted change of its magnitude; negative: it must fall */
    int32_t motor_achieved_mNm; /* estimated from measured currents, signed */
    torque_enable_t torque_enable;
} brake_blending_input_t;

typedef struct {
    int32_t electric_mNm;  /* torque demanded of the motor, magnitude >= 0, before the torque rate
                              limit; at most `available` */
    int32_t hydraulic_mNm; /* magnitude >= 0 */
    limit_t available;     /* largest electric torque under this strategy, and its reason */
    reason_t reason;       /* of an electric torque below the demand; else REASON_NONE */
    reason_t hydraulic_reason; /* REASON_HYDRAULIC_LIMIT if both brakes cannot meet the demand */
} brake_blending_out_t;

void brake_blending_init(brake_blending_state_t *state);

brake_blending_out_t brake_blending_step(brake_blending_state_t *state, const config_t *config,
                                         const torque_limits_t *limits,
                                         const brake_blending_input_t *in);

#endif
