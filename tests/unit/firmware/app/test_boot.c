/* SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "app/boot.h"
#include "config/bases.h"
#include "config_image.h"
#include "mock_analog.h"
#include "mock_flash.h"
#include "mock_inverter.h"
#include "mock_memory.h"
#include "mock_rotor_sensor.h"
#include "mock_serial.h"
#include "mock_time.h"
#include "mock_watchdog.h"
#include "unity.h"

static struct {
    config_t config;
    uint32_t mark[2]; /* none: app/config_store.h */
} sector;
static flash_image_t sector_a;
static analog_scale_t scale;
static uint32_t dead_time_least_ns;
static bool rotor_sensor_there, brown_out_low;
static volatile uint32_t window[16];

static flash_image_t give_sector(flash_sector_t asked, int calls)
{
    const flash_image_t none = {NULL, 0};
    (void)calls;
    return asked == FLASH_CONFIGURATION_A ? sector_a : none;
}

/* A board without any fault; each test changes one condition. */
static void expect_board(bool clock_good, const void *configuration, uint32_t configuration_bytes,
                         uint32_t firmware_crc32)
{
    const memory_window_t unused = {window, 16};
    const flash_image_t firmware = {"123456789", 9};
    sector_a.begin = configuration;
    sector_a.size_bytes = configuration_bytes + (uint32_t)sizeof sector.mark;
    time_init_ExpectAndReturn(clock_good);
    watchdog_reset_cause_ExpectAndReturn(RESET_POWER);
    memory_unused_ExpectAndReturn(unused);
    memory_mark_stack_Expect();
    serial_init_Expect(BOOT_SERIAL_BIT_RATE);
    flash_firmware_ExpectAndReturn(firmware);
    flash_firmware_crc32_ExpectAndReturn(firmware_crc32);
    flash_sector_StubWithCallback(give_sector);
    flash_brown_out_low_ExpectAndReturn(brown_out_low);
}

static void expect_ports(inverter_status_t status)
{
    static inverter_settings_t settings;
    settings.pwm_frequency_Hz = (uint32_t)sector.config.drive.pwm_frequency_Hz;
    settings.pwm_period_counts =
        (uint32_t)bases_pwm_period_counts(&sector.config, BASES_MODEL_TIMER_Hz);
    settings.dead_time_ns = (uint32_t)sector.config.drive.dead_time_ns;
    static const rotor_sensor_kind_t KINDS[] = {
        [CONFIG_ROTOR_ANGLE] = ROTOR_SENSOR_ANGLE,
        [CONFIG_ROTOR_HALL] = ROTOR_SENSOR_HALL,
        [CONFIG_ROTOR_ENCODER] = ROTOR_SENSOR_ENCODER,
    };
    rotor_sensor_init_ExpectAndReturn(KINDS[sector.config.rotor.sensor], rotor_sensor_there);
    inverter_timer_Hz_ExpectAndReturn(BASES_MODEL_TIMER_Hz);
    inverter_init_ExpectAndReturn(&settings, status);
}

enum { GOOD_CRC32 = (int)0xCBF43926 };

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
    sector.config = CONFIG_IMAGE;
    scale.current_full_scale_mA = sector.config.drive.current_full_scale_mA;
    scale.voltage_full_scale_mV = sector.config.drive.voltage_full_scale_mV;
    scale.low_side_least_ns = 0;
    scale.switch_25C_code = 0;
    analog_scale_Stub(scale_of_board);
    dead_time_least_ns = 0;
    inverter_dead_time_least_ns_Stub(dead_time_of_board);
    rotor_sensor_there = true;
    brown_out_low = false;
}

void tearDown(void) {}

void test_a_board_without_fault_starts_control(void)
{
    expect_board(true, &sector.config, sizeof sector.config, (uint32_t)GOOD_CRC32);
    expect_ports(INVERTER_OK);
    const boot_report_t report = boot_run();
    TEST_ASSERT_TRUE(boot_config_accepted(&report));
    TEST_ASSERT_TRUE(boot_selftest_passed(&report));
    TEST_ASSERT_TRUE(boot_may_control(&report));
    TEST_ASSERT_EQUAL_PTR(&sector.config, report.config);
}

void test_a_low_brown_out_level_is_reported_and_control_starts(void)
{
    for (int low = 0; low <= 1; low++) {
        brown_out_low = low != 0;
        expect_board(true, &sector.config, sizeof sector.config, (uint32_t)GOOD_CRC32);
        expect_ports(INVERTER_OK);
        const boot_report_t report = boot_run();
        TEST_ASSERT_EQUAL(low != 0, report.brown_out_low);
        TEST_ASSERT_TRUE(boot_may_control(&report));
    }
}

static bool line_may_interrupt;

static void start_line(uint32_t bit_rate, int calls)
{
    (void)bit_rate;
    (void)calls;
    line_may_interrupt = true;
}

static memory_window_t give_away_memory(int calls)
{
    (void)calls;
    TEST_ASSERT_FALSE(line_may_interrupt); /* hal/memory.h: only while no interrupt is enabled */
    const memory_window_t unused = {window, 16};
    return unused;
}

void test_memory_is_tested_before_interrupts_are_enabled(void)
{
    line_may_interrupt = false;
    expect_board(true, &sector.config, sizeof sector.config, (uint32_t)GOOD_CRC32);
    expect_ports(INVERTER_OK);
    serial_init_AddCallback(start_line);
    memory_unused_AddCallback(give_away_memory);
    (void)boot_run();
    TEST_ASSERT_TRUE(line_may_interrupt);
}

void test_a_board_without_the_configured_rotor_sensor_does_not_start_control(void)
{
    sector.config.rotor.encoder_counts = 4096;
    for (int32_t sensor = CONFIG_ROTOR_ANGLE; sensor <= CONFIG_ROTOR_ENCODER; sensor++) {
        for (int there = 0; there <= 1; there++) {
            rotor_sensor_there = there != 0;
            sector.config.rotor.sensor = sensor;
            sector.config.crc32 = config_crc32(&sector.config, (uint32_t)offsetof(config_t, crc32));
            expect_board(true, &sector.config, sizeof sector.config, (uint32_t)GOOD_CRC32);
            expect_ports(INVERTER_OK);
            const boot_report_t report = boot_run();
            TEST_ASSERT_EQUAL(there != 0, boot_may_control(&report));
        }
    }
}

/* With the amplifiers of another board every current would be wrong by their ratio; 5 % are the
 * tolerance of shunts and dividers. */
void test_a_configuration_for_other_shunts_or_dividers_is_refused_with_both_numbers(void)
{
    const int32_t of_image = sector.config.drive.current_full_scale_mA;
    scale.current_full_scale_mA = 2 * of_image;
    expect_board(true, &sector.config, sizeof sector.config, (uint32_t)GOOD_CRC32);
    boot_report_t report = boot_run();
    TEST_ASSERT_FALSE(boot_may_control(&report));
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_RANGE, report.config_result.code);
    TEST_ASSERT_EQUAL_STRING("drive.current_full_scale_mA on this board",
                             report.config_result.field);
    TEST_ASSERT_EQUAL_INT32(of_image, report.config_result.value);
    TEST_ASSERT_EQUAL_INT32(2 * of_image - of_image / 10, report.config_result.lowest);
    TEST_ASSERT_EQUAL_INT32(2 * of_image + of_image / 10, report.config_result.highest);

    scale.current_full_scale_mA = of_image + of_image / 25;
    scale.voltage_full_scale_mV = sector.config.drive.voltage_full_scale_mV / 2;
    expect_board(true, &sector.config, sizeof sector.config, (uint32_t)GOOD_CRC32);
    report = boot_run();
    TEST_ASSERT_FALSE(boot_may_control(&report));
    TEST_ASSERT_EQUAL_STRING("drive.voltage_full_scale_mV on this board",
                             report.config_result.field);
}

/* Amplifiers of low-side shunts: 1014 ns to settle and sample, and half of 1000 ns of dead time, on
 * either side of the pulse's middle. */
void test_a_configuration_whose_low_pulses_are_too_short_for_the_shunts_is_refused(void)
{
    sector.config.drive.pwm_frequency_Hz = 20000;
    sector.config.drive.dead_time_ns = 1000;
    scale.low_side_least_ns = 1014;
    for (int32_t half_ns = 1513; half_ns <= 1514; half_ns++) {
        sector.config.drive.min_pulse_ns = half_ns;
        sector.config.crc32 = config_crc32(&sector.config, (uint32_t)offsetof(config_t, crc32));
        expect_board(true, &sector.config, sizeof sector.config, (uint32_t)GOOD_CRC32);
        if (half_ns == 1514) {
            expect_ports(INVERTER_OK);
        }
        const boot_report_t report = boot_run();
        TEST_ASSERT_EQUAL(half_ns == 1514, boot_may_control(&report));
        if (half_ns == 1513) {
            TEST_ASSERT_EQUAL_STRING("drive.min_pulse_ns on this board",
                                     report.config_result.field);
            TEST_ASSERT_EQUAL_INT32(1513, report.config_result.value);
            TEST_ASSERT_EQUAL_INT32(1514, report.config_result.lowest);
        }
    }
}

/* At 20 kHz an eighth of the period is 6250 ns. */
void test_a_configuration_with_less_dead_time_than_the_switches_need_is_refused(void)
{
    sector.config.drive.pwm_frequency_Hz = 20000;
    dead_time_least_ns = 660;
    for (int32_t dead_ns = 659; dead_ns <= 660; dead_ns++) {
        sector.config.drive.dead_time_ns = dead_ns;
        sector.config.crc32 = config_crc32(&sector.config, (uint32_t)offsetof(config_t, crc32));
        expect_board(true, &sector.config, sizeof sector.config, (uint32_t)GOOD_CRC32);
        if (dead_ns == 660) {
            expect_ports(INVERTER_OK);
        }
        const boot_report_t report = boot_run();
        TEST_ASSERT_EQUAL(dead_ns == 660, boot_may_control(&report));
        if (dead_ns == 659) {
            TEST_ASSERT_EQUAL_INT(WAITS_FOR_CONFIGURATION, boot_waits_for(&report));
            TEST_ASSERT_EQUAL_STRING("drive.dead_time_ns on this board",
                                     report.config_result.field);
            TEST_ASSERT_EQUAL_INT32(659, report.config_result.value);
            TEST_ASSERT_EQUAL_INT32(660, report.config_result.lowest);
            TEST_ASSERT_EQUAL_INT32(6250, report.config_result.highest);
        }
    }
}

/* The image's divider has 10 kOhm to ground, as the sensor at 25 degrees. 4.7 kOhm have the code
 * 1309 there, in 10 kOhm that of 21.3 kOhm: 6 degrees of a beta of 3380 K. */
void test_a_configuration_for_another_divider_of_the_switch_sensor_is_refused(void)
{
    static const struct {
        int32_t ground_Ohm;
        bool fits;
    } BOARDS[] = {{10000, true}, {9000, true}, {11000, true}, {4700, false}, {20000, false}};
    for (int k = 0; k < 5; k++) {
        scale.switch_25C_code = 4096 * BOARDS[k].ground_Ohm / (BOARDS[k].ground_Ohm + 10000);
        expect_board(true, &sector.config, sizeof sector.config, (uint32_t)GOOD_CRC32);
        if (BOARDS[k].fits) {
            expect_ports(INVERTER_OK);
        }
        const boot_report_t report = boot_run();
        TEST_ASSERT_EQUAL(BOARDS[k].fits, boot_may_control(&report));
        if (!BOARDS[k].fits) {
            TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_RANGE, report.config_result.code);
            TEST_ASSERT_EQUAL_STRING("temperature.switch_cC of this board's divider at 25 degC",
                                     report.config_result.field);
        }
    }
}

void test_without_a_switch_sensor_any_divider_will_do(void)
{
    sector.config.temperature.switch_lowest_code = 1;
    sector.config.temperature.switch_highest_code = 0;
    sector.config.monitor.switch_sensor_fitted = 0;
    sector.config.crc32 = config_crc32(&sector.config, (uint32_t)offsetof(config_t, crc32));
    scale.switch_25C_code = 1309;
    expect_board(true, &sector.config, sizeof sector.config, (uint32_t)GOOD_CRC32);
    expect_ports(INVERTER_OK);
    const boot_report_t report = boot_run();
    TEST_ASSERT_TRUE(boot_may_control(&report));
}

void test_a_board_without_shunts_and_dividers_takes_any_scale(void)
{
    scale.current_full_scale_mA = 0;
    scale.voltage_full_scale_mV = 0;
    expect_board(true, &sector.config, sizeof sector.config, (uint32_t)GOOD_CRC32);
    expect_ports(INVERTER_OK);
    const boot_report_t report = boot_run();
    TEST_ASSERT_TRUE(boot_may_control(&report));
}

/* Without an expectation for inverter and rotor sensor, a call of either fails the test. */
void test_refused_configuration_starts_neither_bridge_nor_rotor_sensor(void)
{
    sector.config.motor.pole_pairs = 0;
    sector.config.crc32 = config_crc32(&sector.config, (uint32_t)offsetof(config_t, crc32));
    expect_board(true, &sector.config, sizeof sector.config, (uint32_t)GOOD_CRC32);
    const boot_report_t report = boot_run();
    TEST_ASSERT_FALSE(boot_may_control(&report));
    TEST_ASSERT_EQUAL_STRING("motor.", report.config_result.section);
    TEST_ASSERT_TRUE(boot_knows_address(&report));
    TEST_ASSERT_EQUAL_INT(WAITS_FOR_CONFIGURATION, boot_waits_for(&report));
    TEST_ASSERT_EQUAL_STRING("pole_pairs", report.config_result.field);
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_RANGE, report.config_result.code);
}

void test_erased_flash_sector_is_refused(void)
{
    uint8_t erased[sizeof(config_t)];
    memset(erased, 0xFF, sizeof erased);
    memcpy(&sector.config, erased, sizeof sector.config);
    expect_board(true, &sector.config, sizeof sector.config, (uint32_t)GOOD_CRC32);
    const boot_report_t report = boot_run();
    TEST_ASSERT_FALSE(boot_config_accepted(&report));
}

void test_sector_smaller_than_the_image_is_refused_unread(void)
{
    expect_board(true, &sector.config, sizeof sector.config - 4, (uint32_t)GOOD_CRC32);
    const boot_report_t report = boot_run();
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_SIZE, report.config_result.code);
    TEST_ASSERT_FALSE(boot_may_control(&report));
}

void test_without_the_crystal_clock_inverter_and_can_are_not_started(void)
{
    expect_board(false, &sector.config, sizeof sector.config, (uint32_t)GOOD_CRC32);
    const boot_report_t report = boot_run();
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, report.config_result.code);
    TEST_ASSERT_FALSE(boot_may_control(&report));
}

void test_wrong_firmware_crc_fails_the_self_test_and_is_reported(void)
{
    expect_board(true, &sector.config, sizeof sector.config, (uint32_t)GOOD_CRC32 + 1U);
    expect_ports(INVERTER_OK);
    const boot_report_t report = boot_run();
    TEST_ASSERT_FALSE(boot_selftest_passed(&report));
    TEST_ASSERT_TRUE(boot_may_control(&report));
}

void test_configuration_beyond_the_board_s_timer_is_refused(void)
{
    static const inverter_status_t BAD[] = {
        INVERTER_FREQUENCY_UNSUPPORTED, INVERTER_DEAD_TIME_UNSUPPORTED,
        INVERTER_TIMER_UNREADY,         INVERTER_CONVERTER_UNREADY,
        INVERTER_DRIVER_UNREADY,        INVERTER_OVERCURRENT_UNREADY};
    for (size_t i = 0; i < sizeof BAD / sizeof BAD[0]; i++) {
        expect_board(true, &sector.config, sizeof sector.config, (uint32_t)GOOD_CRC32);
        expect_ports(BAD[i]);
        const boot_report_t report = boot_run();
        TEST_ASSERT_FALSE(boot_config_accepted(&report));
        TEST_ASSERT_FALSE(boot_may_control(&report));
        TEST_ASSERT_TRUE(boot_knows_address(&report));
        TEST_ASSERT_EQUAL_INT(i < 2 ? WAITS_FOR_CONFIGURATION : WAITS_FOR_SELFTEST,
                              boot_waits_for(&report));
    }
}
