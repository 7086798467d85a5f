/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The crash record of a Cortex-M3 or M4 (Arm DDI 0403, B1.5 and B3.2). Chip independent: a port's
 * linker script has link_crash_begin and link_crash_stack_end, in memory that is not cleared at
 * reset, with 256 bytes between them.
 */
#include "crash.h"

#include <stdbool.h>
#include <stddef.h>

#include "hal/crash.h"
#include "hal/inverter.h"

enum {
    FRAME_WORDS = 8,
    FRAME_BYTES = 32,
    BELOW_STACK_BYTES = 4096, /* an access there is of a frame that did not fit */
    STACKING_FAILED = 1 << 4 | 1 << 12,
    MEMORY_ADDRESS_VALID = 1 << 7,
    BUS_ADDRESS_VALID = 1 << 15
};
typedef struct {
    uint32_t cfsr, hfsr, dfsr, mmfar, bfar;
} fault_registers_t;
#define SCB_FAULT ((const volatile fault_registers_t *)0xE000ED28U)

extern crash_record_t link_crash_begin;
extern uint32_t link_stack_begin[], link_stack_end[];

static uint32_t check_of(const crash_record_t *record)
{
    uint32_t sum = 0;
    for (uint32_t i = 0; i < CRASH_VALUES; i++) {
        sum += record->value[i];
    }
    return ~sum;
}

const crash_record_t *crash_record(void)
{
    const crash_record_t *record = &link_crash_begin;
    return record->check == check_of(record) && record->value[CRASH_COUNT] != 0 ? record : NULL;
}

/* What is not filled in afterwards stays all ones. */
static void begin(void)
{
    uint32_t *value = link_crash_begin.value;
    const uint32_t before = crash_record() != NULL ? value[CRASH_COUNT] : 0U;
    for (uint32_t i = 0; i < CRASH_CAUSE; i++) {
        value[i] = UINT32_MAX;
    }
    value[CRASH_COUNT] = before + 1U;
}

static void end(uint32_t cause)
{
    link_crash_begin.value[CRASH_CAUSE] = cause;
    link_crash_begin.check = check_of(&link_crash_begin);
}

void crash_of_check(uint32_t module, uint32_t number)
{
    begin();
    link_crash_begin.value[CRASH_PC] = module << 16 | number;
    end(CRASH_CAUSE_CHECK);
}

void crash_of_fault(const uint32_t *frame, uint32_t exception)
{
    inverter_trip();
    begin();
    uint32_t *value = link_crash_begin.value;
    const uint32_t sp = (uint32_t)(uintptr_t)frame;
    const uint32_t lowest = (uint32_t)(uintptr_t)link_stack_begin;
    const uint32_t highest = (uint32_t)(uintptr_t)link_stack_end - FRAME_BYTES;
    const uint32_t cfsr = SCB_FAULT->cfsr;
    const bool is_stacked = (cfsr & STACKING_FAILED) == 0 && sp - lowest <= highest - lowest;
    for (uint32_t i = 0; is_stacked && i < FRAME_WORDS; i++) {
        value[i] = frame[i];
    }
    value[CRASH_SP] = sp;
    value[CRASH_CFSR] = cfsr;
    value[CRASH_HFSR] = SCB_FAULT->hfsr;
    if ((cfsr & MEMORY_ADDRESS_VALID) != 0) {
        value[CRASH_ADDRESS] = SCB_FAULT->mmfar;
    } else if ((cfsr & BUS_ADDRESS_VALID) != 0) {
        value[CRASH_ADDRESS] = SCB_FAULT->bfar;
    }
    /* Unsigned: below the stack, by less than so much. */
    const bool overflowed = !is_stacked || lowest - 1U - value[CRASH_ADDRESS] < BELOW_STACK_BYTES;
    end(overflowed ? (uint32_t)CRASH_CAUSE_STACK : exception);
    for (;;) { /* the watchdog, no longer fed, restarts the core */
    }
}
