/* SPDX-License-Identifier: Apache-2.0 */
/*
 * controller.h: one wheel's whole controller as one value and two steps.
 *
 * The microcontroller, the bench, the FMU and the Python API all drive this and nothing below it:
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
 * fast_report_t. Whoever calls the steps carries them across. Nothing here reads a clock, touches
 * hardware or allocates; equal inputs give equal outputs, bit for bit, on every machine.
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
#include "core/reason.h"
#include "core/torque_enable.h"
#include "foc/exchange.h"
#include "foc/foc.h"
#include "foc/mean_values.h"
#include "foc/sampling_correction.h"
#include "foc/tuning.h"
#include "modes/modes.h"
#include "monitor/monitor.h"
#include "torque/torque.h"

enum { CONTROLLER_SLOW_RATE_HZ = 1000 };

/* What the port measured in this PWM period. */
typedef foc_input_t fast_input_t;

/* What the port must do with the bridge from the next update on. */
typedef struct {
    uint16_t compare_counts[3]; /* high-side on-time of each leg, 0 ..
                                   config.drive.pwm_period_counts (= always on) */
    bridge_mode_t bridge;
} fast_output_t;

/* Inputs of the slow step. Demands come from CAN or the pedal and are already unpacked; limits come
 * from the BMS. */
typedef struct {
    int32_t drive_torque_mNm; /* signed, positive forward; torque at this wheel */
    int32_t
        brake_torque_mNm;   /* magnitude >= 0, at this wheel: motor and hydraulic brake together */
    uint32_t demand_age_ms; /* since the last valid demand; beyond config.brake.demand_timeout_ms it
                               counts as lost */
    int32_t bms_charge_current_mA;    /* what the pack takes now, whole pack, magnitude >= 0 */
    int32_t bms_discharge_current_mA; /* what the pack gives now, whole pack, magnitude >= 0 */
    int32_t winding_temperature_cC;
    int32_t switch_temperature_cC;
    bool enable;          /* the driver has switched the vehicle on */
    bool abs_active;      /* anti-lock system at work: the motor must get out of the way */
    bool fault_reset;     /* rising edge acknowledges a latched fault; honoured only without torque
                             demand */
    bool selftest_passed; /* the port's own power-up checks; stays true afterwards */
    bool config_accepted; /* config_validate() has accepted it at boot; with a refused configuration
                           * no step may be called at all, this keeps the mode in BOOT when that
                           * comes late */
} slow_input_t;

typedef struct {
    int32_t motor_torque_command_mNm;     /* signed: what the current loop is asked for now */
    int32_t motor_torque_estimate_mNm;    /* signed: from measured currents, at the shaft */
    int32_t hydraulic_torque_mNm;         /* command to the hydraulic brake, magnitude >= 0 */
    int32_t electric_brake_available_mNm; /* what the motor could take over now, magnitude >= 0 */
    int32_t speed_mrad_s;                 /* mechanical, signed */
    int32_t i_d_mA, i_q_mA;               /* measured, peak phase values, low-passed */
    int32_t bus_voltage_mV;
    int32_t bus_current_mA; /* estimate from realised voltage and measured current, positive out of
                               the battery */
    reason_t torque_reason; /* what bounds the motor torque in the demanded direction */
    reason_t available_reason; /* what bounds electric_brake_available_mNm */
    reason_t hydraulic_reason; /* REASON_HYDRAULIC_LIMIT: motor and hydraulic brake together cannot
                                  meet the demand */
    reason_t fault_reason;     /* the latched fault, REASON_NONE when healthy */
    modes_mode_t mode;
    bool stop_lamp;
    bool standstill; /* nothing says that the wheel turns, and no speed that was seen is unaccounted
                      for */
} slow_output_t;

typedef struct {
    foc_state_t foc;
    monitor_fast_state_t monitor;
    bridge_mode_t bridge; /* commanded in the latest period */
} controller_fast_t;

typedef struct {
    mean_values_state_t summary;
    int32_t modulation_limit_q15; /* radius of the voltage circle, share of u_dc/sqrt 3 */
    torque_state_t torque;
    monitor_slow_state_t monitor;
    modes_state_t modes;
    int32_t last_command_mNm;
    int32_t last_estimate_mNm;
    uint16_t step_count;
} controller_slow_t;

typedef struct {
    controller_fast_t fast;
    controller_slow_t slow;
} controller_t;

void controller_init(controller_t *controller, const config_t *config);

/* For use before the first slow step: no torque, bridge off. */
fast_setpoint_t controller_initial_setpoint(const config_t *config);

/* Once per PWM period. */
fast_output_t controller_fast_step(controller_fast_t *fast, const config_t *config,
                                   const fast_setpoint_t *setpoint, const fast_input_t *in);

/* What the fast loop did, after its latest step. In the context of controller_fast_step(), in the
 * last period before each slow step. */
void controller_fast_report(const controller_fast_t *fast, fast_report_t *report);

/* Once per millisecond. */
slow_output_t controller_slow_step(controller_slow_t *slow, const config_t *config,
                                   const fast_report_t *report, const slow_input_t *in,
                                   fast_setpoint_t *setpoint);

#endif
