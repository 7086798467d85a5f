/* SPDX-License-Identifier: Apache-2.0 */
/* Vector table and the way from reset to main() and out of it. Shared by the firmware and by every
 * program of tests/target and tools/benchmark that runs on the emulated core, so handlers that a
 * program lacks are faults. */
#include <stdint.h>

#include "memory_map.h"
#include "semihost.h"
#include "vectors.h"

extern uint32_t link_stack_end[];
extern const uint32_t link_data_load[];
extern uint32_t link_data_begin[], link_data_end[];
extern uint32_t link_bss_begin[], link_bss_end[];

int main(void);

typedef union {
    void (*handler)(void);
    const uint32_t *stack;
} vector_t;

enum { EXCEPTIONS = 16, FAULTS_ENABLED = 7 << 16, COPROCESSORS_10_11_FULL = 0xF << 20 };

static void stop(void)
{
    semihost_print("fault: unexpected exception\n");
    semihost_exit(false);
}

__attribute__((weak, alias("stop"))) void fault_handler(void);
__attribute__((weak, alias("stop"))) void systick_handler(void);
__attribute__((weak, alias("stop"))) void timer0_handler(void);
__attribute__((weak, alias("stop"))) void watchdog_handler(void);

__attribute__((section(".vectors"), used)) const vector_t vectors[EXCEPTIONS + INTERRUPT_COUNT] = {
    [0] = {.stack = link_stack_end},
    [1] = {.handler = reset_handler},
    [2] = {.handler = watchdog_handler},
    [3 ... 14] = {.handler = fault_handler},
    [15] = {.handler = systick_handler},
    [EXCEPTIONS... EXCEPTIONS + INTERRUPT_TIMER0 - 1] = {.handler = fault_handler},
    [EXCEPTIONS + INTERRUPT_TIMER0] = {.handler = timer0_handler},
    [EXCEPTIONS + INTERRUPT_TIMER0 + 1 ... EXCEPTIONS + INTERRUPT_COUNT - 1] = {.handler =
                                                                                    fault_handler},
};

void reset_handler(void)
{
    *SCB_SHCSR |= FAULTS_ENABLED;
#if defined(__ARM_FP)
    *SCB_CPACR |= COPROCESSORS_10_11_FULL; /* for tests; the firmware uses no floating point */
#endif
    const uint32_t *from = link_data_load;
    for (uint32_t *to = link_data_begin; to < link_data_end; to++) {
        *to = *from++;
    }
    for (uint32_t *to = link_bss_begin; to < link_bss_end; to++) {
        *to = 0;
    }
    semihost_exit(main() == 0);
}
