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
 *     PA8 PA9 PA10      TIM1_CH1..3      high-side gates a, b, c
 *     PB13 PB14 PB15    TIM1_CH1N..3N    low-side gates a, b, c
 *     PC0 PC1 PC2       ADC123_IN10..12  shunt amplifiers a, b, c, 0.5 V_ref at no current
 *     PC3               ADC123_IN13      bus voltage, 56 kOhm and 2.2 kOhm
 *     PA3               ADC123_IN3       switch temperature: NTC to supply, 10 kOhm to ground
 *     PC4               ADC12_IN14       winding temperature: sensor to ground, 10 kOhm to supply
 *     PA5 PA6           ADC12_IN5, IN6   accelerator a and b, 0 .. V_ref
 *     PC6 PC7 PC8       halls A, B, C; encoder A, B, index: TIM3_CH1..3
 *     PB10 PB11         USART3 transmit, receive
 *     PB8 PB9           CAN1 receive, transmit
 *     PC5               keeps the supply on
 *     PD2, PC9          filters of the shunt amplifiers on, of the phase voltages off
 */
#ifndef STM32F405_BOARDS_MKS84_200_HP_H
#define STM32F405_BOARDS_MKS84_200_HP_H

#include "gpio.h"

enum {
    BOARD_CRYSTAL_Hz = 8000000,
    BOARD_DEAD_TIME_LEAST_ns = 660, /* HW_DEAD_TIME_NSEC */
    BOARD_SHUNTS = BOARD_SHUNTS_IN_PHASES,
    BOARD_CURRENT_CHANNELS = 3,
    BOARD_SHUNT_nOhm = 166667, /* CURRENT_SHUNT_RES: three of 0.5 mOhm side by side */
    BOARD_AMPLIFIER_GAIN = 20,
    BOARD_CURRENT_INVERTED = 1, /* vesc6_mk3.h */
    BOARD_REFERENCE_mV = 3300,  /* V_REG */
    BOARD_DIVIDER_UPPER_Ohm = 56000,
    BOARD_DIVIDER_LOWER_Ohm = 2200,
    BOARD_SWITCH_NTC_BETA_K = 3380,
    BOARD_SWITCH_NTC_GROUND_Ohm = 10000,
    BOARD_AMPLIFIER_SETTLING_ns = 0, /* the shunts carry the current all the time */
    BOARD_CHANNEL_CURRENT_A = 10,
    BOARD_CHANNEL_CURRENT_B = 11,
    BOARD_CHANNEL_CURRENT_C = 12,
    BOARD_CHANNEL_BUS_VOLTAGE = 13,
    BOARD_CHANNEL_WINDING_TEMPERATURE = 14,
    BOARD_CHANNEL_SWITCH_TEMPERATURE = 3,
    BOARD_CHANNEL_ACCELERATOR_A = 5,
    BOARD_CHANNEL_ACCELERATOR_B = 6,
    BOARD_ENCODER_WIRED = 1,
    BOARD_CURRENT_MOST_A = 450, /* HW_LIM_CURRENT_ABS */
    BOARD_VOLTAGE_MOST_V = 87,  /* HW_LIM_VIN is 120, but the divider ends at 87.3 V */
    BOARD_DRIVER_V_DS_CODE = 0  /* none */
};

#define BOARD_CONSTANT_OUTPUTS(PIN) PIN(GPIOD, 2, true) PIN(GPIOC, 9, false)

#define BOARD_DRIVER_KIND BOARD_DRIVER_NONE
#define BOARD_GATE_HIGH_A ((pin_t){GPIOA, 8})
#define BOARD_GATE_HIGH_B ((pin_t){GPIOA, 9})
#define BOARD_GATE_HIGH_C ((pin_t){GPIOA, 10})
#define BOARD_GATE_LOW_A ((pin_t){GPIOB, 13})
#define BOARD_GATE_LOW_B ((pin_t){GPIOB, 14})
#define BOARD_GATE_LOW_C ((pin_t){GPIOB, 15})
#define BOARD_BREAK PIN_NONE
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
#define BOARD_POWER_HOLD ((pin_t){GPIOC, 5})

#endif
