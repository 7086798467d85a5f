/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hydraulic_feedback.h: the hydraulic torque now, the gain of the hydraulic brake, and what is
 * wrong with it, from its measured torque. 1 kHz.
 *
 * A brake whose dead time and lag are between half and twice the configured ones makes of its
 * commands a torque between gain * early and gain * late (hydraulic_model.h). So every report gives
 * an interval of gains: report / larger .. report / smaller of the two models. The learned interval
 * moves to it, slowly where the two contradict each other, and the gain no further than into it.
 * While the torque changes fast the interval is wide and nothing is learned from lateness; once the
 * models agree it is narrow.
 *
 * A report contradicts the commands beyond what gains 1 -+ brake.hydraulic_gain_band make of them,
 * by more than brake.hydraulic_tolerance. Whether the brake or its sensor is wrong nobody can tell,
 * so such a report is shown, and counts as that of a gain at the end of the band: a wrong
 * one moves neither brake further than a gain at the end of the band. After brake.hydraulic_timeout
 * without a report, and at once after one that has changed by more than twice the tolerance faster
 * than a brake with half the lag can follow the latest commands, the model stands in; feedback
 * returns after HYDRAULIC_FEEDBACK_HEAL_ms without either. DERIVATIONS.md, Hydraulic feedback and
 * Wrong reports.
 */
#ifndef TORQUE_HYDRAULIC_FEEDBACK_H
#define TORQUE_HYDRAULIC_FEEDBACK_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/reason.h"
#include "core/slow_messages.h"
#include "torque/hydraulic_model.h"

enum {
    HYDRAULIC_FEEDBACK_PAST_ms = HYDRAULIC_MODEL_BETWEEN_MOST_ms,
    HYDRAULIC_FEEDBACK_HEAL_ms = 1000,
    HYDRAULIC_FEEDBACK_LATE_ms = 1500 /* a brake that is short for less was late */
};

typedef struct {
    int32_t model_mNm[HYDRAULIC_FEEDBACK_PAST_ms + 1]; /* of the last milliseconds */
    uint32_t now;
    int32_t least_q15, gain_q15, most_q15; /* learned; 32 768 = 1.0 */
    int32_t report_mNm, change_mNm;        /* last report, and its change to the one before */
    int32_t raw_mNm;                       /* last report, as it came */
    int32_t since_ms, between_ms;          /* the last report; the last two */
    int32_t heal_ms;                       /* until it is used again; 0: in use */
    int32_t short_ms; /* from the first report that was short to the last, saturating */
    bool seen;        /* a valid report has come since the start */
    reason_t shows;   /* of the brake: HYDRAULIC_WEAK, _DEAD, _STRONG, _STUCK; REASON_NONE */
} hydraulic_feedback_state_t;

typedef struct {
    bool used;          /* there is feedback */
    bool lost;          /* there was feedback, and it is missing or flickers */
    int32_t torque_mNm; /* hydraulic torque now, magnitude: measured, without feedback modelled */
} hydraulic_feedback_out_t;

void hydraulic_feedback_init(hydraulic_feedback_state_t *state, const config_t *config);

static inline bool hydraulic_feedback_used(const hydraulic_feedback_state_t *state)
{
    return state->seen && state->heal_ms == 0;
}

/* True if the reports show a brake that makes less than its command. */
static inline bool hydraulic_feedback_is_short(const hydraulic_feedback_state_t *state)
{
    return state->shows == REASON_HYDRAULIC_WEAK || state->shows == REASON_HYDRAULIC_DEAD;
}

/* After hydraulic_model_step() of the same millisecond. report: its torque is clamped to 0 .. 2^25
 * mN m; with brake.hydraulic_timeout zero none is used. commanded: the brake follows its commands,
 * no anti-lock system moves its valves; else a report is the torque, and shows and teaches nothing.
 */
hydraulic_feedback_out_t hydraulic_feedback_step(hydraulic_feedback_state_t *state,
                                                 const config_t *config,
                                                 const hydraulic_model_t *model,
                                                 const hydraulic_feedback_t *report,
                                                 bool commanded);

#endif
