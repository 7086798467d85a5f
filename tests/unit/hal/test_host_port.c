/* SPDX-License-Identifier: Apache-2.0 */
/* The simulated board keeps the order and the timing of a real one; the application's two up-calls
 * are played here. */
#include <string.h>

#include "hal/analog.h"
#include "hal/flash.h"
#include "hal/rotor_sensor.h"
#include "hal/time.h"
#include "hal/upcall.h"
#include "hal/watchdog.h"
#include "host/port.h"
#include "unity.h"

typedef struct {
    int samples, drives;
    inverter_mode_t mode;
    uint16_t first_compare;
    bool fault;
} plant_t;

static plant_t plant;
static int fast_calls, slow_calls;
static uint16_t compare_to_set;

static host_sample_t sample(void *context)
{
    plant_t *p = context;
    p->samples++;
    const host_sample_t out = {.phase_current_code = {(uint16_t)p->samples, 2, 3},
                               .hall_state = 5,
                               .encoder = {.count = 901, .index_count = 890, .index = true},
                               .rotor_angle_turn = 77,
                               .power_stage_fault = p->fault};
    return out;
}

static void drive(void *context, inverter_mode_t mode, const uint16_t compare_counts[3])
{
    plant_t *p = context;
    p->drives++;
    p->mode = mode;
    p->first_compare = compare_counts[0];
}

void app_pwm_period_isr(void)
{
    fast_calls++;
    const uint16_t compare[3] = {compare_to_set, 0, 0};
    inverter_set(INVERTER_MODE_PWM, compare);
}

void app_millisecond_isr(void)
{
    slow_calls++;
}

static inverter_status_t start(uint32_t frequency_Hz)
{
    const inverter_settings_t settings = {.pwm_frequency_Hz = frequency_Hz,
                                          .pwm_period_counts =
                                              inverter_timer_Hz() / (2U * frequency_Hz),
                                          .dead_time_ns = 500};
    const inverter_status_t status = inverter_init(&settings);
    inverter_start();
    time_start_tick();
    return status;
}

void setUp(void)
{
    const plant_t rest = {0};
    plant = rest;
    fast_calls = 0;
    slow_calls = 0;
    compare_to_set = 0;
    const host_plant_t connection = {.context = &plant, .sample = sample, .drive = drive};
    host_connect(&connection, "\x01\x02\x03\x04", 4);
}

void tearDown(void) {}

void test_no_up_call_before_start(void)
{
    for (int i = 0; i < 100; i++) {
        host_step();
    }
    TEST_ASSERT_EQUAL_INT(0, fast_calls);
    TEST_ASSERT_EQUAL_INT(0, slow_calls);
}

void test_tick_rate_is_1_khz_also_when_the_pwm_frequency_is_no_multiple(void)
{
    (void)start(17500);
    for (int i = 0; i < 17500; i++) {
        host_step();
    }
    TEST_ASSERT_EQUAL_INT(17500, fast_calls);
    TEST_ASSERT_EQUAL_INT(1000, slow_calls);
    TEST_ASSERT_EQUAL_UINT32(1000, time_ms());
}

void test_compare_values_act_from_the_next_top_on(void)
{
    (void)start(20000);
    compare_to_set = 1234;
    host_step();
    TEST_ASSERT_EQUAL_INT(INVERTER_MODE_OFF, plant.mode);
    compare_to_set = 9;
    host_step();
    TEST_ASSERT_EQUAL_INT(INVERTER_MODE_PWM, plant.mode);
    TEST_ASSERT_EQUAL_UINT16(1234, plant.first_compare);
}

void test_the_up_call_reads_the_sample_of_its_own_period(void)
{
    (void)start(20000);
    host_step();
    analog_sample_t sample;
    analog_read(&sample);
    TEST_ASSERT_EQUAL_UINT16(plant.samples, sample.phase_current_code[0]);
    TEST_ASSERT_TRUE(rotor_sensor_init(ROTOR_SENSOR_HALL));
    TEST_ASSERT_EQUAL_UINT8(5, rotor_sensor_hall_state());
    TEST_ASSERT_TRUE(rotor_sensor_init(ROTOR_SENSOR_ANGLE));
    TEST_ASSERT_EQUAL_UINT16(77, rotor_sensor_angle_turn());
    TEST_ASSERT_TRUE(rotor_sensor_init(ROTOR_SENSOR_ENCODER));
    TEST_ASSERT_EQUAL_UINT16(901, rotor_sensor_encoder().count);
    TEST_ASSERT_EQUAL_UINT16(890, rotor_sensor_encoder().index_count);
    TEST_ASSERT_TRUE(rotor_sensor_encoder().index);
}

void test_rotor_sensor_can_be_removed(void)
{
    (void)start(20000);
    host_remove_rotor_sensor(true);
    TEST_ASSERT_FALSE(rotor_sensor_init(ROTOR_SENSOR_HALL));
}

void test_fault_keeps_the_bridge_off_until_cause_is_gone_and_fault_cleared(void)
{
    (void)start(20000);
    host_step();
    host_step();
    TEST_ASSERT_EQUAL_INT(INVERTER_MODE_PWM, plant.mode);
    inverter_trip();
    host_step();
    host_step();
    TEST_ASSERT_TRUE(inverter_fault());
    TEST_ASSERT_EQUAL_INT(INVERTER_MODE_OFF, plant.mode);
    inverter_clear_fault();
    host_step();
    host_step();
    TEST_ASSERT_EQUAL_INT(INVERTER_MODE_PWM, plant.mode);
    plant.fault = true;
    host_step();
    host_step();
    inverter_clear_fault();
    TEST_ASSERT_TRUE(inverter_fault());
    TEST_ASSERT_EQUAL_INT(INVERTER_MODE_OFF, plant.mode);
}

/* Two tops after the last call it is off, and stays so. */
void test_a_bridge_whose_interrupt_hangs_is_off_two_periods_later(void)
{
    start(20000);
    inverter_start();
    for (int n = 0; n < 10; n++) {
        host_step();
        TEST_ASSERT_FALSE(inverter_fault());
    }
    TEST_ASSERT_EQUAL_INT(INVERTER_MODE_PWM, plant.mode);
    host_hang(true, false);
    host_step();
    TEST_ASSERT_EQUAL_INT(INVERTER_MODE_PWM, plant.mode); /* what was computed for this period */
    host_step();
    TEST_ASSERT_EQUAL_INT(INVERTER_MODE_OFF, plant.mode);
    host_hang(false, false);
    host_step();
    host_step();
    TEST_ASSERT_EQUAL_INT(INVERTER_MODE_OFF, plant.mode);
    TEST_ASSERT_TRUE(inverter_fault());
    inverter_clear_fault();
    host_step();
    host_step();
    TEST_ASSERT_EQUAL_INT(INVERTER_MODE_PWM, plant.mode);
}

void test_settings_outside_the_range_of_every_port_are_refused(void)
{
    inverter_settings_t settings = {
        .pwm_frequency_Hz = 20000, .pwm_period_counts = 4200, .dead_time_ns = 6001};
    TEST_ASSERT_EQUAL_INT(INVERTER_DEAD_TIME_UNSUPPORTED, inverter_init(&settings));
    settings.dead_time_ns = 1000;
    settings.pwm_period_counts = 4205; /* 0.12 % */
    TEST_ASSERT_EQUAL_INT(INVERTER_FREQUENCY_UNSUPPORTED, inverter_init(&settings));
}

void test_only_accepted_identifiers_arrive(void)
{
    const uint16_t accepted[] = {0x200};
    TEST_ASSERT_TRUE(can_init(accepted, 1));
    const can_frame_t wrong = {.identifier = 0x201, .length = 8};
    const can_frame_t right = {.identifier = 0x200, .length = 8, .data = {1}};
    host_can_send(&wrong);
    host_can_send(&right);
    can_frame_t frame;
    TEST_ASSERT_TRUE(can_receive(&frame));
    TEST_ASSERT_EQUAL_UINT16(0x200, frame.identifier);
    TEST_ASSERT_FALSE(can_receive(&frame));
}

/* An identifier of 29 bits whose low bits are those of an accepted one, and one whose first 11 bits
 * are. */
void test_frames_of_29_bits_are_sent_after_all_others_and_never_received(void)
{
    const uint16_t accepted[] = {0x200};
    TEST_ASSERT_TRUE(can_init(accepted, 1));
    const can_frame_t foreign[] = {{.identifier = CAN_EXTENDED | 0x200},
                                   {.identifier = CAN_EXTENDED | 0x200U << 18}};
    can_frame_t frame;
    host_can_send(&foreign[0]);
    host_can_send(&foreign[1]);
    TEST_ASSERT_FALSE(can_receive(&frame));
    const can_frame_t own = {.identifier = 0x7FF};
    const can_frame_t extended = {.identifier = CAN_EXTENDED | 0x90A};
    TEST_ASSERT_TRUE(can_transmit(&own));
    TEST_ASSERT_FALSE(can_transmit(&extended));
    TEST_ASSERT_TRUE(host_can_receive(&frame));
    TEST_ASSERT_FALSE(can_transmit(&extended)); /* nobody has asked what became of it */
    TEST_ASSERT_EQUAL_INT(CAN_SENT, can_progress(own.identifier));
    TEST_ASSERT_TRUE(can_transmit(&extended));
    TEST_ASSERT_TRUE(can_transmit(&own));
    TEST_ASSERT_TRUE(host_can_receive(&frame));
    TEST_ASSERT_EQUAL_HEX32(own.identifier, frame.identifier);
    TEST_ASSERT_TRUE(host_can_receive(&frame));
    TEST_ASSERT_EQUAL_HEX32(extended.identifier, frame.identifier);
    TEST_ASSERT_EQUAL_INT(CAN_SENT, can_progress(extended.identifier));
}

void test_watchdog_resets_only_when_it_is_not_fed(void)
{
    time_start_tick();
    watchdog_start(10);
    for (int i = 0; i < 50; i++) {
        watchdog_feed();
        host_step();
    }
    TEST_ASSERT_FALSE(host_watchdog_bit());
    for (int i = 0; i < 11; i++) {
        host_step();
    }
    TEST_ASSERT_TRUE(host_watchdog_bit());
}

void test_configuration_sector_contains_the_image_and_is_erased_after_it(void)
{
    const flash_image_t image = flash_sector(FLASH_CONFIGURATION_A);
    const uint8_t *bytes = image.begin;
    TEST_ASSERT_EQUAL_UINT8(4, bytes[3]);
    TEST_ASSERT_EQUAL_UINT8(0xFF, bytes[4]);
    TEST_ASSERT_EQUAL_UINT8(0xFF, bytes[image.size_bytes - 1]);
}

void test_flash_is_erased_as_a_sector_and_programming_only_clears_bits(void)
{
    const uint8_t *other = flash_sector(FLASH_JOURNAL_B).begin;
    TEST_ASSERT_EQUAL_INT(FLASH_OK, flash_program(FLASH_JOURNAL_B, 8, "\x09\x08\x07\x06", 4));
    TEST_ASSERT_EQUAL_UINT8(9, other[8]);
    TEST_ASSERT_EQUAL_INT(FLASH_WRITE_FAILED,
                          flash_program(FLASH_JOURNAL_B, 8, "\x06\x08\x07\x06", 4));
    TEST_ASSERT_EQUAL_UINT8(0, other[8]);
    TEST_ASSERT_EQUAL_INT(FLASH_TOO_LARGE,
                          flash_program(FLASH_JOURNAL_B, HOST_FLASH_BYTES, "\x06\x08\x07\x06", 4));
    TEST_ASSERT_EQUAL_INT(FLASH_OK, flash_erase(FLASH_JOURNAL_B));
    TEST_ASSERT_EQUAL_UINT8(0xFF, other[8]);
    const uint8_t *configuration = flash_sector(FLASH_CONFIGURATION_A).begin;
    TEST_ASSERT_EQUAL_UINT8(4, configuration[3]);
}

void test_flash_is_neither_erased_nor_programmed_while_the_bridge_switches(void)
{
    (void)start(20000);
    host_step();
    TEST_ASSERT_EQUAL_INT(FLASH_BRIDGE_ON, flash_erase(FLASH_JOURNAL_A));
    TEST_ASSERT_EQUAL_INT(FLASH_BRIDGE_ON,
                          flash_program(FLASH_JOURNAL_A, 0, "\x09\x08\x07\x06", 4));
    inverter_trip();
    TEST_ASSERT_EQUAL_INT(FLASH_OK, flash_erase(FLASH_JOURNAL_A));
}

void test_run_ends_after_the_requested_number_of_periods(void)
{
    (void)start(20000);
    host_run_for(40);
    int polls = 0;
    while (time_running()) {
        polls++;
    }
    TEST_ASSERT_EQUAL_INT(40, polls);
    TEST_ASSERT_EQUAL_INT(40, fast_calls);
}
