/* SPDX-License-Identifier: Apache-2.0 */
#include "bench/board.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "app/app.h"
#include "bench/link.h"
#include "hal/upcall.h"

enum { NO_CURRENT_CODE = 2048, ROOM_TEMPERATURE_cC = 2500 };
static const double ON = 0.5; /* a switch given as a number */
static const double MILLISECOND_S = 1e-3;
/* Of a frame of eight bytes with an identifier of 11 bits at 500 kbit/s, with as many stuff bits as
 * there can be (ISO 11898-1): 135 bits; with an identifier of 29 bits 160. */
static const double FRAME_S = 135.0 / 500e3, EXTENDED_FRAME_S = 160.0 / 500e3;

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

void board_restart(board_t *board, reset_cause_t cause, uint32_t duration_ms)
{
    const fast_output_t off = {.bridge = BRIDGE_OFF};
    board->active = off;
    board->reset_ms = duration_ms;
    host_restart(cause);
    if (duration_ms == 0) {
        app_boot();
    }
}

static fast_output_t period(void *context, const fast_input_t *in)
{
    board_t *board = context;
    if (board->reset_ms > 0) {
        return board->active;
    }
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
    if (board->fault.fast_doubled > ON) {
        app_pwm_period_isr();
    }
    return board->active;
}

static void tap(board_t *board, const can_frame_t *frame)
{
    if (board->tapped_count < BOARD_TAPPED_MAX) {
        board->tapped[board->tapped_count] = *frame;
        board->tapped_count++;
    }
}

/* What the others leave of the bus; nobody can keep a bus that was free for later. */
static void receive_messages(board_t *board)
{
    can_frame_t received;
    board->bus_free_s += (1.0 - board->fault.can_load) * MILLISECOND_S;
    while (board->fault.can_unsent < ON && board->bus_free_s >= FRAME_S &&
           host_can_receive(&received)) {
        tap(board, &received);
        if (received.identifier >= CAN_EXTENDED) { /* for displays alone */
            board->bus_free_s -= EXTENDED_FRAME_S;
            continue;
        }
        board->bus_free_s -= FRAME_S;
        messages_frame_t frame = {.identifier = (uint16_t)received.identifier,
                                  .length = received.length};
        memcpy(frame.data, received.data, sizeof frame.data);
        vehicle_can_receive(&board->vehicle, &frame);
    }
    board->bus_free_s = fmin(board->bus_free_s, FRAME_S);
}

static void send_messages(board_t *board, const slow_input_t *in)
{
    vehicle_can_send(&board->vehicle, in);
    for (uint32_t i = 0; i < board->vehicle.queued_count; i++) {
        const messages_frame_t *queued = &board->vehicle.queued[i];
        can_frame_t sent = {.identifier = queued->identifier, .length = queued->length};
        memcpy(sent.data, queued->data, sizeof sent.data);
        tap(board, &sent);
        host_can_send(&sent);
    }
}

/* A program that hangs is restarted by its watchdog, again and again while the cause stays. */
static void restart_when_due(board_t *board)
{
    const fault_params_t *fault = &board->fault;
    if (fault->restart > ON && !board->has_restarted) {
        board_restart(board, fault->restart_cold > ON ? RESET_POWER : RESET_WATCHDOG,
                      (uint32_t)lround(fault->restart_s / MILLISECOND_S));
    } else if (host_watchdog_bit()) {
        board_restart(board, RESET_WATCHDOG, 0);
    }
    board->has_restarted = fault->restart > ON;
}

/* The main loop runs before the interrupt, so that what was received now is acted upon now, and
 * after it. */
static slow_output_t millisecond(void *context, const slow_input_t *in)
{
    board_t *board = context;
    board->sample.winding_temperature_cC = in->temperature.winding_cC;
    board->sample.switch_temperature_cC = in->temperature.switch_cC;
    restart_when_due(board);
    send_messages(board, in);
    if (board->reset_ms == 0) {
        app_background();
        host_hang(board->fault.fast_stopped > ON, board->fault.slow_stopped > ON);
        host_millisecond();
        if (board->fault.slow_doubled > ON) {
            app_millisecond_isr();
        }
    }
    board->vehicle.now_ms++;
    if (board->reset_ms == 0) {
        app_background();
        receive_messages(board);
    } else if (--board->reset_ms == 0) {
        app_boot();
    }
    vehicle_can_expire(&board->vehicle);
    return board->vehicle.received;
}

static void break_down(void *context, const fault_params_t *fault)
{
    const fault_params_t none = {.wheels = 0.0};
    ((board_t *)context)->fault = fault != NULL ? *fault : none;
}

wheel_coupling_t board_coupling(board_t *board)
{
    const wheel_coupling_t coupling = {
        .context = board, .period = period, .millisecond = millisecond, .break_down = break_down};
    return coupling;
}
