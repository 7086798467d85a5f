/* SPDX-License-Identifier: Apache-2.0 */
/* Handler of every failed CHECK(): a programming error or a memory fault. Switches the bridge off
 * and waits for the watchdog. */
#include "core/check.h"
#include "hal/crash.h"
#include "hal/inverter.h"

void check_failed(check_module_t module, uint16_t number)
{
    inverter_trip();
    crash_of_check((uint32_t)module, number);
    for (;;) { /* the watchdog, no longer fed, restarts the core */
    }
}
