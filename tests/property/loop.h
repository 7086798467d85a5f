/* SPDX-License-Identifier: Apache-2.0 */
/*
 * loop.h: the fast loop as the property tests see it: plain C types, so that C++ may include it,
 * and one place to change when a header of the firmware does.
 */
#ifndef PROPERTY_LOOP_H
#define PROPERTY_LOOP_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"

#ifdef __cplusplus
extern "C" {
#endif

extern const config_t CONFIG_LU2013;

/* One fast loop with the slow loop's share of the work (tuning for speed and bus voltage every
 * millisecond). */
typedef struct loop_s loop_t;

typedef struct {
    uint16_t phase_code[3];
    uint16_t bus_code;
    uint16_t rotor_angle_turn;
    uint8_t hall_state;
} loop_input_t;

/* Numbers of this period, per unit Q15 unless said otherwise. */
typedef struct {
    uint16_t compare_counts[3]; /* effective from the next period on */
    int32_t i_d_pu, i_q_pu;
    int32_t reference_d_pu, reference_q_pu; /* inside the current circle; only while regulating */
    int32_t u_d_pu, u_q_pu;                 /* realised, 1.0 = modulation_limit * v_dc / sqrt 3 */
    int32_t weakening_pu;
    int32_t power_pu; /* mean of the latest millisecond */
    int32_t modulation_limit_q15;
    int32_t speed_q32;
    uint16_t theta_turn;
    bool limited;
    bool sensor_valid;
} loop_output_t;

loop_t *loop_new(const config_t *config);
void loop_free(loop_t *loop);

/* References in Q15 of the current base. */
void loop_set_reference(loop_t *loop, int32_t i_d_pu, int32_t i_q_pu);

/* What the thermistor says; until then the reference temperature. */
void loop_set_winding_temperature(loop_t *loop, int32_t winding_temperature_cC);

/* Average the current sensors' zero for as long as it is asked for; with the bridge off. */
void loop_calibrate_offsets(loop_t *loop, bool calibrate);

/* run: regulate; otherwise held reset. */
loop_output_t loop_step(loop_t *loop, const loop_input_t *in, bool run);

#ifdef __cplusplus
}
#endif

#endif
