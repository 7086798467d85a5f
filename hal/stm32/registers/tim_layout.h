/* SPDX-License-Identifier: Apache-2.0 */
/* tim_layout.h: what the timers of both chips have in common: RM0090 sections 17.4 and 18.4
 * (numbers below), RM0440 sections 28.6 and 29.5, whose further registers are behind these. General
 * purpose timers lack RCR and BDTR. */
#ifndef STM32_REGISTERS_TIM_LAYOUT_H
#define STM32_REGISTERS_TIM_LAYOUT_H

#include <stdint.h>

typedef struct {
    volatile uint32_t CR1;   /* 17.4.1 */
    volatile uint32_t CR2;   /* 17.4.2 */
    volatile uint32_t SMCR;  /* 17.4.3 */
    volatile uint32_t DIER;  /* 17.4.4 */
    volatile uint32_t SR;    /* 17.4.5 */
    volatile uint32_t EGR;   /* 17.4.6 */
    volatile uint32_t CCMR1; /* 17.4.7 */
    volatile uint32_t CCMR2; /* 17.4.8 */
    volatile uint32_t CCER;  /* 17.4.9 */
    volatile uint32_t CNT;
    volatile uint32_t PSC;
    volatile uint32_t ARR;
    volatile uint32_t RCR; /* 17.4.13 */
    volatile uint32_t CCR1;
    volatile uint32_t CCR2;
    volatile uint32_t CCR3;
    volatile uint32_t CCR4;
    volatile uint32_t BDTR; /* 17.4.18 */
} tim_registers_t;

#define TIM_CR1_CEN (1U << 0)
#define TIM_CR1_URS (1U << 2) /* an overflow alone is an update that is requested */
#define TIM_CR1_OPM (1U << 3) /* stops at an update */
#define TIM_CR1_DIR (1U << 4)
#define TIM_CR1_CMS_Pos 5
#define TIM_CR1_CMS (0x3U << 5)
#define TIM_CR1_ARPE (1U << 7)
#define TIM_CR2_MMS_Pos 4
#define TIM_CR2_MMS (0x7U << 4)
#define TIM_SMCR_SMS_Pos 0
#define TIM_SMCR_SMS (0x7U << 0)
#define TIM_DIER_UDE (1U << 8)
#define TIM_SR_UIF (1U << 0)
#define TIM_SR_CC3IF (1U << 3)
#define TIM_SR_BIF (1U << 7)
#define TIM_EGR_UG (1U << 0)
#define TIM_CCMR1_CC1S_Pos 0
#define TIM_CCMR1_CC1S (0x3U << 0)
#define TIM_CCMR1_OC1PE (1U << 3)
#define TIM_CCMR1_OC1M_Pos 4
#define TIM_CCMR1_OC1M (0x7U << 4)
#define TIM_CCMR1_IC1F_Pos 4
#define TIM_CCMR1_IC1F (0xFU << 4)
#define TIM_CCMR1_CC2S_Pos 8
#define TIM_CCMR1_CC2S (0x3U << 8)
#define TIM_CCMR1_OC2PE (1U << 11)
#define TIM_CCMR1_OC2M_Pos 12
#define TIM_CCMR1_OC2M (0x7U << 12)
#define TIM_CCMR1_IC2F_Pos 12
#define TIM_CCMR1_IC2F (0xFU << 12)
#define TIM_CCMR2_CC3S_Pos 0
#define TIM_CCMR2_CC3S (0x3U << 0)
#define TIM_CCMR2_IC3F_Pos 4
#define TIM_CCMR2_IC3F (0xFU << 4)
#define TIM_CCMR2_OC3PE (1U << 3)
#define TIM_CCMR2_OC3M_Pos 4
#define TIM_CCMR2_OC3M (0x7U << 4)
#define TIM_CCMR2_OC4PE (1U << 11)
#define TIM_CCMR2_OC4M_Pos 12
#define TIM_CCMR2_OC4M (0x7U << 12)
#define TIM_CCER_CC1E (1U << 0)
#define TIM_CCER_CC1NE (1U << 2)
#define TIM_CCER_CC2E (1U << 4)
#define TIM_CCER_CC2NE (1U << 6)
#define TIM_CCER_CC3E (1U << 8)
#define TIM_CCER_CC3NE (1U << 10)
#define TIM_BDTR_DTG_Pos 0
#define TIM_BDTR_DTG (0xFFU << 0)
#define TIM_BDTR_LOCK_Pos 8
#define TIM_BDTR_LOCK (0x3U << 8)
#define TIM_BDTR_OSSI (1U << 10)
#define TIM_BDTR_OSSR (1U << 11)
#define TIM_BDTR_BKE (1U << 12)
#define TIM_BDTR_MOE (1U << 15)

#endif
