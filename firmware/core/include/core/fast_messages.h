/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fast_messages.h: the two messages between the slow and the fast loop, one each way. Plain values:
 * the caller of the steps transfers them; no module keeps one as state.
 *
 * Currents are Q15 of the current base, bus voltages Q15 of the voltage base, phase voltages Q15 of
 * the voltage circle (modulation units). The fields `trip`, `bridge`, `safe_bridge`,
 * `clear_trip` and `least_square` belong to the controller, which decides what the bridge does; the
 * current loop uses only `clear_trip`, for the sum of currents.
 */
#ifndef CORE_FAST_MESSAGES_H
#define CORE_FAST_MESSAGES_H

#include <stdbool.h>
#include <stdint.h>

#include "core/angle.h"
#include "core/bridge.h"
#include "core/frames.h"
#include "core/reason.h"

enum { SENSE_PHASES = 3 };

enum {
    PI_LARGEST_PROPORTIONAL_Q10 = 16383,
    PI_LARGEST_INTEGRAL_Q15 = 16383,
    PI_LARGEST_ANTI_WINDUP_Q15 = 4095
};

/* PI controller of one axis (current_controller.h). */
typedef struct {
    int32_t proportional_q10; /* 0 .. PI_LARGEST_PROPORTIONAL_Q10: below 16 */
    int32_t integral_q15;     /* 0 .. PI_LARGEST_INTEGRAL_Q15: a step, below one half */
    int32_t anti_windup_q15;  /* 0 .. PI_LARGEST_ANTI_WINDUP_Q15: k_i/k_p, below one eighth */
} pi_gains_t;

/* Coefficients of the current controller for one bus voltage, speed and winding temperature. Per
 * unit of current to modulation units. */
typedef struct {
    pi_gains_t d, q;
    int32_t w_l_d_q10, w_l_q_q10; /* decoupling: w L I_base, sign of speed, |.| < 16 */
    int32_t forward_d_q25;        /* feed-forward: -w psi_q at zero i_q, without saturation zero */
    int32_t forward_q_q25;        /* feed-forward: back-EMF w psi; both |.| <= 8 */
    rotation_t advance;           /* electrical angle of 1.5 periods */
} current_tuning_t;

/* Slope of the dead-time correction over the current: 1 and sqrt(3)/2 over the zone around zero
 * current, 0 .. 65 000. */
typedef struct {
    int32_t alpha_q8, beta_q8;
} dead_time_slope_t;

/* For the EMF observer. */
typedef struct {
    /* Shares of the flux full scale, Q15, both components the same. */
    q_pair_t volt;             /* flux of one period with the voltage circle's radius, < 1/4 */
    q_pair_t minus_resistance; /* -R T I_base, > -1/4 */
    q_pair_t minus_inductance; /* -L_q I_base, >= -4/5 */
    q_pair_t minus_leak;       /* -lambda T, Q16, >= -1/8 */
    uint16_t lead_turn; /* by which its flux leads the rotor at the present speed, with its sign */
    bool used;          /* the current controller uses the observer's angle */
} observer_tuning_t;

/* Slow to fast, once per slow step. */
typedef struct {
    uint16_t sequence;   /* slow steps since the start, wrapping: a new number is a new setpoint */
    dq_t i_reference_pu; /* sampled current, 16 bits */
    int32_t i_d_sampling_correction_pu; /* mean minus sampled i_d at zero mean current */
    current_tuning_t tuning;            /* for the present bus voltage and speed */
    dead_time_slope_t dead_time_slope;  /* for the present bus voltage */
    observer_tuning_t observer;         /* for the present speed and winding temperature */
    bool calibrate_offsets;    /* average the current sensors' zeros; only with the bridge off */
    bool torque_enabled;       /* any torque is permitted: the bridge switches without a trip */
    bool clear_trip;           /* the fault has been acknowledged */
    bool release_break;        /* for the application: release the hardware's latch, so that the
                                  bridge can be shorted on the side of a stuck switch */
    bridge_mode_t safe_bridge; /* off or a short circuit: without enable, or with a trip */
    uint32_t least_square;     /* of the current vector's length, Q30: current_expectation.h */
} fast_setpoint_t;

/* Running sums since the start, wrapping: a difference over n periods is their exact mean. */
typedef struct {
    uint32_t i_d_pu, i_q_pu;
    uint32_t power_pu; /* u_d i_d + u_q i_q, Q15 */
    uint32_t v_dc_pu;
} foc_sums_t;

/* EMF observer at the latest sample. */
typedef struct {
    int32_t speed_q32;    /* electrical turns per period, forward positive */
    uint16_t theta_turn;  /* of its flux, which leads the rotor by lead_turn */
    dq16_t flux_q14;      /* * its flux along theta_turn and across: remaining angle error */
    uint16_t sensor_turn; /* rotor angle by the sensor at the same time */
    bool acquired;        /* the bridge has switched for 3.3 ms */
} observer_report_t;

/* Of the latest period: what foc_report_complete() computes fields of the report from. */
typedef struct {
    int32_t unsaturated_d_q25, unsaturated_q_q25; /* voltage before the circle */
    ab16_t flux_q14;                              /* of the observer, stator frame */
    uint16_t theta_turn;                          /* electrical angle of i_pu */
} fast_sample_t;

/* Fast to slow: the sums, and the latest period. Fields marked * are complete after
 * foc_report_complete(). */
typedef struct {
    fast_sample_t sample;
    uint16_t sequence; /* PWM periods since the start, wrapping */
    foc_sums_t sums;
    dq16_t i_pu;                     /* sampled current */
    dq16_t u_pu;                     /* applied voltage */
    int32_t voltage_use_q15;         /* * square of the modulation index wanted, 0 .. 65 536 */
    bool voltage_limited;            /* * the voltage circle shortened the voltage */
    bool adc_saturated;              /* * a current converter in use is at an end of its range */
    int32_t current_sum_pu;          /* of the three readings */
    uint8_t wrong_current_sensor;    /* 1 .. 3: sensor of phase a, b, c; 0: none */
    bool current_undetermined;       /* the sum is implausible, no single sensor explains it */
    int32_t i_d_weakening_pu;        /* field-weakening current added to the reference, <= 0 */
    int32_t offset_q4[SENSE_PHASES]; /* zero-current codes * 16 */
    bool offsets_done;
    int32_t speed_q32; /* of the rotor sensor, electrical turns per period, forward positive */
    bool sensor_valid; /* the sensor's angle may be used for torque */
    observer_report_t observer;
    uint16_t rotor_faults; /* wrapping count of readings that a healthy sensor cannot give */
    uint16_t quadrant_transitions; /* of the current vector while not switching, wrapping; forward
                                      counts up */
    uint16_t quadrant_step;        /* `sequence` at the latest of them */
    uint32_t idle_alpha_pu, idle_beta_pu; /* running sums of the current in the stator frame while
                                             not switching, wrapping */
    reason_t trip;        /* of the fast monitor, latched; REASON_NONE when healthy */
    bridge_mode_t bridge; /* what the bridge was commanded to do */
} fast_report_t;

#endif
