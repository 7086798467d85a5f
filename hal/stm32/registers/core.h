/* SPDX-License-Identifier: Apache-2.0 */
/*
 * core.h: the registers of the Cortex-M4 core that the port uses.
 * Arm DDI 0403 (ARMv7-M architecture): B3.2 system control block, B3.3 SysTick, B3.4 NVIC, C1.6 and
 * C1.8 debug and DWT.
 */
#ifndef STM32_REGISTERS_CORE_H
#define STM32_REGISTERS_CORE_H

#include <stdint.h>

typedef struct {
    volatile uint32_t CSR;
    volatile uint32_t RVR;
    volatile uint32_t CVR;
    volatile uint32_t CALIB;
} systick_registers_t;

#define SYSTICK ((systick_registers_t *)0xE000E010U)
#define SYSTICK_CSR_ENABLE (1U << 0)
#define SYSTICK_CSR_TICKINT (1U << 1)
#define SYSTICK_CSR_CLKSOURCE (1U << 2) /* the core's own clock */

#define NVIC_ISER ((volatile uint32_t *)0xE000E100U) /* one bit an interrupt: enable */
#define NVIC_IPR                                                                                   \
    ((volatile uint8_t                                                                             \
          *)0xE000E400U) /* one byte an interrupt: priority, upper four bits on this core */

#define SCB_VTOR ((volatile uint32_t *)0xE000ED08U)
#define SCB_AIRCR ((volatile uint32_t *)0xE000ED0CU)
#define SCB_SHCSR ((volatile uint32_t *)0xE000ED24U)
#define SCB_SHPR ((volatile uint8_t *)0xE000ED18U) /* priority of exceptions 4 .. 15 */
#define SCB_CFSR ((volatile uint32_t *)0xE000ED28U)
#define SCB_CPACR ((volatile uint32_t *)0xE000ED88U)
#define SCB_SHCSR_FAULTS_ENABLED (7U << 16)
#define SCB_CPACR_FLOATING_POINT (0xFU << 20) /* coprocessors 10 and 11, full access */
#define SCB_AIRCR_RESET 0x05FA0004U
#define SCB_SHPR_SYSTICK (15 - 4)

#define DEBUG_DEMCR ((volatile uint32_t *)0xE000EDFCU)
#define DEBUG_DEMCR_TRCENA (1U << 24)
#define DWT_CTRL ((volatile uint32_t *)0xE0001000U)
#define DWT_CYCCNT ((volatile uint32_t *)0xE0001004U)
#define DWT_CTRL_CYCCNTENA (1U << 0)

#endif
