/* SPDX-License-Identifier: Apache-2.0 */
/*
 * charge_trim.h: what a motor returns beyond its model, so that the charge limit holds for the
 * motor as it is. 1 kHz. DERIVATIONS.md, Charge trim.
 *
 * Voltage and current of the motor give the power at its terminals whatever its parameters and the
 * rotor angle are. The loss of the bridge is not in it: only the battery's own current shows that,
 * where one motor is its only source and its message gives the current.
 */
#ifndef TORQUE_CHARGE_TRIM_H
#define TORQUE_CHARGE_TRIM_H

#include <stdbool.h>
#include <stdint.h>

#include "core/filter.h"
#include "core/measured.h"
#include "motor/current_setpoint.h"
#include "motor/motor_model.h"

typedef struct {
    int32_t most_mA;         /* of what the terminals show */
    int32_t terminals_q8_mA; /* bus current of the setpoint by the model, less the measured one */
    int32_t speed_abs_mrad_s;
    int32_t commanded_mA; /* of the latest setpoint by the model */
    bool braking;         /* that setpoint brakes */
    filter_t own;         /* measured, mA, negative while it returns power */
    filter_t pack;        /* how much less the bridge loses than its model, mA */
    int32_t message_mA;   /* what the battery's message may still show of the motor's charge */
    int32_t hold_ms;      /* left until it falls */
} charge_trim_state_t;

enum {
    CHARGE_TRIM_RISE_LOG2 = 6,   /* 64 ms */
    CHARGE_TRIM_FALL_LOG2 = 9,   /* 512 ms */
    CHARGE_TRIM_OWN_LOG2 = 2,    /* 4 ms */
    CHARGE_TRIM_PACK_LOG2 = 7,   /* 128 ms */
    CHARGE_TRIM_MESSAGE_ms = 128 /* more than the cycle of the battery's message */
};

/* Divides; once at start. */
void charge_trim_init(charge_trim_state_t *state, const config_t *config);

/* Slow loop, once per step. flowing: of the measured currents. Returns by how much the motor
 * charges the battery more than its model says, mA, and one code of the current sensors more: at
 * least minus and at most plus half of the copper loss of the largest phase current, and what
 * switching loses. */
int32_t charge_trim_step(charge_trim_state_t *state, const motor_model_t *model,
                         const measured_t *now, motor_point_t flowing);

/* The setpoint that flows until the next step; whether it brakes. */
void charge_trim_commanded(charge_trim_state_t *state, const motor_model_t *model,
                           current_setpoint_t current, bool braking, int32_t bus_mV);

#endif
