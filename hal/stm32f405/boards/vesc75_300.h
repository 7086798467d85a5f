/* SPDX-License-Identifier: Apache-2.0 */
/*
 * vesc75_300.h: VESC 75/300, revisions 2 and 3: 72 V, shunts in the phases. Not verified on a
 * board.
 *
 * Source: the VESC firmware's hwconf/trampa/75_300/hw_75_300_core.h and .c (vedderb/bldc on GitHub,
 * commit b9d287b), hwconf/hw.h for CAN, motor/mcpwm_foc.c for the amplifiers' sign and their
 * filters. Revision 1 has the filter of the phase voltages at PC11. The 75/300 MK IV is another
 * board. No line of the gate drivers' is in these files: a fault is seen by the currents alone. Of
 * the three thermistors beside the switches (PA3, PB0, PB1) the first is read.
 *
 * Pins: vesc_pins_common.h, and
 *     PC0 PC1 PC2       ADC123_IN10..12  shunt amplifiers a, b, c, 0.5 V_ref at no current
 *     PC3               ADC123_IN13      bus voltage, 56 kOhm and 2.2 kOhm
 *     PD2, PC9          filters of the shunt amplifiers on, of the phase voltages off
 */
#ifndef STM32F405_BOARDS_VESC75_300_H
#define STM32F405_BOARDS_VESC75_300_H

#include "boards/no_driver_common.h"
#include "boards/vesc_pins_common.h"

enum {
    BOARD_CRYSTAL_Hz = 8000000,
    BOARD_DEAD_TIME_LEAST_ns = 1000, /* HW_DEAD_TIME_NSEC */
    BOARD_SHUNT_nOhm = 166667,       /* CURRENT_SHUNT_RES: three of 0.5 mOhm side by side */
    BOARD_AMPLIFIER_GAIN = 20,
    BOARD_CURRENT_INVERTED = 1, /* vesc6_mk3.h */
    BOARD_REFERENCE_mV = 3440,  /* V_REG */
    BOARD_DIVIDER_UPPER_Ohm = 56000,
    BOARD_DIVIDER_LOWER_Ohm = 2200,
    BOARD_SWITCH_NTC_BETA_K = 3380,
    BOARD_CURRENT_MOST_A = 480, /* HW_LIM_CURRENT_ABS */
    BOARD_VOLTAGE_MOST_V = 72   /* HW_LIM_VIN */
};

#define BOARD_CONSTANT_OUTPUTS(PIN) PIN(GPIOD, 2, true) PIN(GPIOC, 9, false)

#define BOARD_BREAK PIN_NONE
#define BOARD_POWER_HOLD PIN_NONE

#endif
