/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The whole application, main loop included, on the simulated board, against the two controller
 * steps called directly with the same inputs: every bridge command must be equal.
 */
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "app/app.h"
#include "app/can_link.h"
#include "board_rig.h"
#include "comms/messages.h"
#include "config/bases.h"
#include "config/validate.h"
#include "config_image.h"
#include "controller/controller.h"
#include "hal/flash.h"
#include "hal/inverter.h"
#include "hal/time.h"
#include "hal/upcall.h"
#include "host/port.h"
#include "unity.h"

enum { MESSAGE_PERIOD_ms = 10 };

/* Enabled after 0.5 s; then driving, braking and zero demand for 0.2 s each. */
static wheel_demand_t demand_at(uint32_t now_ms)
{
    const uint32_t phase = now_ms / 200 % 3;
    const wheel_demand_t demand = {
        .drive_torque_mNm = phase == 0 ? 5000 : 0,
        .brake_torque_mNm = phase == 1 ? 15000 : 0,
        .direction = DRIVE_DIRECTION_FORWARD,
        .enable = now_ms >= 500,
    };
    return demand;
}

static messages_address_t address_in(const config_t *config)
{
    return can_link_address(config, config->vehicle.wheel_position);
}

static can_frame_t message(uint32_t now_ms)
{
    const wheel_demand_t demand = demand_at(now_ms);
    const messages_frame_t sent =
        messages_demand(&demand, address_in(&CONFIG_IMAGE), (uint8_t)(now_ms / MESSAGE_PERIOD_ms));
    can_frame_t frame = {.identifier = sent.identifier, .length = sent.length};
    memcpy(frame.data, sent.data, sizeof frame.data);
    return frame;
}

/* The sensors here belong to no motor, so the observer would contradict them. */
static const config_t *sensor_alone(void)
{
    static config_t config;
    config = CONFIG_IMAGE;
    config.rotor.observer_takeover = 0;
    config.crc32 = config_crc32(&config, (uint32_t)offsetof(config_t, crc32));
    return &config;
}

/* The vehicle acknowledges what the wheel sends. */
static void take_frames(void)
{
    can_frame_t frame;
    while (host_can_receive(&frame)) {
    }
}

static void run_application(void)
{
    connect(sensor_alone());
    app_boot();
    host_run_for(PERIODS);
    uint32_t sent_ms = 0;
    while (time_running()) {
        if (time_ms() - sent_ms >= MESSAGE_PERIOD_ms) {
            sent_ms = time_ms();
            const can_frame_t frame = message(sent_ms);
            host_can_send(&frame);
        }
        app_background();
        take_frames();
    }
}

static inverter_mode_t expected_mode(bridge_mode_t bridge)
{
    return bridge == BRIDGE_PWM          ? INVERTER_MODE_PWM
           : bridge == BRIDGE_SHORT      ? INVERTER_MODE_SHORT
           : bridge == BRIDGE_SHORT_HIGH ? INVERTER_MODE_SHORT_HIGH
                                         : INVERTER_MODE_OFF;
}

/* Calls the two steps directly and copies the messages by assignment, as the bench does. */
static void assert_equal_to_direct_steps(void)
{
    const config_t *config = sensor_alone();
    static controller_t controller;
    controller_init(&controller, config, BASES_MODEL_TIMER_Hz);
    fast_setpoint_t fast_setpoint = controller_initial_setpoint(config, BASES_MODEL_TIMER_Hz);
    start_sensors();
    (void)next_sample(&sensors); /* the board samples once at start-up */
    fast_output_t out = {.bridge = BRIDGE_OFF};
    wheel_demand_t demand = {0};
    uint32_t demand_ms = 0, now_ms = 0, sent_ms = 0;
    int messages_received = 0;
    bool received = false;
    int running = 0;
    for (int period = 0; period < PERIODS; period++) {
        TEST_ASSERT_EQUAL_INT(expected_mode(out.bridge), commands[period].mode);
        TEST_ASSERT_EQUAL_MEMORY(out.compare_counts, commands[period].compare_counts,
                                 sizeof out.compare_counts);
        running += out.bridge == BRIDGE_PWM ? 1 : 0;
        const host_sample_t s = next_sample(&sensors);
        const fast_input_t in = {
            .phase_current_code = {s.phase_current_code[0], s.phase_current_code[1],
                                   s.phase_current_code[2]},
            .bus_voltage_code = s.bus_voltage_code,
            .rotor_angle_turn =
                config->rotor.sensor == CONFIG_ROTOR_HALL ? (uint16_t)0 : s.rotor_angle_turn,
            .hall_state = config->rotor.sensor == CONFIG_ROTOR_HALL ? s.hall_state : (uint8_t)0,
        };
        out = *controller_fast_step(&controller.fast, config, &fast_setpoint, &in);
        if ((period + 1) % (config->drive.pwm_frequency_Hz / CONTROLLER_SLOW_RATE_HZ) == 0) {
            now_ms++;
            const slow_input_t slow_in = {
                .demand = demand,
                .demand_age_ms = received ? now_ms - demand_ms : UINT32_MAX,
                .bms = {config->battery.max_charge_current_mA * config->battery.driven_wheels,
                        config->battery.max_discharge_current_mA * config->battery.driven_wheels},
                .temperature = {s.winding_temperature_cC, s.switch_temperature_cC},
                .selftest_passed = true,
                .config_accepted = true,
            };
            fast_report_t fast_report;
            controller_fast_report(&controller.fast, &fast_report);
            (void)controller_slow_step(&controller.slow, config, &fast_report, &slow_in,
                                       &fast_setpoint);
        }
        if (now_ms - sent_ms >= MESSAGE_PERIOD_ms) {
            sent_ms = now_ms;
            messages_received++;
            if (messages_received >= E2E_QUALIFYING_FRAMES) { /* the sender is qualified */
                demand = demand_at(now_ms);
                demand_ms = now_ms;
                received = true;
            }
        }
    }
    TEST_ASSERT_TRUE_MESSAGE(running > PERIODS / 4,
                             "the bridge must switch for a quarter of the periods");
}

void setUp(void) {}

void tearDown(void) {}

void test_bridge_commands_equal_those_of_the_direct_steps_in_every_period(void)
{
    run_application();
    TEST_ASSERT_EQUAL_INT(PERIODS, command_count);
    assert_equal_to_direct_steps();
}

void test_watchdog_does_not_reset_and_the_final_mode_is_run(void)
{
    run_application();
    TEST_ASSERT_FALSE(host_watchdog_bit());
    TEST_ASSERT_TRUE_MESSAGE(app_finish(), host_serial_output());
    TEST_ASSERT_NOT_NULL(strstr(host_serial_output(), "configuration accepted"));
    TEST_ASSERT_NOT_NULL(strstr(host_serial_output(), "result: RUN, "));
}

void test_second_run_from_boot_gives_the_same_commands(void)
{
    static bridge_command_t first[PERIODS];
    run_application();
    memcpy(first, commands, sizeof first);
    run_application();
    TEST_ASSERT_EQUAL_MEMORY(first, commands, sizeof first);
}

void test_corrupt_configuration_is_refused_with_its_field_and_the_bridge_stays_off(void)
{
    config_t config = CONFIG_IMAGE;
    config.battery.max_voltage_mV++;
    connect(&config);
    app_boot();
    host_run_for(2000);
    host_serial_type("status\r");
    while (time_running()) {
        app_background();
    }
    TEST_ASSERT_EQUAL_INT(0, command_count);
    TEST_ASSERT_FALSE(app_finish());
    TEST_ASSERT_NOT_NULL(strstr(host_serial_output(), "configuration refused: crc32"));
    TEST_ASSERT_NOT_NULL(strstr(host_serial_output(), "BOOT, bridge off"));
    TEST_ASSERT_FALSE(host_watchdog_bit());
}

/* Frames on the bus in 100 ms of a configuration that the board refuses; the latest WheelState and
 * WheelAvailable of the front left wheel. Without PWM a step is a millisecond. */
static int frames_in_boot(config_t *config, can_frame_t *state, can_frame_t *available)
{
    config->crc32 = config_crc32(config, (uint32_t)offsetof(config_t, crc32));
    connect(config);
    app_boot();
    can_frame_t frame;
    int count = 0;
    for (int ms = 0; ms < 100; ms++) {
        run_for(1);
        while (host_can_receive(&frame)) {
            *state = frame.identifier == 0x180 ? frame : *state;
            *available = frame.identifier == 0x198 ? frame : *available;
            count++;
        }
    }
    TEST_ASSERT_EQUAL_INT(0, command_count);
    return count;
}

/* Ten WheelState and one WheelAvailable. */
void test_a_refused_but_intact_configuration_is_told_to_the_vehicle(void)
{
    config_t config = CONFIG_IMAGE;
    config.vehicle.wheel_position = MESSAGES_FRONT_LEFT;
    config.motor.pole_pairs = 0;
    can_frame_t state = {0}, available = {0};
    TEST_ASSERT_EQUAL_INT(10 + 1, frames_in_boot(&config, &state, &available));
    TEST_ASSERT_EQUAL_UINT16(0x180, state.identifier);
    TEST_ASSERT_EQUAL_UINT8(MODE_BOOT, state.data[1] >> 4);
    TEST_ASSERT_EQUAL_UINT8(REASON_NONE, state.data[2]);
    TEST_ASSERT_TRUE(e2e_intact(E2E_PROFILE_2, state.data, 0x180));
    TEST_ASSERT_EQUAL_UINT16(0x198, available.identifier);
    TEST_ASSERT_TRUE(e2e_intact(E2E_PROFILE_2, available.data, 0x198));
    TEST_ASSERT_EQUAL_UINT8(WAITS_FOR_CONFIGURATION,
                            (available.data[4] >> 6 | available.data[5] << 2) & 0xFF);
}

void test_a_wheel_whose_address_is_not_known_is_silent(void)
{
    config_t config = CONFIG_IMAGE;
    can_frame_t frame = {0};
    config.vehicle.wheel_position = 4;
    TEST_ASSERT_EQUAL_INT(0, frames_in_boot(&config, &frame, &frame));
    config = CONFIG_IMAGE;
    config.vehicle.can_base = 0x110;
    TEST_ASSERT_EQUAL_INT(0, frames_in_boot(&config, &frame, &frame));
    config = CONFIG_IMAGE;
    config.format_version--;
    TEST_ASSERT_EQUAL_INT(0, frames_in_boot(&config, &frame, &frame));
    config = CONFIG_IMAGE;
    config.motor.pole_pairs = 0; /* the CRC is the old one's */
    connect(&config);
    app_boot();
    run_for(100);
    TEST_ASSERT_FALSE(host_can_receive(&frame));
}

void test_board_without_its_crystal_reports_it_and_stays_in_boot(void)
{
    connect(&CONFIG_IMAGE);
    host_break_clock(true);
    app_boot();
    host_run_for(2000);
    while (time_running()) {
        app_background();
    }
    TEST_ASSERT_EQUAL_INT(0, command_count);
    TEST_ASSERT_NOT_NULL(strstr(host_serial_output(), "clock fault"));
}

void test_the_shell_answers_while_the_wheel_turns(void)
{
    connect(&CONFIG_IMAGE);
    app_boot();
    host_run_for(10000);
    host_serial_type("boot\rstatus\rlimits\r");
    while (time_running()) {
        app_background();
    }
    TEST_ASSERT_NOT_NULL(strstr(host_serial_output(), "self-test RAM: good"));
    TEST_ASSERT_NOT_NULL(strstr(host_serial_output(), " rad/s, "));
    /* Nothing is demanded yet, so torque is not enabled in either direction. */
    TEST_ASSERT_NOT_NULL(strstr(host_serial_output(), "driving 0.000 N m, "));
    TEST_ASSERT_NOT_NULL(strstr(host_serial_output(), "\nENABLE          0.000"));
}

/* A trip in READY, which is still there after the reset; 168 bytes of header, 4 800 and 3 200 of
 * entries are 256 lines of hex.
 */
void test_the_shell_prints_the_record_of_the_first_fault_and_a_reset_keeps_it(void)
{
    connect(&CONFIG_IMAGE);
    app_boot();
    run_for(30000);
    inverter_trip();
    run_for(20000);
    app_boot();
    run_for(10000);
    host_serial_type("blackbox\r");
    run_for(10000);
    const char *shown = strstr(host_serial_output(), "black box: record of 77 ");
    TEST_ASSERT_NOT_NULL_MESSAGE(shown, host_serial_output());
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(shown, "\n2 times power stage reported a fault, since production 2\r\n"), shown);
    TEST_ASSERT_NOT_NULL(strstr(shown, "\n0000: 464F46420100E81F04"));
    uint32_t lines = 0;
    for (const char *at = strstr(shown, "\n0000: "); at != NULL; at = strchr(at + 1, '\n')) {
        lines += strncmp(at + 5, ": ", 2) == 0 ? 1U : 0U;
    }
    TEST_ASSERT_EQUAL_UINT32(256, lines);
}

/* One firmware for four wheels: the configuration holds the wheel's address. */
void test_can_identifiers_are_those_of_the_configured_wheel_and_base(void)
{
    static const int32_t BASES[] = {0x100, 0, 0x320, 0x740};
    for (int32_t wheel = MESSAGES_FRONT_LEFT; wheel <= MESSAGES_REAR_RIGHT; wheel++) {
        config_t config = CONFIG_IMAGE;
        config.vehicle.wheel_position = wheel;
        config.vehicle.can_base = BASES[wheel];
        config.crc32 = config_crc32(&config, (uint32_t)offsetof(config_t, crc32));
        connect(&config);
        app_boot();
        run_for(1000);
        can_frame_t frame;
        int states = 0;
        while (host_can_receive(&frame)) {
            TEST_ASSERT_EQUAL_UINT16(wheel, frame.identifier & 3U);
            const uint32_t from_base = frame.identifier - (uint32_t)BASES[wheel];
            TEST_ASSERT_TRUE(from_base >= 0x80 && from_base < 0xA0);
            states += from_base == 0x80U + (uint32_t)wheel ? 1 : 0;
        }
        TEST_ASSERT_TRUE(states > 0);
        TEST_ASSERT_NOT_NULL(
            strstr(host_serial_output(), messages_wheel_text((messages_wheel_t)wheel)));
    }
}
