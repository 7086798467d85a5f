/* SPDX-License-Identifier: Apache-2.0 */
#include "app/boot.h"

#include "app/board_check.h"
#include "app/config_store.h"
#include "app/selftest.h"
#include "config/bases.h"
#include "hal/flash.h"
#include "hal/memory.h"
#include "hal/rotor_sensor.h"
#include "hal/serial.h"
#include "hal/time.h"
#include "hal/watchdog.h"

static bool ram_good(void)
{
    const memory_window_t window = memory_unused();
    const bool good = selftest_ram(window.begin, window.words);
    memory_mark_stack();
    return good;
}

static rotor_sensor_kind_t rotor_sensor_kind(int32_t sensor)
{
    switch (sensor) {
    case CONFIG_ROTOR_HALL:
        return ROTOR_SENSOR_HALL;
    case CONFIG_ROTOR_ENCODER:
        return ROTOR_SENSOR_ENCODER;
    default: /* CONFIG_ROTOR_ANGLE; config_validate() refuses other values */
        return ROTOR_SENSOR_ANGLE;
    }
}

static inverter_status_t start_inverter(const config_t *config)
{
    const inverter_settings_t settings = {
        .pwm_frequency_Hz = (uint32_t)config->drive.pwm_frequency_Hz,
        .pwm_period_counts =
            (uint32_t)bases_pwm_period_counts(config, (int32_t)inverter_timer_Hz()),
        .dead_time_ns = (uint32_t)config->drive.dead_time_ns,
    };
    return inverter_init(&settings);
}

boot_report_t boot_run(void)
{
    boot_report_t report = {.inverter = INVERTER_OK};
    report.clock_good = time_init();
    report.reset_cause = watchdog_reset_cause();
    report.ram_good = ram_good();
    serial_init(BOOT_SERIAL_BIT_RATE); /* writes into RAM, so only after the RAM test */
    report.brown_out_low = flash_brown_out_low();
    const flash_image_t firmware = flash_firmware();
    report.firmware_good =
        selftest_firmware(firmware.begin, firmware.size_bytes, flash_firmware_crc32());

    const flash_image_t image = config_store_in_force().image;
    report.config = (const config_t *)image.begin;
    report.config_result = board_check_config(report.config, image.size_bytes);
    if (report.clock_good && report.config_result.code == CONFIG_RESULT_OK) {
        report.rotor_sensor_missing =
            !rotor_sensor_init(rotor_sensor_kind(report.config->rotor.sensor));
        report.inverter = start_inverter(report.config);
    }
    return report;
}

bool boot_config_accepted(const boot_report_t *report)
{
    return report->config_result.code == CONFIG_RESULT_OK && report->inverter == INVERTER_OK &&
           !report->rotor_sensor_missing;
}

bool boot_knows_address(const boot_report_t *report)
{
    return report->clock_good && config_has_address(report->config, report->config_result.code);
}

waits_for_t boot_waits_for(const boot_report_t *report)
{
    const bool accepted = report->config_result.code == CONFIG_RESULT_OK &&
                          !report->rotor_sensor_missing &&
                          report->inverter != INVERTER_FREQUENCY_UNSUPPORTED &&
                          report->inverter != INVERTER_DEAD_TIME_UNSUPPORTED;
    return accepted ? WAITS_FOR_SELFTEST : WAITS_FOR_CONFIGURATION;
}

bool boot_selftest_passed(const boot_report_t *report)
{
    return report->ram_good && report->firmware_good;
}

bool boot_may_control(const boot_report_t *report)
{
    return report->clock_good && boot_config_accepted(report);
}
