/* SPDX-License-Identifier: Apache-2.0 */
/* rcc.h: reset and clock control; RM0090 section 7.3 (STM32F405xx). */
#ifndef STM32F405_REGISTERS_RCC_H
#define STM32F405_REGISTERS_RCC_H

#include <stdint.h>

typedef struct {
    volatile uint32_t CR;      /* 7.3.1 */
    volatile uint32_t PLLCFGR; /* 7.3.2 */
    volatile uint32_t CFGR;    /* 7.3.3 */
    volatile uint32_t CIR;
    volatile uint32_t AHB1RSTR;
    volatile uint32_t AHB2RSTR;
    volatile uint32_t AHB3RSTR;
    uint32_t reserved_1C;
    volatile uint32_t APB1RSTR;
    volatile uint32_t APB2RSTR;
    uint32_t reserved_28[2];
    volatile uint32_t AHB1ENR; /* 7.3.10 */
    volatile uint32_t AHB2ENR;
    volatile uint32_t AHB3ENR;
    uint32_t reserved_3C;
    volatile uint32_t APB1ENR; /* 7.3.13 */
    volatile uint32_t APB2ENR; /* 7.3.14 */
    uint32_t reserved_48[2];
    volatile uint32_t AHB1LPENR;
    volatile uint32_t AHB2LPENR;
    volatile uint32_t AHB3LPENR;
    uint32_t reserved_5C;
    volatile uint32_t APB1LPENR;
    volatile uint32_t APB2LPENR;
    uint32_t reserved_68[2];
    volatile uint32_t BDCR;
    volatile uint32_t CSR; /* 7.3.21 */
} rcc_registers_t;

#define RCC ((rcc_registers_t *)0x40023800U)

#define RCC_CR_HSION (1U << 0)
#define RCC_CR_HSIRDY (1U << 1)
#define RCC_CR_HSEON (1U << 16)
#define RCC_CR_HSERDY (1U << 17)
#define RCC_CR_CSSON (1U << 19)
#define RCC_CR_PLLON (1U << 24)
#define RCC_CR_PLLRDY (1U << 25)

#define RCC_PLLCFGR_PLLM_Pos 0
#define RCC_PLLCFGR_PLLM (0x3FU << 0)
#define RCC_PLLCFGR_PLLN_Pos 6
#define RCC_PLLCFGR_PLLN (0x1FFU << 6)
#define RCC_PLLCFGR_PLLP_Pos 16
#define RCC_PLLCFGR_PLLP (0x3U << 16)
#define RCC_PLLCFGR_PLLSRC (1U << 22)
#define RCC_PLLCFGR_PLLQ_Pos 24
#define RCC_PLLCFGR_PLLQ (0xFU << 24)

#define RCC_CFGR_SW_Pos 0
#define RCC_CFGR_SW (0x3U << 0)
#define RCC_CFGR_SWS_Pos 2
#define RCC_CFGR_SWS (0x3U << 2)
#define RCC_CFGR_HPRE (0xFU << 4)
#define RCC_CFGR_PPRE1_Pos 10
#define RCC_CFGR_PPRE1 (0x7U << 10)
#define RCC_CFGR_PPRE2_Pos 13
#define RCC_CFGR_PPRE2 (0x7U << 13)

#define RCC_AHB1ENR_GPIOAEN (1U << 0)
#define RCC_AHB1ENR_GPIOBEN (1U << 1)
#define RCC_AHB1ENR_GPIOCEN (1U << 2)
#define RCC_AHB1ENR_GPIODEN (1U << 3)
#define RCC_AHB1ENR_DMA1EN (1U << 21)
#define RCC_AHB1ENR_DMA2EN (1U << 22)
#define RCC_AHB2ENR_RNGEN (1U << 6)
#define RCC_APB1ENR_TIM3EN (1U << 1)
#define RCC_APB1ENR_USART3EN (1U << 18)
#define RCC_APB1ENR_CAN1EN (1U << 25)
#define RCC_APB1ENR_PWREN (1U << 28)
#define RCC_APB2ENR_TIM1EN (1U << 0)
#define RCC_APB2ENR_TIM8EN (1U << 1)
#define RCC_APB2ENR_ADC1EN (1U << 8)
#define RCC_APB2ENR_ADC2EN (1U << 9)
#define RCC_APB2ENR_ADC3EN (1U << 10)
#define RCC_APB2ENR_SYSCFGEN (1U << 14)

#define RCC_CSR_RMVF (1U << 24)
#define RCC_CSR_BORRSTF (1U << 25)
#define RCC_CSR_PADRSTF (1U << 26)
#define RCC_CSR_PORRSTF (1U << 27)
#define RCC_CSR_SFTRSTF (1U << 28)
#define RCC_CSR_WDGRSTF (1U << 29)
#define RCC_CSR_WWDGRSTF (1U << 30)
#define RCC_CSR_LPWRRSTF (1U << 31)

#endif
