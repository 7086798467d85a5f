/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_speed.h: no wheel turns faster than this, whatever has become of its rotor sensor. 1 kHz.
 *
 * A sensor that starts anew, or dies, shows a speed of nothing within milliseconds. What is known
 * otherwise:
 *
 *   - A vehicle loses no more speed than its tyres hold, TYRE_GRIP (1.2 g), and a wheel that was
 * locked comes back to the vehicle's speed as soon as it is let go. So the speed that is held falls
 * no faster than that towards what a valid sensor says. While the sensor's angle is not valid, it
 * falls as a vehicle that rolls out does, COASTING (0.01 g).
 *   - In the short the currents turn with the magnets, and in the steady state |Z| |i| = w psi. The
 * fast loop counts the quarter turns of the current's vector and says when the latest came. A
 * window ends after 16 of them, which took so many periods, or after 100 ms, in which it may have
 * been one more than was counted. It counts if its current fits its speed, max(R, w L_d) |i| <= 2 w
 * psi: while a decaying direct current is longer than the turning one, or a sensor is dead, the
 * vector does not go round, and there is far too much of it for the speed. Two windows in a row
 * make a speed, and one that is an eighth below the one before must be confirmed by the next: the
 * vector may have begun to go round in the middle of it. No current at all: the wheel stands.
 *   - With the bridge off, a current that goes on flowing flows through the diodes: sqrt(3) psi w
 * has reached the bus. So has it, as far as anybody can tell, when the bus rises beyond the trip
 * voltage. Both are asked only where the sensor is blind: not valid, or below the hand-over speed.
 * A wheel that stands does not mind a short; one that is seen to turn slowly is not shorted because
 * of a broken current sensor, or of another wheel's regeneration.
 */
#ifndef MONITOR_MONITOR_SPEED_H
#define MONITOR_MONITOR_SPEED_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/torque_enable.h"

enum {
    MONITOR_SPEED_WINDOW_QUARTERS = 16,
    MONITOR_SPEED_WINDOW_STEPS = 100,
    MONITOR_SPEED_DIODE_STEPS = 20, /* more looks with a current than without one, bridge off */
    MONITOR_SPEED_STANDSTILL_mrad_s = 300, /* a turn in 20 s */
    MONITOR_SPEED_TYRE_GRIP_mm_s2 = 11768,
    MONITOR_SPEED_COASTING_mm_s2 = 98
};

typedef struct {
    int64_t held_urad_s;
    int32_t window_mrad_s[2]; /* of the latest two in this short; MONITOR_SPEED_UNKNOWN for one that
                                 does not count */
    int64_t peak_square_mA2;  /* of the current in this window */
    int32_t windows;          /* in this short, saturating at 2 */
    int32_t window_steps;
    int32_t diode_steps;
    uint16_t window_quarters,
        window_periods;    /* where the window began: the count, and when it was reached */
    bool overvoltage_seen; /* it has said what it had to say */
} monitor_speed_state_t;

enum { MONITOR_SPEED_UNKNOWN = -1 };

typedef struct {
    int32_t speed_mrad_s; /* the rotor sensor's, mechanical, signed */
    bool rotor_valid;
    bridge_mode_t bridge;      /* what it did since the last step */
    int32_t i_d_mA, i_q_mA;    /* of the latest period, peak phase; in any frame */
    bool offsets_known;        /* of the current sensors */
    uint16_t current_quarters; /* of the current vector, wrapping */
    uint16_t quarter_step;     /* periods at the latest of them, wrapping */
    uint16_t fast_step_count;  /* periods, wrapping */
    int32_t bus_voltage_mV;
} monitor_speed_input_t;

/* Mechanical, magnitude, mrad/s. */
int32_t monitor_speed_step(monitor_speed_state_t *state, const config_t *config,
                           const monitor_speed_input_t *in);

#endif
