/* SPDX-License-Identifier: Apache-2.0 */
#include "bench/abs_unit.h"

#include <math.h>

/* A brake whose torque is lower by more than this is below its command. */
static const double TOLERANCE_NM = 1.0;

void abs_unit_begin(abs_unit_t *abs_unit, const bench_params_t *params, wheel_t *wheels, int count)
{
    const abs_unit_t empty = {.last_rad_s = {0.0}};
    *abs_unit = empty;
    for (int k = 0; k < count; k++) {
        const double speed_rad_s = wheels[k].motion.speed_rad_s;
        const wheel_speed_t known = {.speed_rad_s = fabs(speed_rad_s)};
        wheels[k].ring = known;
        abs_unit->last_rad_s[k] = speed_rad_s;
        abs_unit->anti_lock.wheel[k].rim_m_per_s =
            fabs(speed_rad_s) * params->vehicle.wheel_radius_m;
        abs_unit->anti_lock.reference_m_per_s = abs_unit->anti_lock.wheel[k].rim_m_per_s;
    }
}

static void sample_speeds(abs_unit_t *abs_unit, const wheel_world_t *world, wheel_t *wheels,
                          int count, double time_s, double step_s)
{
    const bench_params_t *params = world->params;
    for (int k = 0; k < count; k++) {
        const double now_rad_s = wheels[k].motion.speed_rad_s;
        const double turned_rad = 0.5 * (abs_unit->last_rad_s[k] + now_rad_s) * step_s;
        abs_unit->last_rad_s[k] = now_rad_s;
        wheel_speed_step(&params->wheel_speed, &wheels[k].ring, turned_rad, now_rad_s, time_s,
                         step_s, params->wheel[k].speed_sensor_dead > 0.5);
    }
}

static void set_valves(abs_unit_t *abs_unit, const wheel_world_t *world, wheel_t *wheels, int count,
                       const anti_lock_input_t *in, double step_s)
{
    const anti_lock_params_t *params = &world->params->anti_lock;
    anti_lock_step(params, &abs_unit->anti_lock, in, step_s);
    for (int k = 0; k < count; k++) {
        hydraulic_brake_valve(&wheels[k].brake, abs_unit->anti_lock.wheel[k].valve,
                              params->build_rate_nm_per_s, params->dump_rate_nm_per_s,
                              world->step_s);
    }
}

void abs_unit_step(abs_unit_t *abs_unit, const wheel_world_t *world, wheel_t *wheels, int count,
                   const vehicle_state_t *vehicle, double brake_nm, double time_s, double step_s)
{
    const bench_params_t *params = world->params;
    if (params->anti_lock.active < 0.5 && !abs_unit->was_active) {
        sample_speeds(abs_unit, world, wheels, count, time_s, step_s);
        return;
    }
    /* One more step after the system is switched off opens the valves. */
    abs_unit->was_active = params->anti_lock.active > 0.5;
    double rim_m_per_s[ANTI_LOCK_WHEELS_MAX];
    bool below_command[ANTI_LOCK_WHEELS_MAX];
    sample_speeds(abs_unit, world, wheels, count, time_s, step_s);
    for (int k = 0; k < count; k++) {
        rim_m_per_s[k] = wheels[k].ring.speed_rad_s * params->vehicle.wheel_radius_m;
        below_command[k] = wheels[k].brake.torque_nm < wheels[k].brake.target_nm - TOLERANCE_NM;
    }
    const double ahead = vehicle->speed_m_per_s >= 0.0 ? 1.0 : -1.0;
    const anti_lock_input_t in = {
        .rim_m_per_s = rim_m_per_s,
        .below_command = below_command,
        .wheels = count,
        .acceleration_m_per_s2 = ahead * vehicle->acceleration_m_per_s2,
        .brakes = brake_nm > 0.0,
    };
    set_valves(abs_unit, world, wheels, count, &in, step_s);
}
