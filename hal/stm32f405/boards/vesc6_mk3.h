/* SPDX-License-Identifier: Apache-2.0 */
/*
 * vesc6_mk3.h: VESC 6 MK3, MK4 and MK5: 60 V, phase shunts, DRV8301.
 *
 * Source: the VESC firmware's hwconf/trampa/vesc6/hw_60_core.h and .c (vedderb/bldc on GitHub,
 * commit 6106081), hwconf/hw.h for CAN, motor/mcpwm_foc.c for the amplifiers' sign: it modulates
 * the negated voltage vector, so its codes fall with current into the motor. Of what is used here
 * MK3, MK4 and MK5 have the same.
 *
 * Pins: vesc_pins_common.h, and
 *     PB5, PB7          gate driver: enable, fault
 *     PB4 PB3 PC10 PC9  gate driver's serial bus, by software: SDI, SDO, SCLK, nSCS
 *     PC0 PC1 PC2       ADC123_IN10..12  shunt amplifiers a, b, c, 0.5 V_ref at no current
 *     PC3               ADC123_IN13      bus voltage, 39 kOhm and 2.2 kOhm
 *     PC4               ADC12_IN14       winding temperature: NTC to ground, 10 kOhm to supply
 *     PC5               keeps the supply on
 *     PD2               switches the filters of the shunt amplifiers on
 *
 * TIM1's break input, PB12, is wired to the radio here, so it is not used.
 */
#ifndef STM32F405_BOARDS_VESC6_MK3_H
#define STM32F405_BOARDS_VESC6_MK3_H

#include "boards/vesc6_common.h"

/* PIN(port, number, level): driven so from the start on. */
#define BOARD_CONSTANT_OUTPUTS(PIN) PIN(GPIOD, 2, true)

#endif
