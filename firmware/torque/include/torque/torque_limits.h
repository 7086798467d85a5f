/* SPDX-License-Identifier: Apache-2.0 */
/*
 * torque_limits.h: what the motor can do at this moment, in each direction of power, and why not
 * more.
 *
 * All slow limits meet here and nowhere else: torque, power, phase current, the battery's charge
 * and discharge current, bus voltage, winding and switch temperature, speed, rotor quality. Each is
 * a bound in newton-metres at the shaft; the smallest wins and gives its reason. Temperature, speed
 * and pedal never cut braking because of a driving-side reason.
 *
 * Torque against the rotation returns power up to the loss optimum; a little further on it draws
 * some, and then the discharge limits bound it like driving. Near the ends of the battery's voltage
 * the currents follow foldback.h.
 *
 * Phase current and battery power of a torque are those of the currents that current_setpoint.h
 * would ask for: the map's i_d at that torque, field weakening as it is now, and the i_q that goes
 * with them. So a torque found here is one the current reference makes without giving way, and one
 * at which the battery takes or gives what it may. Where a limit bites, the torque is right to 0.1
 * %.
 */
#ifndef TORQUE_TORQUE_LIMITS_H
#define TORQUE_TORQUE_LIMITS_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "torque/limit.h"
#include "torque/motor_model.h"

typedef struct {
    int32_t bus_voltage_mV;
    int32_t phase_voltage_mV;      /* peak phase: what the current loop may ask for and still has a
                                      reserve; >= 0 */
    int32_t bms_charge_current_mA; /* whole pack, magnitude; negative counts as 0 */
    int32_t bms_discharge_current_mA; /* whole pack, magnitude */
    int32_t winding_temperature_cC;
    int32_t switch_temperature_cC;
    bool voltage_low,
        voltage_high;    /* near the end of the battery's voltage, or lately so (foldback_near) */
    int32_t command_mNm; /* torque the motor is asked for now, signed: where the voltage limits
                            start from */
    int32_t i_d_weakening_mA; /* what field weakening adds to i_d now, <= 0 */
    bool rotor_valid;
} torque_limits_input_t;

typedef struct {
    limit_t driving;      /* torque in the direction of rotation (or from standstill) */
    limit_t regenerating; /* torque against the rotation, hard limits only */
    limit_t optimal;      /* regenerating and also not beyond the loss optimum */
} torque_limits_t;

torque_limits_t torque_limits_step(const config_t *config, const motor_model_t *model,
                                   const torque_limits_input_t *in);

#endif
