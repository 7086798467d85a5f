/* SPDX-License-Identifier: Apache-2.0 */
/* Clock tree (RM0440 section 7.2), in voltage range 1 with boost (6.1.5). */
#include "clock.h"

#include "board.h"
#include "registers/flash.h"
#include "registers/power.h"
#include "wait.h"

enum { /* 8 MHz / 2 = 4 MHz, x 85 = 340 MHz, / 2 = 170 MHz */
       PLL_M = BOARD_CRYSTAL_Hz / 4000000,
       PLL_N = 85,
       PLL_R_CODE_2 = 0,
       PLL_SOURCE_CRYSTAL = 3,
       FLASH_WAIT_STATES = 4, /* RM0440 table 9: 136 < f <= 170 MHz in range 1 with boost */
       PRESCALER_BY_2 = 8,    /* code of HPRE */
       SWITCH_INTERNAL = 1,   /* code of SW and SWS; 0 is reserved (7.4.3) */
       SWITCH_PLL = 3,
       POLLS_CRYSTAL = 400000, /* 0.1 s; crystals need 2 .. 20 ms */
       POLLS_PLL = 20000,      /* 6 ms; the data sheet says 40 us */
       POLLS_1_us = 100        /* at 85 MHz, of five cycles each */
};
_Static_assert(BOARD_CRYSTAL_Hz / PLL_M * PLL_N / 2 == CLOCK_CORE_Hz, "clock tree");

static bool on_crystal;

static bool start_crystal_and_pll(void)
{
    RCC->CR |= RCC_CR_HSEON;
    if (!wait_for(&RCC->CR, RCC_CR_HSERDY, RCC_CR_HSERDY, POLLS_CRYSTAL)) {
        return false;
    }
    RCC->PLLCFGR = ((uint32_t)PLL_SOURCE_CRYSTAL << RCC_PLLCFGR_PLLSRC_Pos) |
                   ((uint32_t)(PLL_M - 1) << RCC_PLLCFGR_PLLM_Pos) |
                   ((uint32_t)PLL_N << RCC_PLLCFGR_PLLN_Pos) |
                   ((uint32_t)PLL_R_CODE_2 << RCC_PLLCFGR_PLLR_Pos) | RCC_PLLCFGR_PLLREN;
    RCC->CR |= RCC_CR_PLLON;
    return wait_for(&RCC->CR, RCC_CR_PLLRDY, RCC_CR_PLLRDY, POLLS_PLL);
}

/* The core's supply for more than 150 MHz; and the pull-downs of the USB power-delivery inputs,
 * which are on after a reset, are taken from PB4 and PB6 (6.4.3). */
static void prepare_power(void)
{
    RCC->APB1ENR1 |= RCC_APB1ENR1_PWREN;
    (void)RCC->APB1ENR1;
    PWR->CR3 |= PWR_CR3_UCPD1_DBDIS;
    PWR->CR5 &= ~(uint32_t)PWR_CR5_R1MODE;
}

bool clock_start(void)
{
    prepare_power();
    if (!start_crystal_and_pll()) {
        return false;
    }
    /* Wait states before the frequency, verified by reading back (3.3.3). */
    FLASH->ACR = FLASH_ACR_PRFTEN | FLASH_ACR_ICEN | FLASH_ACR_DCEN |
                 ((uint32_t)FLASH_WAIT_STATES << FLASH_ACR_LATENCY_Pos);
    if ((FLASH->ACR & FLASH_ACR_LATENCY) != (uint32_t)FLASH_WAIT_STATES << FLASH_ACR_LATENCY_Pos ||
        (PWR->CR5 & PWR_CR5_R1MODE) != 0) {
        return false;
    }
    /* A step of more than 80 MHz takes half the frequency for a microsecond (7.2.7). */
    RCC->CFGR = (uint32_t)PRESCALER_BY_2 << RCC_CFGR_HPRE_Pos | (uint32_t)SWITCH_INTERNAL
                                                                    << RCC_CFGR_SW_Pos;
    RCC->CFGR |= (uint32_t)SWITCH_PLL << RCC_CFGR_SW_Pos;
    on_crystal =
        wait_for(&RCC->CFGR, RCC_CFGR_SWS, (uint32_t)SWITCH_PLL << RCC_CFGR_SWS_Pos, POLLS_PLL);
    if (on_crystal) {
        (void)wait_for(&RCC->CFGR, 0, 1, POLLS_1_us);
        RCC->CFGR &= ~(uint32_t)RCC_CFGR_HPRE;
        RCC->CR |= RCC_CR_CSSON; /* a crystal that stops later raises NMI: flash_error.c */
    } else {
        RCC->CFGR = (uint32_t)SWITCH_INTERNAL << RCC_CFGR_SW_Pos;
    }
    return on_crystal;
}

uint32_t clock_core_Hz(void)
{
    return on_crystal ? CLOCK_CORE_Hz : CLOCK_INTERNAL_Hz;
}
