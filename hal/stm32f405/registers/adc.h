/* SPDX-License-Identifier: Apache-2.0 */
/* adc.h: analog-to-digital converters; RM0090 section 13.13. */
#ifndef STM32F405_REGISTERS_ADC_H
#define STM32F405_REGISTERS_ADC_H

#include <stdint.h>

typedef struct {
    volatile uint32_t SR;    /* 13.13.1 */
    volatile uint32_t CR1;   /* 13.13.2 */
    volatile uint32_t CR2;   /* 13.13.3 */
    volatile uint32_t SMPR1; /* 13.13.4: channels 10 .. 18, three bits each */
    volatile uint32_t SMPR2; /* 13.13.5: channels 0 .. 9 */
    volatile uint32_t JOFR1;
    volatile uint32_t JOFR2;
    volatile uint32_t JOFR3;
    volatile uint32_t JOFR4;
    volatile uint32_t HTR;
    volatile uint32_t LTR;
    volatile uint32_t SQR1;
    volatile uint32_t SQR2;
    volatile uint32_t SQR3;
    volatile uint32_t JSQR; /* 13.13.12 */
    volatile uint32_t JDR1; /* 13.13.13 */
    volatile uint32_t JDR2;
    volatile uint32_t JDR3;
    volatile uint32_t JDR4;
    volatile uint32_t DR;
} adc_registers_t;

/* Common to the three converters. */
typedef struct {
    volatile uint32_t CSR; /* 13.13.15 */
    volatile uint32_t CCR; /* 13.13.16 */
    volatile uint32_t CDR;
} adc_common_registers_t;

#define ADC1 ((adc_registers_t *)0x40012000U)
#define ADC2 ((adc_registers_t *)0x40012100U)
#define ADC3 ((adc_registers_t *)0x40012200U)
#define ADC_COMMON ((adc_common_registers_t *)0x40012300U)

#define ADC_SR_EOC (1U << 1)
#define ADC_SR_JEOC (1U << 2)
#define ADC_SR_JSTRT (1U << 3)
#define ADC_CR1_JEOCIE (1U << 7)
#define ADC_CR1_SCAN (1U << 8)
#define ADC_CR2_ADON (1U << 0)
#define ADC_CR2_JEXTSEL_Pos 16
#define ADC_CR2_JEXTSEL (0xFU << 16)
#define ADC_CR2_JEXTEN_Pos 20
#define ADC_CR2_JEXTEN (0x3U << 20)
#define ADC_CR2_SWSTART (1U << 30)
#define ADC_SQR3_SQ1_Pos 0
#define ADC_SQR3_SQ1 (0x1FU << 0)
#define ADC_JSQR_JSQ3_Pos 10
#define ADC_JSQR_JSQ3 (0x1FU << 10)
#define ADC_JSQR_JSQ4_Pos 15
#define ADC_JSQR_JSQ4 (0x1FU << 15)
#define ADC_JSQR_JL_Pos 20
#define ADC_JSQR_JL (0x3U << 20)
#define ADC_COMMON_CCR_MULTI_Pos 0
#define ADC_COMMON_CCR_MULTI (0x1FU << 0)
#define ADC_COMMON_CCR_ADCPRE_Pos 16
#define ADC_COMMON_CCR_ADCPRE (0x3U << 16)

#endif
