/* SPDX-License-Identifier: Apache-2.0 */
#include "app/service.h"

#include <stdatomic.h>
#include <stddef.h>

#include "core/signals.h"
#include "hal/memory.h"
#include "hal/packets.h"
#include "hal/random.h"

enum {
    ANSWERS_ABOVE_COMMANDS = CONFIG_WHEELS,
    CONNECT = 0xFF, /* comms/xcp.h */
    DISCONNECT = 0xFE,
    COMMANDS_A_PASS = 8,
    PACKETS_A_PASS = 64
};

#define PLACE(from, type, where) {offsetof(type, where), sizeof(((type *)NULL)->where), (from)},
#define OUTPUT(name, raw, where, ...) PLACE(XCP_RECORD_OUTPUT, slow_output_t, where)
#define INPUT(name, raw, where, ...) PLACE(XCP_RECORD_INPUT, slow_input_t, where)
#define FAST_OUTPUT(name, raw, where, ...) PLACE(XCP_RECORD_FAST_OUTPUT, fast_output_t, where)
#define FAST_INPUT(name, raw, where, ...) PLACE(XCP_RECORD_FAST_INPUT, fast_input_t, where)
#define FAST_VIEW(name, raw, where, ...) PLACE(XCP_RECORD_FAST_VIEW, fast_view_t, where)

static const xcp_signal_t SIGNALS[] = {
    SIGNALS_SLOW_OUTPUTS(OUTPUT) SIGNALS_SLOW_INPUTS(INPUT) SIGNALS_FAST_OUTPUTS(FAST_OUTPUT)
        SIGNALS_FAST_INPUTS(FAST_INPUT) SIGNALS_FAST_VIEW(FAST_VIEW)};
_Static_assert(sizeof SIGNALS / sizeof SIGNALS[0] <= UINT8_MAX, "places in scope_entry_t");

static const daq_line_t LINES[SERVICE_LINES] = {
    [SERVICE_CAN] = {.packet_bytes = XCP_PACKET_BYTES, .packets_a_ms = 1},
    [SERVICE_PACKETS] = {.packet_bytes = DAQ_PACKET_BYTES,
                         .packets_a_ms = DAQ_QUEUE,
                         .carries_fast_list = true},
    [SERVICE_SERIAL] = {.packet_bytes = XCP_PACKET_BYTES, .packets_a_ms = 0},
};
_Static_assert((int)DAQ_PACKET_BYTES <= (int)PACKET_BYTES, "hal/packets.h");

/* Apart from service_t, which a port without XCP has too. */
static daq_t daq;
static scope_t scope;
/* Each context fills it before it reads. One interrupts another with later values: in the PWM
 * period, where whole rows are taken, they are always of that period. */
static fast_view_t loop;

static xcp_table_t table_of(const service_t *service, const slow_output_t *output,
                            const slow_input_t *input)
{
    const controller_fast_t *fast = service->link->fast;
    controller_fast_view(fast, &loop);
    const xcp_table_t table = {
        .signals = SIGNALS,
        .signals_count = sizeof SIGNALS / sizeof SIGNALS[0],
        .record = {[XCP_RECORD_OUTPUT] = output,
                   [XCP_RECORD_INPUT] = input,
                   [XCP_RECORD_FAST_OUTPUT] = &fast->output,
                   [XCP_RECORD_FAST_INPUT] = service->link->fast_input,
                   [XCP_RECORD_FAST_VIEW] = &loop},
    };
    return table;
}

static xcp_access_t access_of(service_t *service, const service_view_t *view)
{
    const xcp_access_t access = {
        .table = table_of(service, view->output, view->input),
        .slow_steps = service->slow_steps,
        .line = &LINES[service->line],
        .daq = &daq,
        .scope = &scope,
        .in_force = view->in_force,
        .staging = view->staging,
        .identification = "hubfoc-" HUBFOC_VERSION,
    };
    return access;
}

void service_init(service_t *service, const config_t *config, const service_link_t *link)
{
    const service_t fresh = {.on_can = config->service.can_base != 0, .link = link};
    const int32_t command = config->service.can_base + config->vehicle.wheel_position;
    const memory_window_t memory = memory_scope();
    *service = fresh;
    *link->recording = NULL;
    service->command_identifier = (uint16_t)command;
    service->answer_identifier = (uint16_t)(command + ANSWERS_ABOVE_COMMANDS);
    xcp_init(&service->slave);
    daq_init(&daq);
    /* Not volatile for the scope: app.c, start_recorder(). */
    scope_init(&scope, (void *)(uintptr_t)memory.begin, 4U * memory.words,
               (uint32_t)config->drive.pwm_frequency_Hz);
}

/* What the interrupts are to call from now on, after what the background has changed. */
static void follow(service_t *service)
{
    atomic_signal_fence(memory_order_seq_cst); /* app/double_buffer.h, Memory order */
    service->samples = daq_runs_slow(&daq);
    *service->link->recording = scope_runs(&scope) ? &scope : NULL;
}

void service_slow_step(service_t *service, const slow_output_t *output, const slow_input_t *input)
{
    service->slow_steps = (uint16_t)(service->slow_steps + 1U);
    if (!service->samples && *service->link->recording == NULL) {
        return;
    }
    const xcp_table_t table = table_of(service, output, input);
    if (service->samples) {
        daq_slow_step(&daq, &table, service->slow_steps);
    }
    if (*service->link->recording != NULL) {
        scope_slow_step(&scope, &table, service->link->findings);
    }
}

void service_fast_step(scope_t *recording, const controller_fast_t *fast)
{
    controller_fast_view(fast, &loop);
    scope_fast_step(recording);
}

bool service_accepts(const service_t *service, uint16_t *identifier)
{
    *identifier = service->command_identifier;
    return service->on_can;
}

static void answer(service_t *service, const packet_t *packet)
{
    if (packet->length == 0) {
        return;
    }
    if (service->line == SERVICE_PACKETS) {
        (void)packets_send(packet);
        return;
    }
    if (service->line == SERVICE_SERIAL) {
        for (uint32_t i = 0; i < packet->length; i++) {
            service->serial_answer[i] = packet->bytes[i];
        }
        service->serial_answer_bytes = packet->length;
        return;
    }
    service->answer.identifier = service->answer_identifier;
    service->answer.length = packet->length;
    for (uint32_t i = 0; i < packet->length; i++) {
        service->answer.data[i] = packet->bytes[i];
    }
    service->answers = true;
}

static void obey(service_t *service, const service_view_t *view, const uint8_t *command,
                 uint32_t length, service_line_t line, uint32_t now_ms)
{
    packet_t out;
    if (length > 0 && command[0] == CONNECT) {
        service->line = line;
    } else if (service->line != line) {
        return;
    }
    const xcp_access_t access = access_of(service, view);
    out.length = (uint8_t)xcp_command(&service->slave, &access, now_ms, command, length, out.bytes);
    follow(service);
    answer(service, &out);
}

void service_receive(service_t *service, const service_view_t *view, const can_frame_t *frame,
                     uint32_t now_ms)
{
    obey(service, view, frame->data, frame->length, SERVICE_CAN, now_ms);
}

void service_receive_serial(service_t *service, const service_view_t *view, const uint8_t *packet,
                            uint32_t length, uint32_t now_ms)
{
    obey(service, view, packet, length, SERVICE_SERIAL, now_ms);
}

uint32_t service_serial_answer(service_t *service, const uint8_t **packet)
{
    const uint32_t bytes = service->serial_answer_bytes;
    service->serial_answer_bytes = 0;
    *packet = service->serial_answer;
    return bytes;
}

void service_end_serial(service_t *service, const service_view_t *view, uint32_t now_ms)
{
    static const uint8_t END = DISCONNECT;
    obey(service, view, &END, sizeof END, SERVICE_SERIAL, now_ms);
    service->serial_answer_bytes = 0;
}

static void receive_packets(service_t *service, const service_view_t *view, uint32_t now_ms)
{
    packet_t packet;
    for (int i = 0; i < COMMANDS_A_PASS && packets_receive(&packet); i++) {
        obey(service, view, packet.bytes, packet.length, SERVICE_PACKETS, now_ms);
    }
}

/* The fence keeps a packet from being overwritten while it is copied. */
static void take_measured(void)
{
    atomic_signal_fence(memory_order_seq_cst);
    daq_taken(&daq, &scope);
}

static void send_packets(void)
{
    packet_t packet;
    for (int i = 0; i < PACKETS_A_PASS; i++) {
        packet.length = (uint8_t)daq_next(&daq, &scope, packet.bytes);
        if (packet.length == 0 || !packets_send(&packet)) {
            return;
        }
        take_measured();
    }
}

static void measure(service_t *service)
{
    uint8_t bytes[DAQ_PACKET_BYTES];
    const uint32_t length = service->measures ? 0U : daq_next(&daq, &scope, bytes);
    if (length == 0) {
        return;
    }
    service->measured.identifier = service->answer_identifier;
    service->measured.length = (uint8_t)length;
    for (uint32_t i = 0; i < length; i++) {
        service->measured.data[i] = bytes[i];
    }
    service->measures = true;
    take_measured();
}

static void follow_sent(service_t *service)
{
    const can_progress_t progress = can_progress(service->answer_identifier);
    service->under_way = progress == CAN_PENDING;
    if (progress == CAN_ABORTED && service->under_way_is_measured) {
        service->measures = true;
    } else if (progress == CAN_ABORTED) {
        service->answers = true;
    }
}

/* One frame at a time: answers first. */
static void transmit(service_t *service)
{
    if (service->under_way) {
        follow_sent(service);
    }
    if (service->under_way) {
        return;
    }
    if (service->answers) {
        service->under_way = can_transmit(&service->answer);
        service->answers = !service->under_way;
        service->under_way_is_measured = false;
        return;
    }
    measure(service);
    if (service->measures) {
        service->under_way = can_transmit(&service->measured);
        service->measures = !service->under_way;
        service->under_way_is_measured = true;
    }
}

void service_step(service_t *service, const service_view_t *view, uint32_t now_ms)
{
    receive_packets(service, view, now_ms);
    if (service->slave.connected) {
        const xcp_access_t access = access_of(service, view);
        uint64_t bits;
        xcp_tick(&service->slave, &access, now_ms);
        if (xcp_wants_seed(&service->slave) && random_draw(&bits)) {
            xcp_give_seed(&service->slave, bits);
        }
    }
    follow(service);
    if (service->line == SERVICE_PACKETS) {
        send_packets();
    } else {
        transmit(service);
    }
}

bool service_wants_store(const service_t *service)
{
    return service->slave.store_wanted;
}

void service_store(service_t *service, xcp_error_t error, uint32_t now_ms)
{
    packet_t out;
    out.length = (uint8_t)xcp_store(&service->slave, error, out.bytes);
    answer(service, &out);
    service->stores = error == XCP_ERROR_NONE;
    service->stores_since_ms = now_ms;
}

bool service_store_is_due(service_t *service, uint32_t now_ms)
{
    const bool left = service->line != SERVICE_SERIAL && !service->answers && !service->under_way;
    const bool due =
        service->stores && (left || now_ms - service->stores_since_ms >= SERVICE_ANSWER_ms);
    service->stores = service->stores && !due;
    return due;
}
