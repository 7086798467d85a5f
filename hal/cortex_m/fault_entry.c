/* SPDX-License-Identifier: Apache-2.0 */
#include "crash.h"

/* On a stack of its own: the other one may be what has failed, and it is looked at. */
__attribute__((naked)) void fault_handler(void)
{
    __asm volatile("mov r0, sp\n\t"
                   "mrs r1, ipsr\n\t"
                   "ldr r2, =link_crash_stack_end\n\t"
                   "mov sp, r2\n\t"
                   "b crash_of_fault");
}
