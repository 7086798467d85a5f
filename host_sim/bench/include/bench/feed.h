/* SPDX-License-Identifier: Apache-2.0 */
/*
 * feed.h: between bridge and motor of one wheel: motor voltage of a period, and the inputs of the
 * converters.
 *
 * Currents are sampled at the top of the count or sensors.sampling_delay_s after it. The bridge
 * commands from the top on are known there, so a late sample is calculated in advance on a copy of
 * the motor, with the averaged bridge or with every edge. With sensors.shunt_settling_s the
 * converters sample the amplifiers of the shunts (shunts.h) instead of the phase currents. A wheel
 * with its own coupling uses the bridge commands of the previous period.
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
