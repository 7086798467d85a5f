/* SPDX-License-Identifier: Apache-2.0 */
/* vesc6_common.h: what the revisions of the VESC 6 from MK3 on have in common (vesc6_mk3.h, with
 * its sources). */
#ifndef STM32F405_BOARDS_VESC6_COMMON_H
#define STM32F405_BOARDS_VESC6_COMMON_H

#include "gpio.h"

enum {
    BOARD_CRYSTAL_Hz = 8000000,
    /* Below it both switches of a leg could conduct together. Switches of this class are off within
     * 200 ns of their gate driver's input; VESC takes 360 ns. Measure before you lower it. */
    BOARD_DEAD_TIME_LEAST_ns = 300,
    BOARD_SHUNTS = BOARD_SHUNTS_IN_PHASES,
    BOARD_CURRENT_CHANNELS = 3,
    BOARD_SHUNT_nOhm = 500000,
    BOARD_AMPLIFIER_GAIN = 20,
    BOARD_CURRENT_INVERTED = 1, /* the amplifiers' output falls with current into the motor */
    BOARD_REFERENCE_mV = 3300,
    BOARD_DIVIDER_UPPER_Ohm = 39000,
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
    BOARD_CURRENT_MOST_A = 160, /* HW_LIM_CURRENT_ABS */
    BOARD_VOLTAGE_MOST_V = 60,  /* the DRV8301's supply, SLOS719 */
    /* Switches of 1 to 1.5 mOhm, 1.6 times that when hot: an estimate, no part is named. The code
     * is the lowest above 160 A through them; it is VESC's own default as well. */
    BOARD_SWITCH_HOT_uOhm = 2400,
    BOARD_DRIVER_V_DS_CODE = 16
};

#define BOARD_DRIVER_KIND BOARD_DRIVER_DRV8301
#define BOARD_GATE_HIGH_A ((pin_t){GPIOA, 8})
#define BOARD_GATE_HIGH_B ((pin_t){GPIOA, 9})
#define BOARD_GATE_HIGH_C ((pin_t){GPIOA, 10})
#define BOARD_GATE_LOW_A ((pin_t){GPIOB, 13})
#define BOARD_GATE_LOW_B ((pin_t){GPIOB, 14})
#define BOARD_GATE_LOW_C ((pin_t){GPIOB, 15})
#define BOARD_BREAK PIN_NONE
#define BOARD_DRIVER_ENABLE ((pin_t){GPIOB, 5})
#define BOARD_DRIVER_FAULT ((pin_t){GPIOB, 7})
#define BOARD_DRIVER_SDI ((pin_t){GPIOB, 4})
#define BOARD_DRIVER_SDO ((pin_t){GPIOB, 3})
#define BOARD_DRIVER_CLOCK ((pin_t){GPIOC, 10})
#define BOARD_DRIVER_SELECT ((pin_t){GPIOC, 9})
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
