/* SPDX-License-Identifier: Apache-2.0 */
/*
 * board.h: the board that this image is for, as data: boards/NAME.h, which the build chooses
 * (tools/dev firmware --board NAME).
 */
#ifndef STM32G431_BOARD_H
#define STM32G431_BOARD_H

#include <stdint.h>

#include "gpio.h"

#ifndef HUBFOC_BOARD_HEADER
#define HUBFOC_BOARD_HEADER "boards/b_g431b_esc1.h"
#endif
#include HUBFOC_BOARD_HEADER

/* The timer whose inputs an encoder's pins are. */
#define ENCODER TIM4

enum {
    /* Codes span the reference: half of it either way for a current, all of it for the voltage. */
    BOARD_CURRENT_FULL_SCALE_mA =
        (int)((int64_t)BOARD_REFERENCE_mV * 500000000 * BOARD_AMPLIFIER_GAIN_DENOMINATOR /
              (BOARD_SHUNT_nOhm * BOARD_AMPLIFIER_GAIN_NUMERATOR)),
    BOARD_VOLTAGE_FULL_SCALE_mV =
        (int)((int64_t)BOARD_REFERENCE_mV * (BOARD_DIVIDER_UPPER_Ohm + BOARD_DIVIDER_LOWER_Ohm) /
              BOARD_DIVIDER_LOWER_Ohm),
    /* A thermistor of 10 kOhm at 25 degrees Celsius to the supply. */
    BOARD_SWITCH_25C_code =
        4096 * BOARD_SWITCH_NTC_GROUND_Ohm / (BOARD_SWITCH_NTC_GROUND_Ohm + 10000)
};

_Static_assert(
    (int64_t)BOARD_NETWORK_NUMERATOR *(BOARD_NETWORK_GROUND_Ohm *BOARD_NETWORK_REFERENCE_Ohm +
                                       BOARD_NETWORK_SHUNT_Ohm * BOARD_NETWORK_REFERENCE_Ohm +
                                       BOARD_NETWORK_SHUNT_Ohm * BOARD_NETWORK_GROUND_Ohm) ==
        (int64_t)BOARD_NETWORK_DENOMINATOR * BOARD_NETWORK_GROUND_Ohm * BOARD_NETWORK_REFERENCE_Ohm,
    "the network's share of the shunt's voltage is what its resistors give");
_Static_assert(BOARD_CURRENT_FULL_SCALE_mA / 1000 >= BOARD_CURRENT_MOST_A,
               "the amplifiers show what the board may carry");
_Static_assert(BOARD_VOLTAGE_FULL_SCALE_mV / 1000 >= BOARD_VOLTAGE_MOST_V,
               "the divider shows what the board may bear");

#endif
