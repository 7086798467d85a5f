/* SPDX-License-Identifier: Apache-2.0 */
/*
 * board.h: the wiring of a 60 V, three-shunt board of the VESC 6 class: the one place to change for
 * another board.
 *
 *     PA8 PA9 PA10      TIM1_CH1..3      high-side gates a, b, c          AF1
 *     PB13 PB14 PB15    TIM1_CH1N..3N    low-side gates a, b, c           AF1
 *     PB12              TIM1_BKIN        fault, low = switch off; pulled up, so open is healthy AF1
 *     PB5, PB7          gate driver enable (high), gate driver fault (low = fault, pulled up)
 *     PC0 PC1 PC2       ADC123_IN10..12  shunt amplifiers a, b, c, 0.5 V_ref at no current
 *     PC3               ADC123_IN13      bus voltage through a divider
 *     PA3               ADC123_IN3       switch temperature: NTC to supply, 10 kOhm to ground
 *     PC4               ADC12_IN14       winding temperature: NTC to ground, 10 kOhm to supply
 *     PA5 PA6           ADC12_IN5, IN6   pedals: accelerator a and b, 0 .. V_ref, pulled down
 *     PC6 PC7 PC8       halls A, B, C; encoder A, B, index: TIM3_CH1..3   AF2
 *     PB10 PB11         USART3 transmit, receive   AF7
 *     PB8 PB9           CAN1 receive, transmit     AF9
 *
 * Alternate functions: STM32F405 data sheet (DocID022152), table 9.
 */
#ifndef STM32F405_BOARD_H
#define STM32F405_BOARD_H

#include <stdint.h>

#include "gpio.h"

enum {
    BOARD_CRYSTAL_Hz = 8000000,
    /* Below it both switches of a leg could conduct together. Switches of this class are off within
     * 200 ns of their gate driver's input; measure your own board's before you lower it. */
    BOARD_DEAD_TIME_LEAST_ns = 300,
    BOARD_CURRENT_INVERTED = 1, /* the amplifiers' output falls with current into the motor */
    BOARD_CHANNEL_CURRENT_A = 10,
    BOARD_CHANNEL_CURRENT_B = 11,
    BOARD_CHANNEL_CURRENT_C = 12,
    BOARD_CHANNEL_BUS_VOLTAGE = 13,
    BOARD_CHANNEL_WINDING_TEMPERATURE = 14,
    BOARD_CHANNEL_SWITCH_TEMPERATURE = 3,
    BOARD_CHANNEL_ACCELERATOR_A = 5,
    BOARD_CHANNEL_ACCELERATOR_B = 6,
    BOARD_HALL_FIRST_PIN = 6 /* A; B and C are the next two, so that one read has all three */
};

enum { BOARD_AF_TIM1 = 1, BOARD_AF_TIM3 = 2, BOARD_AF_USART3 = 7, BOARD_AF_CAN1 = 9 };

#define BOARD_GATE_HIGH_A ((pin_t){GPIOA, 8})
#define BOARD_GATE_HIGH_B ((pin_t){GPIOA, 9})
#define BOARD_GATE_HIGH_C ((pin_t){GPIOA, 10})
#define BOARD_GATE_LOW_A ((pin_t){GPIOB, 13})
#define BOARD_GATE_LOW_B ((pin_t){GPIOB, 14})
#define BOARD_GATE_LOW_C ((pin_t){GPIOB, 15})
#define BOARD_BREAK ((pin_t){GPIOB, 12})
#define BOARD_DRIVER_ENABLE ((pin_t){GPIOB, 5})
#define BOARD_DRIVER_FAULT ((pin_t){GPIOB, 7})
#define BOARD_CURRENT_A ((pin_t){GPIOC, 0})
#define BOARD_CURRENT_B ((pin_t){GPIOC, 1})
#define BOARD_CURRENT_C ((pin_t){GPIOC, 2})
#define BOARD_BUS_VOLTAGE ((pin_t){GPIOC, 3})
#define BOARD_SWITCH_TEMPERATURE ((pin_t){GPIOA, 3})
#define BOARD_WINDING_TEMPERATURE ((pin_t){GPIOC, 4})
#define BOARD_ACCELERATOR_A ((pin_t){GPIOA, 5})
#define BOARD_ACCELERATOR_B ((pin_t){GPIOA, 6})
#define BOARD_HALL_PORT GPIOC
#define BOARD_ROTOR_A ((pin_t){GPIOC, 6})
#define BOARD_ROTOR_B ((pin_t){GPIOC, 7})
#define BOARD_ROTOR_C ((pin_t){GPIOC, 8})
#define BOARD_SERIAL_TRANSMIT ((pin_t){GPIOB, 10})
#define BOARD_SERIAL_RECEIVE ((pin_t){GPIOB, 11})
#define BOARD_CAN_RECEIVE ((pin_t){GPIOB, 8})
#define BOARD_CAN_TRANSMIT ((pin_t){GPIOB, 9})

#endif
