/* SPDX-License-Identifier: Apache-2.0 */
#include "timer1_model.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "board.h"
#include "modelled_wait.h"
#include "registers/dma.h"
#include "registers/rcc.h"
#include "registers/tim.h"

enum { PERIPHERALS = 0x40000000, PERIPHERALS_BYTES = 0x30000 };

dbgmcu_registers_t modelled_debugger;

static struct {
    uint32_t flags; /* what SR really holds */
    uint32_t repetitions;
    uint32_t compare[3]; /* active */
    uint32_t break_rises_after;
    bool break_high, stopped, at_top, updated;
} timer;

static void map_peripherals(void)
{
    void *const got = mmap((void *)(uintptr_t)PERIPHERALS, PERIPHERALS_BYTES,
                           PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0);
    if (got == MAP_FAILED) {
        abort();
    }
}

static void set_pin(pin_t pin, bool high)
{
    const uint32_t bit = 1U << pin.number;
    pin.port->IDR = high ? pin.port->IDR | bit : pin.port->IDR & ~bit;
}

void timer1_reset(void)
{
    const uint32_t rises_after = timer.break_rises_after;
    map_peripherals();
    memset(&timer, 0, sizeof timer);
    timer.break_rises_after = rises_after;
    timer.break_high = rises_after == 0;
    set_pin(BOARD_BREAK, timer.break_high);
    set_pin(BOARD_DRIVER_FAULT, true);
}

void timer1_set_break_pin(bool high)
{
    timer.break_high = high;
    timer.break_rises_after = 0;
    set_pin(BOARD_BREAK, high);
    timer1_settle();
}

void timer1_set_driver_fault_pin(bool high)
{
    set_pin(BOARD_DRIVER_FAULT, high);
}

void timer1_break_rises_after(uint32_t half_periods)
{
    timer.break_rises_after = half_periods;
}

void timer1_stop_clock(void)
{
    timer.stopped = true;
}

void timer1_settle(void)
{
    timer.flags &= TIM1->SR;
    if (!timer.break_high && (TIM1->BDTR & TIM_BDTR_BKE) != 0) {
        timer.flags |= TIM_SR_BIF;
        TIM1->BDTR &= ~(uint32_t)TIM_BDTR_MOE;
    }
    TIM1->SR = timer.flags;
}

static void update(void)
{
    timer.updated = timer.repetitions == 0;
    if (!timer.updated) {
        timer.repetitions--;
        return;
    }
    timer.repetitions = TIM1->RCR;
    timer.compare[0] = TIM1->CCR1;
    timer.compare[1] = TIM1->CCR2;
    timer.compare[2] = TIM1->CCR3;
    timer.flags |= TIM_SR_UIF;
    TIM1->SR = timer.flags;
}

/* Stream 1 writes words to BDTR at the request of TIM8's update, channel 7 (table 43). Which word
 * is beyond what a pointer of the host could show. */
static bool transfer_is_set(void)
{
    const uint32_t words = 7U << 25 | 2U << 13 | 2U << 11 | 1U << 8 | 1U << 6 | 1U;
    const dma_stream_t *stream = &DMA2->stream[1];
    return stream->CR == words && stream->NDTR == 1U &&
           stream->PAR == (uint32_t)(uintptr_t)&TIM1->BDTR &&
           (RCC->AHB1ENR & RCC_AHB1ENR_DMA2EN) != 0;
}

static void count_timer8(uint32_t counts)
{
    if ((TIM8->CR1 & TIM_CR1_CEN) == 0 || (RCC->APB2ENR & RCC_APB2ENR_TIM8EN) == 0) {
        return;
    }
    TIM8->CNT += counts;
    if (TIM8->CNT > TIM8->ARR) {
        TIM8->CNT -= TIM8->ARR + 1U;
        TIM8->CR1 &= (TIM8->CR1 & TIM_CR1_OPM) != 0 ? ~(uint32_t)TIM_CR1_CEN : UINT32_MAX;
        TIM8->SR |= TIM_SR_UIF;
        if ((TIM8->DIER & TIM_DIER_UDE) != 0 && transfer_is_set()) {
            TIM1->BDTR &= ~(uint32_t)TIM_BDTR_MOE;
        }
    }
}

void timer1_half_period(void)
{
    timer1_settle();
    count_timer8(TIM1->ARR);
    if (timer.break_rises_after > 0) {
        timer.break_rises_after--;
        timer.break_high = timer.break_rises_after == 0;
        set_pin(BOARD_BREAK, timer.break_high);
    }
    timer.updated = false;
    if (timer.stopped || (TIM1->CR1 & TIM_CR1_CEN) == 0) {
        return;
    }
    TIM1->CR1 ^= TIM_CR1_DIR;
    timer.at_top = (TIM1->CR1 & TIM_CR1_DIR) != 0;
    update();
}

bool timer1_at_top(void)
{
    return timer.at_top;
}

bool timer1_updated(void)
{
    return timer.updated;
}

gates_t timer1_gates(uint32_t count)
{
    static const uint32_t BOTH[3] = {TIM_CCER_CC1E | TIM_CCER_CC1NE, TIM_CCER_CC2E | TIM_CCER_CC2NE,
                                     TIM_CCER_CC3E | TIM_CCER_CC3NE};
    gates_t gates = {.high = {false}};
    timer1_settle();
    for (int x = 0; x < 3; x++) {
        /* Only the line of the table that the port means to be in is known here: both outputs
         * enabled, active high, idle states low. In any other one nothing is promised. */
        if ((TIM1->CCER & BOTH[x]) != BOTH[x] || (TIM1->BDTR & TIM_BDTR_OSSI) == 0) {
            abort();
        }
        const bool reference = count < timer.compare[x]; /* PWM mode 1 */
        const bool enabled = (TIM1->BDTR & TIM_BDTR_MOE) != 0;
        gates.high[x] = enabled && reference;
        gates.low[x] = enabled && !reference;
    }
    return gates;
}

/* Every read advances the model by half a period, much more than on the chip; no code may depend on
 * less.
 */
bool wait_for(const volatile uint32_t *reg, uint32_t mask, uint32_t value, uint32_t polls)
{
    enum { POLLS_MAX = 64 };
    timer1_settle();
    for (uint32_t i = 0; i < polls && i < POLLS_MAX; i++) {
        if ((*reg & mask) == value) {
            return true;
        }
        timer1_half_period();
    }
    return false;
}
