/* SPDX-License-Identifier: Apache-2.0 */
/*
 * motion.h: from torques to motion: a vehicle whose wheels roll, or one whose wheels can slip.
 *
 * Without a friction coefficient (road.friction = 0) the wheels roll with the road and
 * vehicle_step() moves everything at once. With one, every driven wheel is a flywheel of its own
 * between motor, brake and tyre,
 *
 *     J dw/dt = T - brake - F r          (m - n J / r^2) dv/dt = sum F - road
 *
 * loads from chassis.h, forces from tyre.h; brakes are an implicit impulse on the wheel, so a wheel
 * locks without chatter. Energies use mean speeds of the step, for which kinetic energies change by
 * impulse times way exactly; what wheel and vehicle do not agree about is the tyre's: heat of the
 * slip and the change of its deflection.
 */
#ifndef BENCH_MOTION_H
#define BENCH_MOTION_H

#include "bench/wheel.h"
#include "plant/chassis.h"
#include "plant/tyre.h"
#include "plant/vehicle.h"

/* What all wheels have in common, worked out from the parameters. */
typedef struct {
    vehicle_t vehicle; /* as a whole, wheels included */
    vehicle_t body;    /* without what rotates by itself */
    chassis_t chassis;
    double wheel_inertia_kg_m2;
    bool slips;
} motion_world_t;

/* What moves; not owned. */
typedef struct {
    vehicle_state_t *vehicle;
    chassis_state_t *chassis;
    wheel_t *wheels;
    const wheel_world_t *const *worlds; /* of each wheel */
    int count;
} motion_t;

typedef struct {
    vehicle_flow_t road;
    double tyre_j; /* heat of the slip and energy gained by the tyres' deflection */
} motion_flow_t;

motion_world_t motion_world(const bench_params_t *params, double step_s);

/* Why these parameters cannot carry a slipping wheel, in one line; NULL: they can, or no wheel
 * slips. */
const char *motion_objection(const bench_params_t *params);

/* All wheels roll with the vehicle. */
void motion_roll(const motion_world_t *world, const motion_t *motion);

/* Speed of a wheel expected in the middle of the next step, rad/s. */
double motion_expected_rad_s(const motion_world_t *world, const motion_t *motion, int wheel,
                             double step_s);

/* One step; gives every wheel its result (wheel_settle()). */
motion_flow_t motion_step(const motion_world_t *world, const motion_t *motion,
                          const wheel_flow_t *flow);

double motion_kinetic_energy_j(const motion_world_t *world, const vehicle_state_t *vehicle,
                               const wheel_t *wheels, int count);

#endif
