/* SPDX-License-Identifier: Apache-2.0 */
#include "bench/motion.h"

#include <math.h>
#include <stddef.h>

#include "plant/numbers.h"

motion_world_t motion_world(const bench_params_t *params, double step_s)
{
    motion_world_t out = {
        .vehicle = vehicle_on_road(&params->vehicle, &params->road),
        .wheel_inertia_kg_m2 = params->chassis.wheel_inertia_kg_m2,
        .slips = params->road.friction > 0.0,
    };
    const double radius_m = out.vehicle.wheel_radius_m;
    const double rotating_kg = floor(params->vehicle.driven_wheels) *
                               params->chassis.wheel_inertia_kg_m2 / (radius_m * radius_m);
    out.body = out.vehicle;
    out.body.mass_kg -= rotating_kg;
    out.body.per_mass_1_per_kg = 1.0 / out.body.mass_kg;
    out.chassis = chassis_on_road(&params->chassis, out.vehicle.mass_kg, out.vehicle.weight_n,
                                  out.vehicle.slope_n, step_s);
    return out;
}

const char *motion_objection(const bench_params_t *params)
{
    const chassis_params_t *chassis = &params->chassis;
    const tyre_params_t *tyre = &params->tyre;
    if (params->road.friction <= 0.0) {
        return NULL;
    }
    if (chassis->wheel_inertia_kg_m2 <= 0.0 || chassis->wheels_per_axle < 1.0) {
        return "road.friction: wheels that slip need chassis.wheel_inertia_kg_m2 and "
               "chassis.wheels_per_axle above 0";
    }
    if (tyre->bristle_stiffness_per_m <= 0.0 || tyre->contact_length_m <= 0.0 ||
        tyre->sliding_share <= 0.0 || tyre->stribeck_speed_m_per_s <= 0.0) {
        return "road.friction: wheels that slip need tyre.bristle_stiffness_per_m, "
               "contact_length_m, sliding_share and "
               "stribeck_speed_m_per_s above 0";
    }
    if (floor(params->vehicle.driven_wheels) > 2.0 * floor(chassis->wheels_per_axle)) {
        return "chassis.wheels_per_axle: two axles have fewer wheels than are driven";
    }
    if (motion_world(params, 1.0).body.mass_kg <= 0.0) {
        return "chassis.wheel_inertia_kg_m2: the wheels are heavier than the vehicle";
    }
    return NULL;
}

void motion_roll(const motion_world_t *world, const motion_t *motion)
{
    for (int k = 0; k < motion->count; k++) {
        const wheel_motion_t rolling = {
            .speed_rad_s = motion->vehicle->speed_m_per_s / world->vehicle.wheel_radius_m,
            .load_n = chassis_load_n(&world->chassis, motion->chassis, k),
        };
        motion->wheels[k].motion = rolling;
    }
}

double motion_expected_rad_s(const motion_world_t *world, const motion_t *motion, int wheel,
                             double step_s)
{
    if (world->slips) {
        const wheel_motion_t *rim = &motion->wheels[wheel].motion;
        return rim->speed_rad_s + 0.5 * step_s * rim->acceleration_rad_s2;
    }
    return vehicle_expected_speed_m_per_s(motion->vehicle, step_s) *
           world->vehicle.per_radius_1_per_m;
}

static motion_flow_t roll(const motion_world_t *world, const motion_t *motion,
                          const wheel_flow_t *flow)
{
    vehicle_load_t load = {.torque_impulse_nms = 0.0, .friction_capacity_nm = 0.0};
    for (int k = 0; k < motion->count; k++) {
        load.torque_impulse_nms += flow[k].airgap_nms - flow[k].viscous_nms;
        load.friction_capacity_nm += flow[k].friction_capacity_nm;
    }
    const motion_flow_t out = {
        .road = vehicle_step(&world->vehicle, motion->vehicle, &load, motion->worlds[0]->step_s),
        .tyre_j = 0.0,
    };
    const double per_radius = world->vehicle.per_radius_1_per_m;
    for (int k = 0; k < motion->count; k++) {
        motion->wheels[k].motion.speed_rad_s = motion->vehicle->speed_m_per_s * per_radius;
        wheel_settle(&motion->wheels[k], motion->worlds[k], &flow[k],
                     out.road.mean_speed_m_per_s * per_radius, out.road.friction_used);
    }
    return out;
}

/* Force of the tyre, and the wheel turned by what is left of its torques. Returns the mean speed of
 * the rim. */
static double turn_wheel(const motion_world_t *world, wheel_t *wheel,
                         const wheel_world_t *wheel_world, const wheel_flow_t *flow,
                         double speed_m_per_s)
{
    const double h = wheel_world->step_s;
    const double radius_m = world->vehicle.wheel_radius_m;
    const double inertia = world->wheel_inertia_kg_m2;
    wheel_motion_t *m = &wheel->motion;
    const double before = m->speed_rad_s;
    const tyre_contact_t contact = {
        .friction = wheel->friction,
        .load_n = m->load_n,
        .slip_m_per_s = before * radius_m - speed_m_per_s,
        .rolling_m_per_s = before * radius_m,
    };
    m->force_n = tyre_step(&wheel_world->params->tyre, &m->tyre, &contact, h);

    const double unhindered =
        before + (flow->airgap_nms - flow->viscous_nms - m->force_n * radius_m * h) / inertia;
    const double most_nms = flow->friction_capacity_nm * h;
    const double friction_nms = plant_clamp(-unhindered * inertia, -most_nms, most_nms);
    m->speed_rad_s = unhindered + friction_nms / inertia;
    m->acceleration_rad_s2 = (m->speed_rad_s - before) / h;
    const double mean = 0.5 * (before + m->speed_rad_s);
    wheel_settle(wheel, wheel_world, flow, mean, most_nms > 0.0 ? -friction_nms / most_nms : 0.0);
    return mean * radius_m;
}

static motion_flow_t slip(const motion_world_t *world, const motion_t *motion,
                          const wheel_flow_t *flow)
{
    const double h = motion->worlds[0]->step_s;
    vehicle_load_t load = {.torque_impulse_nms = 0.0, .friction_capacity_nm = 0.0};
    double at_rims_j = 0.0;
    double force_n = 0.0;
    for (int k = 0; k < motion->count; k++) {
        wheel_t *wheel = &motion->wheels[k];
        wheel->motion.load_n = chassis_load_n(&world->chassis, motion->chassis, k);
        const double rim_m_per_s =
            turn_wheel(world, wheel, motion->worlds[k], &flow[k], motion->vehicle->speed_m_per_s);
        at_rims_j += wheel->motion.force_n * rim_m_per_s * h;
        force_n += wheel->motion.force_n;
    }
    load.torque_impulse_nms = force_n * h * world->body.wheel_radius_m;
    motion_flow_t out = {.road = vehicle_step(&world->body, motion->vehicle, &load, h)};
    out.tyre_j = at_rims_j - force_n * out.road.mean_speed_m_per_s * h;
    chassis_step(&world->chassis, motion->chassis, motion->vehicle->acceleration_m_per_s2);
    return out;
}

motion_flow_t motion_step(const motion_world_t *world, const motion_t *motion,
                          const wheel_flow_t *flow)
{
    return world->slips ? slip(world, motion, flow) : roll(world, motion, flow);
}

double motion_kinetic_energy_j(const motion_world_t *world, const vehicle_state_t *vehicle,
                               const wheel_t *wheels, int count)
{
    if (!world->slips) {
        return vehicle_kinetic_energy_j(&world->vehicle, vehicle);
    }
    double out_j = vehicle_kinetic_energy_j(&world->body, vehicle);
    for (int k = 0; k < count; k++) {
        const double speed_rad_s = wheels[k].motion.speed_rad_s;
        out_j += 0.5 * world->wheel_inertia_kg_m2 * speed_rad_s * speed_rad_s;
    }
    return out_j;
}
