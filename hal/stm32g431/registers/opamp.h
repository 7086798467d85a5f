/* SPDX-License-Identifier: Apache-2.0 */
/* opamp.h: operational amplifiers; RM0440 section 25.5. */
#ifndef STM32G431_REGISTERS_OPAMP_H
#define STM32G431_REGISTERS_OPAMP_H

#include <stdint.h>

typedef struct {
    volatile uint32_t OPAMP1_CSR;
    volatile uint32_t OPAMP2_CSR;
    volatile uint32_t OPAMP3_CSR;
    uint32_t reserved_0C[3];
    volatile uint32_t OPAMP1_TCMR;
    volatile uint32_t OPAMP2_TCMR;
    volatile uint32_t OPAMP3_TCMR;
} opamp_registers_t;

#define OPAMP ((opamp_registers_t *)0x40010300U)

/* The same for all three. */
#define OPAMP_OPAMP1_CSR_OPAEN (1U << 0)
#define OPAMP_OPAMP1_CSR_VP_SEL_Pos 2
#define OPAMP_OPAMP1_CSR_VP_SEL (0x3U << 2)
#define OPAMP_OPAMP1_CSR_VM_SEL_Pos 5
#define OPAMP_OPAMP1_CSR_VM_SEL (0x3U << 5)
#define OPAMP_OPAMP1_CSR_OPAHSM (1U << 7)
#define OPAMP_OPAMP1_CSR_PGA_GAIN_Pos 14
#define OPAMP_OPAMP1_CSR_PGA_GAIN (0x1FU << 14)

#endif
