/* SPDX-License-Identifier: Apache-2.0 */
/* vesc6_common.h: what the revisions of the VESC 6 from MK3 on have in common (vesc6_mk3.h, with
 * its sources). */
#ifndef STM32F405_BOARDS_VESC6_COMMON_H
#define STM32F405_BOARDS_VESC6_COMMON_H

#include "boards/vesc_pins_common.h"

enum {
    BOARD_CRYSTAL_Hz = 8000000,
    /* Below it both switches of a leg could conduct together. HW_DEAD_TIME_NSEC where a board sets
     * none, motor/mc_interface.h (vesc6_mk3.h). Measure before you lower it. */
    BOARD_DEAD_TIME_LEAST_ns = 360,
    BOARD_SHUNT_nOhm = 500000,
    BOARD_AMPLIFIER_GAIN = 20,
    BOARD_CURRENT_INVERTED = 1, /* the amplifiers' output falls with current into the motor */
    BOARD_REFERENCE_mV = 3300,
    BOARD_DIVIDER_UPPER_Ohm = 39000,
    BOARD_DIVIDER_LOWER_Ohm = 2200,
    BOARD_SWITCH_NTC_BETA_K = 3380,
    BOARD_CURRENT_MOST_A = 160, /* HW_LIM_CURRENT_ABS */
    BOARD_VOLTAGE_MOST_V = 60,  /* the DRV8301's supply, SLOS719 */
    /* Switches of 1 to 1.5 mOhm, 1.6 times that when hot: an estimate, no part is named. The code
     * is the lowest above 160 A through them; it is VESC's own default as well. */
    BOARD_SWITCH_HOT_uOhm = 2400,
    BOARD_DRIVER_V_DS_CODE = 16
};

#define BOARD_DRIVER_KIND BOARD_DRIVER_DRV8301
#define BOARD_BREAK PIN_NONE
#define BOARD_DRIVER_ENABLE ((pin_t){GPIOB, 5})
#define BOARD_DRIVER_FAULT ((pin_t){GPIOB, 7})
#define BOARD_DRIVER_SDI ((pin_t){GPIOB, 4})
#define BOARD_DRIVER_SDO ((pin_t){GPIOB, 3})
#define BOARD_DRIVER_CLOCK ((pin_t){GPIOC, 10})
#define BOARD_DRIVER_SELECT ((pin_t){GPIOC, 9})
#define BOARD_POWER_HOLD ((pin_t){GPIOC, 5})

#endif
