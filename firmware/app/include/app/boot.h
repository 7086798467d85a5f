/* SPDX-License-Identifier: Apache-2.0 */
/*
 * boot.h: start-up from reset to the first control step. Background context, once, before any
 * interrupt of the application is enabled.
 *
 * Order: clocks, serial line, RAM window, CRC of the firmware, configuration, then the ports with
 * the settings of the accepted configuration. Start-up continues after a failure where it can, so
 * that the report contains all of them.
 */
#ifndef APP_BOOT_H
#define APP_BOOT_H

#include <stdbool.h>

#include "config/config.h"
#include "config/validate.h"
#include "core/waits_for.h"
#include "hal/inverter.h"
#include "hal/watchdog.h"

enum { BOOT_SERIAL_BIT_RATE = 115200 };

typedef struct {
    bool clock_good; /* otherwise control does not start */
    bool ram_good;
    bool firmware_good;        /* the CRC of the image in flash is the build's */
    bool brown_out_low;        /* option bytes: the chip runs on below the supply that it needs */
    reset_cause_t reset_cause; /* of this start */
    config_result_t config_result;
    inverter_status_t inverter; /* set only with an accepted configuration and a good clock */
    bool rotor_sensor_missing;  /* the board lacks the sensor kind that the configuration names;
                                   set under the same condition as `inverter` */
    const config_t *config;     /* the image in flash; only to be used if `config_result` is good */
} boot_report_t;

/* Runs the whole start-up once and returns what it found. */
boot_report_t boot_run(void);

/* Accepted by the validator, feasible for the port's timers, and the rotor sensor is present. */
bool boot_config_accepted(const boot_report_t *report);

/* True if the wheel may send although it must not control: the clock is good, and magic, version,
 * size and CRC of the configuration hold, so that its address is the wheel's. */
bool boot_knows_address(const boot_report_t *report);

/* What a wheel without control waits for: another configuration, or a part of the board that did
 * not start. */
waits_for_t boot_waits_for(const boot_report_t *report);

/* True if RAM and the firmware's CRC are good. */
bool boot_selftest_passed(const boot_report_t *report);

/* True if the control steps may run: configuration accepted and clock good. After a failed
 * self-test they run and report the fault on CAN. */
bool boot_may_control(const boot_report_t *report);

#endif
