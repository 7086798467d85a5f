/* SPDX-License-Identifier: Apache-2.0 */
/* Clock tree (RM0090 section 7.2). */
#include "clock.h"

#include "board.h"
#include "registers/flash.h"
#include "registers/rcc.h"
#include "wait.h"

enum { /* 8 MHz / 8 = 1 MHz, x 336 = 336 MHz, / 2 = 168 MHz for the core, / 7 = 48 MHz */
       PLL_M = BOARD_CRYSTAL_Hz / 1000000,
       PLL_N = 336,
       PLL_P_HALF_LESS_ONE = 2 / 2 - 1,
       PLL_Q = 7,
       FLASH_WAIT_STATES = 5, /* RM0090 table 10: 150 < f <= 168 MHz at 2.7 .. 3.6 V */
       PRESCALER_BY_2 = 4,    /* codes of PPRE1 and PPRE2 */
       PRESCALER_BY_4 = 5,
       SWITCH_PLL = 2,         /* code of SW and SWS */
       POLLS_CRYSTAL = 400000, /* 0.1 s; crystals need 2 .. 20 ms */
       POLLS_PLL = 20000       /* 6 ms; the data sheet says 0.3 ms */
};
_Static_assert(BOARD_CRYSTAL_Hz / PLL_M * PLL_N / 2 == CLOCK_CORE_Hz, "clock tree");

static bool on_crystal;

static bool start_crystal_and_pll(void)
{
    /* The regulator is in scale 1 after reset, as 168 MHz needs. */
    RCC->CR |= RCC_CR_HSEON;
    if (!wait_for(&RCC->CR, RCC_CR_HSERDY, RCC_CR_HSERDY, POLLS_CRYSTAL)) {
        return false;
    }
    RCC->PLLCFGR = ((uint32_t)PLL_M << RCC_PLLCFGR_PLLM_Pos) |
                   ((uint32_t)PLL_N << RCC_PLLCFGR_PLLN_Pos) |
                   ((uint32_t)PLL_P_HALF_LESS_ONE << RCC_PLLCFGR_PLLP_Pos) | RCC_PLLCFGR_PLLSRC |
                   ((uint32_t)PLL_Q << RCC_PLLCFGR_PLLQ_Pos);
    RCC->CR |= RCC_CR_PLLON;
    return wait_for(&RCC->CR, RCC_CR_PLLRDY, RCC_CR_PLLRDY, POLLS_PLL);
}

bool clock_start(void)
{
    if (!start_crystal_and_pll()) {
        return false;
    }
    /* Wait states before the frequency, verified by reading back (RM0090 section 3.5.1). */
    FLASH->ACR = FLASH_ACR_PRFTEN | FLASH_ACR_ICEN | FLASH_ACR_DCEN |
                 ((uint32_t)FLASH_WAIT_STATES << FLASH_ACR_LATENCY_Pos);
    if ((FLASH->ACR & FLASH_ACR_LATENCY) != (uint32_t)FLASH_WAIT_STATES << FLASH_ACR_LATENCY_Pos) {
        return false;
    }
    RCC->CFGR = ((uint32_t)PRESCALER_BY_4 << RCC_CFGR_PPRE1_Pos) |
                ((uint32_t)PRESCALER_BY_2 << RCC_CFGR_PPRE2_Pos);
    RCC->CFGR |= (uint32_t)SWITCH_PLL << RCC_CFGR_SW_Pos;
    on_crystal =
        wait_for(&RCC->CFGR, RCC_CFGR_SWS, (uint32_t)SWITCH_PLL << RCC_CFGR_SWS_Pos, POLLS_PLL);
    if (on_crystal) {
        RCC->CR |=
            RCC_CR_CSSON; /* a crystal that stops later raises NMI, which switches the bridge off */
    } else {
        RCC->CFGR = 0; /* buses undivided again, as reported by clock_apb1_Hz() and needed by the
                          serial line */
    }
    return on_crystal;
}

uint32_t clock_core_Hz(void)
{
    return on_crystal ? CLOCK_CORE_Hz : CLOCK_INTERNAL_Hz;
}

uint32_t clock_apb1_Hz(void)
{
    return on_crystal ? CLOCK_CORE_Hz / CLOCK_APB1_DIVIDER : CLOCK_INTERNAL_Hz;
}
