/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hoverboard.h: mainboard of a self-balancing scooter with an STM32F103RC: 36 V, two motors.
 *
 * There is no port for this chip, because its core is too slow (hal/README.md): nothing is built
 * from this file but a test of it. It is here for whoever makes one, with another split of the work
 * or a faster chip on the same board (GD32F103, 108 MHz).
 *
 * Source: EFeru's FOC firmware for these boards on GitHub, Inc/defines.h (commit 0527bd7) and
 * Inc/config.h, for pins, divider and amperes a code. TIM1 and TIM8 are on these pins without a
 * remap (STM32F103xC data sheet, table 5).
 *
 *     right motor, M1                      left motor, M2
 *     PA8  PA9  PA10   TIM1_CH1..3         PC6  PC7  PC8   TIM8_CH1..3     high sides a, b, c
 *     PB13 PB14 PB15   TIM1_CH1N..3N       PA7  PB0  PB1   TIM8_CH1N..3N   low sides a, b, c
 *     PC4  PC5         ADC12_IN14, IN15    PA0  PC3        ADC_IN0, IN13   two currents
 *     PC1              ADC123_IN11         PC0             ADC123_IN10     current from the battery
 *     PC10 PC11 PC12                       PB5  PB6  PB7                   halls A, B, C
 *     PC2              ADC123_IN12         bus voltage, 30 kOhm and 1 kOhm
 *     PA5, PA1, PA12                       power hold, button, charger plugged in
 *     PA2  PA3,  PB10 PB11                 USART2 and USART3, on the cables of the sensor boards
 *
 * No CAN, no fault line of the gate drivers, no break input.
 */
#ifndef STM32F103_BOARDS_HOVERBOARD_H
#define STM32F103_BOARDS_HOVERBOARD_H

enum {
    BOARD_CRYSTAL_Hz = 0, /* none used: 64 MHz from the 8 MHz oscillator, 8/2 times 16 */
    BOARD_CLOCK_Hz = 64000000,
    BOARD_FLASH_BYTES = 256 * 1024,
    BOARD_RAM_BYTES = 48 * 1024,
    BOARD_MOTORS = 2,
    BOARD_CURRENT_CHANNELS = 2, /* a motor; the third current is minus their sum */
    BOARD_CURRENT_uA_PER_CODE = 20000,
    BOARD_REFERENCE_mV = 3300,
    BOARD_DIVIDER_UPPER_Ohm = 30000,
    BOARD_DIVIDER_LOWER_Ohm = 1000
};

/* PIN(port, number) is what the port's gpio.h makes of a pin. */
#define BOARD_M1_GATE_HIGH_A PIN(A, 8)
#define BOARD_M1_GATE_HIGH_B PIN(A, 9)
#define BOARD_M1_GATE_HIGH_C PIN(A, 10)
#define BOARD_M1_GATE_LOW_A PIN(B, 13)
#define BOARD_M1_GATE_LOW_B PIN(B, 14)
#define BOARD_M1_GATE_LOW_C PIN(B, 15)
#define BOARD_M1_CURRENT_FIRST PIN(C, 4)
#define BOARD_M1_CURRENT_SECOND PIN(C, 5)
#define BOARD_M1_CURRENT_BATTERY PIN(C, 1)
#define BOARD_M1_ROTOR_A PIN(C, 10)
#define BOARD_M1_ROTOR_B PIN(C, 11)
#define BOARD_M1_ROTOR_C PIN(C, 12)
#define BOARD_M2_GATE_HIGH_A PIN(C, 6)
#define BOARD_M2_GATE_HIGH_B PIN(C, 7)
#define BOARD_M2_GATE_HIGH_C PIN(C, 8)
#define BOARD_M2_GATE_LOW_A PIN(A, 7)
#define BOARD_M2_GATE_LOW_B PIN(B, 0)
#define BOARD_M2_GATE_LOW_C PIN(B, 1)
#define BOARD_M2_CURRENT_FIRST PIN(A, 0)
#define BOARD_M2_CURRENT_SECOND PIN(C, 3)
#define BOARD_M2_CURRENT_BATTERY PIN(C, 0)
#define BOARD_M2_ROTOR_A PIN(B, 5)
#define BOARD_M2_ROTOR_B PIN(B, 6)
#define BOARD_M2_ROTOR_C PIN(B, 7)
#define BOARD_BUS_VOLTAGE PIN(C, 2)
#define BOARD_SERIAL_TRANSMIT PIN(B, 10)
#define BOARD_SERIAL_RECEIVE PIN(B, 11)
#define BOARD_POWER_HOLD PIN(A, 5)
#define BOARD_BUTTON PIN(A, 1)
#define BOARD_CHARGER PIN(A, 12)

#endif
