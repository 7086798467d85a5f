/*
 * foc.h: the fast reach. Once per PWM period: codes in, compare values out. Per-unit volts, amperes and angles,
 * nothing else; no division, no loop over data, no floating point.
 *
 *     phase currents -> sense -> Clarke, Park -> current loop -> inverse Park -> SVPWM -> compare values
 *     rotor input    -> rotor estimate --'                              '-- dead time, sampling window
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
#include "foc/rotor.h"
#include "foc/sense.h"
#include "foc/svpwm.h"

/* From the slow reach, every millisecond. */
typedef struct {
    dq_t i_reference_pu;          /* Q15 of the current base */
    current_loop_tuning_t tuning; /* for the present bus voltage and speed */
    bool calibrate_offsets;       /* average the current sensors' zero; only with the bridge off */
} foc_command_t;

/* What the port measured in this PWM period. */
typedef struct {
    uint16_t phase_current_code[SENSE_PHASES]; /* right-aligned 12-bit codes, mid-range 2048 = no current, rising with
                                                * current into the motor */
    uint16_t bus_voltage_code; /* right-aligned 12-bit code, 4096 = config.drive.voltage_full_scale_mV */
    uint16_t rotor_angle_turn; /* absolute electrical angle, 65 536 = one turn; read only when rotor.sensor =
                                * CONFIG_ROTOR_ANGLE */
    encoder_input_t encoder;   /* read only when rotor.sensor = CONFIG_ROTOR_ENCODER */
    uint8_t hall_state;     /* bit 0 = hall A, bit 1 = B, bit 2 = C; read only when rotor.sensor = CONFIG_ROTOR_HALL */
    bool power_stage_fault; /* gate driver or timer break input active; the monitor's, not read in this room */
} foc_input_t;

/* One period of the current loop: what it is given, what it saw and what it did. */
typedef struct {
    dq_t i_reference_pu;        /* given: inside the current circle */
    dq_t i_pu;                  /* Q15 of the current base */
    current_loop_out_t voltage; /* modulation units */
    int32_t current_sum_pu;     /* of the three readings */
    uint16_t theta_turn;        /* given: electrical angle of the rotor at the moment of the sample */
} foc_period_t;

/* Running sums since the start, wrapping. Whoever takes the difference over n periods has their exact mean (summary.h). */
typedef struct {
    uint32_t i_d_pu, i_q_pu; /* Q15 of the current base */
    uint32_t power_pu;       /* u_d i_d + u_q i_q, Q15 */
    uint32_t v_dc_pu;        /* Q15 of the voltage base */
} foc_sums_t;

/* To the slow reach. One structure that lives as long as the controller: it holds the sums, and what seldom changes is only
 * written when it does. */
typedef struct {
    foc_period_t current; /* this period */
    foc_sums_t sums;
    int32_t v_dc_pu;          /* this period */
    int32_t speed_q32;        /* electrical turns per period */
    int32_t i_d_weakening_pu; /* demagnetising current that is added to the reference, Q15, <= 0 */
    int32_t offset_q4[SENSE_PHASES];
    int32_t rotor_age_periods; /* since the last hall edge or encoder count */
    uint16_t rotor_faults;     /* wrapping count of what a healthy rotor sensor does not do */
    bool rotor_valid;
    bool offsets_done;
} foc_report_t;

/* What the current loop proper keeps. */
typedef struct {
    sense_state_t sense;
    current_loop_state_t loop;
    svpwm_t svpwm;
    dead_time_t dead_time;
    int32_t on_q16[SENSE_PHASES]; /* high-side on-times, timer counts with 16 fraction bits; their whole parts are the
                                   * compare values, effective from the next update */
} foc_current_state_t;

typedef struct {
    foc_current_state_t current;
    rotor_state_t rotor;
    circle_t current_circle;
    field_weakening_t weakening;
    bool calibrating;
} foc_state_t;

void foc_init(foc_state_t *state, const config_t *config);

/* A command that regulates nothing, with gains for the highest bus voltage; for use before the slow reach speaks. */
foc_command_t foc_initial_command(const foc_state_t *state, const config_t *config);

/*
 * The current loop proper: from codes, angle and reference (both in `period`) to state->on_q16. Cost: see README.md.
 */
void foc_current_step(foc_current_state_t *restrict state, const current_loop_tuning_t *restrict tuning,
                      const uint16_t *restrict codes, foc_period_t *restrict period);

/* One PWM period. run: regulate and modulate; otherwise the regulators are held reset and the compares centred. The
 * compare values are in state->current.on_q16. report: always the same structure; zero at first. */
void foc_step(foc_state_t *state, const config_t *config, const foc_command_t *command, bool run, const foc_input_t *in,
              foc_report_t *report);

#endif
