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
    STATE_LIMIT_PU = 65536, /* of predictions: twice the largest current */
    TURN = 65536,
    GLITCH_SHARE = SENSOR_ISOLATION_GLITCH_MS / SENSOR_ISOLATION_AGREES_MS,
    QUIET_SHARE = SENSOR_ISOLATION_QUIET_MS / SENSOR_ISOLATION_AGREES_MS
};

enum { NEGATIVE = 1, POSITIVE = 2 }; /* signs of a current */

static const agreement_t NONE;

/* Share of a current error that the controller removes in the period in which its voltage acts,
 * k_p T/L = a (1 - a). */
static int32_t removed_share_q15(const config_t *config)
{
    const int64_t b_q24 = design_half_period_q24(config);
    const int64_t a_q24 = (b_q24 * b_q24) >> 24;
    return design_q15((a_q24 * (DESIGN_ONE_Q24 - a_q24)) >> 24);
}

static int32_t suspect_pu(const sensor_isolation_t *state)
{
    return state->implausible_pu / SENSOR_ISOLATION_SUSPECT_SHARE;
}

/* From the next period on all three sensors are used. */
static void use_all(sensor_isolation_t *state)
{
    state->phase = SENSE_PHASES;
    state->suspect_pu = suspect_pu(state);
    state->suspect_range_pu = (uint32_t)(2 * state->suspect_pu);
    state->periods = 0;
}

/* A sensor that comes and goes has to prove itself for longer each time. */
static void name(sensor_isolation_t *state, uint8_t phase)
{
    const int32_t quiet_periods = QUIET_SHARE * state->agrees_periods;
    const bool again = state->last_step - state->used_step < (uint32_t)quiet_periods;
    state->phase = phase;
    state->suspect_pu = SENSOR_ISOLATION_EVERY_SUM_PU;
    state->suspect_range_pu = 0;
    state->undetermined = false; /* it has been determined in time */
    state->may_return = true;
    state->signs = 0;
    state->named_step = state->last_step;
    state->returned = NONE;
    state->proved = NONE;
    state->proof_periods =
        again ? q_min(2 * state->proof_periods, quiet_periods) : state->agrees_periods;
}

void sensor_isolation_init(sensor_isolation_t *state, const config_t *config)
{
    const int32_t l_d_nH = config->motor.d_inductance_nH;
    const int32_t l_q_nH = config->motor.q_inductance_nH;
    const int32_t agrees_periods =
        config->drive.pwm_frequency_Hz / 1000 * SENSOR_ISOLATION_AGREES_MS;
    const sensor_isolation_t fresh = {
        .used_step = 0U - (uint32_t)(QUIET_SHARE * agrees_periods),
        .agrees_periods = agrees_periods,
        .proof_periods = agrees_periods,
        .answer = SENSE_PHASES,
        .implausible_pu = config->monitor.current_sum_pu_q15,
        .removed_share_q15 = removed_share_q15(config),
        .l_q_over_l_d_q10 = q_min(q_scale(l_q_nH, 1024, l_d_nH), RATIO_MAX_Q10),
        .l_d_over_l_q_q10 = q_min(q_scale(l_d_nH, 1024, l_q_nH), RATIO_MAX_Q10),
    };
    *state = fresh;
    use_all(state);
}

void sensor_isolation_acknowledge(sensor_isolation_t *state)
{
    if (state->undetermined) {
        use_all(state);
    }
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
    state->theta_turn = period->theta_turn;
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
    if (state->agreeing < SENSOR_ISOLATION_NAMED_PERIODS) {
        return;
    }
    if (state->phase == SENSE_PHASES) {
        name(state, answer);
    } else if (state->phase == answer) {
        state->may_return = false; /* no glitch: it is wrong again */
    } else {
        state->undetermined = true; /* a second sensor is wrong */
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

static void agree(agreement_t *agreement, int32_t enough_periods, int32_t step_turn)
{
    agreement->periods = q_min(agreement->periods + 1, enough_periods);
    agreement->turned = q_clamp(agreement->turned + step_turn, -TURN, TURN);
}

/* Long enough, and over an electrical turn. */
static bool lasts(const agreement_t *agreement, int32_t enough_periods)
{
    return agreement->periods >= enough_periods && q_abs(agreement->turned) == TURN;
}

/* The named sensor reads right again after a glitch. */
static bool has_returned(const sensor_isolation_t *state)
{
    return state->may_return && lasts(&state->returned, state->agrees_periods);
}

static bool is_proved(const sensor_isolation_t *state)
{
    return lasts(&state->proved, state->proof_periods) && state->signs == (NEGATIVE | POSITIVE);
}

static void disagree(sensor_isolation_t *state, uint32_t step_count)
{
    state->proved = NONE;
    state->signs = 0;
    if (!has_returned(state)) {
        const uint32_t wrong_periods = step_count - state->named_step;
        state->may_return =
            state->may_return && wrong_periods <= (uint32_t)(GLITCH_SHARE * state->agrees_periods);
        state->returned = NONE;
    }
}

/* A period while a sensor is named. i_pu: its phase's current by the other two, zero where that
 * proves nothing. */
static void follow(sensor_isolation_t *state, const foc_period_t *period, int32_t sum_pu,
                   int32_t i_pu)
{
    const int32_t step_turn = angle_difference(period->theta_turn, state->theta_turn);
    state->theta_turn = period->theta_turn;
    if (q_abs(sum_pu) > state->implausible_pu / SENSOR_ISOLATION_AGREES_SHARE) {
        disagree(state, period->step_count);
        return;
    }
    agree(&state->returned, state->agrees_periods, step_turn);
    if (q_abs(i_pu) > SENSOR_ISOLATION_PROOF_CURRENT * state->implausible_pu) {
        agree(&state->proved, state->proof_periods, step_turn);
        state->signs = (uint8_t)(state->signs | (i_pu > 0 ? POSITIVE : NEGATIVE));
    }
}

ab16_t sensor_isolation_idle(foc_current_state_t *current, const uint16_t codes[SENSE_PHASES],
                             sense_out_t sensed, const foc_period_t *period)
{
    sensor_isolation_t *state = &current->isolation;
    if (state->phase == SENSE_PHASES) {
        return sensed.i;
    }
    follow(state, period, sensed.sum_pu, 0);
    const bool counts = has_returned(state) && q_abs(sensed.sum_pu) > state->implausible_pu;
    state->unknown = (uint16_t)(counts ? q_min(state->unknown + 1, state->agrees_periods) : 0);
    state->undetermined = state->undetermined || state->unknown >= state->agrees_periods;
    return sense_without(&current->sense, codes, state->phase);
}

/* Current of the named sensor's phase by the other two: its reading less the sum. */
static int32_t reconstructed_pu(const foc_current_state_t *current,
                                const uint16_t codes[SENSE_PHASES], int32_t sum_pu)
{
    const uint8_t phase = current->isolation.phase;
    return codes[phase] * 16 - current->sense.offset_q4[phase] - sum_pu;
}

void sensor_isolation_examine(foc_period_t *period, const uint16_t codes[SENSE_PHASES],
                              foc_current_state_t *current, int32_t sum_pu)
{
    sensor_isolation_t *state = &current->isolation;
    const sense_state_t *sense = &current->sense;
    const uint8_t named = state->phase;
    if (named != SENSE_PHASES) {
        period->i_ab_pu = sense_without(sense, codes, named);
        follow(state, period, sum_pu, reconstructed_pu(current, codes, sum_pu));
        if (is_proved(state)) {
            use_all(state);
            state->used_step = period->step_count;
            return;
        }
        if (!has_returned(state) || q_abs(sum_pu) <= suspect_pu(state)) {
            return;
        }
    }
    predict(current, period);
    const rotation_t angle = angle_rotation(period->theta_turn);
    const ab_t predicted = transforms_inverse_park(dq16_saturated(state->predicted_pu), angle);
    const uint8_t without =
        isolate(state, sense_phases(sense, codes), transforms_inverse_clarke(predicted), sum_pu);
    if (without == SENSE_PHASES) {
        return;
    }
    const bool second = named != SENSE_PHASES && without != named;
    if (without == USE_PREDICTION || second) {
        period->i_ab_pu = ab16_saturated(predicted);
    } else {
        period->i_ab_pu = sense_without(sense, codes, without);
        state->predicted_pu = dq_of(transforms_park(period->i_ab_pu, angle));
    }
}
