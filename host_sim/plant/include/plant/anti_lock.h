/* SPDX-License-Identifier: Apache-2.0 */
/*
 * anti_lock.h: the vehicle's anti-lock system: from wheel speeds and acceleration to the valves of
 * the hydraulic brakes and the flag "anti-lock active".
 *
 * Reference speed of the vehicle from the wheel speeds and an accelerometer:
 *
 *     v = max(fastest rim, v + (a - margin) dt)        slip = (v - rim) / v
 *
 * The second term keeps it up when all wheels lock at the same time. Each wheel is controlled by
 * itself. Above slip_dump, while the rim decelerates, its pressure is reduced. Above slip_hold, or
 * with a rim deceleration above that of any vehicle, it is held. Otherwise it is built up, at a
 * limited rate while the flag is set. With thresholds on both sides of the slip of largest tyre
 * force the wheel oscillates about that slip. The flag is set from the first reduction until every
 * brake has followed its command for release_s. Below lowest_speed_m_per_s all valves are open: a
 * wheel may stop there. A wheel sensor that shows zero for longer than a locked wheel can has
 * failed: the system switches off for the rest of the run.
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
    X(slip_hold,                  0.0, 1.0,  "1",     "slip from which pressure is held") \
    X(slip_dump,                  0.0, 1.0,  "1", \
      "slip from which pressure is reduced; at or above slip_hold") \
    X(rim_deceleration_m_per_s2,  0.0, 1e3,  "m/s2", \
      "fall of a rim's speed from which pressure is held at any slip") \
    X(build_rate_nm_per_s,        1.0, 1e6,  "N m/s", \
      "rise of a brake's torque while the flag is set") \
    X(dump_rate_nm_per_s,         1.0, 1e6,  "N m/s", "fall of it while pressure is reduced") \
    X(margin_m_per_s2,            0.0, 100.0, "m/s2", \
      "largest fall of the reference above the measured deceleration") \
    X(lowest_speed_m_per_s,       0.0, 100.0, "m/s",  "below, all valves are open") \
    X(release_s,                  0.0, 10.0, "s", \
      "the flag stays set this long after the last intervention")
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

typedef struct {
    const double *rim_m_per_s; /* magnitude, of each wheel's sensor */
    const bool *below_command; /* of each wheel: the brake's torque is below its command */
    int wheels;
    double acceleration_m_per_s2; /* of the body, in the direction of travel */
    bool brakes;                  /* the driver brakes */
} anti_lock_input_t;

/* Why the parameters are refused, in one line; NULL if they are accepted or the system is off. */
const char *anti_lock_objection(const anti_lock_params_t *params);

/* About 1 kHz; valves and flag are in the state. */
void anti_lock_step(const anti_lock_params_t *params, anti_lock_t *state,
                    const anti_lock_input_t *in, double step_s);

#endif
