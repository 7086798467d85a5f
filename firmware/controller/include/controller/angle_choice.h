/* SPDX-License-Identifier: Apache-2.0 */
/*
 * angle_choice.h: which rotor angle may be used for torque: the sensor's, the EMF observer's, or
 * none. Slow loop, 1 kHz.
 *
 * The observer is confirmed while the bridge switches, its flux has half to four times the
 * magnitude that the magnets have at its speed (in a salient machine the current adds to it) and
 * lies within 14 degrees of its angle, the speed is at least rotor.observer_speed, and its
 * direction is that of before or 11 ms old. It then watches the sensor: 60 degrees for 2 ms, or 16
 * degrees for 12 ms, make the sensor wrong, until they have agreed for monitor.rotor_warning_time.
 * From half that speed on 60 degrees for 12 ms do; 30 degrees (halls: 60) for 6 ms of a sensor that
 * turns as fast as the observer; and a salient motor's flux below a third of what its current
 * should make of it, for 5 ms. Below four times that speed a slip needs i_q of one sign, a
 * sixteenth of the current's full scale, for 40 ms; below twice, a sensor that has been below half
 * of it for 50 ms, or a quarter faster than the observer, is wrong after 100 ms. Halls without a
 * speed show their sector: 90 degrees.
 * What L_q may turn the observer by at the present current comes to the angles below 60 degrees
 * (motor/observer_error.h), and is counted in those of 60 where it is large.
 * While the sensor is wrong or invalid the observer's angle is used. Above 15/16 of its speed
 * torque is permitted with it; below, the angle is still there for the torque to ramp out.
 *
 * A sensor that was invalid is used again once it is within 12 degrees, and what L_q makes, of a
 * confirmed observer.
 * Halls or an absolute angle that become invalid while the bridge switches, below the observer's
 * speed and without it confirmed, are wrong once they are valid again; below half of it by sensor
 * and observer at once. Torque ends there and does not return with them.
 *
 * 10 ms after 60 degrees a wrong sensor gets its name, by its speed: frozen below half the
 * observer's, reversed against it, else slipped. At 16 degrees it has slipped at once.
 *
 * Without rotor.observer_takeover the sensor alone decides.
 *
 * A bridge that begins to switch without a sensor uses the observer's angle from the first period
 * on, at zero torque until it is confirmed. README and DERIVATIONS.md, Choice of angle.
 */
#ifndef CONTROLLER_ANGLE_CHOICE_H
#define CONTROLLER_ANGLE_CHOICE_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/frames.h"
#include "core/measured.h"
#include "core/reason.h"

typedef struct {
    int32_t agreed_steps;  /* since the sensor was wrong */
    int32_t last_mrad_s;   /* the observer's speed in the step before */
    uint8_t plausible;     /* consecutive steps, saturating */
    uint8_t implausible;   /* likewise */
    uint8_t against;       /* consecutive steps against the direction */
    int8_t current_steps;  /* with enough of it, by its sign */
    uint8_t rest_steps;    /* with a sensor at rest or faster than the observer, less others */
    int8_t direction;      /* of the observer, +-1; 0 until it has acquired the rotor */
    uint8_t opposed_steps; /* at 60 degrees and more, or without its flux */
    uint8_t slipped;       /* steps apart as above, twice if not confirmed, less steps without */
    uint8_t wrong_steps;   /* until it has its name */
    bool lacks_flux;       /* the observer's is much less than the current should make */
    bool was_valid;        /* the sensor, in the step before */
    bool failed;           /* it became invalid at low speed, while the bridge switched */
    bool confirmed;
    bool sensor_wrong;
    bool observer_used;
    reason_t name; /* REASON_NONE until it is known */
} angle_choice_state_t;

/* Sensor and observer at the same time, in the terms of the slow loop (operating_point.h). */
typedef struct {
    int32_t observer_mrad_s; /* mechanical, signed */
    int32_t sensor_mrad_s;   /* likewise */
    int16_t difference_turn; /* rotor angle of the sensor less that of the observer */
    int32_t flux_q14;        /* of the observer along its angle */
    int32_t across_q14;      /* and across it */
    int32_t expected_q14;    /* of the magnets at its speed */
    dq_t i_pu;               /* latest sample, in the frame of the angle in use */
    bool acquired;           /* the observer's start is over */
    bool sensor_valid;       /* by the sensor's own plausibility */
    bool switching;
} rotor_view_t;

typedef struct {
    bool valid;        /* the angle in use may make torque */
    angle_by_t by;     /* whose it is */
    bool sensor_wrong; /* contradicted by the observer */
    bool observed;     /* the observer is confirmed */
    reason_t name;     /* of a wrong sensor; REASON_NONE until it is known */
} angle_choice_t;

void angle_choice_init(angle_choice_state_t *state);

/* 1 kHz. Any speed, angle and flux; magnitudes of the speed fit 32 bits. cleared: acknowledged at
 * rest; with an open bridge the sensor counts as right again. */
angle_choice_t angle_choice_step(angle_choice_state_t *state, const config_t *config,
                                 const rotor_view_t *in, bool cleared);

#endif
