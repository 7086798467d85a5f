/* SPDX-License-Identifier: Apache-2.0 */
/* Where every CHECK() of every room ends: a programming error or a broken memory cell, so nothing
 * may be trusted. */
#include "core/check.h"
#include "hal/inverter.h"

/* For a debugger, and for whoever reads the RAM of a board that stopped. */
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
