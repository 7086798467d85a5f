/* SPDX-License-Identifier: Apache-2.0 */
/*
 * boot.h: everything between reset and the first control step, once, with no interrupt of the
 * application running.
 *
 * Order: clocks, serial line, RAM window, CRC of the firmware, configuration, then the ports with
 * the numbers of the accepted configuration. Nothing stops at the first failure that does not have
 * to: the report names all of them.
 */
#ifndef APP_BOOT_H
#define APP_BOOT_H

#include <stdbool.h>

#include "config/config.h"
#include "config/validate.h"
#include "hal/inverter.h"

enum { BOOT_SERIAL_BIT_RATE = 115200 };

typedef struct {
    bool clock_good; /* otherwise nothing that needs exact time may run */
    bool ram_good;
    bool firmware_good; /* what is in flash is what was built */
    bool was_watchdog;  /* the watchdog caused this start */
    config_result_t config_result;
    inverter_status_t inverter; /* looked at only with an accepted configuration and a good clock */
    bool rotor_sensor_missing;  /* the board has none of the kind that the configuration names;
                                   looked at likewise */
    const config_t *config;     /* the image in flash; only to be used if `config_result` is good */
} boot_report_t;

boot_report_t boot_run(void);

/* Accepted by the validator, the port's timers can realise it, and its rotor sensor can be read. */
bool boot_config_accepted(const boot_report_t *report);

/* RAM and firmware. */
bool boot_selftest_passed(const boot_report_t *report);

/* May the control steps run at all? They need a configuration and a clock; a failed self-test they
 * report themselves. */
bool boot_may_control(const boot_report_t *report);

#endif
