/* SPDX-License-Identifier: Apache-2.0 */
/*
 * memory.h: facts about RAM for self-test and supervision.
 */
#ifndef HAL_MEMORY_H
#define HAL_MEMORY_H

#include <stdint.h>

typedef struct {
    volatile uint32_t *begin;
    uint32_t words;
} memory_window_t;

/* The part of the stack that has not been reached yet, a margin below the caller's frame left out.
 * The self-test may overwrite it as long as no interrupt is enabled. The stack lies at the lower
 * end of RAM on every port, so that an overflow leaves RAM and faults instead of overwriting
 * variables. */
memory_window_t memory_unused(void);

/* Fills memory_unused() with the pattern that memory_stack_free_bytes() searches. Once, before
 * interrupts start. */
void memory_mark_stack(void);

/* Words that no reset changes as long as the supply stays, 8 KiB or none; after power-up they hold
 * anything. Nothing else uses them. Any context. */
memory_window_t memory_retained(void);

/* For recordings of the service protocol, 16 KiB or none. Nothing else uses them. Any context. */
memory_window_t memory_scope(void);

/* Bytes that the stack has not used since memory_mark_stack(); 0 if it was never called. Background
 * context: the time grows with the number of free bytes. */
uint32_t memory_stack_free_bytes(void);

#endif
