/* SPDX-License-Identifier: Apache-2.0 */
/*
 * b_g431b_esc1.h: ST's B-G431B-ESC1: 25 V, three low-side shunts on the chip's own amplifiers,
 * L6387 gate drivers.
 *
 * Source: NuttX, boards/arm/stm32/b-g431b-esc1 (apache/nuttx on GitHub: README.txt, include/board.h
 * and src/stm32_foc.c, after ST's UM2516) for pins, shunts, gain, sign, divider and the 40 A and
 * 25 V. The Arduino core's variant_B_G431B_ESC1.h for PC11 and PC14. FOC-Stim (diglet48/FOC-Stim,
 * src/bsp and src/utils.cpp) for the thermistor. The amplifiers' network: the board's schematic as
 * quoted in the SimpleFOC forum, thread 521. What has no such source is marked below; README lists
 * it as to be verified.
 *
 *     PA8 PA9 PA10      TIM1_CH1..3      high-side gates a, b, c
 *     PC13 PA12 PB15    TIM1_CH1N..3N    low-side gates a, b, c
 *     PA1 PA3, PA2      OPAMP1 inputs, output: ADC1_IN3     current a
 *     PA7 PA5, PA6      OPAMP2 inputs, output: ADC2_IN3     current b
 *     PB0 PB2, PB1      OPAMP3, current c: not used, there are two converters
 *     PA1, PA7, PB0     COMP1, COMP2, COMP4 as well: over-current of a, b, c
 *     PA0               ADC1_IN1         bus voltage, 169 kOhm and 18 kOhm
 *     PB14              ADC1_IN5         switch temperature: NTC to supply, 4.7 kOhm to ground
 *     PB12              ADC1_IN11        the board's potentiometer: accelerator a
 *     PB6 PB7 PB8       halls A, B, C; encoder A, B, index: TIM4_CH1..3
 *     PB3 PB4           USART2 transmit, receive: the debug probe's virtual port
 *     PA11 PB9          FDCAN1 receive, transmit
 *     PC11, PC14        CAN transceiver: shutdown (active high), termination
 *
 * Winding temperature, second accelerator track and brake pedal have no input here.
 */
#ifndef STM32G431_BOARDS_B_G431B_ESC1_H
#define STM32G431_BOARDS_B_G431B_ESC1_H

#include "gpio.h"

enum {
    BOARD_CRYSTAL_Hz = 8000000,
    /* NuttX takes 500 ns; the driver adds none of its own that could be relied on. */
    BOARD_DEAD_TIME_LEAST_ns = 500,
    BOARD_SHUNT_nOhm = 3000000,
    /* Amplifier 16, and the network before it takes 4/7: 64/7, SimpleFOC's figure as well. */
    BOARD_AMPLIFIER_GAIN_NUMERATOR = 64,
    BOARD_AMPLIFIER_GAIN_DENOMINATOR = 7,
    BOARD_CURRENT_INVERTED = 1, /* the amplifiers' output falls with current into the motor */
    /* The network alone, before the amplifiers and the comparators: from the shunt, to ground, to
     * the reference. It takes 4/7 of the shunt's voltage, on a level of 128.6 mV; one board was
     * measured with 128 mV. Within the limits lie its resistors' 1 % and a comparator's offset. */
    BOARD_NETWORK_SHUNT_Ohm = 1500,
    BOARD_NETWORK_GROUND_Ohm = 2200,
    BOARD_NETWORK_REFERENCE_Ohm = 22000,
    BOARD_NETWORK_NUMERATOR = 4,
    BOARD_NETWORK_DENOMINATOR = 7,
    BOARD_NETWORK_LEVEL_LEAST_mV = 100,
    BOARD_NETWORK_LEVEL_MOST_mV = 160,
    /* The amplifiers' output without current lies between half of the reference and 16 times that
     * level, 2 553: README, Zero current. */
    BOARD_CURRENT_ZERO_CODE = 2304,
    /* For monitor.offset_tolerance_codes: the third current is minus the sum of two (README). */
    BOARD_OFFSET_TOLERANCE_codes = 800,
    /* In a shunt to ground: a quarter above the board's 40 A, within full scale. */
    BOARD_TRIP_A = 50,
    BOARD_REFERENCE_mV = 3300,
    BOARD_DIVIDER_UPPER_Ohm = 169000,
    BOARD_DIVIDER_LOWER_Ohm = 18000,
    /* FOC-Stim, src/bsp: measured 1.3 us after a switch is off. */
    BOARD_AMPLIFIER_SETTLING_ns = 1300,
    BOARD_SWITCH_NTC_BETA_K = 3425, /* 10 kOhm at 25 C, to the supply: FOC-Stim */
    BOARD_SWITCH_NTC_GROUND_Ohm = 4700,
    BOARD_CHANNEL_CURRENT_A = 3,
    BOARD_CHANNEL_CURRENT_B = 3,
    BOARD_CHANNEL_BUS_VOLTAGE = 1,
    BOARD_CHANNEL_SWITCH_TEMPERATURE = 5,
    BOARD_CHANNEL_ACCELERATOR_A = 11,
    BOARD_ENCODER_WIRED = 1,
    BOARD_CURRENT_MOST_A = 40,
    BOARD_VOLTAGE_MOST_V = 25,
    /* STM32G431xB data sheet (DS12589), table 13; all, and the converters' channels, as in the
     * Arduino core's variants/STM32G4xx/G431C(6-8-B)U_G441CBU/PeripheralPins.c, made of the
     * vendor's pin data. */
    BOARD_AF_GATES_HIGH = 6,
    BOARD_AF_GATE_LOW_A = 4,
    BOARD_AF_GATE_LOW_B = 6,
    BOARD_AF_GATE_LOW_C = 4,
    BOARD_AF_BREAK = 6,
    BOARD_AF_ENCODER = 2,
    BOARD_AF_SERIAL = 7,
    BOARD_AF_CAN = 9
};

/* PIN(port, number, level): driven so from the start on. The termination is off: whoever ends the
 * bus switches it on here. */
#define BOARD_CONSTANT_OUTPUTS(PIN) PIN(GPIOC, 11, false) PIN(GPIOC, 14, false)

#define BOARD_GATE_HIGH_A ((pin_t){GPIOA, 8})
#define BOARD_GATE_HIGH_B ((pin_t){GPIOA, 9})
#define BOARD_GATE_HIGH_C ((pin_t){GPIOA, 10})
#define BOARD_GATE_LOW_A ((pin_t){GPIOC, 13})
#define BOARD_GATE_LOW_B ((pin_t){GPIOA, 12})
#define BOARD_GATE_LOW_C ((pin_t){GPIOB, 15})
#define BOARD_BREAK PIN_NONE
#define BOARD_CURRENT_A_IN ((pin_t){GPIOA, 1})
#define BOARD_CURRENT_A_BIAS ((pin_t){GPIOA, 3})
#define BOARD_CURRENT_A_OUT ((pin_t){GPIOA, 2})
#define BOARD_CURRENT_B_IN ((pin_t){GPIOA, 7})
#define BOARD_CURRENT_B_BIAS ((pin_t){GPIOA, 5})
#define BOARD_CURRENT_B_OUT ((pin_t){GPIOA, 6})
#define BOARD_CURRENT_C_IN ((pin_t){GPIOB, 0})
#define BOARD_BUS_VOLTAGE ((pin_t){GPIOA, 0})
#define BOARD_SWITCH_TEMPERATURE ((pin_t){GPIOB, 14})
#define BOARD_ACCELERATOR_A ((pin_t){GPIOB, 12})
#define BOARD_ROTOR_A ((pin_t){GPIOB, 6})
#define BOARD_ROTOR_B ((pin_t){GPIOB, 7})
#define BOARD_ROTOR_C ((pin_t){GPIOB, 8})
#define BOARD_SERIAL_TRANSMIT ((pin_t){GPIOB, 3})
#define BOARD_SERIAL_RECEIVE ((pin_t){GPIOB, 4})
#define BOARD_CAN_RECEIVE ((pin_t){GPIOA, 11})
#define BOARD_CAN_TRANSMIT ((pin_t){GPIOB, 9})
#define BOARD_POWER_HOLD PIN_NONE

#endif
