/* SPDX-License-Identifier: Apache-2.0 */
#include "app/supervisor.h"

void supervisor_init(supervisor_t *supervisor, uint32_t fast_rate_Hz, uint32_t slow_rate_Hz)
{
    const supervisor_counts_t zero = {0};
    const uint32_t expected = fast_rate_Hz * SUPERVISOR_WINDOW_STEPS / slow_rate_Hz;
    supervisor->last = zero;
    /* Two more either way: a window begins and ends anywhere between two steps. */
    supervisor->fast_least = expected - expected / 4U - 2U;
    supervisor->fast_most = expected + expected / 4U + 2U;
}

bool supervisor_may_feed(supervisor_t *supervisor, supervisor_counts_t now)
{
    const uint32_t slow = (uint16_t)(now.slow_steps - supervisor->last.slow_steps);
    const uint32_t fast = (uint16_t)(now.fast_steps - supervisor->last.fast_steps);
    if (slow < SUPERVISOR_WINDOW_STEPS) {
        return false;
    }
    /* A delayed background sees a longer window; the limits scale with it. */
    const bool fast_in_time = fast * SUPERVISOR_WINDOW_STEPS >= supervisor->fast_least * slow &&
                              fast * SUPERVISOR_WINDOW_STEPS <= supervisor->fast_most * slow;
    const bool monitor_in_time = now.monitor_steps != supervisor->last.monitor_steps;
    if (!fast_in_time || !monitor_in_time) {
        return false;
    }
    supervisor->last = now;
    return true;
}
