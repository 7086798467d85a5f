/* SPDX-License-Identifier: Apache-2.0 */
#include "sensor_isolation.h"

#include "core/angle.h"
#include "current_controller.h"
#include "design_response.h"
#include "sense.h"
#include "transforms.h"

enum {
    RADIANS_PER_TURN_Q15 = ANGLE_PI_Q24 >> 8, /* 2 pi */
    USE_PREDICTION = SENSE_PHASES + 1,
    RATIO_MAX_Q10 = 16 * 1024,
    STATE_LIMIT_PU = 65536 /* of predictions: twice the largest current */
};

/* Share of a current error that the controller removes in the period in which its voltage acts,
 * k_p T/L = a (1 - a). */
static int32_t removed_share_q15(const config_t *config)
{
    const int64_t b_q24 = design_half_period_q24(config);
    const int64_t a_q24 = (b_q24 * b_q24) >> 24;
    return design_q15((a_q24 * (DESIGN_ONE_Q24 - a_q24)) >> 24);
}

void sensor_isolation_init(sensor_isolation_t *state, const config_t *config)
{
    const int32_t l_d_nH = config->motor.d_inductance_nH;
    const int32_t l_q_nH = config->motor.q_inductance_nH;
    const int32_t suspect_pu = config->monitor.current_sum_pu_q15 / SENSOR_ISOLATION_SUSPECT_SHARE;
    const sensor_isolation_t fresh = {
        .suspect_pu = suspect_pu,
        .suspect_range_pu = (uint32_t)(2 * suspect_pu),
        .phase = SENSE_PHASES,
        .answer = SENSE_PHASES,
        .implausible_pu = config->monitor.current_sum_pu_q15,
        .removed_share_q15 = removed_share_q15(config),
        .l_q_over_l_d_q10 = q_min(q_scale(l_q_nH, 1024, l_d_nH), RATIO_MAX_Q10),
        .l_d_over_l_q_q10 = q_min(q_scale(l_d_nH, 1024, l_q_nH), RATIO_MAX_Q10),
    };
    *state = fresh;
}

void sensor_isolation_acknowledge(sensor_isolation_t *state)
{
    state->undetermined = false;
    state->unknown = 0;
    state->periods = 0;
}

/*
 * Change of the current from the next sample to the one after it, by the voltage that the period
 * before has commanded. error: of the current that the controller used; zero on an axis whose
 * voltage was limited, because there the current stays. wrong: used less predicted current, which
 * the decoupling has taken for a current (cross-coupling w L per unit of it).
 */
static dq_t change_by(const foc_current_state_t *current, const foc_period_t *period, dq_t error,
                      dq_t wrong)
{
    const sensor_isolation_t *state = &current->isolation;
    const voltage_out_t *voltage = &period->voltage;
    const dq_t applied = dq_of(voltage->applied);
    const dq_t unsaturated = voltage_unsaturated(voltage);
    const int32_t sampled_weight_q15 = Q15_ONE - current->predictor.weight_q15;
    const int64_t turned_q15 = ((int64_t)period->rotor.speed_q32 * RADIANS_PER_TURN_Q15) >> 32;
    const int32_t coupled_q15 = (int32_t)((turned_q15 * sampled_weight_q15) >> 15);
    const int32_t d_q15 = (coupled_q15 * state->l_q_over_l_d_q10) >> 10;
    const int32_t q_q15 = (coupled_q15 * state->l_d_over_l_q_q10) >> 10;
    const int32_t share_q15 = state->removed_share_q15;
    const dq_t out = {
        .d = (applied.d == unsaturated.d ? q15_product(share_q15, error.d) : 0) -
             q15_product(d_q15, wrong.q),
        .q = (applied.q == unsaturated.q ? q15_product(share_q15, error.q) : 0) +
             q15_product(q_q15, wrong.d),
    };
    return out;
}

/* The prediction for this sample. The first examined period begins from the current of the one
 * before. */
static void predict(foc_current_state_t *current, const foc_period_t *period)
{
    sensor_isolation_t *state = &current->isolation;
    const dq_t before = dq_of(period->i_pu);
    const dq_t reference = dq_of(period->i_reference_pu);
    const bool continues = state->periods > 0 && period->step_count - state->last_step == 1U;
    if (!continues) {
        state->predicted_pu = before;
        state->begin_sum_pu = period->current_sum_pu;
        state->periods = 0;
        state->agreeing = 0;
        state->unknown = 0;
        state->answer = SENSE_PHASES;
    }
    const dq_t error = {.d = reference.d - before.d, .q = reference.q - before.q};
    const dq_t wrong = {.d = before.d - state->predicted_pu.d,
                        .q = before.q - state->predicted_pu.q};
    const dq_t next = change_by(current, period, error, wrong);
    const dq_t change = continues ? state->change_pu : next;
    state->predicted_pu.d = q_limit(state->predicted_pu.d + change.d, STATE_LIMIT_PU);
    state->predicted_pu.q = q_limit(state->predicted_pu.q + change.q, STATE_LIMIT_PU);
    state->change_pu = next;
    state->last_step = period->step_count;
    state->periods++;
}

/* The sensor that alone explains the sum: the residuals of the other two are below 5/16 of it.
 * SENSE_PHASES: none. All three cannot be, because they add up to the sum. */
static uint8_t explained_by(abc_t residual, int32_t sum_pu)
{
    const int32_t tolerance = (q_abs(sum_pu) >> 4) * 5;
    const bool a = q_abs(residual.a) <= tolerance;
    const bool b = q_abs(residual.b) <= tolerance;
    const bool c = q_abs(residual.c) <= tolerance;
    if (b && c) {
        return 0;
    }
    if (a && c) {
        return 1;
    }
    return a && b ? 2 : SENSE_PHASES;
}

static void count(sensor_isolation_t *state, uint8_t answer)
{
    if (answer == SENSE_PHASES) {
        state->agreeing = 0;
        state->unknown++;
        state->undetermined =
            state->undetermined || state->unknown >= SENSOR_ISOLATION_UNKNOWN_PERIODS;
    } else {
        state->agreeing = (uint16_t)(answer == state->answer ? state->agreeing + 1 : 1);
        state->unknown = 0;
    }
    state->answer = answer;
    if (state->agreeing >= SENSOR_ISOLATION_NAMED_PERIODS) {
        state->phase = answer;
        state->suspect_pu = 0;
        state->suspect_range_pu = 0;
    }
}

/* What to use in this period: 0 .. 2, without that sensor; SENSE_PHASES, as measured; or
 * USE_PREDICTION. */
static uint8_t isolate(sensor_isolation_t *state, abc_t read, abc_t predicted, int32_t sum_pu)
{
    const int32_t size_pu = q_abs(sum_pu);
    if (size_pu <= state->implausible_pu) {
        if (state->periods >= SENSOR_ISOLATION_MEMORY_PERIODS) {
            state->periods = 0; /* the next prediction begins here */
        }
        return SENSE_PHASES;
    }
    /* What has grown since the prediction began is what the residuals can show. */
    if (q_abs(sum_pu - state->begin_sum_pu) < (size_pu >> 3) * 5) {
        count(state, SENSE_PHASES);
        return SENSE_PHASES;
    }
    const abc_t residual = {
        .a = read.a - predicted.a, .b = read.b - predicted.b, .c = read.c - predicted.c};
    const uint8_t answer = explained_by(residual, sum_pu);
    count(state, answer);
    return answer == SENSE_PHASES ? (uint8_t)USE_PREDICTION : answer;
}

void sensor_isolation_examine(foc_period_t *period, const uint16_t codes[SENSE_PHASES],
                              foc_current_state_t *current, int32_t sum_pu)
{
    sensor_isolation_t *state = &current->isolation;
    const sense_state_t *sense = &current->sense;
    if (state->phase != SENSE_PHASES) {
        period->i_ab_pu = sense_without(sense, codes, state->phase);
        return;
    }
    predict(current, period);
    const rotation_t angle = angle_rotation(period->theta_turn);
    const ab_t predicted = transforms_inverse_park(dq16_saturated(state->predicted_pu), angle);
    const uint8_t without =
        isolate(state, sense_phases(sense, codes), transforms_inverse_clarke(predicted), sum_pu);
    if (without == USE_PREDICTION) {
        period->i_ab_pu = ab16_saturated(predicted);
    } else if (without != SENSE_PHASES) {
        period->i_ab_pu = sense_without(sense, codes, without);
        state->predicted_pu = dq_of(transforms_park(period->i_ab_pu, angle));
    }
}
