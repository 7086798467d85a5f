/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mks84_200_hp.h: Makerbase MKS 84200 HP: 87 V, shunts in the phases. Not verified on a board.
 *
 * Source: the VESC firmware's hwconf/makerbase/84_200_HP/hw_mksesc_84_200_hp.h and .c (vedderb/bldc
 * on GitHub, commit b9d287b), hwconf/hw.h for CAN, motor/mcpwm_foc.c for the amplifiers' sign and
 * their filters. No line of the gate drivers' is in these files: a fault is seen by the currents
 * alone. Of the three thermistors beside the switches (PA3, PB0, PB1) the first is read. That
 * firmware also reads the switch at PC5 between its pulses, which is not done here.
 *
 * Pins: vesc_pins_common.h, and
 *     PC0 PC1 PC2       ADC123_IN10..12  shunt amplifiers a, b, c, 0.5 V_ref at no current
 *     PC3               ADC123_IN13      bus voltage, 56 kOhm and 2.2 kOhm
 *     PC5               keeps the supply on
 *     PD2, PC9          filters of the shunt amplifiers on, of the phase voltages off
 */
#ifndef STM32F405_BOARDS_MKS84_200_HP_H
#define STM32F405_BOARDS_MKS84_200_HP_H

#include "boards/no_driver_common.h"
#include "boards/vesc_pins_common.h"

enum {
    BOARD_CRYSTAL_Hz = 8000000,
    BOARD_DEAD_TIME_LEAST_ns = 660, /* HW_DEAD_TIME_NSEC */
    BOARD_SHUNT_nOhm = 166667,      /* CURRENT_SHUNT_RES: three of 0.5 mOhm side by side */
    BOARD_AMPLIFIER_GAIN = 20,
    BOARD_CURRENT_INVERTED = 1, /* vesc6_mk3.h */
    BOARD_REFERENCE_mV = 3300,  /* V_REG */
    BOARD_DIVIDER_UPPER_Ohm = 56000,
    BOARD_DIVIDER_LOWER_Ohm = 2200,
    BOARD_SWITCH_NTC_BETA_K = 3380,
    BOARD_CURRENT_MOST_A = 450, /* HW_LIM_CURRENT_ABS */
    BOARD_VOLTAGE_MOST_V = 87   /* HW_LIM_VIN is 120, but the divider ends at 87.3 V */
};

#define BOARD_CONSTANT_OUTPUTS(PIN) PIN(GPIOD, 2, true) PIN(GPIOC, 9, false)

#define BOARD_BREAK PIN_NONE
#define BOARD_POWER_HOLD ((pin_t){GPIOC, 5})

#endif
