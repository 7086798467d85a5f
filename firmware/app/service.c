/* SPDX-License-Identifier: Apache-2.0 */
#include "app/service.h"

#include <stddef.h>

#include "core/signals.h"
#include "hal/random.h"

enum { ANSWERS_ABOVE_COMMANDS = CONFIG_WHEELS };

#define PLACE(from, type, where) {offsetof(type, where), sizeof(((type *)NULL)->where), (from)},
#define OUTPUT(name, raw, where, ...) PLACE(XCP_RECORD_OUTPUT, slow_output_t, where)
#define INPUT(name, raw, where, ...) PLACE(XCP_RECORD_INPUT, slow_input_t, where)

static const xcp_signal_t SIGNALS[] = {SIGNALS_SLOW_OUTPUTS(OUTPUT) SIGNALS_SLOW_INPUTS(INPUT)};

static xcp_access_t access_of(const service_view_t *view)
{
    const xcp_access_t access = {
        .signals = SIGNALS,
        .signals_count = sizeof SIGNALS / sizeof SIGNALS[0],
        .record = {[XCP_RECORD_OUTPUT] = view->output, [XCP_RECORD_INPUT] = view->input},
        .in_force = view->in_force,
        .staging = view->staging,
        .identification = "hubfoc-" HUBFOC_VERSION,
    };
    return access;
}

void service_init(service_t *service, const config_t *config)
{
    const service_t fresh = {.on_can = config->service.can_base != 0};
    const int32_t command = config->service.can_base + config->vehicle.wheel_position;
    *service = fresh;
    service->command_identifier = (uint16_t)command;
    service->answer_identifier = (uint16_t)(command + ANSWERS_ABOVE_COMMANDS);
    xcp_init(&service->slave);
}

bool service_accepts(const service_t *service, uint16_t *identifier)
{
    *identifier = service->command_identifier;
    return service->on_can;
}

static void answer(service_t *service, uint32_t bytes)
{
    if (bytes > 0) {
        service->answer.identifier = service->answer_identifier;
        service->answer.length = (uint8_t)bytes;
        service->answers = true;
    }
}

void service_receive(service_t *service, const service_view_t *view, const can_frame_t *frame,
                     uint32_t now_ms)
{
    const xcp_access_t access = access_of(view);
    answer(service, xcp_command(&service->slave, &access, now_ms, frame->data, frame->length,
                                service->answer.data));
}

static void transmit(service_t *service)
{
    if (service->under_way) {
        const can_progress_t progress = can_progress(service->answer_identifier);
        service->under_way = progress == CAN_PENDING;
        service->answers = service->answers || progress == CAN_ABORTED;
    }
    if (service->answers && can_transmit(&service->answer)) {
        service->answers = false;
        service->under_way = true;
    }
}

void service_step(service_t *service, const service_view_t *view, uint32_t now_ms)
{
    if (service->slave.connected) {
        const xcp_access_t access = access_of(view);
        uint64_t bits;
        xcp_tick(&service->slave, &access, now_ms);
        if (xcp_wants_seed(&service->slave) && random_draw(&bits)) {
            xcp_give_seed(&service->slave, bits);
        }
    }
    transmit(service);
}

bool service_wants_store(const service_t *service)
{
    return service->slave.store_wanted;
}

void service_store(service_t *service, xcp_error_t error, uint32_t now_ms)
{
    answer(service, xcp_store(&service->slave, error, service->answer.data));
    service->stores = error == XCP_ERROR_NONE;
    service->stores_since_ms = now_ms;
}

bool service_store_is_due(service_t *service, uint32_t now_ms)
{
    const bool due = service->stores && ((!service->answers && !service->under_way) ||
                                         now_ms - service->stores_since_ms >= SERVICE_ANSWER_ms);
    service->stores = service->stores && !due;
    return due;
}
