/* SPDX-License-Identifier: Apache-2.0 */
/*
 * B-G431B-ESC1 (hal/stm32g431/boards): low-side shunts of 3 mOhm, of whose voltage the network
 * before PA1, PA7 and PB0 leaves 4/7, falling with current into the motor: 1.5 kOhm to the shunt,
 * 2.2 kOhm to ground, 22 kOhm to the reference; bus voltage at PA0, switch thermistor at PB14, from
 * the supply over 4.7 kOhm; halls at PB6 to PB8; no winding sensor.
 */
#include "wiring.h"

#include <math.h>
#include <string.h>

#include "analog.h"

enum { PORT_B = 1, HALL_PINS = 7 << 6, CODES = ANALOG_CODES, MIDDLE_CODE = 2048 };
static double full_scale_a;
/* Of the amplifiers, as FOC-Stim measured it on the board. */
static const double SETTLING_S = 1.3e-6;
/* By the conductances in mS of the three resistors. */
static const double TO_SHUNT = 1.0 / 1.5, TO_GROUND = 1.0 / 2.2, TO_REFERENCE = 1.0 / 22.0;

bool wiring_choose(const char *board)
{
    return strcmp(board, "b_g431b_esc1") == 0;
}

wiring_shunts_t wiring_shunts(void)
{
    const wiring_shunts_t shunts = {true, {true, true, true}, SETTLING_S};
    return shunts;
}

void wiring_full_scales(double current_a, double voltage_v)
{
    (void)voltage_v; /* its codes are the converter's */
    full_scale_a = current_a;
}

/* The comparators of the chip itself take its place. */
bool wiring_has_fault_line(void)
{
    return true;
}

/* The transceiver's are looked at by can.c. */
bool wiring_outputs_hold(chip_t *chip)
{
    (void)chip;
    return true;
}

void wiring_currents(chip_t *chip, const uint16_t code[3])
{
    for (int x = 0; x < 3; x++) {
        chip_inputs(chip)->current_a[x] = (code[x] - MIDDLE_CODE) * full_scale_a / MIDDLE_CODE;
    }
}

void wiring_bus_voltage(chip_inputs_t *in, uint16_t code)
{
    in->analog_code[0] = code;
}

void wiring_halls(chip_inputs_t *in, uint8_t state)
{
    wiring_pins(in, PORT_B, HALL_PINS, (unsigned)state << 6);
}

/* 10 kOhm at 25 degC, B = 3380 K, over 4.7 kOhm to ground. */
void wiring_temperatures(chip_inputs_t *in, int32_t winding_cC, int32_t switch_cC)
{
    (void)winding_cC;
    const double kelvin = switch_cC / 100.0 + 273.15;
    const double ohm = 10e3 * exp(3380.0 * (1.0 / kelvin - 1.0 / 298.15));
    in->analog_code[1] = (uint16_t)lround(CODES * 4.7e3 / (4.7e3 + ohm));
}

static double shunt_pin_V(const chip_t *chip, unsigned phase)
{
    const bool lasts = chip->fault.low_side_a_ends == 0 || chip->now < chip->fault.low_side_a_ends;
    const double down_a = phase == 0 && lasts && chip->fault.low_side_a_mA != 0
                              ? chip->fault.low_side_a_mA / 1000.0
                              : -chip->in.current_a[phase];
    return (TO_SHUNT * 0.003 * down_a + TO_REFERENCE * ANALOG_REFERENCE_uV / 1e6) /
           (TO_SHUNT + TO_GROUND + TO_REFERENCE);
}

double analog_pin_V(const chip_t *chip, char port, unsigned pin)
{
    const double code_V = ANALOG_REFERENCE_uV / 1e6 / CODES;
    if (port == 'A') {
        switch (pin) {
        case 0:
            return chip->in.analog_code[0] * code_V;
        case 1:
            return shunt_pin_V(chip, 0);
        case 2:
            return amplifier_V(chip, 1);
        case 6:
            return amplifier_V(chip, 2);
        case 7:
            return shunt_pin_V(chip, 1);
        default:
            return 0.0;
        }
    }
    if (port == 'B' && pin == 0) {
        return shunt_pin_V(chip, 2);
    }
    return port == 'B' && pin == 14 ? chip->in.analog_code[1] * code_V : 0.0;
}
