/* SPDX-License-Identifier: Apache-2.0 */
/*
 * brake_blending.h: splits a braking demand between motor and hydraulic brake. 1 kHz.
 *
 * The motor brakes up to its torque limits (torque_limits.h, which include the strategy); the
 * hydraulic brake gets the rest, up to its own limit. A shortfall of the estimated below the
 * commanded motor torque, beyond brake.shortfall_band, is added to the hydraulic command at once.
 *
 * The hydraulic brake responds with a delay; its torque is measured (hydraulic_feedback.h) or
 * estimated (hydraulic_model.h). So
 *   - electric <= demand - hydraulic torque: the motor makes what the hydraulic brake does not make
 *     yet, and its torque rises no faster than the hydraulic torque falls;
 *   - above a falling deferrable limit the motor torque is kept for the dead time and then falls
 *     with the lag, to a tenth within brake.bridging_time; with feedback, which knows a brake up to
 *     twice as slow, up to twice as slowly. Hard limits hold at once;
 *   - the hydraulic command is predictive: it uses the motor limit expected after dead time plus
 *     lag, extrapolated with its slope of the last 64 ms, and the line BLEND_OUT of the speed
 *     expected after dead time plus two lags, with feedback three;
 *   - the available motor torque is that reached within brake.motor_arrival; it is the present
 *     command if the voltage permits no rise;
 *   - where the brake system takes its own path, the motor torque falls with the lag with which
 * that arrives, and no report says anything of the command;
 *   - with feedback the command is divided by the learned gain. While that is uncertain the motor
 *     brakes beyond the lines of the strategy by what the hydraulic brake may miss, and the command
 *     is larger by what the motor can take back, smaller by what it can make up for only.
 *
 * Equations: README, Brake blending; DERIVATIONS.md, Bridging to Hydraulic feedback.
 *
 * Source: Lu et al. 2013 section 3.2. Unlike there, in region I of its Fig. 5 the motor brakes with
 * T_opt instead of the friction brake alone, which never returns less energy.
 */
#ifndef TORQUE_BRAKE_BLENDING_H
#define TORQUE_BRAKE_BLENDING_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/filter.h"
#include "core/findings.h"
#include "core/last.h"
#include "core/measured.h"
#include "core/torque_enable.h"
#include "torque/demand.h"
#include "torque/hydraulic_feedback.h"
#include "torque/hydraulic_model.h"
#include "torque/torque_limits.h"

/* With a demand an open bridge closes within 5 ms; one that does not makes no torque, and the
 * demand is the hydraulic brake's. */
enum { BRAKE_BLENDING_CLOSING_STEPS = 8 };

typedef struct {
    hydraulic_model_t hydraulic;
    hydraulic_feedback_state_t feedback;
    filter_t limit_lp_mNm;    /* low-passed limit of the strategy */
    filter_t speed_lp_mrad_s; /* low-passed magnitude of the speed */
    int32_t bridged_q6_mNm;   /* what is left of a deferrable limit that has fallen */
    int32_t within_q6_mNm;    /* the deferrable limit of the last step */
    int32_t bridging_ms;      /* since it began to fall */
    int32_t covered_mNm;      /* of the demand, by the hydraulic brake in the last step */
    int32_t slower_mrad_s;    /* speed expected when the hydraulic brake has followed, magnitude */
    uint8_t open_steps;       /* of the bridge with a demand, less the closed ones */
} brake_blending_state_t;

/* What the motor makes now. */
typedef struct {
    int32_t achieved_mNm; /* estimated from measured currents, signed */
    int32_t short_mNm;    /* braking torque of an active short circuit by its model, magnitude; 0:
                             the bridge is not shorted */
    int32_t coasting_mNm; /* braking torque at zero current, where coasting is one; magnitude */
    int32_t growth_mNm;   /* permitted change of the command's magnitude; negative: it must fall */
    int32_t missing_q15;  /* share of its current that it does not see, 0 .. 16 384: the hydraulic
                             brake takes that much of its part */
    bool bridge_open;     /* since the last step: freewheel or active short circuit */
} motor_now_t;

typedef struct {
    int32_t electric_mNm;  /* torque demanded of the motor, magnitude >= 0, before the torque rate
                              limit; above `available` only while a limit is bridged */
    int32_t hydraulic_mNm; /* magnitude >= 0 */
    int32_t hard_mNm;      /* the tightest hard line */
    limit_t available;     /* largest electric torque under this strategy, and its reason */
    reason_t reason;       /* of an electric torque below the demand; else REASON_NONE */
    reason_t hydraulic_reason; /* REASON_HYDRAULIC_LIMIT if both brakes cannot meet the demand */
    int32_t uncovered_mNm;     /* of the demand, beyond the hydraulic torque, >= 0 */
    int32_t rise_mNm;      /* of the hydraulic torque in this step, >= 0: the motor torque beyond
                              uncovered_mNm falls by it at once */
    int32_t slower_mrad_s; /* speed expected when it has followed a command, magnitude */
    int32_t made_mNm;      /* hydraulic torque now, measured or modelled, magnitude */
} brake_blending_out_t;

void brake_blending_init(brake_blending_state_t *state, const config_t *config);

/* Sets the findings BRAKE_*, of the hydraulic brake and of its reports; returns the reason of the
 * first that is present. Once a step, after brake_blending_step(). */
reason_t brake_blending_report(const brake_blending_state_t *state, findings_t *findings);

/* 1 kHz. limits: of this step. last: torque command, and what was added to the hydraulic command.
 * report: of this wheel's brake; an age beyond brake.hydraulic_timeout_ms is a missing one.
 *
 * The electric torque is at most the demand and every hard line; a demand below zero counts as
 * zero. The hydraulic command is at most brake.max_hydraulic_torque. */
brake_blending_out_t brake_blending_step(brake_blending_state_t *state, const config_t *config,
                                         const torque_limits_t *limits, const measured_t *now,
                                         const last_t *last, const hydraulic_feedback_t *report,
                                         const torque_enable_t *enable, const demand_t *demand,
                                         const motor_now_t *motor);

#endif
