/* SPDX-License-Identifier: Apache-2.0 */
/*
 * foc.h: the fast reach. Once per PWM period: codes in, compare values out. Per-unit volts, amperes
 * and angles, nothing else; no division, no loop over data, no floating point.
 *
 *     phase currents -> sense -> Clarke, Park -> current loop -> inverse Park -> SVPWM -> compare
 * values rotor input    -> rotor estimate --'                              '-- dead time, sampling
 * window
 */
#ifndef FOC_FOC_H
#define FOC_FOC_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/circle.h"
#include "core/frames.h"
#include "foc/current_loop.h"
#include "foc/dead_time.h"
#include "foc/field_weakening.h"
#include "foc/response.h"
#include "foc/rotor.h"
#include "foc/sense.h"
#include "foc/svpwm.h"

/* From the slow reach, every millisecond. */
typedef struct {
    uint16_t number; /* another one for another command: the fast reach looks at what follows only
                        when it changes */
    dq_t i_reference_pu;               /* Q15 of the current base, 16 bits */
    int32_t i_d_mean_less_sample_pu;   /* of no mean current: sampled_current.h. Q15, 16 bits; dead
                                          time goes by the mean */
    current_loop_tuning_t tuning;      /* for the present bus voltage and speed */
    dead_time_slope_t dead_time_slope; /* for the present bus voltage */
    bool calibrate_offsets; /* average the current sensors' zero; only with the bridge off */
} foc_command_t;

/* What the port measured in this PWM period. */
typedef struct {
    uint16_t phase_current_code[SENSE_PHASES]; /* right-aligned 12-bit codes, mid-range 2048 = no
                                                * current, rising with current into the motor */
    uint16_t
        bus_voltage_code; /* right-aligned 12-bit code, 4096 = config.drive.voltage_full_scale_mV */
    uint16_t rotor_angle_turn; /* absolute electrical angle, 65 536 = one turn; read only when
                                * rotor.sensor = CONFIG_ROTOR_ANGLE */
    encoder_input_t encoder;   /* read only when rotor.sensor = CONFIG_ROTOR_ENCODER */
    uint8_t hall_state;     /* bit 0 = hall A, bit 1 = B, bit 2 = C; read only when rotor.sensor =
                               CONFIG_ROTOR_HALL */
    bool power_stage_fault; /* gate driver or timer break input active; the monitor's, not read in
                               this room */
} foc_input_t;

/* One period of the current loop: what it is given, what it saw and what it did. */
typedef struct {
    rotor_out_t rotor;          /* given: at the moment of the sample */
    dq_t i_reference_pu;        /* given: inside the current circle */
    dq_t i_pu;                  /* Q15 of the current base */
    current_loop_out_t voltage; /* modulation units */
    int32_t current_sum_pu;     /* of the three readings */
} foc_period_t;

/* Running sums since the start, wrapping. Whoever takes the difference over n periods has their
 * exact mean (summary.h). */
typedef struct {
    uint32_t i_d_pu, i_q_pu; /* Q15 of the current base */
    uint32_t power_pu;       /* u_d i_d + u_q i_q, Q15 */
    uint32_t v_dc_pu;        /* Q15 of the voltage base */
} foc_sums_t;

/* To the slow reach. One structure that lives as long as the controller: it holds the sums, and
 * what seldom changes is only written when it does. */
typedef struct {
    foc_period_t current; /* this period */
    foc_sums_t sums;
    uint32_t step_count;      /* periods since the start, wrapping */
    int32_t v_dc_pu;          /* this period */
    int32_t i_d_weakening_pu; /* demagnetising current that is added to the reference, Q15, <= 0 */
    int32_t offset_q4[SENSE_PHASES];
    uint16_t current_quarters; /* quarter turns of the phase current's vector while the bridge does
                                  not switch, wrapping */
    uint16_t quarter_step;     /* step_count at the latest of them */
    bool offsets_done;
} foc_report_t;

/* What the current loop proper keeps. */
typedef struct {
    current_loop_tuning_t tuning; /* of the command that is followed */
    current_loop_state_t loop;
    svpwm_t svpwm;
    dead_time_t dead_time;
    response_expected_t expected;
    int32_t
        on_q16[SENSE_PHASES]; /* high-side on-times, timer counts with 16 fraction bits; their whole
                               * parts are the compare values, effective from the next update */
    sense_state_t sense;
} foc_current_state_t;

typedef struct {
    rotor_state_t rotor;
    foc_current_state_t current;
    circle_t current_circle;
    response_t response;
    field_weakening_t weakening;
    int32_t followed; /* number of the command, or none */
    uint32_t quarter; /* in which the current vector was last seen at rest, 0 .. 3 */
    bool calibrating;
} foc_state_t;

enum {
    FOC_NOTHING_FOLLOWED = -1, /* no command is that: the next one is followed */
    FOC_MEAN_LESS_SAMPLE_MOST_PU =
        200 /* by which an expected current may leave the circle: dead_time_shares() */
};

void foc_init(foc_state_t *state, const config_t *config);

/* A command that regulates nothing, with gains for the highest bus voltage; for use before the slow
 * reach speaks. */
foc_command_t foc_initial_command(const foc_state_t *state, const config_t *config);

/*
 * The current loop proper: from codes, angle and reference (both in `period`) to state->on_q16.
 * Cost: see README.md.
 */
void foc_current_step(foc_current_state_t *restrict state, const uint16_t *restrict codes,
                      foc_period_t *restrict period);

/* A new command, new field weakening, or a reference that is not given as it is yet.
 * period->i_reference_pu: the commanded current and the demagnetising one, shaped (response.h) and
 * inside the current circle, the d axis first. */
void foc_follow(foc_state_t *state, const foc_command_t *command, foc_period_t *period);

/* The same measurements with the bridge not switching: nothing is regulated, the next start is
 * bump-free. calibrate_offsets: one sample for the zeros of the current sensors. */
void foc_rest(foc_state_t *state, bool calibrate_offsets, const uint16_t codes[SENSE_PHASES],
              foc_report_t *report);

/* The next period's demagnetising current. */
static inline void foc_weaken(foc_state_t *state, const config_t *config, foc_report_t *report)
{
    const current_loop_out_t *voltage = &report->current.voltage;
    const int32_t margin_q15 = field_weakening_margin_q15(voltage->realised.d, voltage->wanted_q);
    if (margin_q15 < 0) {
        current_loop_give_back_d(&state->current.loop, voltage);
    }
    if (margin_q15 < 0 || state->weakening.current_q28 != 0) {
        field_weakening_step(&state->weakening, margin_q15,
                             config->current_loop.field_weakening_gain_pu_q15,
                             config->current_loop.field_weakening_current_pu_q15);
        /* The next period works the reference out anew, also when the current has just come back to
         * nothing. */
        state->followed = FOC_NOTHING_FOLLOWED;
        report->i_d_weakening_pu = field_weakening_current_pu(&state->weakening);
    }
}

static inline void foc_add_up(foc_sums_t *sums, const foc_period_t *period, int32_t v_dc_pu)
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

/*
 * One PWM period; inline, because it has one caller, and the call would cost a tenth of what is
 * around the current loop. permitted and not tripped: regulate and modulate; otherwise the
 * regulators are held reset and the compares centred. The on-times are in state->current.on_q16.
 * report: always the same structure; zero at first.
 *
 * The reference is worked out when a command with another number comes, and in the two periods
 * after it has changed. The voltage margin moves slowly: field weakening looks at it every fourth
 * period, and while it is at work the reference follows in these.
 */
static inline void foc_step(foc_state_t *state, const config_t *config,
                            const foc_command_t *command, bool permitted, bool tripped,
                            const foc_input_t *in, foc_report_t *report)
{
    foc_period_t *period = &report->current;
    rotor_step(&state->rotor, config, in->rotor_angle_turn, in->hall_state, &in->encoder,
               &period->rotor);
    report->v_dc_pu = q_saturate13(in->bus_voltage_code) * 8;
    report->step_count++;
    if (permitted && !tripped) {
        const bool look = report->step_count % 4U == 0U;
        if (state->followed != command->number) {
            foc_follow(state, command, period);
        }
        foc_current_step(&state->current, in->phase_current_code, period);
        if (look) {
            foc_weaken(state, config, report);
        }
    } else {
        foc_rest(state, command->calibrate_offsets, in->phase_current_code, report);
    }
    foc_add_up(&report->sums, period, report->v_dc_pu);
}

#endif
