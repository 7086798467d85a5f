/* SPDX-License-Identifier: Apache-2.0 */
/*
 * torque.h: the slow reach. 1 kHz, newton-metres and wheel speed, SI milli-units in int32_t.
 *
 *     demand -> capability (table, limits) -> brake arbiter -> torque limit -> current reference
 *                                               `-> hydraulic torque command
 */
#ifndef TORQUE_TORQUE_H
#define TORQUE_TORQUE_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/torque_enable.h"
#include "torque/brake_blending.h"
#include "torque/current_setpoint.h"
#include "torque/demand.h"
#include "torque/stop_lamp.h"
#include "torque/torque_command.h"
#include "torque/torque_limits.h"

typedef struct {
    /* Demand */
    int32_t drive_torque_mNm; /* signed, positive forward */
    int32_t brake_torque_mNm; /* magnitude >= 0 */
    uint32_t demand_age_ms;
    bool abs_active;
    /* Measured by the fast reach */
    int32_t speed_mrad_s; /* mechanical, signed */
    motor_current_t current;
    bool voltage_limited;
    int32_t voltage_use_q15; /* square of the wanted phase voltage over that of the largest one */
    /* Limits and temperatures */
    torque_limits_input_t capability;
    torque_enable_t torque_enable;
} torque_input_t;

typedef struct {
    current_setpoint_t current;
    int32_t command_mNm;       /* signed */
    int32_t estimate_mNm;      /* signed, from measured currents, at the shaft */
    int32_t hydraulic_mNm;     /* magnitude >= 0 */
    reason_t hydraulic_reason; /* REASON_HYDRAULIC_LIMIT when the demand cannot be met */
    limit_t available;         /* electric braking the motor could take over now */
    reason_t reason;           /* what bounds the motor torque in the demanded direction */
    bool demand_timed_out;
    bool stop_lamp;
} torque_output_t;

typedef struct {
    demand_state_t demand;
    brake_blending_state_t blending;
    torque_command_state_t limit;
    stop_lamp_state_t lamp;
    uint16_t voltage_low_steps,
        voltage_high_steps; /* left of having been near an end of the battery's voltage */
} torque_state_t;

void torque_init(torque_state_t *state);

torque_output_t torque_step(torque_state_t *state, const config_t *config,
                            const torque_input_t *in);

#endif
