/* SPDX-License-Identifier: Apache-2.0 */
/*
 * measure.h: what is known of this millisecond: operating point, rotor angle in use, temperatures
 * in use. Slow loop, 1 kHz, before all other parts.
 */
#ifndef CONTROLLER_MEASURE_H
#define CONTROLLER_MEASURE_H

#include "config/config.h"
#include "controller/angle_choice.h"
#include "controller/operating_point.h"
#include "controller/temperatures.h"
#include "core/findings.h"
#include "core/last.h"
#include "core/measured.h"

typedef struct {
    operating_point_state_t operating_point;
    angle_choice_state_t angle;
    temperatures_t temperatures;
} measure_t;

/* timer_Hz: as for foc_init(). Divides. */
void measure_init(measure_t *state, const config_t *config, int32_t timer_Hz);

/* Once per slow step, first. report and in must stay valid as long as the result is used: it points
 * to them. in: temperatures -1000 .. 1000 degC. Sets the findings of rotor and temperature sensors.
 * A trip of the report that the fast monitor cannot have given is REASON_MEMORY. */
measured_t measure_step(measure_t *state, const config_t *config, const fast_report_t *report,
                        const slow_input_t *in, const last_t *last, findings_t *findings);

/* The setpoint's reference for mean currents, and what belongs to the operating point of the latest
 * step: operating_point_setpoint(). */
void measure_setpoint(const measure_t *state, const config_t *config, int32_t i_d_mA,
                      int32_t i_q_mA, fast_setpoint_t *setpoint);

#endif
