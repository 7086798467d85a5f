/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hydraulic_watch_rig.h: a vehicle on a slope in double precision; its brake makes what it wants of
 * the commands, and hydraulic_watch_step() sees the speed. Included once in a program.
 */
#ifndef HYDRAULIC_WATCH_RIG_H
#define HYDRAULIC_WATCH_RIG_H

#include <math.h>

#include "paper_vehicle.h"
#include "torque/hydraulic_watch.h"
#include "unity.h"

/* 165 kg on a wheel of 0.25 m: 41 N m for 1 m/s^2. */
static const double INERTIA_KG_M2 = 10.3, RADIUS_M = 0.25, PER_MS = 1e-3, G_M_S2 = 9.81;
static const double TORQUE_PER_M_S2 = 10.3 / 0.25;
enum { COAST_ms = 1500, MINUTE_ms = 60000 };

static config_t config;
static hydraulic_watch_t watch;
static hydraulic_watch_input_t in;
static double speed_rad_s, mass_factor, slope, found_after_ms, direction;
static bool used; /* the reports: what they say is what is expected */
static double motor_nm, commanded_nm, made_nm, seen_share, air_nm_s2;

static inline void rig_up(void)
{
    config = paper_vehicle();
    config.brake.blend_out_start_mrad_s = 2600;
    config.brake.blend_out_end_mrad_s = 800;
    config.brake.hydraulic_watch_inertia_g_m2 = 10300;
    config.brake.hydraulic_watch_speed_mrad_s = 480;
    config.brake.hydraulic_watch_floor_mrad_s2 = 400;
    config.brake.hydraulic_watch_share_q15 = 4915;
    config.brake.hydraulic_watch_road_mrad_s2 = 10;
    config.brake.hydraulic_watch_drag_uNm_s2 = 0;
    config.vehicle.wheel_radius_um = 250000;
    config.monitor.tyre_grip_mm_s2 = 11768;
    hydraulic_watch_init(&watch);
    const hydraulic_watch_input_t still = {.trusted = true};
    in = still;
    used = false;
    speed_rad_s = 50.0;
    direction = 1.0;
    seen_share = 1.0;
    mass_factor = 1.0;
    slope = 0.0;
    motor_nm = 0.0;
    commanded_nm = 0.0;
    made_nm = 0.0;
    air_nm_s2 = 0.0;
    found_after_ms = NAN;
}

/* Torques against the motion are positive here but the motor's, which is along it. */
static inline void millisecond(void)
{
    const double against_nm = made_nm + slope * G_M_S2 * TORQUE_PER_M_S2 * mass_factor +
                              air_nm_s2 * speed_rad_s * speed_rad_s;
    speed_rad_s += (motor_nm - against_nm) / (INERTIA_KG_M2 * mass_factor) * PER_MS;
    speed_rad_s = fmax(speed_rad_s, 0.0);
    in.speed_mrad_s = (int32_t)lround(direction * seen_share * speed_rad_s * 1e3);
    in.motor_mNm = (int32_t)lround(direction * motor_nm * 1e3);
    in.commanded_mNm = (int32_t)lround(commanded_nm * 1e3);
    in.modelled_mNm = used ? in.reported_mNm : in.commanded_mNm;
    hydraulic_watch_step(&watch, &config, &in);
}

static inline reason_t run(int duration_ms)
{
    for (int n = 0; n < duration_ms; n++) {
        millisecond();
        if (watch.reason != REASON_NONE && isnan(found_after_ms)) {
            found_after_ms = n + 1;
        }
    }
    return watch.reason;
}

/* A command, of which the brake makes a part. */
static inline reason_t brake(double command_nm, double gain, int duration_ms)
{
    commanded_nm = command_nm;
    made_nm = gain * command_nm;
    return run(duration_ms);
}

#endif
