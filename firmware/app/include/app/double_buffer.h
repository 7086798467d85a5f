/* SPDX-License-Identifier: Apache-2.0 */
/*
 * double_buffer.h: which of two buffers belongs to which of two contexts, without locks and without
 * waiting.
 *
 * For two contexts of one core, of which one (the high side: an interrupt) may interrupt the other
 * (the low side: a lower interrupt or the background) at any instruction, and never the other way
 * round. At any time each side owns one of the two buffers. Only the low side exchanges them, by
 * one store of one byte.
 *
 * The high side reads the index at its start. It cannot change before its end, because the low side
 * does not run meanwhile: the high side owns its buffer for its whole run.
 *
 * The low side owns its buffer until it exchanges the two itself. The high side may run any number
 * of times in between and uses only the other one. So no value is read partly written, in either
 * direction.
 *
 * Low to high: the low side fills its buffer completely, then double_buffer_swap(). High to low:
 * the high side fills its buffer completely, whenever it has something new, and then calls
 * double_buffer_mark(); the low side calls double_buffer_take() and then reads its buffer. If the
 * high side runs between the two stores of take(), its mark is lost and that value is seen one run
 * later; a value is never seen twice as new, and the values seen never go backwards in time.
 *
 * Memory order: a core observes its own accesses in program order, also across interrupt entry and
 * return, so no barrier instruction is needed; only the compiler must not move buffer accesses
 * across the index. That is what the signal fences do (C11 7.17.4.2), and they cost nothing. The
 * byte is atomic so that it is read and written whole and once.
 */
#ifndef APP_DOUBLE_BUFFER_H
#define APP_DOUBLE_BUFFER_H

#include <stdatomic.h>
#include <stdbool.h>

#include "core/q15.h"

typedef struct {
    atomic_uchar low;  /* index of the low side's buffer, 0 or 1; written by the low side only */
    atomic_bool fresh; /* the high side has written since the last exchange */
} double_buffer_t;

static inline void double_buffer_init(double_buffer_t *pair)
{
    atomic_store_explicit(&pair->low, 0, memory_order_relaxed);
    atomic_store_explicit(&pair->fresh, false, memory_order_relaxed);
}

/* The low side's buffer. */
static inline unsigned double_buffer_low(const double_buffer_t *pair)
{
    return atomic_load_explicit(&pair->low, memory_order_relaxed);
}

/* The high side's buffer. Twice in each PWM period. */
Q_TARGET_INLINE unsigned double_buffer_high(const double_buffer_t *pair)
{
    const unsigned index = 1U - atomic_load_explicit(&pair->low, memory_order_relaxed);
    atomic_signal_fence(memory_order_acquire);
    return index;
}

/* Low side: hands over the buffer it has filled and gets the other one. */
static inline void double_buffer_swap(double_buffer_t *pair)
{
    atomic_signal_fence(memory_order_release);
    const unsigned char low =
        (unsigned char)(1U - atomic_load_explicit(&pair->low, memory_order_relaxed));
    atomic_store_explicit(&pair->low, low, memory_order_relaxed);
    atomic_signal_fence(memory_order_acquire);
}

/* High side: its buffer is complete. */
static inline void double_buffer_mark(double_buffer_t *pair)
{
    atomic_signal_fence(memory_order_release);
    atomic_store_explicit(&pair->fresh, true, memory_order_relaxed);
}

/* Low side: true if its buffer now holds something new. */
static inline bool double_buffer_take(double_buffer_t *pair)
{
    if (!atomic_load_explicit(&pair->fresh, memory_order_relaxed)) {
        return false;
    }
    double_buffer_swap(pair);
    atomic_store_explicit(&pair->fresh, false, memory_order_relaxed);
    return true;
}

#endif
