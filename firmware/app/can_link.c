/* SPDX-License-Identifier: Apache-2.0 */
#include "app/can_link.h"

#include "hal/can.h"

enum { FRAMES_PER_PASS = 8 /* bounds the time of a pass on a flooded bus */ };

bool can_link_init(can_link_t *link, messages_wheel_t wheel, battery_limits_t pack, uint32_t now_ms)
{
    uint16_t accepted[MESSAGES_RECEIVED];
    node_accepted(wheel, accepted);
    node_init(&link->node, wheel, pack, now_ms);
    return can_init(accepted, MESSAGES_RECEIVED);
}

bool can_link_receive(can_link_t *link, uint32_t now_ms)
{
    bool changed = node_tick(&link->node, now_ms);
    can_frame_t received;
    for (int i = 0; i < FRAMES_PER_PASS && can_receive(&received); i++) {
        messages_frame_t frame = {.identifier = received.identifier, .length = received.length};
        for (uint32_t k = 0; k < sizeof frame.data; k++) {
            frame.data[k] = received.data[k];
        }
        changed = node_receive(&link->node, &frame, now_ms) || changed;
    }
    return changed;
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
        node_sent(&link->node, now_ms);
    }
}
