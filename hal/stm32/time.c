/* SPDX-License-Identifier: Apache-2.0 */
/* SysTick and cycle counter; the clock tree is the chip's (clock.h). */
#include "hal/time.h"

#include "clock.h"
#include "hal/upcall.h"
#include "interrupts.h"
#include "power.h"
#include "registers/core.h"
#include "vectors.h"

static volatile uint32_t milliseconds;

bool time_init(void)
{
    power_start();
    *DEBUG_DEMCR |= DEBUG_DEMCR_TRCENA;
    *DWT_CTRL |= DWT_CTRL_CYCCNTENA;
    return clock_start();
}

void time_start_tick(void)
{
    interrupts_set_millisecond_priority();
    SYSTICK->RVR = clock_core_Hz() / 1000U - 1U;
    SYSTICK->CVR = 0;
    SYSTICK->CSR = SYSTICK_CSR_CLKSOURCE | SYSTICK_CSR_TICKINT | SYSTICK_CSR_ENABLE;
}

void systick_handler(void)
{
    milliseconds = milliseconds + 1U;
    app_millisecond_isr();
}

uint32_t time_ms(void)
{
    return milliseconds;
}

uint32_t time_cycles(void)
{
    return *DWT_CYCCNT;
}

bool time_running(void)
{
    return true;
}
