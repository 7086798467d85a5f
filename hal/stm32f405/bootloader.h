/* SPDX-License-Identifier: Apache-2.0 */
/* bootloader.h: the maker's bootloader, in the system memory (AN2606): stack and entry first. */
#ifndef STM32F405_BOOTLOADER_H
#define STM32F405_BOOTLOADER_H

#include "registers/rcc.h"
#include "registers/syscfg.h"

#define BOOTLOADER_BEGIN 0x1FFF0000U

/* System memory at address 0, where the bootloader expects its vectors (RM0090 section 9.2.1). */
static inline void bootloader_map(void)
{
    enum { SYSTEM_MEMORY = 1 };
    RCC->APB2ENR |= RCC_APB2ENR_SYSCFGEN;
    (void)RCC->APB2ENR;
    SYSCFG->MEMRM = SYSTEM_MEMORY;
}

#endif
