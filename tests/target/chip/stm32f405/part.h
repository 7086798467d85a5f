/* SPDX-License-Identifier: Apache-2.0 */
/* part.h: the numbers and names of the STM32F405 for what both chips have alike. */
#ifndef CHIP_PART_H
#define CHIP_PART_H

#include "registers.h"

/* Every clock of the chip is a whole number of them: 336 MHz. */
#define CHIP_TICKS_PER_US 336ULL

enum {
    CHIP_FLASH_BYTES = 1 << 20,
    CHIP_RAM_BYTES = 128 << 10,
    CHIP_ENTRY_OFFSET = 0x20000, /* of the program in the flash */
    CHIP_INTERRUPTS = 82,
    CHIP_LSI_TICKS = 10500, /* 32 kHz */
    CHIP_CELL_WORDS = 1,    /* programmed by one operation */
    CHIP_UPDATE_ERASES = 1  /* of an update of the configuration */
};

enum {
    INTERRUPT_PVD = 16 + 1,
    INTERRUPT_ADC = 16 + 18,
    INTERRUPT_PINS_5_TO_9 = 16 + 23,
    INTERRUPT_SERIAL = 16 + 39,
    INTERRUPT_PINS_10_TO_15 = 16 + 40
};
#define CHIP_INTERRUPT_SOURCES                                                                     \
    INTERRUPT_PVD, INTERRUPT_ADC, INTERRUPT_SERIAL, INTERRUPT_PINS_5_TO_9, INTERRUPT_PINS_10_TO_15

/* Where peripherals answer. */
#define CHIP_WINDOWS                                                                               \
    {0x40000000U, 0x80000U},                                                                       \
    {                                                                                              \
        0x50060000U, 0x1000U                                                                       \
    }

/* Ports A to F; 0: there is none, or it is not modelled. */
#define CHIP_PORT_MODERS                                                                           \
    CHIP_GPIOA_MODER, CHIP_GPIOB_MODER, CHIP_GPIOC_MODER, CHIP_GPIOD_MODER, 0, 0

/* Gates a, b, c: high side, low side. Port, pin, function (data sheet, table 9). */
#define CHIP_GATE_PINS                                                                             \
    {{'A', 8, 1}, {'B', 13, 1}}, {{'A', 9, 1}, {'B', 14, 1}},                                      \
    {                                                                                              \
        {'A', 10, 1},                                                                              \
        {                                                                                          \
            'B', 15, 1                                                                             \
        }                                                                                          \
    }

/* Of BDTR at lock level 1 (17.4.18). */
#define CHIP_TIMER1_LOCKED                                                                         \
    (CHIP_TIM1_BDTR_DTG | CHIP_TIM1_BDTR_BKE | CHIP_TIM1_BDTR_BKP | CHIP_TIM1_BDTR_AOE |           \
     CHIP_TIM1_BDTR_LOCK)

/* The timer that counts an encoder, and its first two pins with their function. */
#define CHIP_ENCODER_CR1 CHIP_TIM3_CR1
#define CHIP_ENCODER_SMCR CHIP_TIM3_SMCR
#define CHIP_ENCODER_SR CHIP_TIM3_SR
#define CHIP_ENCODER_CCR3 CHIP_TIM3_CCR3
#define CHIP_ENCODER_CNT CHIP_TIM3_CNT
#define CHIP_ENCODER_PINS                                                                          \
    {'C', 6, 2},                                                                                   \
    {                                                                                              \
        'C', 7, 2                                                                                  \
    }
#define CHIP_ENCODER_CR1_CEN CHIP_TIM3_CR1_CEN
#define CHIP_ENCODER_SMCR_SMS CHIP_TIM3_SMCR_SMS
#define CHIP_ENCODER_SR_CC3IF CHIP_TIM3_SR_CC3IF

/* EXTI. */
#define CHIP_LINES_MASK CHIP_EXTI_IMR
#define CHIP_LINES_RISING CHIP_EXTI_RTSR
#define CHIP_LINES_FALLING CHIP_EXTI_FTSR
#define CHIP_LINES_PENDING CHIP_EXTI_PR

/* Which memory is at address 0, and the clock's settings as after a reset. */
#define CHIP_REMAP CHIP_SYSCFG_MEMRM
#define CHIP_RCC_CFGR_AT_RESET 0U

#endif
