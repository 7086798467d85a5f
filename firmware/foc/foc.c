/* SPDX-License-Identifier: Apache-2.0 */
#include "foc/foc.h"

#include "core/angle.h"
#include "foc/transforms.h"

static void centre_counts(foc_current_state_t *state)
{
    for (int x = 0; x < SENSE_PHASES; x++) {
        state->on_q16[x] = state->svpwm.centre_q16;
    }
}

void foc_init(foc_state_t *state, const config_t *config)
{
    const foc_state_t zero = {0};
    *state = zero;
    const config_drive_t *drive = &config->drive;
    state->current.dead_time = dead_time_init(config);
    response_init(&state->response, &state->current.expected, config);
    state->current.svpwm = svpwm_init(drive->pwm_period_counts, drive->min_pulse_counts,
                                      state->current.dead_time.full_counts,
                                      config->current_loop.modulation_limit_pu_q15);
    state->current_circle = circle_init(config->current_loop.max_current_pu_q15);
    sense_init(&state->current.sense);
    rotor_init(&state->rotor, config);
    state->followed = FOC_NOTHING_FOLLOWED;
    centre_counts(&state->current);
}

foc_command_t foc_initial_command(const foc_state_t *state, const config_t *config)
{
    const int32_t highest_pu =
        q_scale(config->battery.max_voltage_mV, 32768, config->drive.voltage_full_scale_mV);
    const foc_command_t command = {
        .i_reference_pu = {.d = 0, .q = 0},
        .tuning = current_loop_tuning(config, state->current.svpwm.modulation_limit_q15, highest_pu,
                                      0, config->motor.reference_temperature_cC),
        .dead_time_slope = dead_time_slope_at(config, highest_pu),
        .calibrate_offsets = false,
    };
    return command;
}

void foc_current_step(foc_current_state_t *restrict state, const uint16_t *restrict codes,
                      foc_period_t *restrict period)
{
    const current_loop_tuning_t *tuning = &state->tuning;
    const sense_out_t sensed = sense_step(&state->sense, codes, state->on_q16);
    period->current_sum_pu = sensed.sum_pu;
    const sincos_t angle = angle_sincos(period->rotor.theta_turn);
    const dq_t i = transforms_park(sensed.i, angle);
    period->i_pu = i;
    const dq_t reference = period->i_reference_pu;
    current_loop_step(&state->loop, tuning, reference, i, &period->voltage);

    /* The voltage acts from the next update for one period: on average 1.5 periods after the
     * sample. */
    const sincos_t angle_applied = transforms_advance(angle, tuning->advance);
    const ab_t u = transforms_inverse_park(period->voltage.realised, angle_applied);
    const ab_t i_applied =
        transforms_inverse_park(response_expect(&state->expected), angle_applied);
    svpwm_step(&state->svpwm, u, dead_time_shares(&state->dead_time, i_applied), state->on_q16);
}

static void calibrate(foc_state_t *state, const uint16_t codes[SENSE_PHASES], foc_report_t *report)
{
    sense_state_t *sense = &state->current.sense;
    if (!state->calibrating) { /* the command is new, or came while running */
        sense_calibrate_restart(sense);
    }
    sense_calibrate_step(sense, codes);
    for (int x = 0; x < SENSE_PHASES; x++) {
        report->offset_q4[x] = sense->offset_q4[x];
    }
    report->offsets_done = sense->calibrated;
}

/* In the short the currents turn as the magnets do: forward counted up, back down. A vector that
 * leaps across the middle says nothing. At the speed base, a sixteenth of a turn in a period, it is
 * seen four times in a quarter. */
static void count_quarters(foc_state_t *state, ab_t i, foc_report_t *report)
{
    const uint32_t upper = i.alpha >= 0 ? 0 : 1;
    const uint32_t quarter = i.beta >= 0 ? upper : 3U - upper;
    const uint32_t gone = (quarter - state->quarter) & 3U;
    state->quarter = quarter;
    if ((gone & 1U) != 0) {
        report->current_quarters =
            (uint16_t)(report->current_quarters + (gone == 1U ? 1U : UINT16_MAX));
        report->quarter_step = (uint16_t)report->step_count;
    }
}

void foc_rest(foc_state_t *state, bool calibrate_offsets, const uint16_t codes[SENSE_PHASES],
              foc_report_t *report)
{
    foc_period_t *period = &report->current;
    const sense_out_t sensed = sense_step(&state->current.sense, codes, state->current.on_q16);
    const current_loop_out_t no_voltage = {
        .wanted_d = 0, .wanted_q = 0, .realised = {.d = 0, .q = 0}};
    const dq_t no_current = {.d = 0, .q = 0};
    period->i_reference_pu = no_current;
    period->i_pu = transforms_park(sensed.i, angle_sincos(period->rotor.theta_turn));
    count_quarters(state, sensed.i, report);
    period->voltage = no_voltage;
    period->current_sum_pu = sensed.sum_pu;
    current_loop_reset(&state->current.loop);
    response_rest(&state->response, &state->current.expected);
    state->weakening.current_q28 = 0;
    report->i_d_weakening_pu = 0;
    centre_counts(&state->current);
    if (calibrate_offsets) {
        calibrate(state, codes, report);
    }
    state->calibrating = calibrate_offsets;
    state->followed = FOC_NOTHING_FOLLOWED;
}

static dq_t inside(const circle_t *circle, int32_t d, int32_t q)
{
    const int32_t real_d = q_limit(d, circle->radius_q15);
    const dq_t out = {.d = real_d, .q = q_limit(q, circle_other(circle, real_d))};
    return out;
}

void foc_follow(foc_state_t *state, const foc_command_t *command, foc_period_t *period)
{
    const circle_t *circle = &state->current_circle;
    foc_current_state_t *current = &state->current;
    const int32_t d = command->i_reference_pu.d + field_weakening_current_pu(&state->weakening);
    const int32_t q = command->i_reference_pu.q;
    const int32_t mean_d =
        d + q_limit(command->i_d_mean_less_sample_pu, FOC_MEAN_LESS_SAMPLE_MOST_PU);
    const dq_t mean = inside(circle, mean_d, q);
    const response_given_t given =
        response_follow(&state->response, inside(circle, d, q), &current->expected, mean);
    period->i_reference_pu = state->response.settled
                                 ? given.reference_pu
                                 : inside(circle, given.reference_pu.d, given.reference_pu.q);
    current->dead_time.slope = command->dead_time_slope;
    current->tuning = command->tuning;
    current_loop_bring_forward(&current->tuning, state->response.nearer_q15, given.aim_pu);
    state->calibrating = false;
    state->followed = state->response.settled ? command->number : FOC_NOTHING_FOLLOWED;
}
