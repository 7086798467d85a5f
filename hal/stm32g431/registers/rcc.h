/* SPDX-License-Identifier: Apache-2.0 */
/* rcc.h: reset and clock control; RM0440 section 7.4. */
#ifndef STM32G431_REGISTERS_RCC_H
#define STM32G431_REGISTERS_RCC_H

#include <stdint.h>

typedef struct {
    volatile uint32_t CR;
    volatile uint32_t ICSCR;
    volatile uint32_t CFGR;
    volatile uint32_t PLLCFGR;
    uint32_t reserved_10[2];
    volatile uint32_t CIER;
    volatile uint32_t CIFR;
    volatile uint32_t CICR;
    uint32_t reserved_24;
    volatile uint32_t AHB1RSTR;
    volatile uint32_t AHB2RSTR;
    volatile uint32_t AHB3RSTR;
    uint32_t reserved_34;
    volatile uint32_t APB1RSTR1;
    volatile uint32_t APB1RSTR2;
    volatile uint32_t APB2RSTR;
    uint32_t reserved_44;
    volatile uint32_t AHB1ENR;
    volatile uint32_t AHB2ENR;
    volatile uint32_t AHB3ENR;
    uint32_t reserved_54;
    volatile uint32_t APB1ENR1;
    volatile uint32_t APB1ENR2;
    volatile uint32_t APB2ENR;
    uint32_t reserved_64;
    volatile uint32_t AHB1SMENR;
    volatile uint32_t AHB2SMENR;
    volatile uint32_t AHB3SMENR;
    uint32_t reserved_74;
    volatile uint32_t APB1SMENR1;
    volatile uint32_t APB1SMENR2;
    volatile uint32_t APB2SMENR;
    uint32_t reserved_84;
    volatile uint32_t CCIPR;
    uint32_t reserved_8C;
    volatile uint32_t BDCR;
    volatile uint32_t CSR;
    volatile uint32_t CRRCR;
    volatile uint32_t CCIPR2;
} rcc_registers_t;

#define RCC ((rcc_registers_t *)0x40021000U)

#define RCC_CR_HSION (1U << 8)
#define RCC_CR_HSIRDY (1U << 10)
#define RCC_CR_HSEON (1U << 16)
#define RCC_CR_HSERDY (1U << 17)
#define RCC_CR_CSSON (1U << 19)
#define RCC_CR_PLLON (1U << 24)
#define RCC_CR_PLLRDY (1U << 25)

#define RCC_PLLCFGR_PLLSRC_Pos 0
#define RCC_PLLCFGR_PLLSRC (0x3U << 0)
#define RCC_PLLCFGR_PLLM_Pos 4
#define RCC_PLLCFGR_PLLM (0xFU << 4)
#define RCC_PLLCFGR_PLLN_Pos 8
#define RCC_PLLCFGR_PLLN (0x7FU << 8)
#define RCC_PLLCFGR_PLLREN (1U << 24)
#define RCC_PLLCFGR_PLLR_Pos 25
#define RCC_PLLCFGR_PLLR (0x3U << 25)

#define RCC_CFGR_SW_Pos 0
#define RCC_CFGR_SW (0x3U << 0)
#define RCC_CFGR_SWS_Pos 2
#define RCC_CFGR_SWS (0x3U << 2)
#define RCC_CFGR_HPRE_Pos 4
#define RCC_CFGR_HPRE (0xFU << 4)

#define RCC_CIFR_CSSF (1U << 8)

#define RCC_AHB1ENR_DMA1EN (1U << 0)
#define RCC_AHB1ENR_DMAMUXEN (1U << 2)
#define RCC_AHB2ENR_GPIOAEN (1U << 0)
#define RCC_AHB2ENR_GPIOBEN (1U << 1)
#define RCC_AHB2ENR_GPIOCEN (1U << 2)
#define RCC_AHB2ENR_GPIOFEN (1U << 5)
#define RCC_AHB2ENR_ADC12EN (1U << 13)
#define RCC_AHB2ENR_DAC3EN (1U << 18)
#define RCC_APB1ENR1_TIM4EN (1U << 2)
#define RCC_APB1ENR1_USART2EN (1U << 17)
#define RCC_APB1ENR1_FDCANEN (1U << 25)
#define RCC_APB1ENR1_PWREN (1U << 28)
#define RCC_APB2ENR_SYSCFGEN (1U << 0)
#define RCC_APB2ENR_TIM1EN (1U << 11)
#define RCC_APB2ENR_TIM8EN (1U << 13)
#define RCC_CCIPR_FDCANSEL (0x3U << 24)

#define RCC_CSR_RMVF (1U << 23)
#define RCC_CSR_OBLRSTF (1U << 25)
#define RCC_CSR_PADRSTF (1U << 26) /* PINRSTF */
#define RCC_CSR_BORRSTF (1U << 27)
#define RCC_CSR_PORRSTF RCC_CSR_BORRSTF /* there is one flag for both */
#define RCC_CSR_SFTRSTF (1U << 28)
#define RCC_CSR_WDGRSTF (1U << 29) /* IWDGRSTF */
#define RCC_CSR_WWDGRSTF (1U << 30)
#define RCC_CSR_LPWRRSTF (1U << 31)

#endif
