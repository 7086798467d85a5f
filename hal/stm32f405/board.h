/* SPDX-License-Identifier: Apache-2.0 */
/*
 * board.h: the board that this image is for, as data: boards/NAME.h, which the build chooses
 * (tools/dev firmware --board NAME).
 *
 * Alternate functions: STM32F405 data sheet (DocID022152), table 9; channels and pins of the
 * converters: table 7. All that the boards use, as in the Arduino core's
 * variants/STM32F4xx/F405RGT_F415RGT/PeripheralPins.c, made of the vendor's pin data.
 */
#ifndef STM32F405_BOARD_H
#define STM32F405_BOARD_H

#include <stdint.h>

#include "gpio.h"

/* Where the shunts are: in the phases, which carry the current all the time, or between the low
 * sides and ground, which carry it while the low side conducts. */
#define BOARD_SHUNTS_LOW_SIDE 0
#define BOARD_SHUNTS_IN_PHASES 1
#define BOARD_DRIVER_DRV8301 1
#define BOARD_DRIVER_DRV8302 2
#define BOARD_DRIVER_NONE 3 /* no line to or from it but the gates */
#define BOARD_CHANNEL_NONE 255

#ifndef HUBFOC_BOARD_HEADER
#define HUBFOC_BOARD_HEADER "boards/vesc6_mk3.h"
#endif
#include HUBFOC_BOARD_HEADER

enum {
    BOARD_AF_TIM1 = 1,
    BOARD_AF_TIM3 = 2,
    BOARD_AF_GATES_HIGH = BOARD_AF_TIM1,
    BOARD_AF_GATE_LOW_A = BOARD_AF_TIM1,
    BOARD_AF_GATE_LOW_B = BOARD_AF_TIM1,
    BOARD_AF_GATE_LOW_C = BOARD_AF_TIM1,
    BOARD_AF_BREAK = BOARD_AF_TIM1,
    BOARD_AF_ENCODER = BOARD_AF_TIM3,
    BOARD_AF_SERIAL = 7,
    BOARD_AF_CAN1 = 9
};

/* The timer whose inputs an encoder's pins are. */
#define ENCODER TIM3

enum {
    /* Codes span the reference: half of it either way for a current, all of it for the voltage. */
    BOARD_CURRENT_FULL_SCALE_mA =
        (int)((int64_t)BOARD_REFERENCE_mV * 500000000 / (BOARD_SHUNT_nOhm * BOARD_AMPLIFIER_GAIN)),
    BOARD_VOLTAGE_FULL_SCALE_mV =
        (int)((int64_t)BOARD_REFERENCE_mV * (BOARD_DIVIDER_UPPER_Ohm + BOARD_DIVIDER_LOWER_Ohm) /
              BOARD_DIVIDER_LOWER_Ohm),
    /* A thermistor of 10 kOhm at 25 degrees Celsius to the supply. */
    BOARD_SWITCH_25C_code =
        4096 * BOARD_SWITCH_NTC_GROUND_Ohm / (BOARD_SWITCH_NTC_GROUND_Ohm + 10000)
};

_Static_assert(BOARD_CURRENT_CHANNELS == 2 || BOARD_CURRENT_CHANNELS == 3,
               "shunts of two or three");
_Static_assert((BOARD_CURRENT_CHANNELS == 3) == (BOARD_CHANNEL_CURRENT_B != BOARD_CHANNEL_NONE),
               "of two currents it is b that is missing");
_Static_assert(BOARD_SHUNTS == BOARD_SHUNTS_IN_PHASES || BOARD_AMPLIFIER_SETTLING_ns > 0,
               "amplifiers of low-side shunts settle in every period");
_Static_assert(BOARD_CURRENT_FULL_SCALE_mA / 1000 >= BOARD_CURRENT_MOST_A,
               "the amplifiers show what the board may carry");
/* V_DS at which the DRV8301 trips, by OC_ADJ_SET (SLOS719, table 13; the same in the DRV8301-Q1's
 * SLOS842, table 10), within 20 %. */
#define BOARD_V_DS_mV(code)                                                                        \
    ((code) == 14   ? 317                                                                          \
     : (code) == 15 ? 358                                                                          \
     : (code) == 16 ? 403                                                                          \
     : (code) == 17 ? 454                                                                          \
     : (code) == 18 ? 511                                                                          \
     : (code) == 19 ? 576                                                                          \
                    : 0)
#if BOARD_DRIVER_KIND == BOARD_DRIVER_DRV8301
_Static_assert(BOARD_V_DS_mV(BOARD_DRIVER_V_DS_CODE) * 1000 >=
                       BOARD_CURRENT_MOST_A * BOARD_SWITCH_HOT_uOhm &&
                   BOARD_V_DS_mV(BOARD_DRIVER_V_DS_CODE - 1) * 1000 <
                       BOARD_CURRENT_MOST_A * BOARD_SWITCH_HOT_uOhm,
               "the lowest threshold that lets the largest current pass through hot switches");
#endif
_Static_assert(BOARD_CHANNEL_CURRENT_A != BOARD_CHANNEL_CURRENT_C &&
                   BOARD_CHANNEL_CURRENT_A != BOARD_CHANNEL_CURRENT_B &&
                   BOARD_CHANNEL_CURRENT_B != BOARD_CHANNEL_CURRENT_C,
               "a channel for each current");

#endif
