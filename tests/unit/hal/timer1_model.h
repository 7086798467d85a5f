/* SPDX-License-Identifier: Apache-2.0 */
/*
 * timer1_model.h: TIM1 of the STM32F405 and the circuits connected to it, as far as
 * hal/stm32/inverter.c uses it, on a host: memory at the chip's addresses, and the rules of
 * RM0090 section 17 by which it changes.
 *
 *     update     the repetition counter counts ends of the count; at 0 it is loaded from RCR, the
 *                preloaded compare values become active and UIF is set (17.3.2, 17.3.3)
 *     outputs    table "Output control bits for complementary OCx and OCxN channels with
 *                break feature" (17.4.9)
 *     break      BKIN low with BKE = 1, BKP = 0 sets BIF and clears MOE for as long as it lasts
 *                (17.3.12)
 *     SR         a flag is cleared by writing 0; writing 1 leaves it
 *     TIM8       counts up with TIM1's clock; its overflow sets UIF and, with UDE = 1 and DMA2's
 *                stream 1 on for it, clears MOE as the transferred word does (17.4, 10.3)
 *
 * Steps are half periods. Memory does not detect a write, so timer1_settle() computes its effect on
 * SR and MOE.
 */
#ifndef TIMER1_MODEL_H
#define TIMER1_MODEL_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    bool high[3]; /* gates of the high sides a, b, c are driven on */
    bool low[3];
} gates_t;

/* Reset values, pins at their resting levels, no break. */
void timer1_reset(void);

/* From now on the pin is at that level. */
void timer1_set_break_pin(bool high);
void timer1_set_driver_fault_pin(bool high);

/* The break input rises only so many half periods after the next reset, as one with a slow pull-up
 * does. */
void timer1_break_rises_after(uint32_t half_periods);

/* Stops the counter independently of CEN: a timer without its clock. */
void timer1_stop_clock(void);

void timer1_half_period(void);
void timer1_settle(void);

/* Has the latest half period ended at the top, and did it bring an update? */
bool timer1_at_top(void);
bool timer1_updated(void);

/* Gate signals while the count is at this value. */
gates_t timer1_gates(uint32_t count);

#endif
