/* SPDX-License-Identifier: Apache-2.0 */
/* dac.h: digital-to-analog converter 3, whose outputs stay in the chip; RM0440 section 22.7. */
#ifndef STM32G431_REGISTERS_DAC_H
#define STM32G431_REGISTERS_DAC_H

#include <stdint.h>

typedef struct {
    volatile uint32_t CR;
    volatile uint32_t SWTRGR;
    volatile uint32_t DHR12R1;
    uint32_t reserved_0C[2];
    volatile uint32_t DHR12R2;
    uint32_t reserved_18[5];
    volatile uint32_t DOR1;
    volatile uint32_t DOR2;
    uint32_t reserved_34[2];
    volatile uint32_t MCR;
} dac_registers_t;

#define DAC3 ((dac_registers_t *)0x50001000U)

#define DAC_CR_EN1 (1U << 0)
#define DAC_CR_EN2 (1U << 16)
#define DAC_MCR_MODE1_Pos 0
#define DAC_MCR_MODE1 (0x7U << 0)
#define DAC_MCR_HFSEL_Pos 14
#define DAC_MCR_HFSEL (0x3U << 14)
#define DAC_MCR_MODE2_Pos 16
#define DAC_MCR_MODE2 (0x7U << 16)

#endif
