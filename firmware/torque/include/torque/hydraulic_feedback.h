/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hydraulic_feedback.h: the hydraulic torque now, and the gain of the hydraulic brake, from its
 * measured torque. 1 kHz.
 *
 * A brake whose dead time and lag are between half and twice the configured ones makes of its
 * commands a torque between gain * early and gain * late (hydraulic_model.h). So every report gives
 * an interval of gains: report / larger .. report / smaller of the two models. The learned interval
 * moves to it, slowly where the two contradict each other, and the gain no further than into it.
 * While the torque changes fast the interval is wide and nothing is learned from lateness; once the
 * models agree it is narrow.
 *
 * A report counts as implausible beyond the range of the brake, or beyond what gains 1 -+
 * brake.hydraulic_gain_band make of the commands, by more than brake.hydraulic_tolerance. After
 * brake.hydraulic_timeout of missing or implausible reports the feedback is not used, the learned
 * gain is forgotten (implausible) or kept (missing), and the model stands in; feedback returns
 * after HYDRAULIC_FEEDBACK_HEAL_ms of plausible reports. A report short of the learned gain by a
 * quarter of the tolerance counts as the model less that quarter until the deceleration confirms
 * it, so that a wrong sensor does not raise the motor torque. DERIVATIONS.md, Hydraulic
 * feedback and Wrong reports.
 */
#ifndef TORQUE_HYDRAULIC_FEEDBACK_H
#define TORQUE_HYDRAULIC_FEEDBACK_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/slow_messages.h"
#include "torque/hydraulic_model.h"

enum { HYDRAULIC_FEEDBACK_PAST_ms = 63, HYDRAULIC_FEEDBACK_HEAL_ms = 1000 };

typedef struct {
    int32_t model_mNm[HYDRAULIC_FEEDBACK_PAST_ms + 1]; /* of the last milliseconds */
    uint32_t now;
    int32_t least_q15, gain_q15, most_q15; /* learned; 32 768 = 1.0 */
    int32_t report_mNm, change_mNm;        /* last report, and its change to the one before */
    int32_t since_ms, between_ms;          /* the last report; the last two */
    int32_t bad_ms;                        /* missing or implausible for so long */
    int32_t heal_ms;                       /* until it is used again; 0: in use */
    bool seen;                             /* a valid report has come since the start */
    bool good;                             /* the last one was plausible */
    bool confirmed;          /* reports beyond the band are right: hydraulic_watch.h */
    bool refuted;            /* they are wrong, until they agree for the heal time */
    int32_t outside_ms;      /* reports are beyond the band, < 0: short of the learned gain, for
                                so long */
    int32_t contradicts_mNm; /* the last report beyond (> 0) or short of (< 0) what the commands
                                explain */
} hydraulic_feedback_state_t;

typedef struct {
    bool used;          /* there is feedback, and it is plausible */
    bool lost;          /* there was feedback, and it is missing or implausible */
    int32_t torque_mNm; /* hydraulic torque now, magnitude: measured, without feedback modelled */
} hydraulic_feedback_out_t;

void hydraulic_feedback_init(hydraulic_feedback_state_t *state, const config_t *config);

static inline bool hydraulic_feedback_used(const hydraulic_feedback_state_t *state)
{
    return state->seen && state->heal_ms == 0;
}

/* After hydraulic_model_step() of the same millisecond. report: its torque is clamped to 0 .. 2^25
 * mN m; with brake.hydraulic_timeout zero none is used. */
hydraulic_feedback_out_t hydraulic_feedback_step(hydraulic_feedback_state_t *state,
                                                 const config_t *config,
                                                 const hydraulic_model_t *model,
                                                 const hydraulic_feedback_t *report);

#endif
