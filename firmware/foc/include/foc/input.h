/* SPDX-License-Identifier: Apache-2.0 */
/* input.h: what the port measured in one PWM period. */
#ifndef FOC_INPUT_H
#define FOC_INPUT_H

#include <stdbool.h>
#include <stdint.h>

#include "core/fast_messages.h"

/* Incremental encoder. */
typedef struct {
    uint16_t count;       /* free running, four to a line */
    uint16_t index_count; /* count captured at the latest index pulse; read only if index */
    bool index;           /* an index pulse since the last period */
} encoder_input_t;

typedef struct {
    uint16_t phase_current_code[SENSE_PHASES]; /* 12 bit, 2048 = zero, rising into the motor */
    uint16_t bus_voltage_code; /* 12 bit, 4096 = config.drive.voltage_full_scale_mV */
    uint16_t rotor_angle_turn; /* electrical, 65 536 = one turn; with CONFIG_ROTOR_ANGLE */
    encoder_input_t encoder;   /* with CONFIG_ROTOR_ENCODER */
    uint8_t hall_state;        /* bit 0 = A, 1 = B, 2 = C; with CONFIG_ROTOR_HALL */
    bool power_stage_fault;    /* gate driver or timer break input; read by the monitor only */
} foc_input_t;

#endif
