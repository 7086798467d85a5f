/* SPDX-License-Identifier: Apache-2.0 */
/*
 * overcurrent.h: TIM1's second break input from the chip's comparators at the three shunts, for
 * inverter.c: a current to ground beyond BOARD_TRIP_A takes all gates without software (README,
 * Over-current).
 */
#ifndef STM32G431_OVERCURRENT_H
#define STM32G431_OVERCURRENT_H

#include <stdbool.h>
#include <stdint.h>

#include "registers/tim.h"

/* Of BDTR: enabled, active high, after 64 clocks of 170 MHz, 0.38 us. Of SR: it has acted. */
enum { OVERCURRENT_FILTER = 9 };
#define OVERCURRENT_BREAK                                                                          \
    (TIM_BDTR_BK2E | TIM_BDTR_BK2P | (uint32_t)OVERCURRENT_FILTER << TIM_BDTR_BK2F_Pos)
#define OVERCURRENT_FLAG TIM_SR_B2IF

/* Connects comparators and timer. Before BDTR is written: its lock covers this. */
void overcurrent_connect(void);

/* Finds the comparators' level without current and sets the thresholds that far above it. False if
 * a comparator does not answer to its threshold, the level is not the board's, or a setting does
 * not read back. The bridge is off, the wheel without current. Background context, once; 0.3 ms. */
bool overcurrent_start(void);

#endif
