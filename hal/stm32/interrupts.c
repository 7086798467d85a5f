/* SPDX-License-Identifier: Apache-2.0 */
#include "priorities.h"

#include "registers/core.h"

static uint8_t level(uint32_t priority)
{
    return (uint8_t)(priority << 4);
}

void interrupts_enable(uint32_t number, uint32_t priority)
{
    NVIC_IPR[number] = level(priority);
    NVIC_ISER[number / 32U] = 1U << (number % 32U);
}

void interrupts_set_millisecond_priority(void)
{
    SCB_SHPR[SCB_SHPR_SYSTICK] = level(PRIORITY_MILLISECOND);
}
