/* SPDX-License-Identifier: Apache-2.0 */
/*
 * angle_choice_rig.h: the choice of the rotor angle and what it sees, `at`, which a test changes
 * between steps. Included once in a program.
 */
#ifndef ANGLE_CHOICE_RIG_H
#define ANGLE_CHOICE_RIG_H

#include <math.h>

#include "controller/angle_choice.h"
#include "paper_vehicle.h"
#include "unity.h"

/* A sensor that agrees with an observer of plausible flux. */
static const rotor_view_t ROLLING = {
    .observer_mrad_s = 20000,
    .sensor_mrad_s = 20000,
    .flux_q14 = 4000,
    .across_q14 = 100,
    .expected_q14 = 4000,
    .i_pu = {.q = 2048},
    .acquired = true,
    .sensor_valid = true,
    .switching = true,
};

static config_t config;
static angle_choice_state_t rotor;
static rotor_view_t at;
static bool cleared;
static angle_choice_t seen;

static inline void rig_up(const rotor_view_t *view)
{
    const angle_choice_t fresh = {.name = REASON_NONE};
    config = paper_vehicle();
    config.rotor.observer_takeover = 1;
    /* L_q may turn the observer by less than a step of angle, but for a salient motor. */
    config.motor.d_inductance_nH = 100;
    config.motor.q_inductance_nH = 100;
    angle_choice_init(&rotor);
    at = *view;
    cleared = false;
    seen = fresh;
}

/* The observer's speed, an angle of 60 degrees, rounded up, and times of the header. */
enum { FROM_mrad_s = 16000, OPPOSED = 10923, SLOW_ms = 12, HEAL_ms = 20 };

static inline void rig_up_to_compare(void)
{
    rig_up(&ROLLING);
    config.rotor.observer_speed_mrad_s = FROM_mrad_s;
    config.monitor.rotor_warning_time_ms = HEAL_ms;
}

static inline void run(int steps)
{
    for (int n = 0; n < steps; n++) {
        seen = angle_choice_step(&rotor, &config, &at, cleared);
        TEST_ASSERT_TRUE(rotor.agreed_steps >= 0 &&
                         rotor.agreed_steps <= config.monitor.rotor_warning_time_ms);
    }
}

static inline void run_at(int steps, int16_t difference_turn)
{
    at.difference_turn = difference_turn;
    run(steps);
}

static inline bool observed(void)
{
    return seen.by == ANGLE_BY_OBSERVER;
}

/* ---- the salient motor of 400 V ---- */

static const double FLUX_WB = 0.066, D_H = 0.37e-3, Q_H = 1.2e-3, FULL_SCALE_A = 280.0;

enum { EXPECTED_Q14 = 1746 };

static inline void rig_up_salient(int32_t speed_mrad_s)
{
    rig_up(&ROLLING);
    at.observer_mrad_s = speed_mrad_s;
    at.sensor_mrad_s = speed_mrad_s;
    at.flux_q14 = EXPECTED_Q14;
    at.across_q14 = 0;
    at.expected_q14 = EXPECTED_Q14;
    config.motor.flux_linkage_nWb = (int32_t)(FLUX_WB * 1e9);
    config.motor.d_inductance_nH = (int32_t)(D_H * 1e9);
    config.motor.q_inductance_nH = (int32_t)(Q_H * 1e9);
    config.drive.current_full_scale_mA = (int32_t)(FULL_SCALE_A * 1e3);
}

static inline int32_t per_unit(double current_a)
{
    return (int32_t)lround(current_a / FULL_SCALE_A * 32768.0);
}

#endif
