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
#include "core/torque_enable.h"
#include "torque/available_ahead.h"
#include "torque/brake_blending.h"
#include "motor/current_setpoint.h"
#include "torque/demand.h"
#include "torque/hill_hold.h"
#include "torque/lift_off.h"
#include "torque/stop_lamp.h"
#include "torque/torque_command.h"
#include "torque/torque_limits.h"

typedef struct {
    /* Demand */
    int32_t drive_torque_mNm; /* signed, positive forward */
    int32_t brake_torque_mNm; /* magnitude >= 0 */
    uint32_t demand_age_ms;
    reason_t demand_reason; /* why a demand is not what the pedal says; REASON_NONE: it is */
    drive_direction_t direction;
    bool abs_active;
    uint8_t abs_share_percent; /* of the demand, for the motor meanwhile */
    bool acknowledged;         /* warnings are, at rest and without a demand */
    bool standstill;           /* by the monitor's speed upper bound */
    /* Measured by the fast loop */
    int32_t speed_mrad_s; /* mechanical, signed */
    motor_current_t current;
    int32_t i_d_weakening_mA; /* present field-weakening part of i_d, <= 0 */
    bool voltage_limited;
    int32_t voltage_use_q15; /* square of the modulation index (unsaturated voltage), 0 .. 65 536 */
    bool rotor_valid;
    bool bridge_open;  /* freewheel or active short circuit since the last step */
    int32_t short_mNm; /* braking torque of an active short circuit by its model, magnitude; 0: the
                          bridge is not shorted */
    int32_t flux_missing_q15; /* share of the magnets' flux that is known to be lost, 0 .. 16 384 */
    int32_t bus_voltage_mV;
    int32_t battery_voltage_mV; /* its own, where that contradicts the sensor of the bus: each limit
                                   takes the more dangerous of both; 0: none */
    int32_t
        phase_voltage_mV; /* peak phase: largest voltage that leaves the current loop its reserve,
                             >= 0 */
    /* Limits and temperatures */
    int32_t bms_charge_current_mA;    /* whole pack, magnitude; negative counts as 0 */
    int32_t bms_discharge_current_mA; /* whole pack, magnitude */
    int32_t bms_charge_peak_mA;       /* whole pack, for a short time; 0: not given */
    hydraulic_feedback_t hydraulic;   /* measured torque of the hydraulic brake */
    int32_t winding_temperature_cC;
    int32_t switch_temperature_cC;
    torque_enable_t torque_enable;
} torque_input_t;

typedef struct {
    current_setpoint_t current;
    int32_t command_mNm;       /* signed */
    int32_t estimate_mNm;      /* signed, from measured currents, at the shaft */
    int32_t hydraulic_mNm;     /* magnitude >= 0 */
    reason_t hydraulic_reason; /* REASON_HYDRAULIC_LIMIT when the demand cannot be met,
                                  REASON_HILL_HOLD when more than it is commanded */
    bool hydraulic_valid;      /* false: the demand is lost, the brake system takes its own path */
    limit_t available;         /* present limit of electric braking torque */
    reason_t reason;           /* of the limit of the motor torque in the demanded direction */
    drive_direction_t engaged; /* in which driving torque is made */
    bool stop_lamp;
} torque_output_t;

typedef struct {
    motor_constants_t motor;
    demand_state_t demand;
    torque_limits_state_t limits;
    torque_limits_t table; /* of the last step; output for shell and log only */
    brake_blending_state_t blending;
    hill_hold_state_t hold;
    torque_command_state_t command;
    stop_lamp_state_t lamp;
    available_ahead_state_t ahead; /* its results are outputs as well */
} torque_state_t;

/* config: must stay valid as long as the state is used. */
void torque_init(torque_state_t *state, const config_t *config);

/* The invariant torque_state_holds() is in tests/proofs/invariants.h. */
torque_output_t torque_step(torque_state_t *state, const config_t *config,
                            const torque_input_t *in);

/* After torque_step(), with the same input: state->ahead. Apart from it for the sake of the stack.
 */
void torque_look_ahead(torque_state_t *state, const config_t *config, const torque_input_t *in);

#endif
