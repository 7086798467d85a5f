/* SPDX-License-Identifier: Apache-2.0 */
#include "boards.h"

#include <string.h>

#include "wiring.h"

#define VESC_6                                                                                     \
    .low_side_shunts = false, .shunt_ohm = 0.5e-3, .gain = 20.0, .current_channel = {10, 11, 12},  \
    .reference_v = 3.3, .bus_channel = 13, .winding_channel = 14, .switch_channel = 3,             \
    .upper_ohm = 39e3, .lower_ohm = 2.2e3, .switch_beta_k = 3380.0,                                \
    .hall = {{'C', 6}, {'C', 7}, {'C', 8}}, .enable = {'B', 5}, .fault = {'B', 7},                 \
    .sdi = {'B', 4}, .sdo = {'B', 3}, .sclk = {'C', 10}, .nscs = {'C', 9}, .power_hold = {'C', 5}, \
    .encoder_at_tim3 = true

/* Three shunts of 0.5 mOhm side by side; the filters of the phase voltages are off. */
#define VESC_75                                                                                    \
    .low_side_shunts = false, .shunt_ohm = 0.5e-3 / 3.0, .gain = 20.0,                             \
    .current_channel = {10, 11, 12}, .bus_channel = 13, .winding_channel = 14,                     \
    .switch_channel = 3, .upper_ohm = 56e3, .lower_ohm = 2.2e3, .switch_beta_k = 3380.0,           \
    .hall = {{'C', 6}, {'C', 7}, {'C', 8}}, .encoder_at_tim3 = true,                               \
    .outputs = {{{'D', 2}, true}, {{'C', 9}, false}}

static const board_t BOARDS[] = {
    {.name = "vesc6_mk3", VESC_6, .outputs = {{{'D', 2}, true}}}, /* filters of the amplifiers */
    {.name = "vesc6_mk6", VESC_6, .outputs = {{{'D', 2}, true}, {{'A', 4}, false}}}, /* 3.3 V */
    {.name = "vesc4_10",
     .low_side_shunts = true,
     .settling_s = 300e-9, /* DRV8302, SLES267: to 1 % of 2 V at a gain of 10 */
     .shunt_ohm = 1e-3,
     .gain = 10.0,
     .reference_v = 3.3,
     .current_channel = {9, BOARDS_NO_CHANNEL, 8},
     .bus_channel = 12,
     .winding_channel = 10,
     .switch_channel = 3,
     .upper_ohm = 39e3,
     .lower_ohm = 2.2e3,
     .switch_beta_k = 3434.0,
     .hall = {{'B', 6}, {'B', 7}, {'C', 11}},
     .enable = {'C', 10},
     .fault = {'C', 12},
     .oc_adj_mV = 403, /* as a VESC 6: what the resistors of a board make is for it to show */
     .calibrate = {'B', 12},
     .outputs = {{{'B', 12}, false}}},
    {.name = "vesc75_300", VESC_75, .reference_v = 3.44},
    {.name = "mks84_200_hp", VESC_75, .reference_v = 3.3, .power_hold = {'C', 5}},
    {.name = "gate_board",
     .low_side_shunts = false,
     .shunt_ohm = 1.375e-3, /* V an ampere */
     .gain = 1.0,
     .rising = true,
     .reference_v = 3.3,
     .current_channel = {10, 11, 12},
     .bus_channel = 13,
     .winding_channel = 14,
     .switch_channel = 3,
     .upper_ohm = 996.7, /* 1 kV at 3.3 V */
     .lower_ohm = 3.3,
     .switch_beta_k = 3380.0,
     .hall = {{'C', 6}, {'C', 7}, {'C', 8}},
     .encoder_at_tim3 = true,
     .fault = {'B', 12}},
};
enum { BOARDS_COUNT = sizeof BOARDS / sizeof BOARDS[0] };

static const board_t *chosen = &BOARDS[0];

const board_t *boards_chosen(void)
{
    return chosen;
}

bool wiring_has_fault_line(void)
{
    return chosen->fault.port != 0;
}

bool wiring_choose(const char *board)
{
    for (int i = 0; i < BOARDS_COUNT; i++) {
        if (strcmp(BOARDS[i].name, board) == 0) {
            chosen = &BOARDS[i];
            return true;
        }
    }
    return false;
}

bool wiring_outputs_hold(chip_t *chip)
{
    bool hold = chosen->power_hold.port == 0 ||
                chip_drives_high(chip, chosen->power_hold.port, chosen->power_hold.pin);
    for (int i = 0; i < BOARDS_OUTPUTS_MOST; i++) {
        const output_t *output = &chosen->outputs[i];
        if (output->wire.port != 0) {
            hold = hold && (output->high ? chip_drives_high : chip_drives_low)(
                               chip, output->wire.port, output->wire.pin);
        }
    }
    return hold;
}
