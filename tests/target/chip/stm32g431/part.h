/* SPDX-License-Identifier: Apache-2.0 */
/* part.h: the numbers and names of the STM32G431 for what both chips have alike. */
#ifndef CHIP_PART_H
#define CHIP_PART_H

#include "registers.h"

/* Every clock of the chip is a whole number of them: 1360 MHz, the least multiple of 170 and 16. */
#define CHIP_TICKS_PER_US 1360ULL

enum {
    CHIP_FLASH_BYTES = 128 << 10,
    CHIP_RAM_BYTES = 32 << 10, /* SRAM1, SRAM2 and the CCM RAM at its second address (table 3) */
    CHIP_ENTRY_OFFSET = 0,     /* of the program in the flash */
    CHIP_INTERRUPTS = 102,
    CHIP_LSI_TICKS = 42500, /* 32 kHz */
    CHIP_CELL_WORDS = 2,    /* programmed by one operation */
    CHIP_UPDATE_ERASES = 4  /* of an update of the configuration: pages of 2 KiB */
};

enum { INTERRUPT_PVD = 16 + 1, INTERRUPT_ADC = 16 + 18, INTERRUPT_SERIAL = 16 + 38 };
#define CHIP_INTERRUPT_SOURCES INTERRUPT_PVD, INTERRUPT_ADC, INTERRUPT_SERIAL

/* Where peripherals answer. */
#define CHIP_WINDOWS                                                                               \
    {0x40000000U, 0x80000U}, {0x48000000U, 0x2000U},                                               \
    {                                                                                              \
        0x50000000U, 0x2000U                                                                       \
    }

/* Ports A to F; 0: there is none, or it is not modelled. */
#define CHIP_PORT_MODERS                                                                           \
    CHIP_GPIOA_MODER, CHIP_GPIOB_MODER, CHIP_GPIOC_MODER, 0, 0, CHIP_GPIOF_MODER

/* Gates a, b, c: high side, low side. Port, pin, function (data sheet DS12589, table 13). */
#define CHIP_GATE_PINS                                                                             \
    {{'A', 8, 6}, {'C', 13, 4}}, {{'A', 9, 6}, {'A', 12, 6}},                                      \
    {                                                                                              \
        {'A', 10, 6},                                                                              \
        {                                                                                          \
            'B', 15, 4                                                                             \
        }                                                                                          \
    }

/* Of BDTR at lock level 1 (28.6.20). */
#define CHIP_TIMER1_LOCKED                                                                         \
    (CHIP_TIM1_BDTR_DTG | CHIP_TIM1_BDTR_BKE | CHIP_TIM1_BDTR_BKP | CHIP_TIM1_BDTR_AOE |           \
     CHIP_TIM1_BDTR_LOCK | CHIP_TIM1_BDTR_BKF | CHIP_TIM1_BDTR_BK2F | CHIP_TIM1_BDTR_BK2E |        \
     CHIP_TIM1_BDTR_BK2P)

/* The timer that counts an encoder, and its first two pins with their function. */
#define CHIP_ENCODER_CR1 CHIP_TIM4_CR1
#define CHIP_ENCODER_SMCR CHIP_TIM4_SMCR
#define CHIP_ENCODER_SR CHIP_TIM4_SR
#define CHIP_ENCODER_CCR3 CHIP_TIM4_CCR3
#define CHIP_ENCODER_CNT CHIP_TIM4_CNT
#define CHIP_ENCODER_PINS                                                                          \
    {'B', 6, 2},                                                                                   \
    {                                                                                              \
        'B', 7, 2                                                                                  \
    }
#define CHIP_ENCODER_CR1_CEN CHIP_TIM4_CR1_CEN
#define CHIP_ENCODER_SMCR_SMS CHIP_TIM4_SMCR_SMS
#define CHIP_ENCODER_SR_CC3IF CHIP_TIM4_SR_CC3IF

/* EXTI. */
#define CHIP_LINES_MASK CHIP_EXTI_IMR1
#define CHIP_LINES_RISING CHIP_EXTI_RTSR1
#define CHIP_LINES_FALLING CHIP_EXTI_FTSR1
#define CHIP_LINES_PENDING CHIP_EXTI_PR1

/* Which memory is at address 0, and the clock's settings as after a reset. */
#define CHIP_REMAP CHIP_SYSCFG_MEMRMP
#define CHIP_RCC_CFGR_AT_RESET 5U

#endif
