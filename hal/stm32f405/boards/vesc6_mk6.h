/* SPDX-License-Identifier: Apache-2.0 */
/*
 * vesc6_mk6.h: VESC 6 MK6: as MK3 (vesc6_mk3.h), and PA4 chooses the supply of the sensor port,
 * low 3.3 V, high 5 V. It is left at 3.3 V, as that firmware does.
 *
 * Source: as vesc6_mk3.h (SENSOR_VOLTAGE_PIN). Not for the MK6 HP, whose shunts have 0.3 mOhm, and
 * not for the MK6 MAX, whose amplifiers have their reference from the converter of PA4.
 */
#ifndef STM32F405_BOARDS_VESC6_MK6_H
#define STM32F405_BOARDS_VESC6_MK6_H

#include "boards/vesc6_common.h"

#define BOARD_CONSTANT_OUTPUTS(PIN) PIN(GPIOD, 2, true) PIN(GPIOA, 4, false)

#endif
