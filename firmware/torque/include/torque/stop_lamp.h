/* SPDX-License-Identifier: Apache-2.0 */
/*
 * stop_lamp.h: lights the stop lamp for braking demands and for electric deceleration.
 *
 * Any braking demand lights it. Deceleration without one (drive pedal released) lights it above
 * brake.stop_lamp_on and clears it below brake.stop_lamp_off: 1.3 and 0.7 m/s^2 are the thresholds
 * that UN R13-H sets for passenger cars with lift-off regeneration. Not legal advice. Two
 * low-passes with the time constant brake.stop_lamp_filter suppress the ripple of the wheel speed.
 * The lamp goes out when neither has lit it for eight time constants, 0.5 s by default, so that a
 * noisy pedal at its dead band does not make it flicker.
 */
#ifndef TORQUE_STOP_LAMP_H
#define TORQUE_STOP_LAMP_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/filter.h"

typedef struct {
    int32_t speed_lp_q8_mrad_s; /* low-passed speed, 8 more bits */
    filter_t decel_lp_mm_s2;
    uint16_t quiet_ms; /* since it was last lit by either, saturating at the least time */
    bool lit;
    bool started;
} stop_lamp_state_t;

void stop_lamp_init(stop_lamp_state_t *state);

/* 1 kHz. speed_mrad_s: wheel, signed. Returns whether the lamp must be lit. */
bool stop_lamp_step(stop_lamp_state_t *state, const config_t *config, int32_t speed_mrad_s,
                    int32_t brake_demand_mNm);

#endif
