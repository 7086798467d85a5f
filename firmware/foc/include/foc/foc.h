/* SPDX-License-Identifier: Apache-2.0 */
/*
 * foc.h: the fast loop of one wheel. foc_step() runs once per PWM period in the PWM interrupt:
 * converter codes and rotor sensors in, three compare values out.
 *
 *     phase currents --> sense --> Park --> current controller --> inverse Park --> modulation
 *     rotor sensors  --> rotor estimate --'
 *
 * Per-unit volts, amperes and angles only. No division by a run-time value, no loop over data, no
 * floating point. Pure: every result follows from the arguments. Formats, equations and the cost
 * in instructions: README.md.
 *
 * Timing: the converters sample in the middle of the low-side interval; compare values take effect
 * one period later, so that the voltage acts on average 1.5 periods after the sample.
 */
#ifndef FOC_FOC_H
#define FOC_FOC_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/frames.h"
#include "foc/state.h"
#include "foc/tuning.h"

enum {
    FOC_NO_SETPOINT = -1,            /* no sequence number: the next setpoint is applied */
    FOC_SAMPLING_CORRECTION_PU = 200 /* largest |i_d_sampling_correction_pu| that is used */
};

/* From the slow loop, every millisecond. */
typedef struct {
    uint16_t sequence;   /* a setpoint is applied when its number differs from the previous one */
    dq_t i_reference_pu; /* sampled current, Q15 of the current base, 16 bits */
    int32_t i_d_sampling_correction_pu; /* mean minus sampled i_d at zero mean current, Q15 */
    current_tuning_t tuning;            /* for the present bus voltage and speed */
    dead_time_slope_t dead_time_slope;  /* for the present bus voltage */
    bool calibrate_offsets; /* average the current sensors' zeros; only with the bridge off */
} foc_setpoint_t;

/* Incremental encoder in this PWM period. */
typedef struct {
    uint16_t count;       /* free running, four to a line */
    uint16_t index_count; /* count captured at the latest index pulse; read only if index */
    bool index;           /* an index pulse since the last period */
} encoder_input_t;

/* What the port measured in this PWM period. */
typedef struct {
    uint16_t phase_current_code[SENSE_PHASES]; /* 12 bit, 2048 = zero, rising into the motor */
    uint16_t bus_voltage_code; /* 12 bit, 4096 = config.drive.voltage_full_scale_mV */
    uint16_t rotor_angle_turn; /* electrical, 65 536 = one turn; with CONFIG_ROTOR_ANGLE */
    encoder_input_t encoder;   /* with CONFIG_ROTOR_ENCODER */
    uint8_t hall_state;        /* bit 0 = A, 1 = B, 2 = C; with CONFIG_ROTOR_HALL */
    bool power_stage_fault;    /* gate driver or timer break input; read by the monitor only */
} foc_input_t;

/* Rotor estimate at the sample. */
typedef struct {
    uint16_t theta_turn; /* electrical, 65 536 = one turn */
    int32_t speed_q32;   /* electrical turns per PWM period, forward positive */
    int32_t age_periods; /* since the last hall edge or count, 0 .. 65 535; 0: absolute angle */
    uint16_t faults;     /* wrapping count of readings that a healthy sensor cannot give */
    bool valid;          /* the angle may be used for torque; the speed is that of the angle */
} rotor_out_t;

/* Voltage of one period in modulation units, Q15. */
typedef struct {
    int32_t unsaturated_d, unsaturated_q; /* before the voltage circle, |.| < 50 */
    dq16_t applied;                       /* inside the unit circle */
} voltage_out_t;

/* One period of the current controller. */
typedef struct {
    rotor_out_t rotor;
    dq_t i_reference_pu; /* prefiltered, inside the current circle */
    dq16_t i_pu;         /* sampled current, Q15 of the current base; components saturate at 1 */
    voltage_out_t voltage;
    int32_t current_sum_pu; /* of the three readings */
} foc_period_t;

/* Running sums since the start, wrapping: a difference over n periods is their exact mean
 * (mean_values.h). */
typedef struct {
    uint32_t i_d_pu, i_q_pu; /* Q15 of the current base */
    uint32_t power_pu;       /* u_d i_d + u_q i_q, Q15 */
    uint32_t v_dc_pu;        /* Q15 of the voltage base */
} foc_sums_t;

/* To the slow loop. One structure for the life of the controller, zero at first: it contains the
 * sums, and rarely changing fields are written only when they change. */
typedef struct {
    foc_period_t current; /* this period */
    foc_sums_t sums;
    uint32_t step_count;             /* periods since the start, wrapping */
    int32_t v_dc_pu;                 /* this period, Q15 of the voltage base */
    int32_t i_d_weakening_pu;        /* field-weakening current added to the reference, Q15, <= 0 */
    int32_t offset_q4[SENSE_PHASES]; /* zero-current codes * 16 */
    uint16_t quadrant_transitions;   /* of the current vector with the bridge off, wrapping;
                                        forward counts up */
    uint16_t quadrant_step;          /* step_count at the latest of them */
    bool offsets_done;
} foc_report_t;

/* config: accepted by config_validate(). Divides. */
void foc_init(foc_state_t *state, const config_t *config);

/* Radius of the voltage circle as a share of u_dc/sqrt 3, Q15, 8192 .. 32 767. Constant. */
int32_t foc_modulation_limit_q15(const foc_state_t *state);

/* Zero current with gains for the highest bus voltage; for use before the first slow step. */
foc_setpoint_t foc_initial_setpoint(const foc_state_t *state, const config_t *config);

/*
 * One PWM period with the bridge switching: controls the current and modulates. report: always the
 * same structure.
 */
void foc_step(foc_state_t *state, const foc_setpoint_t *setpoint, const foc_input_t *in,
              foc_report_t *report, const config_t *config);

/*
 * One PWM period with the bridge off, in active short circuit, or tripped: measures, keeps the
 * controllers reset and the compare values centred.
 */
void foc_idle_step(foc_state_t *state, const foc_setpoint_t *setpoint, const foc_input_t *in,
                   foc_report_t *report, const config_t *config);

/* High-side on-times of the three legs as the latest step made them: timer counts with 16 fraction
 * bits. The upper half is the compare value, from the shortest pulse to the period less the
 * shortest pulse. */
static inline const int32_t *foc_on_times_q16(const foc_state_t *state)
{
    return state->current.on_q16;
}

/* The current controller from codes to on-times; a function of its own so that its cost can be
 * counted. period: rotor and reference are inputs, the rest is written. */
void foc_current_step(foc_current_state_t *restrict state, const uint16_t *restrict codes,
                      foc_period_t *restrict period);

#endif
