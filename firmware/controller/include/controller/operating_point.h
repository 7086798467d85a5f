/* SPDX-License-Identifier: Apache-2.0 */
/*
 * operating_point.h: the translation between the two loops, 1 kHz. The slow loop computes with
 * means in SI units, the fast loop with samples per unit; only this module knows both. Each
 * quantity crosses once each way:
 *
 *     fast_report_t  --> operating_point_of()        --> measured_t: speed, currents, voltages
 *
 *     fast_setpoint_t <-- operating_point_setpoint() <-- mean currents to control
 *
 * DERIVATIONS.md, Sampling correction and Tuning.
 */
#ifndef CONTROLLER_OPERATING_POINT_H
#define CONTROLLER_OPERATING_POINT_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "controller/angle_choice.h"
#include "core/fast_messages.h"
#include "core/frames.h"
#include "core/measured.h"

/* sampling_correction.h: at one speed and winding temperature */
typedef struct {
    int32_t gain_q24;    /* g, 0 .. 2^20 (1/16: 7 periods per electrical turn) */
    int32_t inverse_q24; /* g/(1 + g): from sampled to mean */
    int32_t magnets_pu;  /* psi/L_d, Q15 of the current base, at most 16 */
} sampling_correction_t;

/* winding.h: one axis around a pair of currents: psi = L i + flux. Units of config.current_loop. */
typedef struct {
    int32_t proportional_pu_q16, integral_pu_q24; /* at the reference temperature */
    int32_t inductance_pu_q16;                    /* L */
    int32_t flux_pu_q16;                          /* without saturation: the magnets', zero in q */
    int32_t anti_windup_q28;                      /* k_i/k_p at the reference temperature */
} winding_axis_t;

typedef struct {
    winding_axis_t d, q;
    int32_t chord_q_q15; /* psi_q/i_q times the current base, share of the observer's full scale */
} winding_t;

/* observer_tuning.h: lambda of the EMF observer */
typedef struct {
    int32_t leak_q24;      /* lambda T */
    int32_t cotangent_q24; /* (lambda T/2)/(1 - lambda T/2) */
} observer_leak_t;

/* observer_tuning.h: constants of the configuration, as shares of the EMF observer's full scale */
typedef struct {
    int32_t resistance_q15; /* R I_base T at the reference temperature */
    int32_t volt_q15;       /* flux of one period at the bus voltage base */
    int32_t flux_q14;       /* the magnets' */
    observer_leak_t start;  /* lambda at a start; of a motor without saliency at all times */
    bool follows_speed;     /* salient: lambda is lower at low speed */
} observer_constants_t;

/* Complete only so that a caller can own one; no other module reads a member. */
typedef struct {
    /* Since the start. */
    int32_t modulation_limit_q15; /* foc_modulation_limit_q15() */
    int32_t magnets_pu;           /* psi/L_d at the reference temperature, Q15 */
    observer_constants_t observer;
    winding_t winding; /* winding_constants() */
    /* At the previous report. */
    foc_sums_t sums;
    uint16_t sequence;
    /* At this one. */
    dq_t i_pu; /* means of the averaging window, sampled currents */
    int32_t i_d_weakening_pu;
    int32_t power_pu; /* of u_d i_d + u_q i_q */
    int32_t v_dc_pu;
    int32_t speed_q32;
    int32_t observer_speed_q32; /* filtered: of its lead */
    observer_leak_t observer_leak;
    uint16_t observer_lead_turn;
    int32_t winding_temperature_cC;
    sampling_correction_t sampling;
} operating_point_state_t;

/* Until the first report the bus voltage is the middle of the battery's range, the currents are
 * zero. timer_Hz: as for foc_init(). Divides. */
void operating_point_init(operating_point_state_t *state, const config_t *config, int32_t timer_Hz);

/* Rotor sensor and EMF observer, in the terms of the slow loop; the observer's lead at its present
 * speed is kept for the next setpoint. Before operating_point_of(). Divides. */
rotor_view_t operating_point_rotor(operating_point_state_t *state, const config_t *config,
                                   const fast_report_t *report);

/* Speed of the rotor angle in use, in the terms of both loops. */
typedef struct {
    int32_t turn_q32;     /* electrical turns per period */
    int32_t wheel_mrad_s; /* mechanical */
} rotor_speed_t;

/* Writes speed, mean and latest values of out, which has its report: at most 40 000 periods after
 * the previous one; the same one again leaves the means unchanged. winding_temperature_cC: any.
 * Divides. */
void operating_point_of(operating_point_state_t *state, const config_t *config, rotor_speed_t speed,
                        int32_t winding_temperature_cC, measured_t *out);

/* Writes reference, sampling correction, tuning and dead-time slope for the operating point of the
 * latest operating_point_of(). i_d_mA, i_q_mA: mean currents without the field-weakening current,
 * saturated at the current base. Divides. */
void operating_point_setpoint(const operating_point_state_t *state, const config_t *config,
                              int32_t i_d_mA, int32_t i_q_mA, fast_setpoint_t *setpoint);

/* The same for zero current and speed at the highest bus voltage, where the gains are smallest:
 * before the first report. */
void operating_point_initial_setpoint(const config_t *config, int32_t timer_Hz,
                                      fast_setpoint_t *setpoint);

#endif
