/* SPDX-License-Identifier: Apache-2.0 */
/* The simulated board's core has no faults; failed checks are recorded until the process ends. */
#include <stddef.h>

#include "hal/crash.h"

static crash_record_t latest;

const crash_record_t *crash_record(void)
{
    return latest.value[CRASH_COUNT] != 0 ? &latest : NULL;
}

void crash_of_check(uint32_t module, uint32_t number)
{
    latest.value[CRASH_PC] = module << 16 | number;
    latest.value[CRASH_CAUSE] = CRASH_CAUSE_CHECK;
    latest.value[CRASH_COUNT]++;
}
