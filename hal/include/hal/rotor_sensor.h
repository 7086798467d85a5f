/* SPDX-License-Identifier: Apache-2.0 */
/*
 * rotor_sensor.h: the rotor position sensor, one of three kinds, selected at start-up.
 */
#ifndef HAL_ROTOR_SENSOR_H
#define HAL_ROTOR_SENSOR_H

#include <stdbool.h>
#include <stdint.h>

typedef enum {
    ROTOR_SENSOR_ANGLE = 0,  /* an absolute electrical angle: a resolver, or a simulation */
    ROTOR_SENSOR_HALL = 1,   /* three hall sensors */
    ROTOR_SENSOR_ENCODER = 2 /* incremental encoder: A, B and index */
} rotor_sensor_kind_t;

/* Counts of an encoder; their scale and the index' position are the configuration's. */
typedef struct {
    uint16_t count;       /* free running, both edges of both tracks: four to a line */
    uint16_t index_count; /* the count at the latest index pulse, captured by hardware; holds for
                             `index` only */
    bool index;           /* an index pulse since the last read */
} rotor_sensor_encoder_t;

/* Background context, once, before inverter_start(). False: this board has no such sensor. */
bool rotor_sensor_init(rotor_sensor_kind_t kind);

/* Each of the following only with the sensor of its name, from app_pwm_period_isr(). */

/* Electrical angle now, 65 536 = one turn, 0 = magnet flux along phase a, rising when driving
 * forward. */
uint16_t rotor_sensor_angle_turn(void);

/* Levels now: bit 0 = hall A, bit 1 = hall B, bit 2 = hall C. Where they come from pins, two
 * samples of this period agreed on them; else they are the last that did, so that one wrong sample
 * has no effect. */
uint8_t rotor_sensor_hall_state(void);

/* Once a period: reading clears `index`. */
rotor_sensor_encoder_t rotor_sensor_encoder(void);

#endif
