/* SPDX-License-Identifier: Apache-2.0 */
/* Handler of every failed CHECK(): a programming error or a memory fault. Switches the bridge off
 * and waits for the watchdog. */
#include "core/check.h"
#include "hal/inverter.h"

/* For a debugger or a RAM dump. */
static volatile struct {
    check_module_t module;
    uint16_t number;
} check_record;

void check_failed(check_module_t module, uint16_t number)
{
    inverter_trip();
    check_record.module = module;
    check_record.number = number;
    for (;;) { /* the watchdog, no longer fed, restarts the core */
    }
}
