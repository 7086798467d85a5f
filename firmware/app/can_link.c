/* SPDX-License-Identifier: Apache-2.0 */
#include "app/can_link.h"

#include "hal/can.h"

enum { FRAMES_PER_PASS = 8 /* bounds the time of a pass on a flooded bus */ };

bool can_link_init(can_link_t *link, messages_wheel_t wheel, messages_battery_t pack,
                   uint32_t now_ms)
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

void can_link_transmit(can_link_t *link, uint32_t now_ms, const messages_output_t *output)
{
    messages_frame_t frame;
    while (node_next(&link->node, now_ms, output, &frame) && transmit(&frame)) {
        node_sent(&link->node, now_ms);
    }
}

messages_output_t can_link_output(const slow_output_t *output, int32_t winding_temperature_cC,
                                  int32_t switch_temperature_cC)
{
    const messages_output_t output_message = {
        .motor_torque_command_mNm = output->motor_torque_command_mNm,
        .motor_torque_estimate_mNm = output->motor_torque_estimate_mNm,
        .hydraulic_torque_mNm = output->hydraulic_torque_mNm,
        .electric_brake_available_mNm = output->electric_brake_available_mNm,
        .speed_mrad_s = output->speed_mrad_s,
        .i_q_mA = output->i_q_mA,
        .bus_voltage_mV = output->bus_voltage_mV,
        .bus_current_mA = output->bus_current_mA,
        .winding_temperature_cC = winding_temperature_cC,
        .switch_temperature_cC = switch_temperature_cC,
        .torque_reason = output->torque_reason,
        .available_reason = output->available_reason,
        .hydraulic_reason = output->hydraulic_reason,
        .fault_reason = output->fault_reason,
        .mode = (uint8_t)output->mode,
        .stop_lamp = output->stop_lamp,
    };
    return output_message;
}
