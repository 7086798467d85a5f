/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hydraulic_watch_states.h: given states of the watch of the hydraulic brake and single steps from
 * them. With an inertia of 1.024 kg m2 a torque is as many millinewton metres as its acceleration
 * is millirads per second squared. Included once in a program.
 */
#ifndef HYDRAULIC_WATCH_STATES_H
#define HYDRAULIC_WATCH_STATES_H

#include "hydraulic_watch_rig.h"

enum {
    FAST_mrad_s = 30000,
    FLOOR_mNm = 400,
    TOLERANCE_mNm = 400,
    TIMEOUT_ms = 50,
    ENOUGH_mNm_ms = 1024 * 480 /* of a sum, to be a finding */
};

/* The rig's 10.3 kg m2. */
static inline void heavy_up(void)
{
    rig_up();
    config.brake.hydraulic_gain_band_q15 = 8192;
    config.brake.hydraulic_tolerance_mNm = TOLERANCE_mNm;
    config.brake.hydraulic_timeout_ms = TIMEOUT_ms;
    config.rotor.sensor = CONFIG_ROTOR_ANGLE;
    in.speed_mrad_s = FAST_mrad_s;
}

static inline void states_up(void)
{
    heavy_up();
    config.brake.hydraulic_watch_inertia_g_m2 = 1024;
    config.brake.hydraulic_watch_share_q15 = 8192;
    config.monitor.tyre_grip_mm_s2 = 1000000;
}

static inline void step(void)
{
    hydraulic_watch_step(&watch, &config, &in);
}

/* At a constant speed, with torques that have lasted: so much is missing, the rest is the road. */
static inline void riding(int32_t motor_mNm, int32_t modelled_mNm, int32_t lacking_mNm)
{
    hydraulic_watch_init(&watch);
    in.motor_mNm = motor_mNm;
    in.modelled_mNm = modelled_mNm;
    in.commanded_mNm = modelled_mNm;
    watch.rolls = true;
    watch.acquired_ms = HYDRAULIC_WATCH_ACQUIRE_ms;
    watch.speed_lp_q8_mrad_s = FAST_mrad_s * 256;
    watch.known_lp_mNm.accumulator = (motor_mNm - modelled_mNm) * 64;
    watch.motor_lp_mNm.accumulator = motor_mNm / 16 * 512;
    watch.road_q8_mNm = (modelled_mNm - motor_mNm - lacking_mNm) * 256;
}

#endif
