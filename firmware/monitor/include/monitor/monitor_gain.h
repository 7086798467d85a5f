/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_gain.h: a common gain error of all current sensors, by the charge that the battery's own
 * current sensor counts. Slow loop, 1 kHz.
 *
 * Sensors that all show g times the current make a bus current 3/2 u i/v_dc of g times the true
 * one, whatever angle and bus sensor show. Over eight times what delays the message (its filter and
 * its cycle) the two charges must agree, within an eighth of the charge moved, a share for losses
 * and other loads, and what the delay explains. DERIVATIONS.md, Gain of all current sensors.
 */
#ifndef MONITOR_MONITOR_GAIN_H
#define MONITOR_MONITOR_GAIN_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/measured.h"

enum {
    MONITOR_GAIN_MESSAGE_ms = 128, /* more than the message's cycle */
    MONITOR_GAIN_WINDOW = 8,       /* of filter and message */
    MONITOR_GAIN_TOLERANCE = 8,    /* of the charge: sensors of motor and battery */
    /* Shares of rated torque times largest speed: */
    MONITOR_GAIN_LEAST = 16,        /* mean power of a window that is judged */
    MONITOR_GAIN_EXTRA = 64,        /* losses of the bridge, other loads, offset */
    MONITOR_GAIN_MOVES = 8,         /* a power that moves by more shows in a battery's current, */
    MONITOR_GAIN_FOLLOWS = 8,       /* with this share of what it moves */
    MONITOR_GAIN_MOST_mA = 10000000 /* larger currents count as this */
};

/* The lowest ratio of the charges that has consequences, 0.6: most of the current that is missing,
 * Q15. */
enum { MONITOR_GAIN_MOST_MISSING_Q15 = 13107 };

typedef struct {
    int64_t loop_uC, battery_uC; /* of this window, positive out of the battery */
    int64_t moved_uC;            /* integral of the loop's |i| */
    int32_t loop_low_mA, loop_high_mA, battery_low_mA, battery_high_mA;
    int32_t begin_mA; /* of the battery */
    int32_t steps;
    bool follows; /* the battery's current moved when the loop's did */
    bool wrong;
    int32_t missing_q15; /* share of the true current that the sensors do not show, 0 .. 13 107 */
} monitor_gain_state_t;

/* Forgets everything. */
void monitor_gain_restart(monitor_gain_state_t *state);

/* True while the gain is wrong: from the end of a window that contradicts, whatever the delay of
 * the message, to the end of one that agrees, whatever it is. A window between, or one that is too
 * weak, decides nothing. A battery's current that does not move while the loop's does counts as not
 * given, which ends the finding. So do a message without the current, an open contactor and several
 * driven wheels, which forget the window as well. known: the bridge switches, or carries no current
 * to the bus; otherwise the window begins anew. */
bool monitor_gain_step(monitor_gain_state_t *state, const config_t *config, const measured_t *now,
                       bool known);

#endif
