/* SPDX-License-Identifier: Apache-2.0 */
/* Receiving and validating a configuration with mocks of memory and bridge. With the whole
 * application: test_install_on_host.c. */
#include <string.h>

#include "app/installer.h"
#include "config_image.h"
#include "mock_analog.h"
#include "mock_flash.h"
#include "mock_inverter.h"
#include "unity.h"

static installer_t installer;
static text_t line;
static analog_scale_t scale; /* of the board; 0: any */
static uint32_t dead_time_least_ns;

static analog_scale_t scale_of_board(int calls)
{
    (void)calls;
    return scale;
}

static uint32_t dead_time_of_board(int calls)
{
    (void)calls;
    return dead_time_least_ns;
}

void setUp(void)
{
    const analog_scale_t any = {.switch_25C_code = 0};
    scale = any;
    analog_scale_Stub(scale_of_board);
    dead_time_least_ns = 0;
    inverter_dead_time_least_ns_Stub(dead_time_of_board);
    text_clear(&line);
    installer_init(&installer);
}

void tearDown(void) {}

static void type(const char *text)
{
    for (; *text != '\0' && installer.state == INSTALLER_RECEIVING; text++) {
        installer_receive(&installer, (uint8_t)*text, 0);
    }
}

static void type_byte(uint8_t byte, uint8_t *sum)
{
    static const char DIGITS[] = "0123456789ABCDEF";
    const char text[3] = {DIGITS[byte >> 4], DIGITS[byte & 15U], '\0'};
    *sum = (uint8_t)(*sum + byte);
    type(text);
}

/* Sixteen bytes a record, as objcopy writes it. */
static void send(const config_t *config, uint32_t size_bytes)
{
    const uint8_t *bytes = (const uint8_t *)config;
    installer_open(&installer, 0);
    for (uint32_t at = 0; at < size_bytes; at += 16U) {
        const uint32_t length = size_bytes - at < 16U ? size_bytes - at : 16U;
        uint8_t sum = 0;
        type(":");
        type_byte((uint8_t)length, &sum);
        type_byte((uint8_t)(at >> 8), &sum);
        type_byte((uint8_t)at, &sum);
        type_byte(0, &sum);
        for (uint32_t i = 0; i < length; i++) {
            type_byte(bytes[at + i], &sum);
        }
        type_byte((uint8_t)(0U - sum), &sum);
        type("\r\n");
    }
    type(":00000001FF\r\n");
}

static void assert_says(const char *words)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(line.chars, words), line.chars);
}

void test_complete_configuration_is_accepted_with_its_name(void)
{
    send(&CONFIG_IMAGE, sizeof CONFIG_IMAGE);
    TEST_ASSERT_EQUAL_INT(INSTALLER_ACCEPTED, installer.state);
    TEST_ASSERT_EQUAL_MEMORY(&CONFIG_IMAGE, &installer.image.config, sizeof CONFIG_IMAGE);
    installer_text(&installer, &line);
    assert_says("accepted: configuration ");
    assert_says(CONFIG_IMAGE.name);
}

/* It would be refused at the next start, and nothing would drive. */
void test_a_configuration_for_another_board_is_refused(void)
{
    scale.current_full_scale_mA = 2 * CONFIG_IMAGE.drive.current_full_scale_mA;
    send(&CONFIG_IMAGE, sizeof CONFIG_IMAGE);
    TEST_ASSERT_EQUAL_INT(INSTALLER_REFUSED, installer.state);
    installer_text(&installer, &line);
    assert_says("drive.current_full_scale_mA on this board");
    assert_says("the configuration is as it was");
}

/* Pulses that low-side shunts are not sampled in, and a sensor in another divider. */
void test_a_configuration_for_another_window_or_divider_is_refused(void)
{
    scale.low_side_least_ns = CONFIG_IMAGE.drive.min_pulse_ns;
    send(&CONFIG_IMAGE, sizeof CONFIG_IMAGE);
    TEST_ASSERT_EQUAL_INT(INSTALLER_REFUSED, installer.state);
    installer_text(&installer, &line);
    assert_says("drive.min_pulse_ns on this board");
    scale.low_side_least_ns = 0;
    scale.switch_25C_code = 1309; /* 4.7 kOhm to ground */
    text_clear(&line);
    send(&CONFIG_IMAGE, sizeof CONFIG_IMAGE);
    TEST_ASSERT_EQUAL_INT(INSTALLER_REFUSED, installer.state);
    installer_text(&installer, &line);
    assert_says("temperature.switch_cC of this board's divider");
}

void test_a_configuration_with_less_dead_time_than_the_switches_need_is_refused(void)
{
    dead_time_least_ns = (uint32_t)CONFIG_IMAGE.drive.dead_time_ns;
    send(&CONFIG_IMAGE, sizeof CONFIG_IMAGE);
    TEST_ASSERT_NOT_EQUAL(INSTALLER_REFUSED, installer.state);
    dead_time_least_ns++;
    send(&CONFIG_IMAGE, sizeof CONFIG_IMAGE);
    TEST_ASSERT_EQUAL_INT(INSTALLER_REFUSED, installer.state);
    installer_text(&installer, &line);
    assert_says("drive.dead_time_ns on this board");
    assert_says("the configuration is as it was");
}

void test_a_configuration_that_the_validator_refuses_is_refused_with_its_field(void)
{
    config_t config = CONFIG_IMAGE;
    config.motor.pole_pairs = 0;
    config.crc32 = config_crc32(&config, (uint32_t)offsetof(config_t, crc32));
    send(&config, sizeof config);
    TEST_ASSERT_EQUAL_INT(INSTALLER_REFUSED, installer.state);
    installer_text(&installer, &line);
    assert_says("motor.pole_pairs is 0, accepted 1 .. ");
    assert_says("the configuration is as it was");
}

void test_a_configuration_with_its_end_missing_is_refused(void)
{
    send(&CONFIG_IMAGE, sizeof CONFIG_IMAGE - 4U);
    TEST_ASSERT_EQUAL_INT(INSTALLER_REFUSED, installer.state);
    installer_text(&installer, &line);
    assert_says("size_bytes is not what this firmware expects");
}

void test_a_damaged_record_is_refused_by_number_after_the_last_one(void)
{
    installer_open(&installer, 0);
    type(":0100000011EE\n:0100010022DD\n:0100020033CA\n");
    TEST_ASSERT_EQUAL_INT(INSTALLER_RECEIVING, installer.state);
    type(":00000001FF");
    TEST_ASSERT_EQUAL_INT(INSTALLER_REFUSED, installer.state);
    installer_text(&installer, &line);
    assert_says("refused: record 2: wrong checksum; the configuration is as it was");
}

void test_timeout_or_control_c_cancels_the_reception(void)
{
    installer_open(&installer, 1000);
    installer_receive(&installer, ':', 2000);
    installer_tick(&installer, 2000 + INSTALLER_TIMEOUT_ms - 1);
    TEST_ASSERT_EQUAL_INT(INSTALLER_RECEIVING, installer.state);
    installer_tick(&installer, 2000 + INSTALLER_TIMEOUT_ms);
    TEST_ASSERT_EQUAL_INT(INSTALLER_CANCELLED, installer.state);
    installer_text(&installer, &line);
    assert_says("given up");
    installer_open(&installer, 0);
    installer_receive(&installer, 0x03, 0);
    TEST_ASSERT_EQUAL_INT(INSTALLER_CANCELLED, installer.state);
}

static bool tripped;

static void trip(int calls)
{
    (void)calls;
    tripped = true;
}

static flash_image_t give_sector(flash_sector_t sector, int calls)
{
    static const uint8_t ERASED[16384];
    const flash_image_t image = {ERASED, sizeof ERASED};
    (void)sector;
    (void)calls;
    return image;
}

static flash_status_t erase_status;

static flash_status_t erase(flash_sector_t sector, int calls)
{
    (void)calls;
    TEST_ASSERT_TRUE(tripped);
    TEST_ASSERT_EQUAL_INT(FLASH_CONFIGURATION_B, sector);
    return erase_status;
}

static flash_status_t program(flash_sector_t sector, uint32_t at_bytes, const void *words,
                              uint32_t size_bytes, int calls)
{
    (void)calls;
    TEST_ASSERT_EQUAL_INT(FLASH_CONFIGURATION_B, sector);
    if (at_bytes == 0) {
        TEST_ASSERT_EQUAL_UINT32(sizeof CONFIG_IMAGE, size_bytes);
        TEST_ASSERT_EQUAL_MEMORY(&CONFIG_IMAGE, words, sizeof CONFIG_IMAGE);
    }
    return FLASH_OK;
}

void test_bridge_is_switched_off_before_the_memory_is_written(void)
{
    send(&CONFIG_IMAGE, sizeof CONFIG_IMAGE);
    tripped = false;
    erase_status = FLASH_OK;
    inverter_trip_StubWithCallback(trip);
    flash_sector_StubWithCallback(give_sector);
    flash_erase_StubWithCallback(erase);
    flash_program_StubWithCallback(program);
    TEST_ASSERT_TRUE(installer_write(&installer, &line));
    assert_says("written, restarting");
    inverter_trip_StubWithCallback(NULL);
}

void test_memory_failure_is_reported(void)
{
    static const flash_status_t FAILURES[] = {FLASH_TOO_LARGE, FLASH_BRIDGE_ON, FLASH_ERASE_FAILED,
                                              FLASH_WRITE_FAILED, FLASH_UNSUPPORTED};
    flash_sector_StubWithCallback(give_sector);
    flash_erase_StubWithCallback(erase);
    send(&CONFIG_IMAGE, sizeof CONFIG_IMAGE);
    for (size_t i = 0; i < sizeof FAILURES / sizeof FAILURES[0]; i++) {
        inverter_trip_Expect();
        tripped = true;
        erase_status = FAILURES[i];
        text_clear(&line);
        TEST_ASSERT_FALSE(installer_write(&installer, &line));
        assert_says("FAILED: ");
    }
}
