/* SPDX-License-Identifier: Apache-2.0 */
/*
 * foc.h: the fast loop of one wheel. foc_step() runs once per PWM period in the PWM interrupt:
 * converter codes and rotor sensors in, three compare values out.
 *
 *     phase currents --> sense --> Park --> current controller --> inverse Park --> modulation
 *     rotor sensors  --> rotor estimate --'
 *
 * Per-unit volts, amperes and angles only. No division by a run-time value, no loop over data, no
 * floating point. Pure: every result follows from the arguments. Equations: README.md; formats, and
 * why they are so: DERIVATIONS.md.
 *
 * Timing: the converters sample in the middle of the low-side interval; compare values take effect
 * one period later, so that the voltage acts on average 1.5 periods after the sample.
 */
#ifndef FOC_FOC_H
#define FOC_FOC_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/fast_messages.h"
#include "core/fast_view.h"
#include "core/frames.h"
#include "foc/input.h"
#include "foc/state.h"

/* config: accepted by config_validate(). timer_Hz: clock of the timer whose counts the on-times
 * are. Divides. */
void foc_init(foc_state_t *state, const config_t *config, int32_t timer_Hz);

/* Radius of the voltage circle as a share of u_dc/sqrt 3, Q15, 8192 .. 32 767. Divides. */
int32_t foc_modulation_limit_q15(const config_t *config, int32_t timer_Hz);

/* One PWM period with the bridge switching: controls the current and modulates. Returns true if the
 * readings of the current sensors are frozen (README, Frozen readings). */
bool foc_step(foc_state_t *state, const config_t *config, const fast_setpoint_t *setpoint,
              const foc_input_t *in);

/*
 * One PWM period with the bridge off, in active short circuit, or tripped: measures, keeps the
 * controllers reset and the compare values centred.
 */
void foc_idle_step(foc_state_t *state, const config_t *config, const fast_setpoint_t *setpoint,
                   const foc_input_t *in);

/* Fills the report with the state after the latest step, all but `trip` and `bridge`, in two parts.
 * foc_report_copy(): same context as the steps, copies only. foc_report_complete(): any context,
 * the fields that follow from the copied ones; once more changes nothing. */
void foc_report_copy(const foc_state_t *state, fast_report_t *report);
void foc_report_complete(fast_report_t *report);

/* The state after the latest step as tools see it. Same context as the steps; in another one each
 * value is of one period, but not all of the same. */
void foc_view(const foc_state_t *state, fast_view_t *view);

/* The latest period. */
static inline const foc_period_t *foc_latest(const foc_state_t *state)
{
    return &state->period;
}

/* High-side on-times of the three legs as the latest step made them: timer counts with 16 fraction
 * bits. The upper half is the compare value, from the shortest pulse to the period less the
 * shortest pulse. */
static inline const int32_t *foc_on_times_q16(const foc_state_t *state)
{
    return state->current.on_q16;
}

/* The current controller from codes to on-times; a function of its own so that its cost can be
 * counted. Of state->period the rotor and the reference are inputs, the rest is written. */
void foc_current_step(foc_state_t *restrict state, const uint16_t *restrict codes);

#endif
