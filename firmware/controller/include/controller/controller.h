/* SPDX-License-Identifier: Apache-2.0 */
/*
 * controller.h: one wheel's whole controller as one value and two steps.
 *
 * The application on the microcontroller, the bench, the FMU and the Python API all use this
 * interface:
 *
 *     controller_init()          once, with a configuration that config_validate() accepted
 *
 *     controller_fast_step()     once per PWM period, from the ADC interrupt
 *
 *     controller_fast_report()   there too, in the last period before a slow step
 *
 *     controller_slow_step()     once per millisecond, from a lower-priority context
 *
 * Between the two loops lies exactly one message each way (core/fast_messages.h): fast_setpoint_t
 * and fast_report_t. The caller of the steps transfers them. No function here reads a clock,
 * accesses hardware or allocates memory; equal inputs give bit-identical outputs on every machine.
 *
 * Timing the caller must provide: the ADC samples in the middle of the low-side interval (top of
 * the centre-aligned count); compare values returned by a step become effective at the next update,
 * that is one period later, so the voltage acts on average 1.5 periods after the sample. The step
 * compensates this delay.
 *
 * Signs: motor torque, current and speed are positive when they drive forward; braking torque
 * demands and the hydraulic command are magnitudes >= 0. Phase current is positive into the motor.
 */
#ifndef CONTROLLER_CONTROLLER_H
#define CONTROLLER_CONTROLLER_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "controller/bridge_choice.h"
#include "controller/current_expectation.h"
#include "controller/measure.h"
#include "core/fast_messages.h"
#include "core/fast_view.h"
#include "core/findings.h"
#include "core/last.h"
#include "core/measured.h"
#include "core/shown_reason.h"
#include "core/slow_messages.h"
#include "core/torque_enable.h"
#include "foc/foc.h"
#include "modes/modes.h"
#include "monitor/monitor.h"
#include "torque/torque.h"

enum { CONTROLLER_SLOW_RATE_HZ = 1000 };

/* What the port measured in this PWM period. */
typedef foc_input_t fast_input_t;

/* What the port must do with the bridge from the next update on. */
typedef struct {
    uint16_t compare_counts[3]; /* high-side on-time of each leg, 0 ..
                                   bases_pwm_period_counts() (= always on) */
    bridge_mode_t bridge;
} fast_output_t;

typedef struct {
    foc_state_t foc;
    monitor_fast_state_t monitor;
    fast_output_t output; /* of the latest period */
} controller_fast_t;

typedef struct {
    measure_t measure;
    monitor_state_t monitor;
    modes_state_t modes;
    torque_state_t torque;
    bridge_choice_state_t bridge;
    last_t last;
    findings_t findings;
    shown_reason_t torque_reason;
    uint16_t step_count;
} controller_slow_t;

typedef struct {
    controller_fast_t fast;
    controller_slow_t slow;
} controller_t;

/* timer_Hz: clock of the timer whose counts the compare values are (config/bases.h). The invariant
 * controller_slow_holds() is in tests/proofs/invariants.h. */
void controller_init(controller_t *controller, const config_t *config, int32_t timer_Hz);

/* For use before the first slow step: no torque, bridge off. */
fast_setpoint_t controller_initial_setpoint(const config_t *config, int32_t timer_Hz);

/* Once per PWM period; any samples. Returns the output; the next step overwrites it. The bridge is
 * PWM only where the setpoint enables torque and no trip is latched. */
const fast_output_t *controller_fast_step(controller_fast_t *fast, const config_t *config,
                                          const fast_setpoint_t *setpoint, const fast_input_t *in);

/* Fills the report with the state after the latest fast step. In the context of
 * controller_fast_step(), in the last period before each slow step. */
void controller_fast_report(const controller_fast_t *fast, fast_report_t *report);

/* The same in two parts, for a caller whose PWM interrupt is to be short. In the context of
 * controller_fast_step(): copies. */
void controller_fast_report_copy(const controller_fast_t *fast, fast_report_t *report);
/* In the context of controller_slow_step(): computes the remaining fields. */
void controller_fast_report_complete(fast_report_t *report);

/* The current loop for tools that measure (foc_view()). */
void controller_fast_view(const controller_fast_t *fast, fast_view_t *view);

/* The table of all torque limits of the latest slow step, for shell, log and report. In the context
 * of controller_slow_step(). */
const torque_limits_t *controller_limits(const controller_slow_t *slow);

/* Between controller_init() and the first slow step: the thermal model starts at warmest_cC or
 * more. TEMPERATURE_NONE_cC: nothing is known from before. */
void controller_start_warm(controller_slow_t *slow, int32_t warmest_cC);

/* The warmest of what the thermal model holds, to be given to controller_start_warm() after a
 * reset. */
int32_t controller_warmest_cC(const controller_slow_t *slow);

/* Between controller_init() and the first slow step: how the vehicle was held before. */
void controller_start_hold(controller_slow_t *slow, hill_hold_kept_t kept);

/* How the vehicle is held at standstill, to be given to controller_start_hold() after a reset. */
hill_hold_kept_t controller_hold(const controller_slow_t *slow);

/* The temperatures in use in the latest slow step; before the first the reference temperature. */
wheel_temperatures_t controller_temperatures(const controller_slow_t *slow);

/* Once per millisecond. report: of controller_fast_report(), at most 40 000 periods after the one
 * before. in: temperatures -1000 .. 1000 degC, all else of any value. Writes the setpoint that the
 * fast loop uses from its next period on. */
slow_output_t controller_slow_step(controller_slow_t *slow, const config_t *config,
                                   const fast_report_t *report, const slow_input_t *in,
                                   fast_setpoint_t *setpoint);

#endif
