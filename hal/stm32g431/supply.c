/* SPDX-License-Identifier: Apache-2.0 */
/* The voltage detector (RM0440 section 6.2.2). The flash of this chip can be read down to the level
 * at which it resets itself; what falls first is the converters' reference. */
#include "supply.h"

#include "interrupts.h"
#include "registers/power.h"
#include "registers/rcc.h"
#include "wait.h"

enum {
    DETECTOR_2V9 = 6, /* code of PLS */
    POLLS_SUPPLY = 20000
};

void supply_watch(void)
{
    PWR->CR2 = (PWR->CR2 & ~(uint32_t)PWR_CR2_PLS) | (uint32_t)DETECTOR_2V9 << PWR_CR2_PLS_Pos |
               PWR_CR2_PVDE;
    /* As on the STM32F405: its output while it starts is not an event. */
    (void)wait_for(&PWR->SR2, PWR_SR2_PVDO, 0, POLLS_SUPPLY);
    EXTI->RTSR1 |= EXTI_RTSR1_RT16;
    EXTI->PR1 = EXTI_PR1_PIF16;
    EXTI->IMR1 |= EXTI_IMR1_IM16;
    interrupts_enable(INTERRUPT_SUPPLY, PRIORITY_SUPPLY); /* has no handler: a fault */
}

bool supply_low(void)
{
    return (PWR->SR2 & PWR_SR2_PVDO) != 0;
}
