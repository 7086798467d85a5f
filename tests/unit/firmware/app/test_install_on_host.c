/* SPDX-License-Identifier: Apache-2.0 */
/* Installing a configuration over the serial line, with the whole application on the simulated
 * board. */
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "app/config_store.h"
#include "app/fault_journal.h"
#include "board_rig.h"
#include "config/validate.h"
#include "hal/inverter.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

/* Types a configuration as objcopy writes one: sixteen bytes a record. */
static void send_configuration(const config_t *config)
{
    const uint8_t *bytes = (const uint8_t *)config;
    for (uint32_t at = 0; at < sizeof *config; at += 16) {
        const uint32_t length = sizeof *config - at < 16 ? (uint32_t)sizeof *config - at : 16U;
        uint32_t sum = length + (at >> 8) + (at & 0xFFU);
        char record[64];
        int written =
            snprintf(record, sizeof record, ":%02X%04X00", (unsigned)length, (unsigned)at);
        for (uint32_t i = 0; i < length; i++) {
            written +=
                snprintf(&record[written], sizeof record - (size_t)written, "%02X", bytes[at + i]);
            sum += bytes[at + i];
        }
        (void)snprintf(&record[written], sizeof record - (size_t)written, "%02X\r\n",
                       (unsigned)(0x100U - (sum & 0xFFU)) & 0xFFU);
        host_serial_type(record);
    }
    host_serial_type(":00000001FF\r\n");
}

static config_t another_configuration(void)
{
    config_t config = CONFIG_IMAGE;
    memcpy(config.name, "another", sizeof "another");
    config.crc32 = config_crc32(&config, (uint32_t)offsetof(config_t, crc32));
    return config;
}

void test_configuration_installed_at_standstill_is_used_after_the_restart(void)
{
    const config_t another = another_configuration();
    connect(&CONFIG_IMAGE);
    sensors.speed_q32 = 0;
    app_boot();
    run_for(10000);
    TEST_ASSERT_FALSE(host_watchdog_bit());
    host_serial_type("install\r");
    run_for(100);
    TEST_ASSERT_NOT_NULL(strstr(host_serial_output(), "send the configuration as Intel HEX"));
    send_configuration(&another);
    run_for(2000);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(host_serial_output(), "accepted: configuration another"),
                                 host_serial_output());
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(host_serial_output(), "written, restarting"),
                                 host_serial_output());
    TEST_ASSERT_EQUAL_INT(INVERTER_MODE_OFF, commands[command_count - 1].mode);
    TEST_ASSERT_TRUE_MESSAGE(host_watchdog_bit(), "it is the watchdog that restarts the core");

    static config_t kept;
    memcpy(&kept, config_store_in_force().image.begin, sizeof kept);
    connect(&kept);
    app_boot();
    run_for(2000);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(host_serial_output(), ", configuration another "),
                                 host_serial_output());
    TEST_ASSERT_NOT_NULL(strstr(host_serial_output(), "configuration accepted"));
}

void test_board_without_a_configuration_accepts_one(void)
{
    config_t erased;
    memset(&erased, 0xFF, sizeof erased);
    connect(&erased);
    app_boot();
    host_serial_type("install\r");
    run_for(100);
    send_configuration(&CONFIG_IMAGE);
    run_for(2000);
    TEST_ASSERT_EQUAL_MEMORY(&CONFIG_IMAGE, config_store_in_force().image.begin,
                             sizeof CONFIG_IMAGE);
}

static bool configuration_unchanged(void)
{
    return memcmp(&CONFIG_IMAGE, config_store_in_force().image.begin, sizeof CONFIG_IMAGE) == 0;
}

void test_refused_configuration_leaves_the_stored_one_and_the_controller_running(void)
{
    config_t damaged = another_configuration();
    damaged.motor.pole_pairs++;
    connect(&CONFIG_IMAGE);
    app_boot();
    host_serial_type("install\r");
    run_for(100);
    send_configuration(&damaged);
    run_for(2000);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(host_serial_output(), "configuration refused: crc32"),
                                 host_serial_output());
    TEST_ASSERT_TRUE(configuration_unchanged());
    TEST_ASSERT_FALSE(host_watchdog_bit());
    TEST_ASSERT_TRUE(app_finish());
}

static void install(const config_t *another)
{
    host_serial_type("install\r");
    run_for(100);
    send_configuration(another);
    run_for(2000);
}

static void assert_refused(void)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(host_serial_output(), "refused: only with the wheel known to be at rest"),
        host_serial_output());
    TEST_ASSERT_TRUE(configuration_unchanged());
    TEST_ASSERT_FALSE(host_watchdog_bit());
}

void test_install_is_refused_while_the_wheel_turns(void)
{
    const config_t another = another_configuration();
    connect(&CONFIG_IMAGE); /* with a turning rotor */
    app_boot();
    run_for(10000);
    install(&another);
    assert_refused();
}

/* The displayed speed is zero after a quarter of a second of dead reckoning, but no sensor has
 * shown a standstill. */
void test_install_is_refused_after_hall_loss_at_speed(void)
{
    const config_t another = another_configuration();
    connect(&CONFIG_IMAGE);
    app_boot();
    run_for(10000);
    sensors.halls_off = true;
    run_for(20000);
    host_serial_type("status\r");
    run_for(200);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(host_serial_output(), ", 0.000 rad/s, "),
                                 host_serial_output());
    install(&another);
    assert_refused();
}

/* A new board without a motor: hall inputs at their pull-ups, zero current, and no sensor has ever
 * shown a speed. */
void test_board_without_motor_and_sensor_accepts_a_configuration(void)
{
    const config_t another = another_configuration();
    connect(&CONFIG_IMAGE);
    sensors.halls_off = true;
    app_boot();
    run_for(10000);
    install(&another);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(host_serial_output(), "written, restarting"),
                                 host_serial_output());
    TEST_ASSERT_FALSE(configuration_unchanged());
}

static uint32_t records(void)
{
    fault_journal_t journal;
    fault_journal_init(&journal);
    return journal.next;
}

/* One record for the fault, none after it; with a turning wheel none at all. */
void test_a_fault_is_written_into_the_journal_once_the_wheel_is_at_rest(void)
{
    for (int turns = 0; turns <= 1; turns++) {
        connect(&CONFIG_IMAGE);
        sensors.speed_q32 = turns != 0 ? sensors.speed_q32 : 0;
        app_boot();
        run_for(20000);
        TEST_ASSERT_EQUAL_UINT32(0, records());
        inverter_trip();
        run_for(60000);
        TEST_ASSERT_EQUAL_UINT32(turns == 0 ? 1 : 0, records());
    }
}
