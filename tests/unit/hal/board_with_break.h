/* SPDX-License-Identifier: Apache-2.0 */
/* board_with_break.h: a board that wires TIM1's break input, which none of hal/stm32f405/boards
 * does. */
#ifndef BOARD_WITH_BREAK_H
#define BOARD_WITH_BREAK_H

#include "boards/vesc6_mk3.h"

#undef BOARD_BREAK
#define BOARD_BREAK ((pin_t){GPIOB, 12})

#endif
