/* SPDX-License-Identifier: Apache-2.0 */
/* stack.h: the stack pointer, which C has no name for. */
#ifndef CORTEX_M_STACK_H
#define CORTEX_M_STACK_H

#include <stdint.h>

static inline uint32_t stack_pointer(void)
{
    uint32_t pointer;
    __asm volatile("mov %0, sp" : "=r"(pointer));
    return pointer;
}

#endif
