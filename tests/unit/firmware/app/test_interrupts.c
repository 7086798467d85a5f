/* SPDX-License-Identifier: Apache-2.0 */
/* The application's two interrupt handlers and its background function, with mocks of every
 * function of hal/. */
#include <string.h>

#include "app/app.h"
#include "app/kept_hold.h"
#include "app/kept_temperature.h"
#include "app/recorder.h"
#include "app/supervisor.h"
#include "comms/messages.h"
#include "config/validate.h"
#include "config_image.h"
#include "controller/controller.h"
#include "hal/upcall.h"
#include "mock_analog.h"
#include "mock_can.h"
#include "mock_crash.h"
#include "mock_flash.h"
#include "mock_inverter.h"
#include "mock_memory.h"
#include "mock_packets.h"
#include "mock_rotor_sensor.h"
#include "mock_serial.h"
#include "mock_time.h"
#include "mock_watchdog.h"
#include "mocked_board.h"
#include "unity.h"

void setUp(void)
{
    memset(&board, 0, sizeof board);
    board.config = CONFIG_IMAGE;
    board.config.modes.coast_delay_ms = 0; /* PWM also without demand */
    board.config.crc32 = config_crc32(&board.config, (uint32_t)offsetof(config_t, crc32));
    board.firmware_crc32 = 0xCBF43926U; /* of "123456789", published */
    const config_t *c = &board.config;
    const int32_t v_dc_mV = (c->battery.min_voltage_mV + c->battery.foldback_voltage_mV) / 2;
    board.sample = (analog_sample_t){
        {2048, 2048, 2048}, (uint16_t)((int64_t)v_dc_mV * 4096 / c->drive.voltage_full_scale_mV)};
    crash_record_IgnoreAndReturn(NULL);
    time_init_IgnoreAndReturn(true);
    time_start_tick_Ignore();
    time_ms_StubWithCallback(now);
    time_cycles_IgnoreAndReturn(0);
    serial_init_Ignore();
    serial_read_IgnoreAndReturn(false);
    serial_write_IgnoreAndReturn(0);
    watchdog_reset_cause_IgnoreAndReturn(RESET_POWER);
    watchdog_start_Ignore();
    watchdog_feed_StubWithCallback(feed);
    memory_unused_StubWithCallback(unused);
    memory_retained_StubWithCallback(retained);
    static const memory_window_t NO_SCOPE = {NULL, 0};
    memory_scope_IgnoreAndReturn(NO_SCOPE);
    packets_receive_IgnoreAndReturn(false);
    memory_mark_stack_Ignore();
    memory_stack_free_bytes_IgnoreAndReturn(1000);
    flash_firmware_StubWithCallback(firmware);
    flash_firmware_crc32_StubWithCallback(firmware_crc32);
    flash_sector_StubWithCallback(configuration);
    flash_brown_out_low_IgnoreAndReturn(false);
    rotor_sensor_init_IgnoreAndReturn(true);
    rotor_sensor_encoder_StubWithCallback(encoder);
    rotor_sensor_angle_turn_IgnoreAndReturn(0);
    rotor_sensor_hall_state_IgnoreAndReturn(5);
    inverter_timer_Hz_IgnoreAndReturn(168000000);
    inverter_dead_time_least_ns_IgnoreAndReturn(0);
    inverter_init_IgnoreAndReturn(INVERTER_OK);
    inverter_start_StubWithCallback(start);
    inverter_set_StubWithCallback(set);
    inverter_fault_StubWithCallback(fault);
    inverter_driver_status_IgnoreAndReturn(0);
    inverter_clear_fault_StubWithCallback(clear_fault);
    inverter_trip_StubWithCallback(trip);
    analog_read_StubWithCallback(read_analog);
    static const analog_scale_t ANY = {.switch_25C_code = 0};
    analog_scale_IgnoreAndReturn(ANY);
    analog_winding_temperature_cC_IgnoreAndReturn(2500);
    analog_switch_temperature_cC_IgnoreAndReturn(2500);
    can_init_IgnoreAndReturn(true);
    can_receive_StubWithCallback(receive);
    can_transmit_StubWithCallback(transmit);
    can_progress_IgnoreAndReturn(CAN_SENT);
    can_bus_off_IgnoreAndReturn(false);
}

void tearDown(void) {}

static void milliseconds(int count)
{
    const int fast = board.config.drive.pwm_frequency_Hz / 1000;
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < fast; k++) {
            app_pwm_period_isr();
        }
        board.now_ms++;
        app_millisecond_isr();
        app_background();
    }
}

/* The vehicle's demand message every 10 ms, with valid counter and CRC. */
static void vehicle_sends(bool enable, bool fault_reset, int duration_ms)
{
    static uint8_t counter;
    for (int ms = 0; ms < duration_ms; ms += 10) {
        const wheel_demand_t demand = {.enable = enable, .fault_reset = fault_reset};
        const messages_frame_t sent = messages_demand(&demand, own_address(), counter++);
        can_frame_t frame = {.identifier = sent.identifier, .length = sent.length};
        memcpy(frame.data, sent.data, sizeof frame.data);
        board.waiting = frame;
        board.frame_waits = true;
        milliseconds(10);
    }
}

static operating_mode_t mode_on_can(void)
{
    /* hubfoc.dbc: WheelState.mode, bits 12 .. 15 */
    return (operating_mode_t)(board.last_state.data[1] >> 4);
}

/* Travel of either pedal to codes by the calibration of the configuration. */
static void press(double accelerator, double brake)
{
    for (int k = 0; k < ANALOG_PEDAL_CHANNELS; k++) {
        const config_pedals_t *c = &board.config.pedals;
        const double span_q15 = c->pressed_q15[k] - c->released_q15[k];
        const double above_q15 = (k < 2 ? accelerator : brake) * span_q15;
        board.pedal_code[k] = (uint16_t)((c->released_q15[k] + above_q15) / 8.0 + 0.5);
    }
}

/* The image with pedals on this controller, wheel 0, which sends Demand to wheel 1 as well. */
static void wire_pedals(void)
{
    config_pedals_t *c = &board.config.pedals;
    c->accelerator_channels = 2;
    c->brake_channels = 2;
    c->drive_torque_mNm = 10000;
    c->brake_torque_mNm = 20000;
    c->free_travel_torque_mNm = 0;
    c->brake_share_q15[1] = 16384;
    c->other_wheels = 3; /* also its own bit */
    board.config.vehicle.wheel_position = 0;
    board.config.crc32 = config_crc32(&board.config, (uint32_t)offsetof(config_t, crc32));
    analog_pedals_StubWithCallback(pedals);
    board.pedals_sampled = true;
}

/* Without a CAN message: a vehicle of its own, on and forward. At a standing wheel the whole
 * braking demand is the hydraulic command, 20 N m x (0.24 - 0.05)/0.95 = 4 N m; wheel 1 has half.
 */
void test_wired_pedals_give_the_demand_of_this_wheel_and_of_the_others(void)
{
    wire_pedals();
    press(0.0, 0.24);
    app_boot();
    milliseconds(400);
    TEST_ASSERT_EQUAL_INT(MODE_RUN, mode_on_can());
    TEST_ASSERT_INT_WITHIN(1, 40, board.demand_count); /* every 10 ms, to wheel 1 */
    e2e_receiver_t receiver;
    e2e_receiver_init(&receiver, E2E_PROFILE_5, 50);
    for (int k = 0; k < 8; k++) {
        const can_frame_t *sent = &board.demands[(board.demand_count + k) % 8];
        messages_frame_t frame = {.identifier = (uint16_t)sent->identifier, .length = sent->length};
        memcpy(frame.data, sent->data, sizeof frame.data);
        wheel_demand_t demand;
        TEST_ASSERT_TRUE(messages_read_demand(&frame, &demand) && demand.enable);
        TEST_ASSERT_INT32_WITHIN(100, 2000, demand.brake_torque_mNm);
        const e2e_status_t status =
            e2e_receive(&receiver, frame.data, 0x101, true, 10U * (uint32_t)k);
        TEST_ASSERT_TRUE(k < 3 || status == E2E_OK); /* qualified after the first ones */
    }
}

/* An input that is no longer converted is an open one: the brake pedal is lost after its timeout
 * and fault time, and no Demand is sent. */
void test_pedals_that_are_not_sampled_are_lost(void)
{
    wire_pedals();
    press(0.0, 0.24);
    app_boot();
    milliseconds(400);
    board.pedals_sampled = false;
    milliseconds(board.config.brake.demand_timeout_ms + board.config.pedals.fault_time_ms + 2);
    const int before = board.demand_count;
    milliseconds(100);
    TEST_ASSERT_EQUAL_INT(before, board.demand_count);
}

void test_bridge_is_off_from_boot_to_ready(void)
{
    app_boot();
    TEST_ASSERT_TRUE(board.inverter_started);
    for (int ms = 0; ms < 300; ms++) {
        milliseconds(1);
        TEST_ASSERT_EQUAL_INT(INVERTER_MODE_OFF, board.mode);
    }
    TEST_ASSERT_EQUAL_INT(MODE_READY, mode_on_can());
    TEST_ASSERT_EQUAL_INT(300 * board.config.drive.pwm_frequency_Hz / 1000, board.sets);
}

void test_bridge_switches_after_enable_over_can(void)
{
    app_boot();
    milliseconds(300);
    vehicle_sends(true, false, 100);
    TEST_ASSERT_EQUAL_INT(MODE_RUN, mode_on_can());
    TEST_ASSERT_EQUAL_INT(INVERTER_MODE_PWM, board.mode);
}

void test_run_waits_for_the_encoder_index(void)
{
    board.config.rotor.sensor = CONFIG_ROTOR_ENCODER;
    board.config.rotor.encoder_counts = 65536;
    board.config.crc32 = config_crc32(&board.config, (uint32_t)offsetof(config_t, crc32));
    app_boot();
    milliseconds(300);
    vehicle_sends(true, false, 100);
    TEST_ASSERT_EQUAL_INT(MODE_READY, mode_on_can());
    board.at_index = true;
    vehicle_sends(true, false, 100);
    TEST_ASSERT_EQUAL_INT(MODE_RUN, mode_on_can());
}

void test_neither_halls_nor_encoder_are_read_with_an_angle_sensor(void)
{
    board.config.rotor.sensor = CONFIG_ROTOR_ANGLE;
    board.config.crc32 = config_crc32(&board.config, (uint32_t)offsetof(config_t, crc32));
    rotor_sensor_hall_state_StopIgnore(); /* from here on a call fails the test */
    rotor_sensor_encoder_Stub(NULL);
    app_boot();
    milliseconds(300);
    vehicle_sends(true, false, 100);
    TEST_ASSERT_EQUAL_INT(MODE_RUN, mode_on_can());
}

void test_interrupts_have_no_effect_with_a_refused_configuration(void)
{
    board.config.crc32 ^= 1U;
    app_boot();
    TEST_ASSERT_FALSE(board.inverter_started);
    milliseconds(100);
    TEST_ASSERT_EQUAL_INT(0, board.sets);
    TEST_ASSERT_EQUAL_INT(100, board.feedings);
    TEST_ASSERT_FALSE(app_finish());
}

void test_hardware_fault_is_latched_until_an_acknowledgement(void)
{
    app_boot();
    milliseconds(300);
    vehicle_sends(true, false, 50);
    board.fault = true;
    milliseconds(20);
    TEST_ASSERT_EQUAL_INT(MODE_FAULT, mode_on_can());
    TEST_ASSERT_EQUAL_UINT8(REASON_HARDWARE_BREAK, board.last_state.data[2]);
    TEST_ASSERT_FALSE(app_finish());
    vehicle_sends(false, false, 500);
    TEST_ASSERT_EQUAL_INT(MODE_FAULT, mode_on_can());
    TEST_ASSERT_EQUAL_INT(0, board.clearings);
    vehicle_sends(false, true, 500);
    TEST_ASSERT_TRUE(board.clearings > 0);
    TEST_ASSERT_EQUAL_INT(MODE_READY, mode_on_can());
    TEST_ASSERT_TRUE(app_finish());
}

/* Behind the black box. */
static kept_temperature_t *kept(void)
{
    return (kept_temperature_t *)(uintptr_t)((const volatile char *)retained(0).begin +
                                             sizeof(recorder_memory_t));
}

/* The thermal model goes on where it was before a reset; a word that the supply's return left is
 * none. */
void test_the_warmest_temperature_is_kept_over_a_reset(void)
{
    milliseconds(10);
    TEST_ASSERT_INT32_WITHIN(5, 2500, kept_temperature_read(kept()));
    kept_temperature_write(kept(), 13000);
    app_boot();
    milliseconds(10);
    TEST_ASSERT_INT32_WITHIN(5, 13000, kept_temperature_read(kept()));
    kept()->inverted++;
    TEST_ASSERT_EQUAL_INT32(TEMPERATURE_NONE_cC, kept_temperature_read(kept()));
    app_boot();
    milliseconds(10);
    TEST_ASSERT_INT32_WITHIN(5, 2500, kept_temperature_read(kept()));
}

/* The direction of a vehicle that is held goes from the memory to the controller and back. */
void test_a_hold_is_kept_over_a_reset_and_after_another_one(void)
{
    kept_hold_t *hold = (kept_hold_t *)(uintptr_t)(kept() + 1);
    board.config.driver.hold_torque_mNm = 10000;
    board.config.crc32 = config_crc32(&board.config, (uint32_t)offsetof(config_t, crc32));
    const hill_hold_kept_t backwards = {.direction = DRIVE_DIRECTION_REVERSE};
    kept_hold_write(hold, backwards);
    for (int resets = 0; resets < 3; resets++) {
        app_boot();
        TEST_ASSERT_EQUAL_INT(DRIVE_DIRECTION_REVERSE, kept_hold_read(hold).direction);
        milliseconds(resets); /* also before the first slow step */
        TEST_ASSERT_EQUAL_INT(DRIVE_DIRECTION_REVERSE, kept_hold_read(hold).direction);
    }
    vehicle_sends(true, false, 100); /* selects no direction */
    TEST_ASSERT_EQUAL_INT(DRIVE_DIRECTION_NEUTRAL, kept_hold_read(hold).direction);
    hold->crc32++;
    hold->direction = DRIVE_DIRECTION_FORWARD;
    app_boot();
    TEST_ASSERT_EQUAL_INT(DRIVE_DIRECTION_NEUTRAL, kept_hold_read(hold).direction);
    kept_hold_follow(hold, backwards); /* the record is whole again */
    TEST_ASSERT_EQUAL_INT(DRIVE_DIRECTION_REVERSE, kept_hold_read(hold).direction);
}

void test_watchdog_is_fed_once_in_every_window(void)
{
    app_boot();
    milliseconds(SUPERVISOR_WINDOW_STEPS); /* the first window begins somewhere */
    board.feedings = 0;
    milliseconds(40 * SUPERVISOR_WINDOW_STEPS);
    TEST_ASSERT_INT_WITHIN(1, 40, board.feedings);
}

void test_watchdog_is_not_fed_when_either_loop_stops(void)
{
    app_boot();
    milliseconds(100);
    board.feedings = 0;
    for (int i = 0; i < 100; i++) { /* no PWM period any more */
        app_millisecond_isr();
        app_background();
    }
    TEST_ASSERT_EQUAL_INT(0, board.feedings);
    app_boot();
    milliseconds(100);
    board.feedings = 0;
    for (int i = 0; i < 2000; i++) { /* no millisecond any more */
        app_pwm_period_isr();
        app_background();
    }
    TEST_ASSERT_EQUAL_INT(0, board.feedings);
}

/* The configuration in use changes in RUN: the background finds it, and RUN ends. */
void test_a_damaged_configuration_ends_run_and_cannot_be_acknowledged(void)
{
    app_boot();
    milliseconds(300);
    vehicle_sends(true, false, 100);
    TEST_ASSERT_EQUAL_INT(INVERTER_MODE_PWM, board.mode);
    board.config.vehicle.wheel_radius_um++;
    vehicle_sends(true, false, 1000);
    TEST_ASSERT_EQUAL_INT(INVERTER_MODE_OFF, board.mode);
    TEST_ASSERT_EQUAL_INT(MODE_FAULT, mode_on_can());
    TEST_ASSERT_EQUAL_UINT8(REASON_CONFIG_INVALID, board.last_state.data[2]);
    board.config.vehicle.wheel_radius_um--;
    vehicle_sends(false, true, 1000);
    TEST_ASSERT_EQUAL_INT(MODE_FAULT, mode_on_can());
}

/* The fast monitor's limit and the configuration it was made from differ, as after a bit that
 * flips in either; found before the CRC of the configuration, in two passes. */
void test_a_changed_limit_of_the_fast_monitor_ends_run(void)
{
    app_boot();
    milliseconds(300);
    vehicle_sends(true, false, 100);
    TEST_ASSERT_EQUAL_INT(INVERTER_MODE_PWM, board.mode);
    board.config.monitor.overcurrent_pu_q15--;
    vehicle_sends(true, false, 5);
    TEST_ASSERT_EQUAL_INT(INVERTER_MODE_OFF, board.mode);
    vehicle_sends(true, false, 50);
    TEST_ASSERT_EQUAL_INT(MODE_FAULT, mode_on_can());
    TEST_ASSERT_EQUAL_UINT8(REASON_SELFTEST_FAILED, board.last_state.data[2]);
    board.config.monitor.overcurrent_pu_q15++;
    vehicle_sends(false, true, 500);
    TEST_ASSERT_EQUAL_INT(MODE_FAULT, mode_on_can());
}

/* The brake system must see that its command is no longer made: no frame, so no new counter. Only
 * the wheel's state goes on, every 10 ms, and names the fault. */
void test_frames_but_the_state_end_while_the_slow_loop_is_stopped(void)
{
    app_boot();
    milliseconds(100);
    board.frames_sent = 0;
    for (int ms = 0; ms < APP_SLOW_STOPPED_ms; ms++) {
        board.now_ms++;
        app_background();
    }
    const int sent = board.frames_sent;
    const int brakes_sent = board.brakes_sent;
    const uint8_t state_counter = board.last_state.data[1] & 15U; /* hubfoc.dbc */
    const uint8_t brake_counter = board.last_brake.data[2];
    TEST_ASSERT_GREATER_THAN_INT(0, brakes_sent);
    for (int ms = 0; ms < 200; ms++) {
        board.now_ms++;
        app_background();
    }
    TEST_ASSERT_EQUAL_INT(sent + 20, board.frames_sent);
    TEST_ASSERT_EQUAL_INT(brakes_sent, board.brakes_sent);
    TEST_ASSERT_EQUAL_UINT8(brake_counter, board.last_brake.data[2]);
    TEST_ASSERT_EQUAL_UINT8((state_counter + 20U) & 15U, board.last_state.data[1] & 15U);
    TEST_ASSERT_EQUAL_INT(MODE_FAULT, mode_on_can());
    TEST_ASSERT_EQUAL_UINT8(REASON_PROGRAM_FLOW, board.last_state.data[2]);
    milliseconds(100);
    TEST_ASSERT_GREATER_THAN_INT(sent + 40, board.frames_sent);
}

/* In whatever period it happens: the slow step's report is never older than the latest period. */
void test_next_slow_step_reports_a_trip_of_the_latest_period(void)
{
    const int fast = board.config.drive.pwm_frequency_Hz / 1000;
    for (int early = 0; early < fast; early++) {
        setUp();
        app_boot();
        milliseconds(300);
        vehicle_sends(true, false, 50);
        for (int k = 0; k < fast; k++) {
            board.fault = k >= fast - 1 - early;
            app_pwm_period_isr();
        }
        TEST_ASSERT_NOT_EQUAL_INT(MODE_FAULT, mode_on_can());
        app_millisecond_isr();
        board.now_ms += 10; /* the state's message is due */
        app_background();
        TEST_ASSERT_EQUAL_INT(MODE_FAULT, mode_on_can());
    }
}

/* Otherwise the timer would continue with the last compare values until the watchdog resets. */
void test_slow_loop_switches_the_bridge_off_4_ms_after_the_fast_loop_stops(void)
{
    app_boot();
    milliseconds(300);
    vehicle_sends(true, false, 100);
    TEST_ASSERT_EQUAL_INT(INVERTER_MODE_PWM, board.mode);
    TEST_ASSERT_EQUAL_INT(0, board.trips);
    for (int ms = 0; ms < 4; ms++) {
        app_millisecond_isr();
    }
    TEST_ASSERT_TRUE(board.fault);
}

/* An acknowledgement must not enable the bridge while the fast loop is stopped. */
void test_fault_stays_latched_when_the_fast_loop_continues(void)
{
    app_boot();
    milliseconds(300);
    vehicle_sends(true, false, 100);
    for (int ms = 0; ms < 10; ms++) {
        app_millisecond_isr();
    }
    milliseconds(100);
    TEST_ASSERT_EQUAL_INT(MODE_FAULT, mode_on_can());
    TEST_ASSERT_EQUAL_UINT8(REASON_PROGRAM_FLOW, board.last_state.data[2]);
    TEST_ASSERT_TRUE(board.fault);
    vehicle_sends(false, true, 500);
    TEST_ASSERT_FALSE(board.fault);
    TEST_ASSERT_EQUAL_INT(MODE_READY, mode_on_can());
}

void test_wrong_firmware_crc_leads_to_fault_on_can(void)
{
    board.firmware_crc32++;
    app_boot();
    milliseconds(CONFIG_IMAGE.modes.selftest_timeout_ms + 50);
    TEST_ASSERT_EQUAL_INT(MODE_FAULT, mode_on_can());
    TEST_ASSERT_EQUAL_UINT8(REASON_SELFTEST_FAILED, board.last_state.data[2]);
    TEST_ASSERT_EQUAL_INT(INVERTER_MODE_OFF, board.mode);
}
