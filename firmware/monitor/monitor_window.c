/* SPDX-License-Identifier: Apache-2.0 */
#include "monitor/monitor_window.h"

#include "core/q15.h"

void monitor_window_restart(monitor_window_t *window)
{
    const monitor_window_t fresh = {.wrong = false};
    *window = fresh;
}

bool monitor_window_add(monitor_window_t *window, int32_t value)
{
    if (window->steps >= MONITOR_WINDOW_STEPS) {
        window->lowest[1] = window->lowest[0];
        window->highest[1] = window->highest[0];
        window->windows = 1;
        window->steps = 0;
    }
    const bool first = window->steps == 0;
    window->lowest[0] = first ? value : q_min(window->lowest[0], value);
    window->highest[0] = first ? value : q_max(window->highest[0], value);
    window->steps++;
    return window->windows > 0;
}

int32_t monitor_window_lowest(const monitor_window_t *window)
{
    return q_min(window->lowest[0], window->lowest[1]);
}

int32_t monitor_window_highest(const monitor_window_t *window)
{
    return q_max(window->highest[0], window->highest[1]);
}

bool monitor_window_judge(monitor_window_t *window, bool contradicts)
{
    if (contradicts) {
        window->level = (uint16_t)q_min(window->level + 1, MONITOR_WINDOW_QUALIFY_STEPS);
    } else if (window->level > 0) {
        window->level--;
    }
    if (window->level >= MONITOR_WINDOW_QUALIFY_STEPS) {
        window->wrong = true;
    } else if (window->level == 0) {
        window->wrong = false;
    }
    return window->wrong;
}
