/* SPDX-License-Identifier: Apache-2.0 */
/*
 * vesc4_10.h: VESC 4.10 to 4.12: 60 V, two low-side shunts, DRV8302.
 *
 * Source: the VESC firmware's hwconf/other/vesc4/hw_410.h and hwconf/hw_410.c
 * (vedderb/bldc on GitHub, commits a946911 and 116ef56), hwconf/hw.h for CAN; motor/mcpwm_foc.c:
 * with two shunts the second duty goes to channel 3, so the shunts are those of a and c, and the
 * codes fall with current into the motor (vesc6_mk3.h). The DRV8302's threshold, mode and gain are
 * set by resistors on the board; README, Bring-up, C measures the first two.
 *
 *     PA8 PA9 PA10      TIM1_CH1..3      high-side gates a, b, c
 *     PB13 PB14 PB15    TIM1_CH1N..3N    low-side gates a, b, c
 *     PC10, PC12        gate driver: enable, fault
 *     PB12              gate driver: calibration of its amplifiers, low = measure
 *     PB1 PB0           ADC12_IN9, IN8   shunt amplifiers a, c, 0.5 V_ref at no current
 *     PC2               ADC123_IN12      bus voltage, 39 kOhm and 2.2 kOhm
 *     PA3               ADC123_IN3       switch temperature: NTC to supply, 10 kOhm to ground
 *     PC0               ADC123_IN10      winding temperature: NTC to ground, 10 kOhm to supply
 *     PA5 PA6           ADC12_IN5, IN6   accelerator a and b, 0 .. V_ref
 *     PB6 PB7 PC11      halls A, B, C; for an encoder it would take TIM4, which is not driven here
 *     PB10 PB11         USART3 transmit, receive: the pins that VESC uses for I2C
 *     PB8 PB9           CAN1 receive, transmit
 *
 * TIM1's break input, PB12, is the gate driver's calibration here, so it is not used.
 */
#ifndef STM32F405_BOARDS_VESC4_10_H
#define STM32F405_BOARDS_VESC4_10_H

#include "gpio.h"

enum {
    BOARD_CRYSTAL_Hz = 8000000,
    BOARD_DEAD_TIME_LEAST_ns = 360, /* as vesc6_common.h */
    BOARD_SHUNTS = BOARD_SHUNTS_LOW_SIDE,
    BOARD_CURRENT_CHANNELS = 2,
    BOARD_SHUNT_nOhm = 1000000,
    BOARD_AMPLIFIER_GAIN = 10,
    BOARD_CURRENT_INVERTED = 1,
    BOARD_REFERENCE_mV = 3300,
    BOARD_DIVIDER_UPPER_Ohm = 39000,
    BOARD_DIVIDER_LOWER_Ohm = 2200,
    BOARD_SWITCH_NTC_BETA_K = 3434,
    BOARD_SWITCH_NTC_GROUND_Ohm = 10000,
    BOARD_AMPLIFIER_SETTLING_ns = 300, /* to 1 % of 2 V at a gain of 10: data sheet SLES267 */
    BOARD_CHANNEL_CURRENT_A = 9,
    BOARD_CHANNEL_CURRENT_C = 8,
    BOARD_CHANNEL_CURRENT_B = BOARD_CHANNEL_NONE,
    BOARD_CHANNEL_BUS_VOLTAGE = 12,
    BOARD_CHANNEL_WINDING_TEMPERATURE = 10,
    BOARD_CHANNEL_SWITCH_TEMPERATURE = 3,
    BOARD_CHANNEL_ACCELERATOR_A = 5,
    BOARD_CHANNEL_ACCELERATOR_B = 6,
    BOARD_ENCODER_WIRED = 0,
    BOARD_CURRENT_MOST_A = 150, /* HW_LIM_CURRENT_ABS */
    BOARD_VOLTAGE_MOST_V = 60,  /* the DRV8302's supply, SLES267 */
    BOARD_DRIVER_V_DS_CODE = 0  /* set by resistors */
};

#define BOARD_CONSTANT_OUTPUTS(PIN) PIN(GPIOB, 12, false)

#define BOARD_DRIVER_KIND BOARD_DRIVER_DRV8302
#define BOARD_GATE_HIGH_A ((pin_t){GPIOA, 8})
#define BOARD_GATE_HIGH_B ((pin_t){GPIOA, 9})
#define BOARD_GATE_HIGH_C ((pin_t){GPIOA, 10})
#define BOARD_GATE_LOW_A ((pin_t){GPIOB, 13})
#define BOARD_GATE_LOW_B ((pin_t){GPIOB, 14})
#define BOARD_GATE_LOW_C ((pin_t){GPIOB, 15})
#define BOARD_BREAK PIN_NONE
#define BOARD_DRIVER_ENABLE ((pin_t){GPIOC, 10})
#define BOARD_DRIVER_FAULT ((pin_t){GPIOC, 12})
#define BOARD_DRIVER_SDI PIN_NONE
#define BOARD_DRIVER_SDO PIN_NONE
#define BOARD_DRIVER_CLOCK PIN_NONE
#define BOARD_DRIVER_SELECT PIN_NONE
#define BOARD_CURRENT_A ((pin_t){GPIOB, 1})
#define BOARD_CURRENT_B PIN_NONE
#define BOARD_CURRENT_C ((pin_t){GPIOB, 0})
#define BOARD_BUS_VOLTAGE ((pin_t){GPIOC, 2})
#define BOARD_SWITCH_TEMPERATURE ((pin_t){GPIOA, 3})
#define BOARD_WINDING_TEMPERATURE ((pin_t){GPIOC, 0})
#define BOARD_ACCELERATOR_A ((pin_t){GPIOA, 5})
#define BOARD_ACCELERATOR_B ((pin_t){GPIOA, 6})
#define BOARD_ROTOR_A ((pin_t){GPIOB, 6})
#define BOARD_ROTOR_B ((pin_t){GPIOB, 7})
#define BOARD_ROTOR_C ((pin_t){GPIOC, 11})
#define BOARD_SERIAL_TRANSMIT ((pin_t){GPIOB, 10})
#define BOARD_SERIAL_RECEIVE ((pin_t){GPIOB, 11})
#define BOARD_CAN_RECEIVE ((pin_t){GPIOB, 8})
#define BOARD_CAN_TRANSMIT ((pin_t){GPIOB, 9})
#define BOARD_POWER_HOLD PIN_NONE

#endif
