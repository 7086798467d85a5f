/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/hydraulic_feedback.h"

#include "core/q15.h"

enum {
    ONE_Q15 = 1 << 15,
    SIGNIFICANT_LOG2 = 6, /* below a 64th of the largest torque a ratio says nothing */
    MODEL_LOG2 = 4,
    DEAD_SHARE = 4,   /* of its command: a brake that makes less is dead */
    LEARN_LOG2 = 2,   /* share of the way to a new interval that one report goes */
    RELEARN_LOG2 = 4, /* and of that, where it contradicts what was learned */
    MOST_mNm = 1 << 25
};

static void forget_gain(hydraulic_feedback_state_t *state, const config_t *config)
{
    state->least_q15 = ONE_Q15 - config->brake.hydraulic_gain_band_q15;
    state->gain_q15 = ONE_Q15;
    state->most_q15 = ONE_Q15 + config->brake.hydraulic_gain_band_q15;
}

void hydraulic_feedback_init(hydraulic_feedback_state_t *state, const config_t *config)
{
    const hydraulic_feedback_state_t fresh = {.between_ms = 1};
    *state = fresh;
    forget_gain(state, config);
}

/* a / b in Q15, both >= 0. */
static int32_t ratio_q15(int32_t a, int32_t b)
{
    uint32_t over = (uint32_t)a;
    uint32_t under = (uint32_t)b;
    while (over >= (UINT32_C(1) << 17)) {
        over >>= 1;
        under >>= 1;
    }
    return (int32_t)((over << 15) / (under > 0U ? under : 1U));
}

/* What brakes twice as early, as configured and twice as late would report, of gain one and of any
 * gain within the band. */
typedef struct {
    int32_t smaller_mNm, nominal_mNm, larger_mNm;
    int32_t least_mNm, most_mNm;
} possible_t;

static possible_t possible(const config_t *config, const hydraulic_model_t *model,
                           int32_t nominal_mNm)
{
    const int32_t early_mNm = hydraulic_model_early_mNm(model);
    const int32_t late_mNm = hydraulic_model_late_mNm(model);
    const int32_t band_q15 = config->brake.hydraulic_gain_band_q15;
    possible_t out = {.smaller_mNm = q_min(q_min(early_mNm, late_mNm), nominal_mNm),
                      .nominal_mNm = nominal_mNm,
                      .larger_mNm = q_max(q_max(early_mNm, late_mNm), nominal_mNm)};
    out.least_mNm = q15_product(out.smaller_mNm, ONE_Q15 - band_q15);
    out.most_mNm = q15_product(out.larger_mNm, ONE_Q15 + band_q15);
    return out;
}

static int32_t towards(int32_t from, int32_t to)
{
    return from + (to - from) / (1 << LEARN_LOG2);
}

/* The interval moves to what this report leaves of it, the gain into the interval. */
static void learn(hydraulic_feedback_state_t *state, const config_t *config,
                  const possible_t *could, int32_t report_mNm)
{
    const config_brake_t *brake = &config->brake;
    /* Resolution of the sensor, and of the models while they differ. */
    const int32_t noise_mNm = (brake->max_hydraulic_torque_mNm >> (SIGNIFICANT_LOG2 + 3)) +
                              ((could->larger_mNm - could->smaller_mNm) >> MODEL_LOG2);
    if (could->larger_mNm < brake->max_hydraulic_torque_mNm >> SIGNIFICANT_LOG2) {
        return;
    }
    const int32_t lowest_q15 = ONE_Q15 - brake->hydraulic_gain_band_q15;
    const int32_t highest_q15 = ONE_Q15 + brake->hydraulic_gain_band_q15;
    const int32_t at_least_q15 = q_clamp(
        ratio_q15(q_max(report_mNm - noise_mNm, 0), could->larger_mNm), lowest_q15, highest_q15);
    const int32_t at_most_q15 = could->smaller_mNm > 0
                                    ? q_clamp(ratio_q15(report_mNm + noise_mNm, could->smaller_mNm),
                                              lowest_q15, highest_q15)
                                    : highest_q15;
    if (at_least_q15 > state->least_q15) {
        const int32_t least_q15 = towards(state->least_q15, at_least_q15);
        state->most_q15 += q_max(least_q15 - state->most_q15, 0) >> RELEARN_LOG2;
        state->least_q15 = q_min(least_q15, state->most_q15);
    }
    if (at_most_q15 < state->most_q15) {
        const int32_t most_q15 = towards(state->most_q15, at_most_q15);
        state->least_q15 -= q_max(state->least_q15 - most_q15, 0) >> RELEARN_LOG2;
        state->most_q15 = q_max(most_q15, state->least_q15);
    }
    state->gain_q15 = q_clamp(state->gain_q15, state->least_q15, state->most_q15);
}

/* Counts of the reports' age; true in the millisecond of a new one. */
static bool is_new_report(hydraulic_feedback_state_t *state, const hydraulic_feedback_t *report)
{
    const int32_t age_ms =
        report->age_ms < (uint32_t)INT32_MAX ? (int32_t)report->age_ms : INT32_MAX;
    const bool is_new = report->valid && (!state->seen || age_ms <= state->since_ms);
    if (is_new) {
        const int32_t between_ms = q_saturate64((int64_t)state->since_ms + 1 - age_ms);
        state->between_ms = q_clamp(between_ms, 1, HYDRAULIC_FEEDBACK_PAST_ms);
        state->since_ms = age_ms;
    } else if (state->since_ms < INT32_MAX) {
        state->since_ms++;
    }
    return is_new;
}

/* Most that a torque may change towards an end of the commands, since the last report and, as its
 * age is known no better, the delay of one. */
static int32_t reachable_mNm(const hydraulic_feedback_state_t *state, const config_brake_t *brake,
                             int32_t distance_mNm)
{
    const int32_t time_ms = state->between_ms + brake->hydraulic_report_delay_ms;
    return q_scale(q_max(distance_mNm, 0), time_ms,
                   q_max(brake->hydraulic_time_constant_ms / 2, time_ms));
}

/* True if no brake with half the lag and a gain within the band changes so fast. */
static bool jumps(const hydraulic_feedback_state_t *state, const config_t *config,
                  const hydraulic_model_t *model, int32_t report_mNm)
{
    const config_brake_t *brake = &config->brake;
    const hydraulic_range_t commanded = hydraulic_model_commanded(model);
    const int32_t band_q15 = brake->hydraulic_gain_band_q15;
    const int32_t noise_mNm = 2 * brake->hydraulic_tolerance_mNm;
    const int32_t rise_mNm = reachable_mNm(
        state, brake, q15_product(commanded.most_mNm, ONE_Q15 + band_q15) - state->raw_mNm);
    const int32_t fall_mNm = reachable_mNm(
        state, brake, state->raw_mNm - q15_product(commanded.least_mNm, ONE_Q15 - band_q15));
    const int32_t change_mNm = report_mNm - state->raw_mNm;
    return state->seen && state->between_ms < HYDRAULIC_FEEDBACK_PAST_ms &&
           (change_mNm > rise_mNm + noise_mNm || -change_mNm > fall_mNm + noise_mNm);
}

/* What a report shows of the brake. Beside a command so small that a dead brake would agree with it
 * as well, one that was short still is. */
static reason_t shown(const hydraulic_feedback_state_t *state, const possible_t *could,
                      int32_t report_mNm, int32_t tolerance_mNm)
{
    if (report_mNm < could->least_mNm - tolerance_mNm) {
        return report_mNm < could->smaller_mNm / DEAD_SHARE ? REASON_HYDRAULIC_DEAD
                                                            : REASON_HYDRAULIC_WEAK;
    }
    if (report_mNm > could->most_mNm + tolerance_mNm) {
        return could->larger_mNm > tolerance_mNm ? REASON_HYDRAULIC_STRONG : REASON_HYDRAULIC_STUCK;
    }
    const bool tells = could->least_mNm > tolerance_mNm;
    return tells || !hydraulic_feedback_is_short(state) ? REASON_NONE : state->shows;
}

/* A report that contradicts the commands counts as that of a brake as late as configured, with the
 * gain at the end of the band. */
static int32_t counted_mNm(const config_t *config, const possible_t *could, int32_t report_mNm)
{
    const int32_t tolerance_mNm = config->brake.hydraulic_tolerance_mNm;
    const int32_t band_q15 = config->brake.hydraulic_gain_band_q15;
    if (report_mNm < could->least_mNm - tolerance_mNm) {
        return q15_product(could->nominal_mNm, ONE_Q15 - band_q15);
    }
    if (report_mNm > could->most_mNm + tolerance_mNm) {
        return q15_product(could->nominal_mNm, ONE_Q15 + band_q15);
    }
    return report_mNm;
}

static void keep(hydraulic_feedback_state_t *state, int32_t report_mNm)
{
    state->change_mNm = state->seen ? report_mNm - state->report_mNm : 0;
    state->report_mNm = report_mNm;
}

/* A report of a brake that follows its commands. */
static void judge(hydraulic_feedback_state_t *state, const config_t *config,
                  const possible_t *could, int32_t report_mNm)
{
    const int32_t tolerance_mNm = config->brake.hydraulic_tolerance_mNm;
    const bool was_short = hydraulic_feedback_is_short(state);
    state->shows = shown(state, could, report_mNm, tolerance_mNm);
    if (hydraulic_feedback_is_short(state)) {
        state->short_ms = was_short ? q_min(state->short_ms + state->between_ms, INT16_MAX) : 0;
    }
    if (state->heal_ms == 0) {
        learn(state, config, could, report_mNm);
    }
    keep(state, counted_mNm(config, could, report_mNm));
}

static int32_t modelled_ago_mNm(const hydraulic_feedback_state_t *state, int32_t ago_ms)
{
    return state->model_mNm[(state->now - (uint32_t)ago_ms) % (HYDRAULIC_FEEDBACK_PAST_ms + 1)];
}

/* What the torque has become since the sensor saw it: as the model's change, where the reports
 * changed the same way, and no more than at their slope. */
static int32_t since_report_mNm(const hydraulic_feedback_state_t *state, int32_t ago_ms)
{
    const int32_t modelled_mNm =
        q15_product(modelled_ago_mNm(state, 0) - modelled_ago_mNm(state, ago_ms), state->gain_q15);
    /* 2^25 times 63 is within 32 bits. */
    const int32_t straight_mNm = state->change_mNm * ago_ms / state->between_ms;
    if (modelled_mNm > 0) {
        return q_clamp(straight_mNm, 0, modelled_mNm);
    }
    return q_clamp(straight_mNm, modelled_mNm, 0);
}

hydraulic_feedback_out_t hydraulic_feedback_step(hydraulic_feedback_state_t *state,
                                                 const config_t *config,
                                                 const hydraulic_model_t *model,
                                                 const hydraulic_feedback_t *report, bool commanded)
{
    const config_brake_t *brake = &config->brake;
    const int32_t modelled_mNm = hydraulic_model_torque_mNm(model);
    state->now = (state->now + 1U) % (HYDRAULIC_FEEDBACK_PAST_ms + 1);
    state->model_mNm[state->now] = modelled_mNm;
    state->heal_ms = q_max(state->heal_ms - 1, 0);
    if (brake->hydraulic_timeout_ms > 0 && is_new_report(state, report)) {
        const int32_t report_mNm = q_clamp(report->torque_mNm, 0, MOST_mNm);
        const possible_t could =
            possible(config, model, modelled_ago_mNm(state, brake->hydraulic_report_delay_ms));
        if (commanded && jumps(state, config, model, report_mNm)) {
            state->heal_ms = HYDRAULIC_FEEDBACK_HEAL_ms;
        }
        if (commanded) {
            judge(state, config, &could, report_mNm);
        } else {
            keep(state, report_mNm);
        }
        state->raw_mNm = report_mNm;
        state->seen = true;
    }
    if (state->seen && state->since_ms > brake->hydraulic_timeout_ms) {
        state->heal_ms = HYDRAULIC_FEEDBACK_HEAL_ms;
        state->shows = REASON_NONE;
    }
    hydraulic_feedback_out_t out = {
        .used = hydraulic_feedback_used(state),
        .torque_mNm = q15_product(modelled_mNm, state->gain_q15),
    };
    out.lost = state->seen && !out.used;
    if (out.used) {
        const int32_t ago_ms = state->since_ms + brake->hydraulic_report_delay_ms;
        const int32_t change_mNm =
            since_report_mNm(state, q_min(ago_ms, HYDRAULIC_FEEDBACK_PAST_ms));
        out.torque_mNm = q_max(state->report_mNm + change_mNm, 0);
    }
    return out;
}
