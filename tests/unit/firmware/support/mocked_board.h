/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mocked_board.h: what the mocks of the hardware interface answer, and what they were told.
 * Included once in a program.
 */
#ifndef MOCKED_BOARD_H
#define MOCKED_BOARD_H

#include "app/app.h"
#include "app/can_link.h"
#include "comms/messages.h"
#include "config/validate.h"
#include "config_image.h"
#include "controller/controller.h"
#include "mock_analog.h"
#include "mock_can.h"
#include "mock_flash.h"
#include "mock_inverter.h"
#include "mock_memory.h"
#include "mock_rotor_sensor.h"
#include "mock_serial.h"
#include "mock_time.h"
#include "mock_watchdog.h"
#include "unity.h"
#include <string.h>

static struct {
    config_t config;
    uint32_t mark[2]; /* behind it: none (app/config_store.h) */
    analog_sample_t sample;
    inverter_mode_t mode;
    uint16_t compare_counts[3];
    can_frame_t waiting;
    can_frame_t last_state, last_brake;
    can_frame_t demands[8]; /* to other wheels */
    uint16_t pedal_code[ANALOG_PEDAL_CHANNELS];
    uint32_t now_ms, firmware_crc32;
    int sets, feedings, clearings, trips, demand_count, frames_sent, brakes_sent;
    bool fault, at_index, frame_waits, inverter_started, pedals_sampled;
} board;

static messages_address_t own_address(void)
{
    return can_link_address(&board.config, board.config.vehicle.wheel_position);
}

static volatile uint32_t window[4];

static flash_image_t configuration(flash_sector_t sector, int calls)
{
    (void)calls;
    const flash_image_t image = {&board.config, sizeof board.config + sizeof board.mark};
    const flash_image_t none = {NULL, 0};
    return sector == FLASH_CONFIGURATION_A ? image : none;
}

static flash_image_t firmware(int calls)
{
    (void)calls;
    const flash_image_t image = {"123456789", 9};
    return image;
}

static uint32_t firmware_crc32(int calls)
{
    (void)calls;
    return board.firmware_crc32;
}

static memory_window_t unused(int calls)
{
    (void)calls;
    const memory_window_t out = {window, 4};
    return out;
}

static memory_window_t retained(int calls)
{
    (void)calls;
    static uint32_t words[2048];
    const memory_window_t out = {words, 2048};
    return out;
}

static void read_analog(analog_sample_t *sample, int calls)
{
    (void)calls;
    *sample = board.sample;
}

static void set(inverter_mode_t mode, const uint16_t compare_counts[3], int calls)
{
    (void)calls;
    board.sets++;
    board.mode = mode;
    memcpy(board.compare_counts, compare_counts, sizeof board.compare_counts);
}

static void start(int calls)
{
    (void)calls;
    board.inverter_started = true;
}

static bool fault(int calls)
{
    (void)calls;
    return board.fault;
}

static void clear_fault(int calls)
{
    (void)calls;
    board.clearings++;
    board.fault = false;
}

static void trip(int calls)
{
    (void)calls;
    board.trips++;
    board.fault = true;
}

static rotor_sensor_encoder_t encoder(int calls)
{
    (void)calls;
    const rotor_sensor_encoder_t seen = {
        .count = 40000, .index_count = 40000, .index = board.at_index};
    return seen;
}

static void feed(int calls)
{
    (void)calls;
    board.feedings++;
}

static uint32_t now(int calls)
{
    (void)calls;
    return board.now_ms;
}

static bool receive(can_frame_t *frame, int calls)
{
    (void)calls;
    const bool waits = board.frame_waits;
    *frame = board.waiting;
    board.frame_waits = false;
    return waits;
}

static bool transmit(const can_frame_t *frame, int calls)
{
    (void)calls;
    board.frames_sent++;
    if (frame->identifier == messages_identifier(MESSAGES_WHEEL_STATE, own_address())) {
        board.last_state = *frame;
    }
    if (frame->identifier == messages_identifier(MESSAGES_WHEEL_BRAKE, own_address())) {
        board.last_brake = *frame;
        board.brakes_sent++;
    }
    if (frame->identifier < 0x104) { /* hubfoc.dbc: Demand, 0x100 to 0x103 */
        board.demands[board.demand_count++ % 8] = *frame;
    }
    return true;
}

static bool pedals(uint16_t code[ANALOG_PEDAL_CHANNELS], int calls)
{
    (void)calls;
    if (board.pedals_sampled) {
        memcpy(code, board.pedal_code, sizeof board.pedal_code);
    }
    return board.pedals_sampled;
}

#endif
