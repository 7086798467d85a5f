/* SPDX-License-Identifier: Apache-2.0 */
/*
 * memory_map.h: what QEMU's mps2-an386 has where. Arm AN386 (MPS2 Cortex-M4), CMSDK peripherals:
 * Arm DDI 0479.
 */
#ifndef QEMU_MPS2_MEMORY_MAP_H
#define QEMU_MPS2_MEMORY_MAP_H

#include <stdint.h>

enum { PROCESSOR_CLOCK_Hz = 25000000 };

typedef struct {
    volatile uint32_t CTRL; /* bit 0 enable, bit 3 interrupt */
    volatile uint32_t VALUE;
    volatile uint32_t RELOAD;
    volatile uint32_t INTCLEAR;
} cmsdk_timer_t;

typedef struct {
    volatile uint32_t DATA;
    volatile uint32_t STATE; /* bit 0 transmit buffer full, bit 1 receive buffer full */
    volatile uint32_t CTRL;  /* bit 0 transmit, bit 1 receive */
    volatile uint32_t INTCLEAR;
    volatile uint32_t BAUDDIV;
} cmsdk_uart_t;

typedef struct {
    volatile uint32_t LOAD;
    volatile uint32_t VALUE;
    volatile uint32_t CTRL; /* bit 0: raise the interrupt (here: NMI) when the count reaches 0 */
    volatile uint32_t INTCLR;
} cmsdk_watchdog_t;

#define CMSDK_TIMER0 ((cmsdk_timer_t *)0x40000000U)
#define CMSDK_UART0 ((cmsdk_uart_t *)0x40004000U)
#define CMSDK_WATCHDOG ((cmsdk_watchdog_t *)0x40008000U)
#define CMSDK_WATCHDOG_LOCK ((volatile uint32_t *)0x40008C00U)
#define CMSDK_WATCHDOG_UNLOCK 0x1ACCE551U
enum { INTERRUPT_TIMER0 = 8, INTERRUPT_COUNT = 32 };

#define SYSTICK_CSR ((volatile uint32_t *)0xE000E010U)
#define SYSTICK_RVR ((volatile uint32_t *)0xE000E014U)
#define SYSTICK_CVR ((volatile uint32_t *)0xE000E018U)
#define NVIC_ISER ((volatile uint32_t *)0xE000E100U)
#define NVIC_IPR ((volatile uint8_t *)0xE000E400U)
#define SCB_AIRCR ((volatile uint32_t *)0xE000ED0CU)
#define SCB_AIRCR_RESET 0x05FA0004U
#define SCB_SHPR ((volatile uint8_t *)0xE000ED18U) /* priority of exceptions 4 .. 15 */
#define SCB_SHCSR ((volatile uint32_t *)0xE000ED24U)
#define SCB_CPACR ((volatile uint32_t *)0xE000ED88U)

#endif
