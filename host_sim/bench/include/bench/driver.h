/* SPDX-License-Identifier: Apache-2.0 */
/*
 * driver.h: driver model. One driver for the vehicle; the demand is the mean of all driven wheels,
 * which all get but for front_bias.
 *
 * Following a speed trace, the driver uses a model of the vehicle: feed-forward of inertia (from
 * the trace some time ahead), air drag, rolling resistance and slope, and a PI regulator on the
 * speed error for the rest,
 *
 *     F = m a_ref + F_road(v_ref) + 2 m w_b e + m w_b^2 integral(e),
 *     torque = F r / driven wheels
 *
 * whose integrator is updated with what the pedals' range left of the force. Positive force is the
 * drive pedal, negative the brake pedal. Who comes to rest eases it below the release speed v_r: of
 * the force F_0 beyond the slope's pull with which he came, F_0 v/v_r is left, at least what makes
 * 0.1 m/s^2 together with rolling resistance. That lengthens a stop by less than v_r^2/(2 a). Or
 * the pedals are constant as the scenario puts them, to standstill.
 */
#ifndef BENCH_DRIVER_H
#define BENCH_DRIVER_H

#include <stdbool.h>

#include "plant/parameter.h"
#include "plant/vehicle.h"

/* clang-format off */
#define DRIVER_PARAMETERS(X) \
    X(follow_trace,         0.0,  1.0,   "", \
      "1: follows the speed trace, 0: holds the pedals as below") \
    X(brake_demand_nm,      0.0,  1e5,   "N m", \
      "at each driven wheel, magnitude") \
    X(drive_demand_nm,     -1e5,  1e5,   "N m", \
      "at each driven wheel; the controllers decide what it is worth while braking") \
    X(bandwidth_rad_per_s,  1e-3, 100.0, "rad/s", "w_b of the speed regulator") \
    X(preview_s,            1e-3, 10.0,  "s", \
      "preview time of the driver for the acceleration") \
    X(release_speed_m_per_s, 0.0, 1.0,   "m/s", \
      "below it the brake pedal of who comes to rest is eased; 0: never") \
    X(most_drive_nm,        0.0,  1e5,   "N m",   "end of the drive pedal, at each driven wheel") \
    X(most_brake_nm,        0.0,  1e5,   "N m",   "end of the brake pedal, at each driven wheel") \
    X(demand_age_s,         0.0,  1e6,   "s", \
      "age of the demands when they arrive at the controllers") \
    X(demand_period_s,      0.0,  1.0,   "s",     "of their message; 0: every millisecond") \
    X(demand_jitter_s,      0.0,  1.0,   "s",     "most that a period is longer, at random") \
    X(silent,               0.0,  1.0,   "", \
      "1: no more messages, the controllers see the last demand grow old") \
    X(uses_pedals,          0.0,  1.0,   "", \
      "1: the demands come from pedals wired to a controller, 0: as messages") \
    X(accelerator,          0.0,  1.0,   "1",     "travel of the accelerator") \
    X(brake_pedal,          0.0,  1.0,   "1",     "travel of the brake pedal") \
    X(direction,            0.0,  2.0,   "", \
      "drive direction selected: 0 neutral, 1 forward, 2 reverse") \
    X(own_brake_path,       0.0,  1.0,   "", \
      "1: the brakes follow the brake pedal where the controllers' command is not valid") \
    X(enable,               0.0,  1.0,   "",      "1: the vehicle is switched on") \
    X(fault_reset_every_s,  0.0,  1e3,   "s", \
      "acknowledges faults so often, for half of that time each; 0: never") \
    X(front_bias,          -1.0,  1.0,   "1", \
      "of the torque demanded: a wheel of the front axle gets 1 + this times the mean, one of " \
      "the rear axle 1 - this") \
    X(abs_active,           0.0,  1.0,   "",      "1: anti-lock intervention") \
    X(abs_motor_share,      0.0,  1.0,   "",      "of the braking torque, that it leaves the motor")
/* clang-format on */

typedef struct {
    DRIVER_PARAMETERS(PLANT_PARAMETER_MEMBER)
} driver_params_t;

/* Points of a speed over time, times rising from 0; before and after, the nearest point counts. Not
 * owned. */
typedef struct {
    const double *time_s;
    const double *speed_m_per_s;
    int points; /* 0: no trace, speed 0 */
} driver_trace_t;

typedef struct {
    double integral_m; /* of the speed error */
    double braked_n; /* force beyond the slope's pull when easing the brake began; 0: it has not */
    int cursor;      /* point of the trace before the present time */
} driver_state_t;

typedef struct {
    double drive_nm; /* at each driven wheel, signed */
    double brake_nm; /* at each driven wheel, magnitude */
    double reference_m_per_s;
} driver_demand_t;

driver_state_t driver_init(void);

/* Whether the driver acknowledges faults now. */
bool driver_resets(const driver_params_t *params, double time_s);

/* time_s must not go back. */
double driver_trace_at(const driver_trace_t *trace, int *cursor, double time_s);

/* 1 kHz; step_s is the distance of calls. */
driver_demand_t driver_step(const driver_params_t *params, driver_state_t *state,
                            const driver_trace_t *trace, const vehicle_t *vehicle,
                            int driven_wheels, double speed_m_per_s, double time_s, double step_s);

#endif
