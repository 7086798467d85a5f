/* SPDX-License-Identifier: Apache-2.0 */
/* no_driver_common.h: of boards whose gate drivers the controller neither sets nor reads. */
#ifndef STM32F405_BOARDS_NO_DRIVER_COMMON_H
#define STM32F405_BOARDS_NO_DRIVER_COMMON_H

#include "gpio.h"

enum { BOARD_DRIVER_V_DS_CODE = 0 };

#define BOARD_DRIVER_KIND BOARD_DRIVER_NONE
#define BOARD_DRIVER_ENABLE PIN_NONE
#define BOARD_DRIVER_FAULT PIN_NONE
#define BOARD_DRIVER_SDI PIN_NONE
#define BOARD_DRIVER_SDO PIN_NONE
#define BOARD_DRIVER_CLOCK PIN_NONE
#define BOARD_DRIVER_SELECT PIN_NONE

#endif
