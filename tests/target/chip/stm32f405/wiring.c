/* SPDX-License-Identifier: Apache-2.0 */
/*
 * VESC 6 MK3 (hal/stm32f405/boards): shunt amplifiers a, b, c at channels 10, 11, 12, falling with
 * current into the motor; bus voltage at 13; switch thermistor at 3, from the supply; winding
 * thermistor at 14, to ground; halls at PC6 to PC8.
 */
#include "wiring.h"

#include <math.h>

enum {
    CHANNEL_CURRENT_A = 10,
    CHANNEL_BUS = 13,
    CHANNEL_WINDING = 14,
    CHANNEL_SWITCH = 3,
    CODES = 4096,
    CODE_MOST = CODES - 1,
    PORT_C = 2,
    HALL_PINS = 7 << 6
};

void wiring_currents(chip_inputs_t *in, const uint16_t code[3])
{
    for (int x = 0; x < 3; x++) {
        in->analog_code[CHANNEL_CURRENT_A + x] = (uint16_t)(CODE_MOST - code[x]);
    }
}

void wiring_bus_voltage(chip_inputs_t *in, uint16_t code)
{
    in->analog_code[CHANNEL_BUS] = code;
}

void wiring_halls(chip_inputs_t *in, uint8_t state)
{
    wiring_pins(in, PORT_C, HALL_PINS, (unsigned)state << 6);
}

/* 10 kOhm at 25 degC, B = 3380 K, in a divider with 10 kOhm. */
static uint16_t thermistor_code(int32_t temperature_cC, bool to_ground)
{
    const double kelvin = temperature_cC / 100.0 + 273.15;
    const double ratio = exp(3380.0 * (1.0 / kelvin - 1.0 / 298.15));
    const double share = to_ground ? ratio / (ratio + 1.0) : 1.0 / (ratio + 1.0);
    return (uint16_t)lround(fmin(CODES * share, CODE_MOST));
}

void wiring_temperatures(chip_inputs_t *in, int32_t winding_cC, int32_t switch_cC)
{
    in->analog_code[CHANNEL_WINDING] = thermistor_code(winding_cC, true);
    in->analog_code[CHANNEL_SWITCH] = thermistor_code(switch_cC, false);
}
