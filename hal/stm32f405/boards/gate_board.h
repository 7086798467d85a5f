/* SPDX-License-Identifier: Apache-2.0 */
/*
 * gate_board.h: an STM32F405 beside a gate board of one's own, up to 800 V and 1 kA: isolated
 * sensors of phase currents and bus voltage, isolated gate drivers that report by one line.
 *
 * Not a board that exists: a description to copy. Every number marked "own" is a choice of the
 * inverter's builder, who puts his own in its place, and pins of the VESC 75/300 (vesc75_300.h)
 * where there is no reason for others.
 *
 * Pins: vesc_pins_common.h, and
 *     PB12              TIM1_BKIN        fault line of the gate board, low: all gates off at once
 *     PC0 PC1 PC2       ADC123_IN10..12  current sensors a, b, c, 0.5 V_ref at no current
 *     PC3               ADC123_IN13      bus voltage: isolated amplifier
 *
 * Gates are active high: a pin that floats, as during a reset, has to leave its switch off. A fault
 * line that is cut has to read low: this pin's pull-up is weak, so the gate board pulls it down and
 * drives it up.
 */
#ifndef STM32F405_BOARDS_GATE_BOARD_H
#define STM32F405_BOARDS_GATE_BOARD_H

#include "boards/no_driver_common.h"
#include "boards/vesc_pins_common.h"

enum {
    BOARD_CRYSTAL_Hz = 8000000,      /* own */
    BOARD_DEAD_TIME_LEAST_ns = 2000, /* own: switches and drivers, with their tolerances */
    /* own: an isolated sensor of 1.375 mV an ampere, +-1.2 kA at the converter. */
    BOARD_SHUNT_nOhm = 1375000,
    BOARD_AMPLIFIER_GAIN = 1,
    BOARD_CURRENT_INVERTED = 0, /* own */
    BOARD_REFERENCE_mV = 3300,
    /* own: 1 kV at the end of the converter's range, divider and isolated amplifier together. */
    BOARD_DIVIDER_UPPER_Ohm = 302030,
    BOARD_DIVIDER_LOWER_Ohm = 1000,
    BOARD_SWITCH_NTC_BETA_K = 3380, /* own: the module's */
    BOARD_CURRENT_MOST_A = 1000,    /* own */
    BOARD_VOLTAGE_MOST_V = 800      /* own */
};

#define BOARD_CONSTANT_OUTPUTS(PIN)

#define BOARD_BREAK ((pin_t){GPIOB, 12})
#define BOARD_POWER_HOLD PIN_NONE

#endif
