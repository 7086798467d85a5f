/* SPDX-License-Identifier: Apache-2.0 */
#include "bench/board.h"

#include <string.h>

#include "app/app.h"

enum { NO_CURRENT_CODE = 2048, ROOM_TEMPERATURE_cC = 2500, TIMEOUT_CYCLES = 5 };

static host_sample_t sample(void *context)
{
    return ((const board_t *)context)->sample;
}

static void drive(void *context, inverter_mode_t mode, const uint16_t compare_counts[3])
{
    board_t *board = context;
    board->active.bridge = mode == INVERTER_MODE_PWM     ? BRIDGE_PWM
                           : mode == INVERTER_MODE_SHORT ? BRIDGE_SHORT
                                                         : BRIDGE_OFF;
    memcpy(board->active.compare_counts, compare_counts, sizeof board->active.compare_counts);
}

void board_start(board_t *board, const config_t *config)
{
    const board_t at_rest = {
        .wheel = (messages_wheel_t)config->vehicle.wheel_position,
        .sample = {.phase_current_code = {NO_CURRENT_CODE, NO_CURRENT_CODE, NO_CURRENT_CODE},
                   .winding_temperature_cC = ROOM_TEMPERATURE_cC,
                   .switch_temperature_cC = ROOM_TEMPERATURE_cC},
        .active = {.bridge = BRIDGE_OFF},
        .received = {.mode = MODE_BOOT},
    };
    *board = at_rest;
    e2e_receiver_init(&board->state_link, messages_profile(MESSAGES_WHEEL_STATE),
                      TIMEOUT_CYCLES * messages_cycle_ms(MESSAGES_WHEEL_STATE));
    e2e_receiver_init(&board->brake_link, messages_profile(MESSAGES_WHEEL_BRAKE),
                      TIMEOUT_CYCLES * messages_cycle_ms(MESSAGES_WHEEL_BRAKE));
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

static void send(board_t *board, const messages_frame_t *frame)
{
    can_frame_t *sent = &board->queued[board->queued_count];
    board->queued_count++;
    sent->identifier = frame->identifier;
    sent->length = frame->length;
    memcpy(sent->data, frame->data, sizeof sent->data);
    host_can_send(sent);
}

/* The messages of the vehicle and of the battery that are due in this millisecond. */
static void send_messages(board_t *board, const slow_input_t *in)
{
    board->queued_count = 0;
    const uint32_t demand_cycle_ms = messages_cycle_ms(MESSAGES_DEMAND);
    if (board->now_ms % demand_cycle_ms == 0 && in->demand_age_ms < demand_cycle_ms) {
        const messages_frame_t frame =
            messages_demand(&in->demand, board->wheel, board->demand_counter++);
        send(board, &frame);
    }
    if (board->now_ms % messages_cycle_ms(MESSAGES_BATTERY_LIMITS) == 0) {
        const messages_frame_t frame = messages_battery(&in->bms, board->battery_counter++);
        send(board, &frame);
    }
    if (in->bms.charge_peak_current_mA > 0 &&
        board->now_ms % messages_cycle_ms(MESSAGES_BATTERY_PEAK) == 0) {
        const messages_frame_t frame = messages_peak(&in->bms, board->peak_counter++);
        send(board, &frame);
    }
    if (in->hydraulic.valid && in->hydraulic.age_ms == 0) {
        const messages_frame_t frame =
            messages_hydraulic(&in->hydraulic, board->wheel, board->hydraulic_counter++);
        send(board, &frame);
    }
}

static e2e_receiver_t *link_of(board_t *board, uint16_t identifier)
{
    return identifier == messages_identifier(MESSAGES_WHEEL_STATE, board->wheel)
               ? &board->state_link
               : &board->brake_link;
}

static void receive_messages(board_t *board)
{
    can_frame_t received;
    while (host_can_receive(&received)) {
        messages_frame_t frame = {.identifier = received.identifier, .length = received.length};
        memcpy(frame.data, received.data, sizeof frame.data);
        slow_output_t message = board->received;
        if (!messages_read_output(&frame, board->wheel, &message)) {
            continue; /* of no interest to the plant */
        }
        const e2e_status_t check = e2e_receive(link_of(board, frame.identifier), frame.data,
                                               frame.identifier, true, board->now_ms);
        if (check == E2E_OK || check == E2E_SOME_LOST) {
            board->received = message;
        }
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
    board->now_ms++;
    app_background();
    receive_messages(board);
    return board->received;
}

wheel_coupling_t board_coupling(board_t *board)
{
    const wheel_coupling_t coupling = {
        .context = board, .period = period, .millisecond = millisecond};
    return coupling;
}
