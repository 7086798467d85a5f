/* SPDX-License-Identifier: Apache-2.0 */
/*
 * wait.h: how bench and emulator wait for each other over a counter in shared memory. Linux.
 *
 * Each has work for a few microseconds at a time, so the waiting side looks for about as long,
 * gives its core away a few times, and only then sleeps (futex), which costs more but leaves the
 * machine to others.
 */
#ifndef PIL_WAIT_H
#define PIL_WAIT_H

#include <linux/futex.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

enum { PIL_LOOKS = 2000, PIL_YIELDS = 20, PIL_SLEEP_ms = 100 };

/* Waits until the counter differs from `same`, at most about PIL_SLEEP_ms. Returns whether it
 * does. */
static inline bool pil_wait(_Atomic uint32_t *counter, uint32_t same, _Atomic uint32_t *sleeps)
{
    for (int k = 0; k < PIL_LOOKS; k++) {
        if (atomic_load_explicit(counter, memory_order_acquire) != same) {
            return true;
        }
    }
    for (int k = 0; k < PIL_YIELDS; k++) {
        sched_yield();
        if (atomic_load_explicit(counter, memory_order_acquire) != same) {
            return true;
        }
    }
    const struct timespec most = {.tv_nsec = PIL_SLEEP_ms * 1000000L};
    atomic_store(sleeps, 1);
    if (atomic_load(counter) == same) {
        (void)syscall(SYS_futex, counter, FUTEX_WAIT, same, &most, NULL, 0);
    }
    atomic_store(sleeps, 0);
    return atomic_load(counter) != same;
}

/* After the counter was changed. */
static inline void pil_wake(_Atomic uint32_t *counter, _Atomic uint32_t *sleeps)
{
    atomic_thread_fence(memory_order_seq_cst);
    if (atomic_load(sleeps) != 0) {
        (void)syscall(SYS_futex, counter, FUTEX_WAKE, 1, NULL, NULL, 0);
    }
}

#endif
