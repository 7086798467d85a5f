/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/closing_voltage.h"

#include "core/q15.h"

int32_t closing_voltage_mV(const config_t *config, int32_t phase_mV, int32_t bus_mV,
                           int32_t charging_mA)
{
    const int64_t lift_uV = (int64_t)charging_mA * config->battery.resistance_uOhm / 1000;
    const int32_t lift_mV = q_min(q_saturate64(lift_uV / 1000), q_max(bus_mV, 1) / 2);
    const int32_t lowered_mV = phase_mV - q_scale(phase_mV, lift_mV, q_max(bus_mV, 1));
    return lowered_mV - (lowered_mV >> CLOSING_VOLTAGE_HYSTERESIS_LOG2);
}
