/* SPDX-License-Identifier: Apache-2.0 */
/*
 * boot_fixture.h: the report of a successful boot and the controller's output in READY, for tests
 * of the texts that the application prints.
 */
#ifndef BOOT_FIXTURE_H
#define BOOT_FIXTURE_H

#include "app/boot.h"
#include "config_image.h"
#include "controller/controller.h"

static inline boot_report_t successful_boot(void)
{
    const boot_report_t out = {.clock_good = true,
                               .ram_good = true,
                               .firmware_good = true,
                               .config_result = {.field = ""},
                               .config = &CONFIG_IMAGE};
    return out;
}

static inline slow_output_t output_in_ready(void)
{
    const slow_output_t out = {
        .mode = MODE_READY, .torque_reason = REASON_TORQUE_ENABLE, .bus_voltage_mV = 53012};
    return out;
}

#endif
