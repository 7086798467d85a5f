/* SPDX-License-Identifier: Apache-2.0 */
#include "kernels.h"

#include "config/bases.h"
#include "core/angle.h"
#include "core/circle.h"
#include "core/reciprocal.h"
#include "current_controller.h"
#include "field_weakening.h"
#include "foc/foc.h"
#include "modulation.h"
#include "sense.h"
#include "transforms.h"
#include "tuning.h"
#include "winding.h"

static pair_t pair_of_angle(rotation_t angle)
{
    const pair_t out = {q_pair_x(angle.v), q_pair_y(angle.v)};
    return out;
}

static rotation_t angle_of(pair_t cos_sin)
{
    const rotation_t out = {.v = q_pair(cos_sin.x, cos_sin.y)};
    return out;
}

static ab_t ab_of(pair_t x)
{
    const ab_t out = {.alpha = x.x, .beta = x.y};
    return out;
}

static pair_t pair_of_ab(ab_t x)
{
    const pair_t out = {x.alpha, x.beta};
    return out;
}

static dq_t dq_from(pair_t x)
{
    const dq_t out = {.d = x.x, .q = x.y};
    return out;
}

static dq16_t dq16_from(pair_t x)
{
    return dq16_of(dq_from(x));
}

static pair_t pair_of_dq(dq_t x)
{
    const pair_t out = {x.d, x.q};
    return out;
}

static triple_t triple_of(abc_t x)
{
    const triple_t out = {x.a, x.b, x.c};
    return out;
}

pair_t kernel_cos_sin(uint16_t theta_turn)
{
    return pair_of_angle(angle_rotation(theta_turn));
}

pair_t kernel_clarke(triple_t phases)
{
    /* Readings of mid-range whose zeros lie apart by the currents wanted; c is worked out, which
     * changes nothing when they add up. */
    const int32_t middle_q4 = 2048 * 16;
    const uint16_t codes[3] = {2048, 2048, 2048};
    const int32_t on_q16[3] = {0, 0, 1};
    const int32_t offset_q4[3] = {middle_q4 - phases.a, middle_q4 - phases.b, middle_q4 - phases.c};
    return kernel_sense(codes, offset_q4, on_q16);
}

pair_t kernel_park(pair_t ab, pair_t cos_sin)
{
    const ab16_t packed = {.v = q_pair(ab.x, ab.y)};
    return pair_of_dq(dq_of(transforms_park(packed, angle_of(cos_sin))));
}

pair_t kernel_inverse_park(pair_t dq, pair_t cos_sin)
{
    return pair_of_ab(transforms_inverse_park(dq16_from(dq), angle_of(cos_sin)));
}

pair_t kernel_advance(pair_t cos_sin, pair_t by)
{
    return pair_of_angle(transforms_advance(angle_of(cos_sin), angle_of(by)));
}

int32_t kernel_circle_other_q15(int32_t x)
{
    return circle_other_q15(x);
}

int32_t kernel_circle_other(int32_t radius, int32_t x)
{
    const circle_t circle = circle_init(radius);
    return circle_other(&circle, x);
}

double kernel_reciprocal(uint16_t n)
{
    return reciprocal_scale(0x80000000U, n) / 2147483648.0;
}

static sense_state_t sense_of(const int32_t offset_q4[3])
{
    sense_state_t state;
    const config_drive_t stored = {
        .offset_a_q4 = offset_q4[0], .offset_b_q4 = offset_q4[1], .offset_c_q4 = offset_q4[2]};
    sense_init(&state, &stored);
    return state;
}

pair_t kernel_sense(const uint16_t codes[3], const int32_t offset_q4[3], const int32_t on_q16[3])
{
    const sense_state_t state = sense_of(offset_q4);
    const ab16_t i = sense_step(&state, codes, on_q16).i;
    const pair_t out = {q_pair_x(i.v), q_pair_y(i.v)};
    return out;
}

static pi_gains_t gains_of(kernel_pi_gains_t gains)
{
    const pi_gains_t out = {.proportional_q10 = gains.proportional_q10,
                            .integral_q15 = gains.integral_q15,
                            .anti_windup_q15 = gains.anti_windup_q15};
    return out;
}

static kernel_pi_gains_t plain_gains(pi_gains_t gains)
{
    const kernel_pi_gains_t out = {gains.proportional_q10, gains.integral_q15,
                                   gains.anti_windup_q15};
    return out;
}

int32_t kernel_pi_largest_proportional_q10(void)
{
    return PI_LARGEST_PROPORTIONAL_Q10;
}

int32_t kernel_pi_largest_integral_q15(void)
{
    return PI_LARGEST_INTEGRAL_Q15;
}

int32_t kernel_pi_largest_anti_windup_q15(void)
{
    return PI_LARGEST_ANTI_WINDUP_Q15;
}

static current_tuning_t tuning_of(const kernel_tuning_t *tuning)
{
    const current_tuning_t out = {
        .d = gains_of(tuning->d),
        .q = gains_of(tuning->q),
        .w_l_d_q10 = tuning->w_l_d_q10,
        .w_l_q_q10 = tuning->w_l_q_q10,
        .forward_d_q25 = tuning->forward_d_q25,
        .forward_q_q25 = tuning->forward_q_q25,
        .advance = angle_of(tuning->advance),
    };
    return out;
}

kernel_tuning_t kernel_tuning(const config_t *config, int32_t modulation_limit_q15, int32_t v_dc_pu,
                              int32_t speed_q32)
{
    const winding_t winding = winding_constants(config);
    const current_tuning_t tuning =
        current_tuning(config, &winding, modulation_limit_q15, v_dc_pu, speed_q32,
                       config->motor.reference_temperature_cC);
    const kernel_tuning_t out = {
        .d = plain_gains(tuning.d),
        .q = plain_gains(tuning.q),
        .w_l_d_q10 = tuning.w_l_d_q10,
        .w_l_q_q10 = tuning.w_l_q_q10,
        .forward_d_q25 = tuning.forward_d_q25,
        .forward_q_q25 = tuning.forward_q_q25,
        .advance = pair_of_angle(tuning.advance),
    };
    return out;
}

static current_controller_t integrators_of(pair_t integrator_q30)
{
    const current_controller_t out = {.d = {.integrator_q30 = integrator_q30.x},
                                      .q = {.integrator_q30 = integrator_q30.y}};
    return out;
}

static kernel_voltage_t voltage_of(voltage_out_t out, const current_controller_t *state)
{
    const kernel_voltage_t voltage = {
        .wanted = pair_of_dq(voltage_unsaturated(&out)),
        .realised = pair_of_dq(dq_of(out.applied)),
        .integrator_q30 = {state->d.integrator_q30, state->q.integrator_q30},
    };
    return voltage;
}

kernel_voltage_t kernel_current_loop(pair_t integrator_q30, const kernel_tuning_t *tuning,
                                     pair_t reference, pair_t i)
{
    current_controller_t state = integrators_of(integrator_q30);
    const current_tuning_t loop_tuning = tuning_of(tuning);
    const dq_t no_target = {.d = 0, .q = 0};
    const current_gains_t gains = current_gains_of(&loop_tuning, 0, no_target);
    voltage_out_t out;
    current_controller_step(&state, &gains, dq16_from(reference), dq16_from(i), &out);
    return voltage_of(out, &state);
}

static modulation_t modulation_from(const kernel_svpwm_t *svpwm)
{
    const modulation_t out = {.centre_q16 = svpwm->centre_q16,
                              .trim_doubled_counts = svpwm->trim_doubled_counts,
                              .alpha_counts = svpwm->alpha_counts,
                              .beta_counts = svpwm->beta_counts,
                              .limit_q15 = svpwm->modulation_limit_q15};
    return out;
}

kernel_svpwm_t kernel_svpwm_init(int32_t period_counts, int32_t min_pulse_counts,
                                 int32_t trim_counts, int32_t limit_q15)
{
    const modulation_t modulation =
        modulation_of(period_counts, min_pulse_counts, trim_counts, limit_q15);
    const kernel_svpwm_t out = {modulation.centre_q16, modulation.trim_doubled_counts,
                                modulation.alpha_counts, modulation.beta_counts,
                                modulation.limit_q15};
    return out;
}

triple_t kernel_svpwm(const kernel_svpwm_t *svpwm, pair_t u, triple_t trim_q15)
{
    const modulation_t state = modulation_from(svpwm);
    const abc_t trim = {.a = trim_q15.a, .b = trim_q15.b, .c = trim_q15.c};
    int32_t on_q16[3];
    modulation_step(&state, ab_of(u), trim, on_q16);
    const triple_t out = {on_q16[0] >> 16, on_q16[1] >> 16, on_q16[2] >> 16};
    return out;
}

int32_t kernel_pwm_period_counts(const config_t *config)
{
    return bases_pwm_period_counts(config, BASES_MODEL_TIMER_Hz);
}

int32_t kernel_min_pulse_counts(const config_t *config)
{
    return bases_min_pulse_counts(config, BASES_MODEL_TIMER_Hz);
}

kernel_dead_time_t kernel_dead_time_init(const config_t *config)
{
    const int32_t middle_mV = (config->battery.min_voltage_mV + config->battery.max_voltage_mV) / 2;
    const dead_time_slope_t slope =
        dead_time_slope_at(config, q_scale(middle_mV, 32768, config->drive.voltage_full_scale_mV));
    const kernel_dead_time_t out = {modulation_dead_time_counts(config, BASES_MODEL_TIMER_Hz),
                                    slope.alpha_q8, slope.beta_q8};
    return out;
}

static dead_time_slope_t slope_of(kernel_dead_time_t dead_time)
{
    const dead_time_slope_t out = {.alpha_q8 = dead_time.slope_alpha_q8,
                                   .beta_q8 = dead_time.slope_beta_q8};
    return out;
}

triple_t kernel_dead_time(kernel_dead_time_t dead_time, pair_t i)
{
    return triple_of(modulation_dead_time(slope_of(dead_time), ab_of(i)));
}

int32_t kernel_field_weakening(int32_t current_q28, pair_t wanted, int32_t gain_q15,
                               int32_t most_q15)
{
    /* The index as generated, 0.9689. */
    field_weakening_t state = {.current_q28 = current_q28, .target_square_q15 = 30760};
    const dq_t unsaturated = {.d = wanted.x, .q = wanted.y};
    const int32_t margin_q15 = field_weakening_margin_q15(&state, unsaturated);
    field_weakening_step(&state, margin_q15, gain_q15, most_q15);
    return state.current_q28;
}

kernel_loop_out_t kernel_loop(kernel_loop_t *loop, const kernel_tuning_t *tuning,
                              const uint16_t codes[3], uint16_t theta_turn, pair_t reference)
{
    const current_tuning_t loop_tuning = tuning_of(tuning);
    const dq_t no_target = {.d = 0, .q = 0};
    foc_state_t foc = {
        .period = {.i_reference_pu = dq16_from(reference), .theta_turn = theta_turn},
    };
    const foc_current_state_t state = {
        .gains = current_gains_of(&loop_tuning, 0, no_target),
        .advance = loop_tuning.advance,
        .sense = sense_of(loop->offset_q4),
        .controller = integrators_of(loop->integrator_q30),
        .modulation = modulation_from(&loop->svpwm),
        .slope = slope_of(loop->dead_time),
        .predictor = {.settled_pu = dq16_from(reference), .predicted_pu = dq16_from(reference)},
        .on_q16 = {loop->on_q16[0], loop->on_q16[1], loop->on_q16[2]},
    };
    foc.current = state;
    /* Any three codes: as if no sum of them were implausible. */
    foc.current.isolation.suspect_pu = 1 << 18;
    foc.current.isolation.suspect_range_pu = 1U << 19;
    foc_current_step(&foc, codes);
    for (int x = 0; x < 3; x++) {
        loop->on_q16[x] = foc.current.on_q16[x];
    }
    const kernel_loop_out_t result = {
        .i_dq = pair_of_dq(dq_of(foc.period.i_pu)),
        .voltage = voltage_of(foc.period.voltage, &foc.current.controller),
    };
    loop->integrator_q30 = result.voltage.integrator_q30;
    return result;
}
