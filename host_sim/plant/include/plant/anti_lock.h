/* SPDX-License-Identifier: Apache-2.0 */
/*
 * anti_lock.h: the vehicle's anti-lock system: it sees wheel speeds, works the hydraulic brakes'
 * valves and raises a flag.
 *
 * Reference: how fast the vehicle is, as far as wheels and an accelerometer can tell,
 *
 *     v = max(fastest rim, v + (a - margin) dt)        slip = (v - rim) / v
 *
 * so that four wheels that lock at the same time do not pass for a vehicle that stops. Each wheel
 * for itself: above slip_dump and still getting slower its pressure is let go; above slip_hold, or
 * with a rim that falls faster than any vehicle could, it is kept; else it rises, slowly once the
 * system has been at work. With thresholds on both sides of the slip at which the tyre's force is
 * greatest the wheel goes round about that slip. The flag is up from the first valve that releases
 * until every wheel has reached its command for release_s. Below lowest_speed_m_per_s the system
 * leaves the brakes alone: a wheel may stop there. A wheel whose sensor shows zero for as long as
 * no road explains has lost its sensor: the system switches itself off for good.
 *
 * Source: Robert Bosch GmbH, "Brakes, Brake Control and Driver Assistance Systems", Springer 2014,
 * chapters on ABS (build, hold, reduce; thresholds of slip and rim acceleration; reference speed).
 */
#ifndef PLANT_ANTI_LOCK_H
#define PLANT_ANTI_LOCK_H

#include <stdbool.h>

#include "plant/hydraulic_brake.h"
#include "plant/parameter.h"

/* clang-format off */
#define ANTI_LOCK_PARAMETERS(X) \
    X(active,                     0.0, 1.0,  "", \
      "1: the vehicle has the system, 0: wheels lock where the road allows it") \
    X(slip_hold,                  0.0, 1.0,  "1",     "slip from which pressure is kept") \
    X(slip_dump,                  0.0, 1.0,  "1", \
      "slip from which pressure is let go; at or above slip_hold") \
    X(rim_deceleration_m_per_s2,  0.0, 1e3,  "m/s2", \
      "fall of a rim's speed from which pressure is kept whatever the slip") \
    X(build_rate_nm_per_s,        1.0, 1e6,  "N m/s", \
      "rise of a brake's torque while the system is at work") \
    X(dump_rate_nm_per_s,         1.0, 1e6,  "N m/s", "fall of it while pressure is let go") \
    X(margin_m_per_s2,            0.0, 100.0, "m/s2", \
      "the reference may fall by so much more than the accelerometer says") \
    X(lowest_speed_m_per_s,       0.0, 100.0, "m/s",  "below, the brakes are left alone") \
    X(release_s,                  0.0, 10.0, "s", \
      "the flag stays up so long after the last help")
/* clang-format on */

enum { ANTI_LOCK_WHEELS_MAX = 16 };

typedef struct {
    ANTI_LOCK_PARAMETERS(PLANT_PARAMETER_MEMBER)
} anti_lock_params_t;

typedef struct {
    double rim_m_per_s;  /* of the last step */
    double rim_m_per_s2; /* low-passed */
    double silent_s;     /* with zero measured speed while the vehicle runs */
    hydraulic_valve_t valve;
} anti_lock_wheel_t;

typedef struct {
    anti_lock_wheel_t wheel[ANTI_LOCK_WHEELS_MAX];
    double reference_m_per_s;
    double quiet_s;
    bool at_work; /* the flag */
    bool failed;  /* has switched itself off */
} anti_lock_t;

/* What the system sees. */
typedef struct {
    const double *rim_m_per_s; /* magnitude, of each wheel's sensor */
    const bool *wanting;       /* of each wheel: its brake has not reached its command yet */
    int wheels;
    double acceleration_m_per_s2; /* of the body, in the direction of travel */
    bool brakes;                  /* the driver does */
} anti_lock_sight_t;

/* Why these parameters make no system, in one line; NULL: they do, or it is not active. */
const char *anti_lock_objection(const anti_lock_params_t *params);

/* Once a millisecond or so; valves and flag are in the state. */
void anti_lock_step(const anti_lock_params_t *params, anti_lock_t *state,
                    const anti_lock_sight_t *sight, double step_s);

#endif
