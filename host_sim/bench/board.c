/* SPDX-License-Identifier: Apache-2.0 */
#include "bench/board.h"

#include <string.h>

#include "app/app.h"
#include "bench/link.h"

enum { NO_CURRENT_CODE = 2048, ROOM_TEMPERATURE_cC = 2500 };

static host_sample_t sample(void *context)
{
    return ((const board_t *)context)->sample;
}

static void drive(void *context, inverter_mode_t mode, const uint16_t compare_counts[3])
{
    board_t *board = context;
    board->active.bridge = mode == INVERTER_MODE_PWM          ? BRIDGE_PWM
                           : mode == INVERTER_MODE_SHORT      ? BRIDGE_SHORT
                           : mode == INVERTER_MODE_SHORT_HIGH ? BRIDGE_SHORT_HIGH
                                                              : BRIDGE_OFF;
    memcpy(board->active.compare_counts, compare_counts, sizeof board->active.compare_counts);
}

void board_start(board_t *board, const config_t *config)
{
    const board_t at_rest = {
        .sample = {.phase_current_code = {NO_CURRENT_CODE, NO_CURRENT_CODE, NO_CURRENT_CODE},
                   .winding_temperature_cC = ROOM_TEMPERATURE_cC,
                   .switch_temperature_cC = ROOM_TEMPERATURE_cC},
        .active = {.bridge = BRIDGE_OFF},
    };
    *board = at_rest;
    vehicle_can_init(&board->vehicle, link_address(config));
    const host_plant_t plant = {.context = board, .sample = sample, .drive = drive};
    host_connect(&plant, config, sizeof *config);
    app_boot();
}

static fast_output_t period(void *context, const fast_input_t *in)
{
    board_t *board = context;
    memcpy(board->sample.phase_current_code, in->phase_current_code,
           sizeof board->sample.phase_current_code);
    board->sample.bus_voltage_code = in->bus_voltage_code;
    board->sample.rotor_angle_turn = in->rotor_angle_turn;
    board->sample.hall_state = in->hall_state;
    board->sample.encoder.count = in->encoder.count;
    board->sample.encoder.index_count = in->encoder.index_count;
    board->sample.encoder.index = in->encoder.index;
    board->sample.power_stage_fault = in->power_stage_fault;
    host_pwm_period();
    return board->active;
}

static void receive_messages(board_t *board)
{
    can_frame_t received;
    while (!board->unsent && host_can_receive(&received)) {
        messages_frame_t frame = {.identifier = received.identifier, .length = received.length};
        memcpy(frame.data, received.data, sizeof frame.data);
        vehicle_can_receive(&board->vehicle, &frame);
    }
}

static void send_messages(board_t *board, const slow_input_t *in)
{
    vehicle_can_send(&board->vehicle, in);
    for (uint32_t i = 0; i < board->vehicle.queued_count; i++) {
        const messages_frame_t *queued = &board->vehicle.queued[i];
        can_frame_t sent = {.identifier = queued->identifier, .length = queued->length};
        memcpy(sent.data, queued->data, sizeof sent.data);
        host_can_send(&sent);
    }
}

/* The main loop runs before the interrupt, so that what was received now is acted upon now, and
 * after it. */
static slow_output_t millisecond(void *context, const slow_input_t *in)
{
    board_t *board = context;
    board->sample.winding_temperature_cC = in->temperature.winding_cC;
    board->sample.switch_temperature_cC = in->temperature.switch_cC;
    send_messages(board, in);
    app_background();
    host_millisecond();
    board->vehicle.now_ms++;
    app_background();
    receive_messages(board);
    vehicle_can_expire(&board->vehicle);
    return board->vehicle.received;
}

wheel_coupling_t board_coupling(board_t *board)
{
    const wheel_coupling_t coupling = {
        .context = board, .period = period, .millisecond = millisecond};
    return coupling;
}
