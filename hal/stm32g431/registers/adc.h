/* SPDX-License-Identifier: Apache-2.0 */
/* adc.h: analog-to-digital converters; RM0440 sections 21.7 and 21.8. */
#ifndef STM32G431_REGISTERS_ADC_H
#define STM32G431_REGISTERS_ADC_H

#include <stdint.h>

typedef struct {
    volatile uint32_t ISR;
    volatile uint32_t IER;
    volatile uint32_t CR;
    volatile uint32_t CFGR;
    volatile uint32_t CFGR2;
    volatile uint32_t SMPR1;
    volatile uint32_t SMPR2;
    uint32_t reserved_1C;
    volatile uint32_t TR1;
    volatile uint32_t TR2;
    volatile uint32_t TR3;
    uint32_t reserved_2C;
    volatile uint32_t SQR1;
    volatile uint32_t SQR2;
    volatile uint32_t SQR3;
    volatile uint32_t SQR4;
    volatile uint32_t DR;
    uint32_t reserved_44[2];
    volatile uint32_t JSQR;
    uint32_t reserved_50[4];
    volatile uint32_t OFR1;
    volatile uint32_t OFR2;
    volatile uint32_t OFR3;
    volatile uint32_t OFR4;
    uint32_t reserved_70[4];
    volatile uint32_t JDR1;
    volatile uint32_t JDR2;
    volatile uint32_t JDR3;
    volatile uint32_t JDR4;
    uint32_t reserved_90[4];
    volatile uint32_t AWD2CR;
    volatile uint32_t AWD3CR;
    uint32_t reserved_A8[2];
    volatile uint32_t DIFSEL;
    volatile uint32_t CALFACT;
} adc_registers_t;

/* Common to both converters. */
typedef struct {
    volatile uint32_t CSR;
    uint32_t reserved_04;
    volatile uint32_t CCR;
    volatile uint32_t CDR;
} adc_common_registers_t;

#define ADC1 ((adc_registers_t *)0x50000000U)
#define ADC2 ((adc_registers_t *)0x50000100U)
#define ADC12_COMMON ((adc_common_registers_t *)0x50000300U)

#define ADC_ISR_ADRDY (1U << 0)
#define ADC_ISR_JEOC (1U << 5)
#define ADC_ISR_JEOS (1U << 6)
#define ADC_IER_JEOSIE (1U << 6)
#define ADC_CR_ADEN (1U << 0)
#define ADC_CR_JADSTART (1U << 3)
#define ADC_CR_ADVREGEN (1U << 28)
#define ADC_CR_DEEPPWD (1U << 29)
#define ADC_CR_ADCAL (1U << 31)
#define ADC_CFGR_JQDIS (1U << 31)
#define ADC_JSQR_JL_Pos 0
#define ADC_JSQR_JL (0x3U << 0)
#define ADC_JSQR_JEXTSEL_Pos 2
#define ADC_JSQR_JEXTSEL (0x1FU << 2)
#define ADC_JSQR_JEXTEN_Pos 7
#define ADC_JSQR_JEXTEN (0x3U << 7)
#define ADC_JSQR_JSQ1_Pos 9
#define ADC_JSQR_JSQ1 (0x1FU << 9)
#define ADC_JSQR_JSQ2_Pos 15
#define ADC_JSQR_JSQ2 (0x1FU << 15)
#define ADC_JSQR_JSQ3_Pos 21
#define ADC_JSQR_JSQ3 (0x1FU << 21)
#define ADC_JSQR_JSQ4_Pos 27
#define ADC_JSQR_JSQ4 (0x1FU << 27)
#define ADC12_COMMON_CCR_DUAL_Pos 0
#define ADC12_COMMON_CCR_DUAL (0x1FU << 0)
#define ADC12_COMMON_CCR_CKMODE_Pos 16
#define ADC12_COMMON_CCR_CKMODE (0x3U << 16)

#endif
