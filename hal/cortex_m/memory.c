/* SPDX-License-Identifier: Apache-2.0 */
#include "hal/memory.h"

#include "stack.h"

enum { PATTERN = 0x5AA5C33CU, MARGIN_BYTES = 256 /* for the frames of whoever uses the window */ };

extern uint32_t link_stack_begin[], link_retained_begin[], link_retained_end[], link_scope_begin[],
    link_scope_end[];

memory_window_t memory_unused(void)
{
    const uint32_t pointer = stack_pointer();
    const uint32_t begin = (uint32_t)(uintptr_t)link_stack_begin;
    const memory_window_t window = {link_stack_begin, pointer > begin + MARGIN_BYTES
                                                          ? (pointer - begin - MARGIN_BYTES) / 4U
                                                          : 0U};
    return window;
}

void memory_mark_stack(void)
{
    const memory_window_t window = memory_unused();
    for (uint32_t i = 0; i < window.words; i++) {
        window.begin[i] = PATTERN;
    }
}

memory_window_t memory_retained(void)
{
    const memory_window_t window = {link_retained_begin,
                                    (uint32_t)(link_retained_end - link_retained_begin)};
    return window;
}

memory_window_t memory_scope(void)
{
    const memory_window_t window = {link_scope_begin,
                                    (uint32_t)(link_scope_end - link_scope_begin)};
    return window;
}

uint32_t memory_stack_free_bytes(void)
{
    uint32_t words = 0;
    const uint32_t most = memory_unused().words;
    while (words < most && link_stack_begin[words] == PATTERN) {
        words++;
    }
    return 4U * words;
}
