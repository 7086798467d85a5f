/* SPDX-License-Identifier: Apache-2.0 */
/*
 * gate_board.h: an STM32F405 beside a gate board of one's own, up to 800 V and 1 kA: isolated
 * sensors of phase currents and bus voltage, isolated gate drivers that report by one line.
 *
 * Not a board that exists: a description to copy. Every number marked "own" is a choice of the
 * inverter's builder, who puts his own in its place, and pins of the VESC 75/300 (vesc75_300.h)
 * where there is no reason for others.
 *
 *     PA8 PA9 PA10      TIM1_CH1..3      high-side gates a, b, c
 *     PB13 PB14 PB15    TIM1_CH1N..3N    low-side gates a, b, c
 *     PB12              TIM1_BKIN        fault line of the gate board, low: all gates off at once
 *     PC0 PC1 PC2       ADC123_IN10..12  current sensors a, b, c, 0.5 V_ref at no current
 *     PC3               ADC123_IN13      bus voltage: isolated amplifier
 *     PA3               ADC123_IN3       switch temperature: NTC to supply, 10 kOhm to ground
 *     PC4               ADC12_IN14       winding temperature: sensor to ground, 10 kOhm to supply
 *     PA5 PA6           ADC12_IN5, IN6   accelerator a and b, 0 .. V_ref
 *     PC6 PC7 PC8       halls A, B, C; encoder A, B, index: TIM3_CH1..3
 *     PB10 PB11         USART3 transmit, receive
 *     PB8 PB9           CAN1 receive, transmit
 *
 * Gates are active high: a pin that floats, as during a reset, has to leave its switch off. A fault
 * line that is cut has to read low: this pin's pull-up is weak, so the gate board pulls it down and
 * drives it up.
 */
#ifndef STM32F405_BOARDS_GATE_BOARD_H
#define STM32F405_BOARDS_GATE_BOARD_H

#include "gpio.h"

enum {
    BOARD_CRYSTAL_Hz = 8000000,      /* own */
    BOARD_DEAD_TIME_LEAST_ns = 2000, /* own: switches and drivers, with their tolerances */
    BOARD_SHUNTS = BOARD_SHUNTS_IN_PHASES,
    BOARD_CURRENT_CHANNELS = 3,
    /* own: an isolated sensor of 1.375 mV an ampere, +-1.2 kA at the converter. */
    BOARD_SHUNT_nOhm = 1375000,
    BOARD_AMPLIFIER_GAIN = 1,
    BOARD_CURRENT_INVERTED = 0, /* own */
    BOARD_REFERENCE_mV = 3300,
    /* own: 1 kV at the end of the converter's range, divider and isolated amplifier together. */
    BOARD_DIVIDER_UPPER_Ohm = 302030,
    BOARD_DIVIDER_LOWER_Ohm = 1000,
    BOARD_SWITCH_NTC_BETA_K = 3380, /* own: the module's */
    BOARD_SWITCH_NTC_GROUND_Ohm = 10000,
    BOARD_AMPLIFIER_SETTLING_ns = 0, /* the sensors see the current all the time */
    BOARD_CHANNEL_CURRENT_A = 10,
    BOARD_CHANNEL_CURRENT_B = 11,
    BOARD_CHANNEL_CURRENT_C = 12,
    BOARD_CHANNEL_BUS_VOLTAGE = 13,
    BOARD_CHANNEL_WINDING_TEMPERATURE = 14,
    BOARD_CHANNEL_SWITCH_TEMPERATURE = 3,
    BOARD_CHANNEL_ACCELERATOR_A = 5,
    BOARD_CHANNEL_ACCELERATOR_B = 6,
    BOARD_ENCODER_WIRED = 1,
    BOARD_CURRENT_MOST_A = 1000, /* own */
    BOARD_VOLTAGE_MOST_V = 800,  /* own */
    BOARD_DRIVER_V_DS_CODE = 0   /* none */
};

#define BOARD_CONSTANT_OUTPUTS(PIN)

#define BOARD_DRIVER_KIND BOARD_DRIVER_NONE
#define BOARD_GATE_HIGH_A ((pin_t){GPIOA, 8})
#define BOARD_GATE_HIGH_B ((pin_t){GPIOA, 9})
#define BOARD_GATE_HIGH_C ((pin_t){GPIOA, 10})
#define BOARD_GATE_LOW_A ((pin_t){GPIOB, 13})
#define BOARD_GATE_LOW_B ((pin_t){GPIOB, 14})
#define BOARD_GATE_LOW_C ((pin_t){GPIOB, 15})
#define BOARD_BREAK ((pin_t){GPIOB, 12})
#define BOARD_DRIVER_ENABLE PIN_NONE
#define BOARD_DRIVER_FAULT PIN_NONE
#define BOARD_DRIVER_SDI PIN_NONE
#define BOARD_DRIVER_SDO PIN_NONE
#define BOARD_DRIVER_CLOCK PIN_NONE
#define BOARD_DRIVER_SELECT PIN_NONE
#define BOARD_CURRENT_A ((pin_t){GPIOC, 0})
#define BOARD_CURRENT_B ((pin_t){GPIOC, 1})
#define BOARD_CURRENT_C ((pin_t){GPIOC, 2})
#define BOARD_BUS_VOLTAGE ((pin_t){GPIOC, 3})
#define BOARD_SWITCH_TEMPERATURE ((pin_t){GPIOA, 3})
#define BOARD_WINDING_TEMPERATURE ((pin_t){GPIOC, 4})
#define BOARD_ACCELERATOR_A ((pin_t){GPIOA, 5})
#define BOARD_ACCELERATOR_B ((pin_t){GPIOA, 6})
#define BOARD_ROTOR_A ((pin_t){GPIOC, 6})
#define BOARD_ROTOR_B ((pin_t){GPIOC, 7})
#define BOARD_ROTOR_C ((pin_t){GPIOC, 8})
#define BOARD_SERIAL_TRANSMIT ((pin_t){GPIOB, 10})
#define BOARD_SERIAL_RECEIVE ((pin_t){GPIOB, 11})
#define BOARD_CAN_RECEIVE ((pin_t){GPIOB, 8})
#define BOARD_CAN_TRANSMIT ((pin_t){GPIOB, 9})
#define BOARD_POWER_HOLD PIN_NONE

#endif
