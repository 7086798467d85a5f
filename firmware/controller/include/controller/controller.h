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
 * Between the two loops lies exactly one message each way (foc/exchange.h): fast_setpoint_t and
 * fast_report_t. The caller of the steps transfers them. No function here reads a clock, accesses
 * hardware or allocates memory; equal inputs give bit-identical outputs on every machine.
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
#include "controller/operating_point.h"
#include "controller/temperatures.h"
#include "core/slow_messages.h"
#include "core/torque_enable.h"
#include "foc/exchange.h"
#include "foc/foc.h"
#include "modes/modes.h"
#include "monitor/monitor.h"
#include "monitor/monitor_rotor.h"
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
    operating_point_state_t operating_point;
    torque_state_t torque;
    monitor_slow_state_t monitor;
    monitor_rotor_state_t rotor;
    modes_state_t modes;
    bridge_choice_state_t bridge_choice;
    temperatures_t temperatures;
    int32_t last_command_mNm;
    int32_t last_estimate_mNm;
    current_expectation_t expected_current;
    uint16_t step_count;
} controller_slow_t;

typedef struct {
    controller_fast_t fast;
    controller_slow_t slow;
} controller_t;

/* timer_Hz: clock of the timer whose counts the compare values are (config/bases.h). The invariant
 * controller_slow_holds() is in tests/proofs/invariants.h.
 *
 * @post controller_slow_holds(&controller->slow, config)
 *
 * @post controller->fast.output.bridge == BRIDGE_OFF && controller->fast.monitor.trip ==
 * REASON_NONE
 *
 * @post controller->slow.modes.mode == MODE_BOOT && controller->slow.step_count == 0 &&
 * controller->slow.last_command_mNm == 0
 */
void controller_init(controller_t *controller, const config_t *config, int32_t timer_Hz);

/* For use before the first slow step: no torque, bridge off.
 *
 * @post !result.torque_enabled && result.safe_bridge == BRIDGE_OFF && !result.clear_trip &&
 * !result.release_break && !result.calibrate_offsets
 *
 * @post is_within(result.i_reference_pu.d, -32768, 32767) && is_within(result.i_reference_pu.q,
 * -32768, 32767) && result.sequence == 0
 */
fast_setpoint_t controller_initial_setpoint(const config_t *config, int32_t timer_Hz);

/* Once per PWM period. Returns the output; the next step overwrites it.
 *
 * @post result == &fast->output
 *
 * @post result->bridge == (setpoint->torque_enabled && fast->monitor.trip == REASON_NONE ?
 * BRIDGE_PWM : setpoint->safe_bridge)
 *
 * @post !in->power_stage_fault || fast->monitor.trip != REASON_NONE
 *
 * @post old(fast->monitor.trip) == REASON_NONE || setpoint->clear_trip || fast->monitor.trip ==
 * old(fast->monitor.trip)
 */
const fast_output_t *controller_fast_step(controller_fast_t *fast, const config_t *config,
                                          const fast_setpoint_t *setpoint, const fast_input_t *in);

/* Fills the report with the state after the latest fast step. In the context of
 * controller_fast_step(), in the last period before each slow step.
 *
 * @post report->trip == fast->monitor.trip && report->bridge == fast->output.bridge
 */
void controller_fast_report(const controller_fast_t *fast, fast_report_t *report);

/* The same in two parts, for a caller whose PWM interrupt is to be short. In the context of
 * controller_fast_step(): copies.
 *
 * @post report->trip == fast->monitor.trip && report->bridge == fast->output.bridge
 */
void controller_fast_report_copy(const controller_fast_t *fast, fast_report_t *report);
/* In the context of controller_slow_step(): computes the remaining fields.
 *
 * @post report->trip == old(report->trip) && report->bridge == old(report->bridge) &&
 * report->rotor_valid == old(report->rotor_valid) && report->sequence == old(report->sequence)
 */
void controller_fast_report_complete(fast_report_t *report);

/* The table of all torque limits of the latest slow step, for shell, log and report. In the context
 * of controller_slow_step().
 *
 * @post result == &slow->torque.table
 */
const torque_limits_t *controller_limits(const controller_slow_t *slow);

/* Once per millisecond.
 *
 * @pre battery_relations_hold(config) && derating_relations_hold(config)
 *
 * @pre controller_slow_holds(slow, config)
 *
 * @pre is_within(in->temperature.winding_cC, -100000, 100000) &&
 * is_within(in->temperature.switch_cC, -100000, 100000)
 *
 * @pre is_within(report->i_d_weakening_pu, -32768, 0) && is_within(dq_of(report->i_pu).d, -32768,
 * 32767) && is_within(dq_of(report->i_pu).q, -32768, 32767)
 *
 * @post controller_slow_holds(slow, config)
 *
 * @post slow->step_count == (uint16_t)(old(slow->step_count) + 1) && setpoint->sequence ==
 * slow->step_count && result.motor_torque_command_mNm == slow->last_command_mNm
 *
 * @post setpoint->safe_bridge != BRIDGE_PWM && is_within(setpoint->i_reference_pu.d, -32768, 32767)
 * && is_within(setpoint->i_reference_pu.q, -32768, 32767)
 *
 * @post result.mode == MODE_RUN || result.mode == MODE_LIMP || (!setpoint->torque_enabled &&
 * result.motor_torque_command_mNm == 0)
 *
 * @post in->bms.contactor != CONTACTOR_OPEN || (!setpoint->torque_enabled &&
 * result.motor_torque_command_mNm == 0)
 *
 * @post in->demand.brake_torque_mNm <= 0 || result.speed_mrad_s == 0 || (result.speed_mrad_s > 0 ?
 * result.motor_torque_command_mNm <= 0 : result.motor_torque_command_mNm >= 0)
 *
 * @post !demand_is_lost(config, in->demand_age_ms) || result.speed_mrad_s == 0 ||
 * (result.speed_mrad_s > 0 ? result.motor_torque_command_mNm <= 0 : result.motor_torque_command_mNm
 * >= 0)
 *
 * @post report->bridge == BRIDGE_PWM || q_abs(result.motor_torque_command_mNm) <=
 * q_max(config->brake.torque_rate_mNm_s / 1000, 1)
 *
 * @post report->trip != REASON_HARDWARE_BREAK || old(slow->modes.mode) == MODE_BOOT || result.mode
 * == MODE_FAULT
 *
 * @post result.hydraulic_torque_mNm <= config->brake.max_hydraulic_torque_mNm
 *
 * @post result.drive_available_mNm >= 0 && result.drive_ahead_mNm >= 0 &&
 * result.electric_brake_ahead_mNm >= 0
 */
slow_output_t controller_slow_step(controller_slow_t *slow, const config_t *config,
                                   const fast_report_t *report, const slow_input_t *in,
                                   fast_setpoint_t *setpoint);

#endif
