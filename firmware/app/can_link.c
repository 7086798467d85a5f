/* SPDX-License-Identifier: Apache-2.0 */
#include "app/can_link.h"

#include <stddef.h>

#include "config/pack_share.h"
#include "hal/can.h"

enum { FRAMES_PER_PASS = 8 /* bounds the time of a pass on a flooded bus */ };

node_limits_t can_link_limits(const config_t *config)
{
    const config_battery_t *battery = &config->battery;
    const config_driver_t *driver = &config->driver;
    const node_limits_t limits = {
        .pack = {.charge_current_mA = pack_share_whole_mA(battery, battery->max_charge_current_mA),
                 .discharge_current_mA =
                     pack_share_whole_mA(battery, battery->max_discharge_current_mA)},
        .largest_drive_mNm = driver->largest_drive_mNm,
        .largest_brake_mNm = driver->largest_brake_mNm,
        .demand_rise_ms = driver->demand_rise_ms,
        .demand_lost_frames = driver->demand_lost_frames,
    };
    return limits;
}

messages_address_t can_link_address(const config_t *config, int32_t wheel)
{
    const messages_address_t address = {.base = (uint16_t)config->vehicle.can_base,
                                        .wheel = (messages_wheel_t)wheel};
    return address;
}

bool can_link_init(can_link_t *link, const config_t *config, const uint16_t *service,
                   uint32_t now_ms)
{
    const messages_address_t address = can_link_address(config, config->vehicle.wheel_position);
    const node_limits_t limits = can_link_limits(config);
    uint16_t accepted[MESSAGES_RECEIVED + 1];
    node_accepted(address, accepted);
    node_init(&link->node, address, &limits, now_ms);
    link->has_service = service != NULL;
    link->service_identifier = service != NULL ? *service : 0;
    link->service_received = false;
    accepted[MESSAGES_RECEIVED] = link->service_identifier;
    return can_init(accepted, MESSAGES_RECEIVED + (service != NULL ? 1U : 0U));
}

/* What became of the frames that the CAN controller has; true if the command has changed. */
static bool follow_sent(can_link_t *link, uint32_t now_ms)
{
    bool changed = false;
    for (uint32_t i = 0; i < MESSAGES_SENT; i++) {
        uint16_t identifier;
        if (!node_pending(&link->node, i, &identifier)) {
            continue;
        }
        const can_progress_t progress = can_progress(identifier);
        if (progress == CAN_SENT) {
            changed = node_left(&link->node, i, now_ms) || changed;
        } else if (progress == CAN_ABORTED) {
            node_aborted(&link->node, i, now_ms);
        }
    }
    return changed;
}

bool can_link_receive(can_link_t *link, uint32_t now_ms)
{
    bool changed = node_tick(&link->node, now_ms);
    changed = follow_sent(link, now_ms) || changed;
    can_frame_t received;
    for (int i = 0; i < FRAMES_PER_PASS && can_receive(&received); i++) {
        if (link->has_service && received.identifier == link->service_identifier) {
            link->service_command = received;
            link->service_received = true;
            continue;
        }
        messages_frame_t frame = {.identifier = (uint16_t)received.identifier,
                                  .length = received.length};
        for (uint32_t k = 0; k < sizeof frame.data; k++) {
            frame.data[k] = received.data[k];
        }
        changed = node_receive(&link->node, &frame, now_ms) || changed;
    }
    return changed;
}

const can_frame_t *can_link_service(can_link_t *link)
{
    const bool received = link->service_received;
    link->service_received = false;
    return received ? &link->service_command : NULL;
}

static bool transmit(const messages_frame_t *frame)
{
    can_frame_t sent = {.identifier = frame->identifier, .length = frame->length};
    for (uint32_t k = 0; k < sizeof sent.data; k++) {
        sent.data[k] = frame->data[k];
    }
    return can_transmit(&sent);
}

void can_link_transmit(can_link_t *link, uint32_t now_ms, const slow_output_t *output,
                       const wheel_temperatures_t *temperature)
{
    messages_frame_t frame;
    while (node_next(&link->node, now_ms, output, temperature, &frame) && transmit(&frame)) {
        node_taken(&link->node, now_ms);
    }
}

void can_link_transmit_energy(can_link_t *link, uint32_t now_ms,
                              const messages_energy_t *since_start,
                              const messages_energy_t *for_life)
{
    messages_frame_t frame;
    if (node_next_energy(&link->node, now_ms, since_start, for_life, &frame) && transmit(&frame)) {
        node_taken(&link->node, now_ms);
    }
}

void can_link_transmit_state(can_link_t *link, uint32_t now_ms, const slow_output_t *output,
                             const wheel_temperatures_t *temperature)
{
    messages_frame_t frame;
    if (node_next_state(&link->node, now_ms, output, temperature, &frame) && transmit(&frame)) {
        node_taken(&link->node, now_ms);
    }
}

void can_link_transmit_boot(can_link_t *link, uint32_t now_ms, waits_for_t waits_for)
{
    messages_frame_t frame;
    (void)follow_sent(link, now_ms);
    while (node_next_boot(&link->node, now_ms, waits_for, &frame) && transmit(&frame)) {
        node_taken(&link->node, now_ms);
    }
}
