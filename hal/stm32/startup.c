/* SPDX-License-Identifier: Apache-2.0 */
/* Vector table and the way from reset to main(). */
#include <stdint.h>

#include "../cortex_m/mpu.h"
#include "bootloader.h"
#include "bootloader_request.h"
#include "interrupts.h"
#include "power.h"
#include "protected.h"
#include "registers/core.h"
#include "vectors.h"

extern uint32_t link_stack_end[];
extern const uint32_t link_data_load[];
extern uint32_t link_data_begin[], link_data_end[], link_ram_code_end[], link_guard_begin[];
extern uint32_t link_bss_begin[], link_bss_end[];

int main(void);

typedef union {
    void (*handler)(void);
    const uint32_t *stack;
} vector_t;

enum { EXCEPTIONS = 16 };

/* What the core reads after reset, alone in the first sector: stack and entry. The faults are here
 * too, because the real table is not in force yet while reset_handler() runs. */
__attribute__((section(".boot_vectors"), used)) const vector_t boot_vectors[EXCEPTIONS] = {
    [0] = {.stack = link_stack_end},
    [1] = {.handler = reset_handler},
    [2 ... EXCEPTIONS - 1] = {.handler = fault_handler},
};

/* In the checked image; VTOR requires alignment to its size rounded up to a power of two: of at
 * most 128 words, 512 bytes. What a chip does not name (interrupts.h) is a fault. */
#define OF_INTERRUPT(number, function) [EXCEPTIONS + (number)] = {.handler = (function)},
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Woverride-init"
__attribute__((section(".vectors"), used, aligned(512)))
const vector_t vectors[EXCEPTIONS + INTERRUPT_COUNT] = {
    [0] = {.stack = link_stack_end},
    [1] = {.handler = reset_handler},
    [2] = {.handler = INTERRUPT_NMI_HANDLER},
    [3 ... EXCEPTIONS + INTERRUPT_COUNT - 1] = {.handler = fault_handler},
    [15] = {.handler = systick_handler},
    INTERRUPT_HANDLERS(OF_INTERRUPT)};
#pragma GCC diagnostic pop
_Static_assert(sizeof vectors <= 512, "the table's alignment");

/* The image cannot be written; the application's sectors are programmed by stores (protected.h of
 * the chip). RAM cannot be executed but for the code that programs. */
static void protect_memory(void)
{
    const uint32_t eighths =
        (uint32_t)((uintptr_t)link_ram_code_end - (uintptr_t)link_data_begin) / 32U;
    const mpu_region_t regions[] = {
        {(const void *)0x08000000U, MPU_READ_ONLY | MPU_SIZE(PROTECTED_FLASH_LOG2) |
                                        MPU_WITHOUT_EIGHTHS(PROTECTED_NOT_EIGHTHS)},
        {(const void *)0x20000000U, MPU_READ_WRITE | MPU_NO_EXECUTE | MPU_SIZE(PROTECTED_RAM_LOG2)},
        {link_data_begin,
         MPU_READ_ONLY | MPU_SIZE(8U) | MPU_WITHOUT_EIGHTHS(0xFFU << eighths & 0xFFU)},
        {link_guard_begin, MPU_NO_ACCESS | MPU_NO_EXECUTE | MPU_SIZE(5U)},
        {(const void *)0U, MPU_NO_ACCESS | MPU_NO_EXECUTE | MPU_SIZE(12U)}, /* null pointers */
    };
    mpu_start(regions, sizeof regions / sizeof regions[0]);
}

/* As after a reset but for the pins that keep the board's supply on. No variable is initialised
 * yet. */
static void enter_bootloader_on_request(void)
{
    if (link_bootloader_request[0] != BOOTLOADER_REQUEST ||
        link_bootloader_request[1] != ~BOOTLOADER_REQUEST) {
        return;
    }
    link_bootloader_request[0] = 0;
    power_start();
    bootloader_map();
    __asm volatile("ldr sp, [%0]\n\t"
                   "ldr r0, [%0, #4]\n\t"
                   "bx r0"
                   :
                   : "r"(BOOTLOADER_BEGIN)
                   : "r0");
    __builtin_unreachable();
}

void reset_handler(void)
{
    enter_bootloader_on_request();
    *SCB_VTOR = (uint32_t)(uintptr_t)vectors;
    *SCB_SHCSR |= SCB_SHCSR_FAULTS_ENABLED;
    /* The firmware computes nothing in floating point, but a compiler may keep integers in the
     * unit's registers. */
    *SCB_CPACR |= SCB_CPACR_FLOATING_POINT;
    const uint32_t *from = link_data_load;
    for (uint32_t *to = link_data_begin; to < link_data_end; to++) {
        *to = *from++;
    }
    for (uint32_t *to = link_bss_begin; to < link_bss_end; to++) {
        *to = 0;
    }
    protect_memory();
    (void)main();
    fault_handler(); /* main() does not return on a board */
}
