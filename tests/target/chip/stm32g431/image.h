/* SPDX-License-Identifier: Apache-2.0 */
/* image.h: the vehicle of the image on this chip: a hub wheel at six cells, whose board has no
 * input for a winding sensor, so that the controller drives with a warning. */
#ifndef CHIP_IMAGE_H
#define CHIP_IMAGE_H

#include "vehicle_fixture.h"

#define IMAGE_CHIP "STM32G431"
#define IMAGE_SPEED_M_PER_S 1.9
#define IMAGE_BRAKE_NM 4.0
#define IMAGE_SMALL_BRAKE_NM 2.0
#define IMAGE_OTHER_BRAKES_NM                                                                      \
    {                                                                                              \
        4.0, 2.5, 1.0                                                                              \
    }
#define IMAGE_SLOPE 0.5 /* 4 N m at the wheel */
#define IMAGE_DRIVE_NM 1.5
#define IMAGE_HAS_FAULT_LINE false
#define IMAGE_SPEED_RAD_S 23.1 /* at that speed, rounded up */
#define IMAGE_MODE MODE_RUN
#define IMAGE_HAS_XCP false
#define IMAGE_SENDS_VESC_STATUS false
#define IMAGE_REPORTS_BROWN_OUT false    /* its flash can be read down to its own reset */
#define IMAGE_BROWN_OUT_HAS_A_FLAG false /* the supply's */
#define IMAGE_OPTION_BYTES_RESET true
#define IMAGE_RAM_BYTES 0x8000U
#define IMAGE_BEGINS 0x08000000U /* of the program, hal/stm32g431/link.ld */
#define IMAGE_BYTES 0x1B000U
#define IMAGE_STACK_BYTES 3328U /* reserved, with the guard: hal/stm32g431/CMakeLists.txt */
/* Flash without a sector of the application that the protection unit's eighths leave writable: the
 * end of the program. */
#define IMAGE_OPEN_BEGINS 0x08018000U
#define IMAGE_OPEN_ENDS 0x0801B000U
#define IMAGE_CONFIGURATION_BEGINS 0x0801B000U
#define IMAGE_JOURNAL_A 0x0801F000U
#define IMAGE_JOURNAL_B 0x0801F800U
#define IMAGE_JOURNAL_ENDS 0x08020000U
#define IMAGE_HOLDS_SUPPLY false

static inline bench_params_t image_vehicle(void)
{
    bench_params_t params = fixture_drive("wheel24v");
    params.winding_sensor.open = 1.0;
    return params;
}

static inline config_t image_config(void)
{
    return fixture_drive_config("wheel24v");
}

#endif
