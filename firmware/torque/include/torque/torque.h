/* SPDX-License-Identifier: Apache-2.0 */
/*
 * torque.h: the slow loop. 1 kHz, newton-metres and wheel speed, SI milli-units in int32_t.
 * Currents and voltages are means over the PWM period.
 *
 *     demand -> torque limits -> brake blending -> torque command -> current setpoint
 *                                    '-> hill hold -> hydraulic torque command
 */
#ifndef TORQUE_TORQUE_H
#define TORQUE_TORQUE_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/findings.h"
#include "core/last.h"
#include "core/measured.h"
#include "core/monitored.h"
#include "core/torque_enable.h"
#include "motor/current_setpoint.h"
#include "torque/available_ahead.h"
#include "torque/brake_blending.h"
#include "torque/charge_trim.h"
#include "torque/demand.h"
#include "torque/hill_hold.h"
#include "torque/lift_off.h"
#include "torque/road.h"
#include "torque/stop_lamp.h"
#include "torque/torque_command.h"
#include "torque/torque_limits.h"

typedef struct {
    current_setpoint_t current;
    int32_t command_mNm;         /* signed */
    int32_t coasting_mNm;        /* braking torque at zero current, magnitude; 0 where a bridge
                                    without a demand does not open */
    int32_t estimate_mNm;        /* signed, from measured currents, at the shaft */
    int32_t uncertainty_mNm;     /* of it, one standard deviation; INT32_MAX: unknown */
    int32_t hydraulic_mNm;       /* magnitude >= 0 */
    int32_t hydraulic_added_mNm; /* of it, beyond what brake blending commands */
    int32_t hydraulic_apart_mNm; /* of that, none of the braking demand: lift-off, the hold of a
                                    wheel that stands, the brake system's own path */
    int32_t phase_voltage_mV;    /* peak phase: that PWM has or would have, less a reserve */
    int32_t kept_mNm;            /* of a lost demand, by a vehicle without another brake: braking
                                    torque of both brakes, magnitude; else 0 */
    reason_t hydraulic_reason;   /* REASON_HYDRAULIC_LIMIT when the demand cannot be met,
                                    REASON_HILL_HOLD when more than it is commanded */
    bool hydraulic_valid; /* false: the demand is lost and no hold works, the brake system takes
                             its own path */
    limit_t available;    /* present limit of electric braking torque */
    available_t available_now, available_ahead;
    reason_t reason;           /* of the limit of the motor torque in the demanded direction */
    drive_direction_t engaged; /* in which driving torque is made */
    bool stop_lamp;
} torque_output_t;

typedef struct {
    motor_constants_t motor;
    demand_state_t demand;
    charge_trim_state_t trim;
    torque_limits_state_t limits;
    torque_limits_t table;    /* of the last step; output for shell and log, and the currents around
                                 which this step solves */
    motor_current_t setpoint; /* of the last step, with field weakening, i_q along the rotation:
                                 around them this step solves */
    brake_blending_state_t blending;
    road_state_t road;
    hill_hold_state_t hold;
    torque_command_state_t command;
    stop_lamp_state_t lamp;
    int32_t uncertainty_mNm;       /* of the torque estimate, of the last round of `ahead` */
    available_ahead_state_t ahead; /* its results are outputs as well */
} torque_state_t;

/* config: must stay valid as long as the state is used. */
void torque_init(torque_state_t *state, const config_t *config);

/* How the vehicle is held at standstill, to be retained over a restart. */
hill_hold_kept_t torque_hold(const torque_state_t *state);

/* After torque_init(). kept: torque_hold() of before the restart. */
void torque_start_hold(torque_state_t *state, hill_hold_kept_t kept);

/* 1 kHz, after modes_step(); findings that are set here act in the next step.
 *
 * Any measured values, demands and limits. Without any torque enable the command is zero; while
 * braking is demanded, or after the demand is lost, it never acts along the rotation; while the
 * bridge is open it is at most one step of the torque rate. The hydraulic command is at most
 * brake.max_hydraulic_torque. The invariant of the state: torque_state_holds(),
 * tests/proofs/invariants.h. */
torque_output_t torque_step(torque_state_t *state, const config_t *config, const measured_t *now,
                            const last_t *last, const slow_input_t *in, const monitored_t *watch,
                            const torque_enable_t *enable, findings_t *findings);

/* The table of all torque limits of the latest step, for shell, log and report. */
const torque_limits_t *torque_limits_of(const torque_state_t *state);

#endif
