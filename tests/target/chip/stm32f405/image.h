/* SPDX-License-Identifier: Apache-2.0 */
/* image.h: the vehicle of the image on this chip: a quarter of the paper's. */
#ifndef CHIP_IMAGE_H
#define CHIP_IMAGE_H

#include "vehicle_fixture.h"

#define IMAGE_CHIP "STM32F405"
#define IMAGE_SPEED_M_PER_S 2.5
#define IMAGE_BRAKE_NM 90.0
#define IMAGE_SMALL_BRAKE_NM 20.0
#define IMAGE_OTHER_BRAKES_NM                                                                      \
    {                                                                                              \
        180.0, 60.0                                                                                \
    }
#define IMAGE_SLOPE 0.12 /* 49 N m at the wheel */
#define IMAGE_DRIVE_NM 10.0
/* Where the voltage is the largest and the low pulses the shortest: a back-EMF of 31 V. */
#define IMAGE_FAST_M_PER_S 16.5
#define IMAGE_HAS_FAULT_LINE true
#define IMAGE_SPEED_RAD_S 9.0 /* at that speed, rounded up */
#define IMAGE_MODE MODE_RUN
#define IMAGE_HAS_XCP true
#define IMAGE_SENDS_VESC_STATUS true
#define IMAGE_REPORTS_BROWN_OUT true
#define IMAGE_BROWN_OUT_HAS_A_FLAG true
#define IMAGE_OPTION_BYTES_RESET false
#define IMAGE_RAM_BYTES 0x20000U
#define IMAGE_BEGINS 0x08020000U /* of the program, hal/stm32f405/link.ld */
#define IMAGE_BYTES 0xE0000U
#define IMAGE_STACK_BYTES 2560U /* reserved, with the guard: hal/stm32f405/CMakeLists.txt */
/* Flash without a sector of the application that the protection unit's eighths leave writable: the
 * first sector. */
#define IMAGE_OPEN_BEGINS 0x08000000U
#define IMAGE_OPEN_ENDS 0x08004000U
#define IMAGE_CONFIGURATION_BEGINS 0x08004000U
#define IMAGE_JOURNAL_A 0x0800C000U
#define IMAGE_JOURNAL_B 0x08010000U
#define IMAGE_JOURNAL_ENDS 0x08020000U
#define IMAGE_HOLDS_SUPPLY true /* by PC5 */

static inline bench_params_t image_vehicle(void)
{
    return fixture_quarter_vehicle();
}

static inline config_t image_config(void)
{
    return fixture_config(CONFIG_STRATEGY_SERIES_OPTIMAL);
}

#endif
