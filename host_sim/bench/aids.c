/* SPDX-License-Identifier: Apache-2.0 */
#include "bench/aids.h"

#include <math.h>

/* A brake this close to its command has reached it. */
static const double ENOUGH_NM = 1.0;

void aids_begin(aids_t *aids, const bench_params_t *params, wheel_t *wheels, int count)
{
    const aids_t empty = {.last_rad_s = {0.0}};
    *aids = empty;
    for (int k = 0; k < count; k++) {
        const double speed_rad_s = wheels[k].motion.speed_rad_s;
        const wheel_speed_t known = {.speed_rad_s = fabs(speed_rad_s)};
        wheels[k].ring = known;
        aids->last_rad_s[k] = speed_rad_s;
        aids->anti_lock.wheel[k].rim_m_per_s = fabs(speed_rad_s) * params->vehicle.wheel_radius_m;
        aids->anti_lock.reference_m_per_s = aids->anti_lock.wheel[k].rim_m_per_s;
    }
}

static void look(aids_t *aids, const wheel_world_t *world, wheel_t *wheels, int count,
                 double time_s, double step_s)
{
    const bench_params_t *params = world->params;
    for (int k = 0; k < count; k++) {
        const double now_rad_s = wheels[k].motion.speed_rad_s;
        const double turned_rad = 0.5 * (aids->last_rad_s[k] + now_rad_s) * step_s;
        aids->last_rad_s[k] = now_rad_s;
        wheel_speed_step(&params->wheel_speed, &wheels[k].ring, turned_rad, now_rad_s, time_s,
                         step_s, params->wheel[k].speed_sensor_dead > 0.5);
    }
}

static void work_valves(aids_t *aids, const wheel_world_t *world, wheel_t *wheels, int count,
                        const anti_lock_sight_t *sight, double step_s)
{
    const anti_lock_params_t *params = &world->params->anti_lock;
    anti_lock_step(params, &aids->anti_lock, sight, step_s);
    for (int k = 0; k < count; k++) {
        hydraulic_brake_valve(&wheels[k].brake, aids->anti_lock.wheel[k].valve,
                              params->build_rate_nm_per_s, params->dump_rate_nm_per_s,
                              world->step_s);
    }
}

void aids_step(aids_t *aids, const wheel_world_t *world, wheel_t *wheels, int count,
               const vehicle_state_t *vehicle, double brake_nm, double time_s, double step_s)
{
    const bench_params_t *params = world->params;
    if (params->anti_lock.active < 0.5 && !aids->busy) {
        look(aids, world, wheels, count, time_s, step_s);
        return;
    }
    aids->busy =
        params->anti_lock.active > 0.5; /* once more after it was switched off: the valves open */
    double rim_m_per_s[ANTI_LOCK_WHEELS_MAX];
    bool wanting[ANTI_LOCK_WHEELS_MAX];
    look(aids, world, wheels, count, time_s, step_s);
    for (int k = 0; k < count; k++) {
        rim_m_per_s[k] = wheels[k].ring.speed_rad_s * params->vehicle.wheel_radius_m;
        wanting[k] = wheels[k].brake.torque_nm < wheels[k].brake.target_nm - ENOUGH_NM;
    }
    const double ahead = vehicle->speed_m_per_s >= 0.0 ? 1.0 : -1.0;
    const anti_lock_sight_t sight = {
        .rim_m_per_s = rim_m_per_s,
        .wanting = wanting,
        .wheels = count,
        .acceleration_m_per_s2 = ahead * vehicle->acceleration_m_per_s2,
        .brakes = brake_nm > 0.0,
    };
    work_valves(aids, world, wheels, count, &sight, step_s);
}
