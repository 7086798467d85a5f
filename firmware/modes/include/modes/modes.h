/* SPDX-License-Identifier: Apache-2.0 */
/*
 * modes.h: the state machine of one controller, 1 kHz. Its output is the torque enable; it computes
 * no torque.
 *
 *     BOOT -> SELFTEST -> OFFSET_CAL -> READY <-> RUN <-> LIMP
 *       any of them but BOOT -> FAULT (latched) -> SELFTEST after an acknowledgement
 *
 * BOOT is left only with an accepted configuration, READY only with a known rotor angle, FAULT only
 * on a rising edge of `fault_reset` while no torque is demanded, no fault is present and the
 * monitor knows that the wheel is at rest, and never after a fault that only a restart clears
 * (core/fault.h). A fault never clears itself. Mode and fault have an inverted copy, and a
 * difference is a fault. A self-test or configuration that is withdrawn later is a fault. A demand
 * that was lost while torque was enabled leaves a warning, which the same acknowledgement clears.
 *
 * It sets the rows of the start, of the demand's sender and of its own memory, and then executes
 * the reactions of the table of findings (core/findings.h).
 */
#ifndef MODES_MODES_H
#define MODES_MODES_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/findings.h"
#include "core/last.h"
#include "core/measured.h"
#include "core/monitored.h"
#include "core/operating_mode.h"
#include "core/reason.h"
#include "core/slow_messages.h"
#include "core/slow_rise.h"
#include "core/torque_enable.h"
#include "core/waits_for.h"

enum {
    /* 0.5 s; averaging over 1024 PWM periods takes at most 256 ms. */
    MODES_CALIBRATION_TIMEOUT_STEPS = 500,
    MODES_CALIBRATION_SETTLE_STEPS = 5,
    /* Slow steps within which no fault may be present any more after an acknowledgement. */
    MODES_ACKNOWLEDGE_STEPS = 50
};

typedef struct {
    operating_mode_t mode;
    reason_t fault;       /* latched, the first one */
    reason_t warning;     /* latched, REASON_NONE or why the demand was lost */
    uint16_t steps;       /* in this mode, saturating */
    uint16_t quiet_steps; /* of OFFSET_CAL without a current that the EMF drives */
    bool offsets_stored;  /* the stored offsets are in use: a warning until others are measured */
    uint16_t acknowledge_steps; /* left of a pending acknowledgement */
    bool fault_persists;        /* the last acknowledgement found the fault still there */
    bool reset_before;
    bool released;       /* the drive pedal, since it was switched on */
    slow_rise_t braking; /* share of braking torque, Q15, that a finding has taken away */
    reason_t taken_by;   /* the reason of that finding */
    uint32_t inverted;   /* of mode and fault: a bit that flips between two steps is a fault */
} modes_state_t;

typedef struct {
    operating_mode_t mode;
    reason_t fault;           /* latched, REASON_NONE when healthy */
    reason_t warning;         /* the latched one, else the present one */
    reason_t present_warning; /* of the first warning row that is present */
    torque_enable_t torque_enable;
    waits_for_t waits_for; /* what driving torque waits for */
    bool calibrate_offsets;
    bool clear_trip; /* an acknowledgement is pending: the fast loop clears its latched trip and
                        checks again */
} modes_output_t;

/* Once, before the first step. */
void modes_init(modes_state_t *state);

/* 1 kHz. Any input is permitted. */
modes_output_t modes_step(modes_state_t *state, const config_t *config, const measured_t *now,
                          const monitored_t *watch, const last_t *last, const slow_input_t *in,
                          findings_t *findings);

#endif
