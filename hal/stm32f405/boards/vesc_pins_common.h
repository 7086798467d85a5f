/* SPDX-License-Identifier: Apache-2.0 */
/*
 * vesc_pins_common.h: the pins and the converter's channels that boards with currents of all three
 * phases have in common: VESC 6 from MK3 on, VESC 75/300, MKS 84200 HP, and gate_board.h. Sources
 * are in each board's header, with what differs.
 *
 *     PA8 PA9 PA10      TIM1_CH1..3      high-side gates a, b, c
 *     PB13 PB14 PB15    TIM1_CH1N..3N    low-side gates a, b, c
 *     PC0 PC1 PC2       ADC123_IN10..12  currents a, b, c, 0.5 V_ref at no current
 *     PC3               ADC123_IN13      bus voltage
 *     PA3               ADC123_IN3       switch temperature: NTC to supply, 10 kOhm to ground
 *     PC4               ADC12_IN14       winding temperature: sensor to ground, 10 kOhm to supply
 *     PA5 PA6           ADC12_IN5, IN6   accelerator a and b, 0 .. V_ref
 *     PC6 PC7 PC8       halls A, B, C; encoder A, B, index: TIM3_CH1..3
 *     PB10 PB11         USART3 transmit, receive
 *     PB8 PB9           CAN1 receive, transmit
 */
#ifndef STM32F405_BOARDS_VESC_PINS_COMMON_H
#define STM32F405_BOARDS_VESC_PINS_COMMON_H

#include "gpio.h"

enum {
    BOARD_SHUNTS = BOARD_SHUNTS_IN_PHASES,
    BOARD_CURRENT_CHANNELS = 3,
    BOARD_SWITCH_NTC_GROUND_Ohm = 10000,
    BOARD_AMPLIFIER_SETTLING_ns = 0, /* the current is measured all the time */
    BOARD_CHANNEL_CURRENT_A = 10,
    BOARD_CHANNEL_CURRENT_B = 11,
    BOARD_CHANNEL_CURRENT_C = 12,
    BOARD_CHANNEL_BUS_VOLTAGE = 13,
    BOARD_CHANNEL_WINDING_TEMPERATURE = 14,
    BOARD_CHANNEL_SWITCH_TEMPERATURE = 3,
    BOARD_CHANNEL_ACCELERATOR_A = 5,
    BOARD_CHANNEL_ACCELERATOR_B = 6,
    BOARD_ENCODER_WIRED = 1
};

#define BOARD_GATE_HIGH_A ((pin_t){GPIOA, 8})
#define BOARD_GATE_HIGH_B ((pin_t){GPIOA, 9})
#define BOARD_GATE_HIGH_C ((pin_t){GPIOA, 10})
#define BOARD_GATE_LOW_A ((pin_t){GPIOB, 13})
#define BOARD_GATE_LOW_B ((pin_t){GPIOB, 14})
#define BOARD_GATE_LOW_C ((pin_t){GPIOB, 15})
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

#endif
