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

/* The first cause whose flag is set: every reset pulls the pin, and the supply's arrival sets the
 * flag of the brown-out too. The flags are the upper byte of RCC_CSR. */
static reset_cause_t cause_of(uint32_t register_value)
{
    static const uint8_t FLAGS[RESET_CAUSES] = {
        [RESET_POWER] = RCC_CSR_PORRSTF >> 24,
        [RESET_BROWN_OUT] = RCC_CSR_BORRSTF >> 24,
        [RESET_WATCHDOG] = RCC_CSR_WDGRSTF >> 24,
        [RESET_WINDOW_WATCHDOG] = RCC_CSR_WWDGRSTF >> 24,
        [RESET_LOW_POWER] = RCC_CSR_LPWRRSTF >> 24,
        [RESET_PROGRAM] = RCC_CSR_SFTRSTF >> 24,
#ifdef RCC_CSR_OBLRSTF
        [RESET_OPTION_BYTES] = RCC_CSR_OBLRSTF >> 24,
#endif
        [RESET_PIN] = RCC_CSR_PADRSTF >> 24,
    };
    for (reset_cause_t cause = RESET_POWER; cause < RESET_CAUSES; cause++) {
        if ((register_value >> 24 & FLAGS[cause]) != 0) {
            return cause;
        }
    }
    return RESET_UNKNOWN;
}

reset_cause_t watchdog_reset_cause(void)
{
    /* Read and cleared at the first call: the flags outlast resets, and the next one must show its
     * own only. */
    static bool known;
    static reset_cause_t cause;
    if (!known) {
        cause = cause_of(RCC->CSR);
        RCC->CSR |= RCC_CSR_RMVF;
        known = true;
    }
    return cause;
}
