/*
 * rotor_sensor.h: where the rotor is. One of two sensors, chosen at start-up.
 */
#ifndef HAL_ROTOR_SENSOR_H
#define HAL_ROTOR_SENSOR_H

#include <stdbool.h>
#include <stdint.h>

typedef enum {
    ROTOR_SENSOR_ANGLE = 0, /* an absolute electrical angle: on boards an incremental encoder with index */
    ROTOR_SENSOR_HALL = 1   /* three hall sensors */
} rotor_sensor_kind_t;

/* Background context, once, before inverter_start(). pole_pairs turns a mechanical angle into an electrical one. */
void rotor_sensor_init(rotor_sensor_kind_t kind, int32_t pole_pairs);

/* False while the angle is not known yet (encoder index not seen); halls are ready at once. Any context. */
bool rotor_sensor_ready(void);

/* Electrical angle now, 65 536 = one turn, 0 = magnet flux along phase a, rising when driving forward; 0 with halls.
 * Only from app_pwm_period_isr(). */
uint16_t rotor_sensor_angle_turn(void);

/* Levels now: bit 0 = hall A, bit 1 = hall B, bit 2 = hall C; 0 with an encoder. Only from app_pwm_period_isr(). */
uint8_t rotor_sensor_hall_state(void);

#endif
