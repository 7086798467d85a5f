/* SPDX-License-Identifier: Apache-2.0 */
#include "supply.h"

#include "interrupts.h"
#include "registers/power.h"
#include "registers/rcc.h"
#include "wait.h"

enum {
    DETECTOR_2V8 = 6, /* code of PLS; by the data sheet 2.85 .. 2.99 V falling */
    POLLS_SUPPLY = 20000
};

void supply_watch(void)
{
    RCC->APB1ENR |= RCC_APB1ENR_PWREN;
    (void)RCC->APB1ENR;
    PWR->CR =
        (PWR->CR & ~(uint32_t)PWR_CR_PLS) | (uint32_t)DETECTOR_2V8 << PWR_CR_PLS_Pos | PWR_CR_PVDE;
    /* The output of the detector while it starts is not an event. A supply that stays low is
     * reported by supply_low(). */
    (void)wait_for(&PWR->CSR, PWR_CSR_PVDO, 0, POLLS_SUPPLY);
    EXTI->RTSR |= EXTI_RTSR_TR16; /* the detector's output rises when the supply falls */
    EXTI->PR = EXTI_PR_PR16;
    EXTI->IMR |= EXTI_IMR_MR16;
    interrupts_enable(INTERRUPT_SUPPLY,
                      PRIORITY_SUPPLY); /* no handler of its own in startup.c: a fault */
}

bool supply_low(void)
{
    return (PWR->CSR & PWR_CSR_PVDO) != 0;
}
