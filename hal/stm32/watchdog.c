/* SPDX-License-Identifier: Apache-2.0 */
/* Independent watchdog on the internal 32 kHz oscillator, 17 .. 47 kHz (STM32F405:
 * RM0090 section 21, data sheet table 35; STM32G431, 29.5 .. 34 kHz: RM0440 section 44). */
#include "hal/watchdog.h"

#include "registers/iwdg.h"
#include "registers/rcc.h"
#include "wait.h"

enum {
    OSCILLATOR_kHz = 32,
    DIVIDER_LOG2_SMALLEST = 2, /* code 0 divides by 4 */
    DIVIDER_CODE_LARGEST = 6,
    RELOAD_MAX = 4095,
    LOOKS =
        1000000 /* 30 ms: a register is taken over within five slow cycles of the slow oscillator */
};

void watchdog_start(uint32_t timeout_ms)
{
    uint32_t code = 0;
    uint32_t ticks = timeout_ms * OSCILLATOR_kHz >> DIVIDER_LOG2_SMALLEST;
    while (ticks > RELOAD_MAX && code < DIVIDER_CODE_LARGEST) {
        ticks >>= 1;
        code++;
    }
    DBGMCU->APB1_FZ |= DBGMCU_APB1_FZ_IWDG_STOP; /* stopped while a debugger halts the core */
    IWDG->KR = IWDG_KR_KEY_START;
    IWDG->KR = IWDG_KR_KEY_ENABLE_ACCESS;
    IWDG->PR = code;
    IWDG->RLR = ticks < 1U ? 1U : (ticks > RELOAD_MAX ? RELOAD_MAX : ticks);
    (void)wait_for(&IWDG->SR, IWDG_SR_PVU | IWDG_SR_RVU, 0, LOOKS);
    IWDG->KR = IWDG_KR_KEY_RELOAD;
}

void watchdog_feed(void)
{
    IWDG->KR = IWDG_KR_KEY_RELOAD;
}

bool watchdog_caused_reset(void)
{
    /* Read and cleared at the first call, so that a later reset by the button is not reported as
     * one by the watchdog. */
    static bool known;
    static bool by_watchdog;
    if (!known) {
        by_watchdog = (RCC->CSR & RCC_CSR_WDGRSTF) != 0;
        RCC->CSR |= RCC_CSR_RMVF;
        known = true;
    }
    return by_watchdog;
}
