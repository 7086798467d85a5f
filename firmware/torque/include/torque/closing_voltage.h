/* SPDX-License-Identifier: Apache-2.0 */
/*
 * closing_voltage.h: the phase voltage that PWM would have. Slow loop, 1 kHz.
 *
 * While the EMF of an open bridge charges the battery through the diodes it lifts the battery's
 * voltage, and with it the voltage that is seen; a bridge that closes ends that.
 */
#ifndef TORQUE_CLOSING_VOLTAGE_H
#define TORQUE_CLOSING_VOLTAGE_H

#include <stdint.h>

#include "config/config.h"

/* What PWM must have more of the voltage before it returns, 1/2^7: the hysteresis. */
enum { CLOSING_VOLTAGE_HYSTERESIS_LOG2 = 7 };

/* The phase voltage, peak, mV, that PWM would have instead of a bridge whose diodes charge the
 * battery with charging_mA >= 0 of this motor: phase (1 - R I / bus), less the hysteresis; R I
 * counts as half of the bus voltage at most. phase_mV, bus_mV: seen now; R: battery.resistance. */
int32_t closing_voltage_mV(const config_t *config, int32_t phase_mV, int32_t bus_mV,
                           int32_t charging_mA);

#endif
