/* SPDX-License-Identifier: Apache-2.0 */
/*
 * motor.h: a motor, its bridge and its sensors, once per PWM period: what a fast step is given.
 *
 * Simplified, not accurate: an averaged bridge, and diodes that conduct fully or not at all. It
 * needs nothing of the firmware but its configuration and its messages; numbers.h says why it
 * computes the same on every machine.
 */
#ifndef ORACLE_MOTOR_H
#define ORACLE_MOTOR_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "controller/controller.h"
#include "random.h"

enum { MOTOR_CODE_MID = 2048, MOTOR_CODE_MOST = 4095 };

typedef struct {
    const config_t *config;
    /* of the configuration, SI */
    double period_s, flux_wb, resistance_ohm, inductance_d_h, inductance_q_h, base_a;
    double top_rad_s;
    int32_t period_counts;
    /* state; speeds are electrical */
    double battery_v;
    double angle_turn, speed_rad_s, acceleration_rad_s2;
    double i_d_a, i_q_a, bus_v;
    int64_t turns; /* whole electrical ones */
} motor_t;

/* At rest, with a battery in the middle of its range. config: stays where it is. */
void motor_init(motor_t *motor, const config_t *config);

/* What the sensors see now, with the noise of two codes. */
fast_input_t motor_sampled(const motor_t *motor, random_t *random);

/* A PWM period with what the bridge does in it. */
void motor_step(motor_t *motor, const fast_output_t *active, bool battery_open);

/* 12 bits. */
uint16_t motor_code(double x);

#endif
