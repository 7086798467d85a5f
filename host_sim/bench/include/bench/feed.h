/* SPDX-License-Identifier: Apache-2.0 */
/*
 * feed.h: between bridge and motor of one wheel: what a period does to the motor, and what the
 * converters see of it.
 *
 * Currents are sampled at the top of the count or sensors.sampling_delay_s after it. What the
 * bridge does from the top on is known there, so a late sample is calculated ahead on a copy of the
 * motor, with the averaged bridge or with every edge. With sensors.shunt_settling_s the converters
 * see the shunts' amplifiers (shunts.h) and not the wires. A wheel with a coupling of its own looks
 * ahead with what its bridge did in the period before.
 */
#ifndef BENCH_FEED_H
#define BENCH_FEED_H

#include "bench/wheel.h"

/* What flowed in a step. */
typedef struct {
    pmsm_flow_t motor;
    inverter_flow_t bridge;
} feed_flow_t;

/* The bridge feeds the motor for world->step_s; speed_rad_s mechanical. */
void feed_motor(wheel_t *wheel, const wheel_world_t *world, double speed_rad_s,
                double bus_voltage_v, feed_flow_t *out);

/* A PWM period is over: before the command of the next one. */
void feed_end_period(wheel_t *wheel, const wheel_world_t *world);

/* Currents at the inputs of the converters when they sample in the period that begins, A. */
plant_abc_t feed_sampled(const wheel_t *wheel, const wheel_world_t *world, double bus_voltage_v);

#endif
