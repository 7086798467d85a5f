/* SPDX-License-Identifier: Apache-2.0 */
/* The plant's signals at the pins of the chosen board (boards.h). */
#include "wiring.h"

#include <math.h>

#include "boards.h"

enum { CODES = 4096, CODE_MOST = CODES - 1 };
static double full_scale_a, full_scale_v;

void wiring_full_scales(double current_a, double voltage_v)
{
    full_scale_a = current_a;
    full_scale_v = voltage_v;
}

static uint16_t code_of(double share)
{
    return (uint16_t)fmin(fmax(round(share), 0.0), CODE_MOST);
}

wiring_shunts_t wiring_shunts(void)
{
    const board_t *board = boards_chosen();
    wiring_shunts_t shunts = {.low_side = board->low_side_shunts, .settling_s = board->settling_s};
    for (int x = 0; x < 3; x++) {
        shunts.at[x] = board->current_channel[x] != BOARDS_NO_CHANNEL;
    }
    return shunts;
}

void wiring_currents(chip_t *chip, const uint16_t code[3])
{
    const board_t *board = boards_chosen();
    const double middle = CODE_MOST / 2.0;
    const double scale = board->shunt_ohm * board->gain / (board->reference_v / CODES) *
                         full_scale_a / (CODES / 2.0);
    const wire_t calibrate = board->calibrate;
    const bool shorted =
        calibrate.port != 0 && chip_drives_high(chip, calibrate.port, calibrate.pin);
    for (int x = 0; x < 3; x++) {
        if (board->current_channel[x] != BOARDS_NO_CHANNEL) {
            chip_inputs(chip)->analog_code[board->current_channel[x]] = code_of(
                shorted ? middle : middle + (code[x] - middle) * (board->rising ? scale : -scale));
        }
    }
}

void wiring_bus_voltage(chip_inputs_t *in, uint16_t code)
{
    const board_t *board = boards_chosen();
    const double volt = code * full_scale_v / CODES;
    const double share = board->lower_ohm / (board->upper_ohm + board->lower_ohm);
    in->analog_code[board->bus_channel] = code_of(volt * share / board->reference_v * CODES);
}

void wiring_halls(chip_inputs_t *in, uint8_t state)
{
    for (int x = 0; x < 3; x++) {
        const wire_t hall = boards_chosen()->hall[x];
        const unsigned high = (state >> x & 1U) != 0 ? 0xFFFFU : 0U;
        wiring_pins(in, hall.port - 'A', 1U << hall.pin, high);
    }
}

/* 10 kOhm at 25 degC in a divider with 10 kOhm. */
static uint16_t thermistor_code(int32_t temperature_cC, double beta_k, bool to_ground)
{
    const double kelvin = temperature_cC / 100.0 + 273.15;
    const double ratio = exp(beta_k * (1.0 / kelvin - 1.0 / 298.15));
    return code_of(CODES * (to_ground ? ratio / (ratio + 1.0) : 1.0 / (ratio + 1.0)));
}

void wiring_temperatures(chip_inputs_t *in, int32_t winding_cC, int32_t switch_cC)
{
    const board_t *board = boards_chosen();
    in->analog_code[board->winding_channel] = thermistor_code(winding_cC, 3380.0, true);
    in->analog_code[board->switch_channel] =
        thermistor_code(switch_cC, board->switch_beta_k, false);
}
