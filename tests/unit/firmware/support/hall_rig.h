/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hall_rig.h: a simulated rotor with three hall sensors, and the hall estimate.
 */
#ifndef HALL_RIG_H
#define HALL_RIG_H

#include <math.h>

#include "core/angle.h"
#include "hall.h"
#include "unity.h"

extern const config_t CONFIG_LU2013;

/* Forward order of the sensor states (bits C B A): sector k lies between edge k and the next. */
static const uint8_t STATE_OF_SECTOR[6] = {5, 1, 3, 2, 6, 4};

static config_t config;
static hall_t hall;
static double theta_turns;   /* true electrical angle */
static double edge_turns[6]; /* where the sensors really switch */

static inline void restart(void)
{
    hall_init(&hall, &config);
    theta_turns = 0.25;
}

static inline int true_sector(void)
{
    const double at = theta_turns - floor(theta_turns);
    int sector = 5; /* before the first edge: the last sector's rest */
    for (int k = 0; k < 6; k++) {
        if (at >= edge_turns[k]) {
            sector = k;
        }
    }
    return sector;
}

/* Error of the estimate, turns, positive ahead of the true angle. */
static inline double angle_error_turns(void)
{
    const double estimate = hall.theta_q32 / 4294967296.0;
    const double error = estimate - theta_turns;
    return error - floor(error + 0.5);
}

static inline double speed_turns(void)
{
    return hall.speed_q32 / 4294967296.0;
}

/* One period, as rotor_step() makes it. */
static inline void period_observed(uint8_t sensors, hall_observed_t observed)
{
    if (!hall_extrapolate(&hall, sensors)) {
        hall_process_event(&hall, &config, sensors, observed);
    }
}

static inline void period(uint8_t sensors)
{
    const hall_observed_t unknown = {.known = false};
    period_observed(sensors, unknown);
}

static inline void turn(double speed_turns_per_period)
{
    theta_turns += speed_turns_per_period;
    period(STATE_OF_SECTOR[true_sector()]);
}

/* The same with an EMF observer that is wrong by a constant angle. */
static inline void turn_observed(double speed_turns_per_period, double observed_error_turns)
{
    theta_turns += speed_turns_per_period;
    const double seen_turns = theta_turns + observed_error_turns;
    const hall_observed_t observed = {
        .theta_turn = (uint16_t)lround((seen_turns - floor(seen_turns)) * 65535.0), .known = true};
    period_observed(STATE_OF_SECTOR[true_sector()], observed);
}

static inline void turn_for(int periods, double speed_turns_per_period)
{
    for (int n = 0; n < periods; n++) {
        turn(speed_turns_per_period);
    }
}

/* The estimate must lie inside the sector that the sensors report; half an LSB for the border
 * itself. */
static inline void assert_inside_sector(void)
{
    const uint16_t estimate = (uint16_t)(hall.theta_q32 >> 16);
    const uint16_t start = (uint16_t)config.rotor.edge_turn[true_sector()];
    const uint16_t width =
        (uint16_t)((uint16_t)config.rotor.edge_turn[(true_sector() + 1) % 6] - start);
    TEST_ASSERT_TRUE((uint16_t)(estimate - start) <= width);
}

/* Electrical speeds of the paper's motor (23 pole pairs) from 60 to 640 r/min at 20 kHz, both ways.
 */
static const double SPEEDS[] = {0.00115,  0.0023,  0.005,  0.00863,  0.01227,
                                -0.00115, -0.0023, -0.005, -0.00863, -0.01227};
enum { SPEED_COUNT = sizeof(SPEEDS) / sizeof(SPEEDS[0]) };

/* Sensors exactly 60 degrees apart, 20 kHz. */
static inline void rig_up(void)
{
    config = CONFIG_LU2013;
    config.drive.pwm_frequency_Hz = 20000;
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    for (int k = 0; k < 6; k++) {
        edge_turns[k] = k / 6.0;
        config.rotor.edge_turn[k] = (int32_t)lround(edge_turns[k] * 65536.0);
    }
    restart();
}

#endif
