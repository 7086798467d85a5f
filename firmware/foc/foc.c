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
    state->current.svpwm =
        svpwm_init(drive->pwm_period_counts, drive->min_pulse_counts, state->current.dead_time.full_counts,
                   config->current_loop.modulation_limit_pu_q15);
    state->current_circle = circle_init(config->current_loop.max_current_pu_q15);
    sense_init(&state->current.sense);
    rotor_init(&state->rotor, config);
    centre_counts(&state->current);
}

foc_command_t foc_initial_command(const foc_state_t *state, const config_t *config)
{
    const int32_t highest_pu = q_scale(config->battery.max_voltage_mV, 32768, config->drive.voltage_full_scale_mV);
    const foc_command_t command = {
        .i_reference_pu = {.d = 0, .q = 0},
        .tuning = current_loop_tuning(config, state->current.svpwm.modulation_limit_q15, highest_pu, 0,
                                      config->motor.reference_temperature_cC),
        .calibrate_offsets = false,
    };
    return command;
}

void foc_current_step(foc_current_state_t *restrict state, const current_loop_tuning_t *restrict tuning,
                      const uint16_t *restrict codes, foc_period_t *restrict period)
{
    const sense_out_t sensed = sense_step(&state->sense, codes, state->on_q16);
    period->current_sum_pu = sensed.sum_pu;
    const sincos_t angle = angle_sincos(period->theta_turn);
    const dq_t i = transforms_park(sensed.i, angle);
    period->i_pu = i;
    const dq_t reference = period->i_reference_pu;
    const current_loop_out_t voltage = current_loop_step(&state->loop, tuning, reference, i);
    period->voltage = voltage;

    /* The voltage acts from the next update for one period: on average 1.5 periods after the sample. */
    const sincos_t angle_applied = transforms_advance(angle, tuning->advance);
    const ab_t u = transforms_inverse_park(voltage.realised, angle_applied);
    const ab_t i_applied = transforms_inverse_park(reference, angle_applied);
    svpwm_step(&state->svpwm, u, dead_time_shares(&state->dead_time, i_applied), state->on_q16);
}

/* The same measurements with the bridge not switching: nothing is regulated, the next start is bump-free. */
static void rest(foc_state_t *state, const uint16_t codes[SENSE_PHASES], foc_period_t *period)
{
    const sense_out_t sensed = sense_step(&state->current.sense, codes, state->current.on_q16);
    const current_loop_out_t no_voltage = {.wanted_d = 0, .wanted_q = 0, .realised = {.d = 0, .q = 0}};
    const dq_t no_current = {.d = 0, .q = 0};
    period->i_reference_pu = no_current;
    period->i_pu = transforms_park(sensed.i, angle_sincos(period->theta_turn));
    period->voltage = no_voltage;
    period->current_sum_pu = sensed.sum_pu;
    current_loop_reset(&state->current.loop);
    state->weakening.current_q30 = 0;
    centre_counts(&state->current);
}

/* The reference inside the current circle, demagnetising current first. */
static dq_t limited_reference(const foc_state_t *state, dq_t wanted)
{
    const int32_t most = state->current_circle.radius_q15;
    dq_t reference = {.d = wanted.d + field_weakening_current_pu(&state->weakening)};
    int32_t most_q = most;
    if (reference.d != 0) {
        reference.d = q_limit(reference.d, most);
        most_q = circle_other(&state->current_circle, reference.d);
    }
    reference.q = q_limit(wanted.q, most_q);
    return reference;
}

static void calibrate(foc_state_t *state, const uint16_t codes[SENSE_PHASES], foc_report_t *report)
{
    sense_state_t *sense = &state->current.sense;
    if (!state->calibrating) {
        sense_calibrate_restart(sense);
    }
    sense_calibrate_step(sense, codes);
    for (int x = 0; x < SENSE_PHASES; x++) {
        report->offset_q4[x] = sense->offset_q4[x];
    }
    report->offsets_done = sense->calibrated;
}

static void add_up(foc_sums_t *sums, const foc_period_t *period, int32_t v_dc_pu)
{
    const dq_t i = period->i_pu;
    const dq_t u = period->voltage.realised;
    foc_sums_t sum = *sums;
    sum.i_d_pu += (uint32_t)i.d;
    sum.i_q_pu += (uint32_t)i.q;
    /* |u| <= 1 and |i| <= 1.53, so the sum of products stays below 2^31. */
    sum.power_pu += (uint32_t)((u.d * i.d + u.q * i.q) >> 15);
    sum.v_dc_pu += (uint32_t)v_dc_pu;
    *sums = sum;
}

void foc_step(foc_state_t *state, const config_t *config, const foc_command_t *command, bool run, const foc_input_t *in,
              foc_report_t *report)
{
    const rotor_out_t rotor = rotor_step(&state->rotor, config, in->rotor_angle_turn, in->hall_state, &in->encoder);
    report->current.theta_turn = rotor.theta_turn;
    report->speed_q32 = rotor.speed_q32;
    report->rotor_age_periods = rotor.age_periods;
    report->rotor_valid = rotor.valid;
    report->rotor_faults = rotor.faults;
    report->v_dc_pu = q_min(in->bus_voltage_code, SENSE_CODE_MAX) * 8;
    if (run) {
        report->current.i_reference_pu = limited_reference(state, command->i_reference_pu);
        foc_current_step(&state->current, &command->tuning, in->phase_current_code, &report->current);
        const current_loop_out_t *voltage = &report->current.voltage;
        field_weakening_step(&state->weakening, voltage->wanted_d, voltage->wanted_q,
                             config->current_loop.field_weakening_gain_pu_q15,
                             config->current_loop.field_weakening_current_pu_q15);
    } else {
        rest(state, in->phase_current_code, &report->current);
    }
    if (command->calibrate_offsets) {
        calibrate(state, in->phase_current_code, report);
    }
    state->calibrating = command->calibrate_offsets;
    report->i_d_weakening_pu = field_weakening_current_pu(&state->weakening);
    add_up(&report->sums, &report->current, report->v_dc_pu);
}
