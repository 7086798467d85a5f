/* SPDX-License-Identifier: Apache-2.0 */
#include "comms/node.h"

void node_accepted(messages_wheel_t wheel, uint16_t identifiers[MESSAGES_RECEIVED])
{
    identifiers[MESSAGES_DEMAND] = messages_identifier(MESSAGES_DEMAND, wheel);
    identifiers[MESSAGES_HYDRAULIC_FEEDBACK] =
        messages_identifier(MESSAGES_HYDRAULIC_FEEDBACK, wheel);
    identifiers[MESSAGES_BATTERY_PEAK] = messages_identifier(MESSAGES_BATTERY_PEAK, wheel);
    identifiers[MESSAGES_BATTERY_LIMITS] = messages_identifier(MESSAGES_BATTERY_LIMITS, wheel);
}

static messages_kind_t sent_kind(uint32_t index)
{
    return (messages_kind_t)(MESSAGES_RECEIVED + index);
}

static void init_receiver(e2e_receiver_t *receiver, messages_kind_t kind)
{
    e2e_receiver_init(receiver, messages_profile(kind),
                      NODE_TIMEOUT_CYCLES * messages_cycle_ms(kind));
}

void node_init(node_t *node, messages_wheel_t wheel, battery_limits_t pack, uint32_t now_ms)
{
    const node_t zero = {
        .wheel = wheel, .pack = pack, .command = {.bms = pack}, .offered = MESSAGES_KINDS};
    *node = zero;
    init_receiver(&node->demand, MESSAGES_DEMAND);
    init_receiver(&node->battery, MESSAGES_BATTERY_LIMITS);
    init_receiver(&node->hydraulic, MESSAGES_HYDRAULIC_FEEDBACK);
    init_receiver(&node->peak, MESSAGES_BATTERY_PEAK);
    for (uint32_t i = 0; i < MESSAGES_SENT; i++) {
        node->due_ms[i] = now_ms + messages_cycle_ms(sent_kind(i));
    }
}

static bool is_usable(e2e_status_t status)
{
    return status == E2E_OK || status == E2E_SOME_LOST;
}

static bool expire_battery_limits(node_t *node)
{
    node->command.bms.charge_current_mA = 0;
    node->command.bms.discharge_current_mA = node->pack.discharge_current_mA;
    node->command.bms.contactor = CONTACTOR_NOT_REPORTED;
    return true;
}

bool node_tick(node_t *node, uint32_t now_ms)
{
    bool changed = false;
    (void)e2e_timed_out(&node->demand, now_ms); /* the torque follows from the demand's age */
    if (node->command.demand_known &&
        now_ms - node->command.demand_time_ms >= NODE_DEMAND_EXPIRY_ms) {
        node->command.demand_known = false;
        changed = true;
    }
    if (e2e_timed_out(&node->battery, now_ms)) {
        changed = expire_battery_limits(node) || changed;
    }
    if (e2e_timed_out(&node->peak, now_ms)) {
        node->command.bms.charge_peak_current_mA = 0;
        changed = true;
    }
    if (e2e_timed_out(&node->hydraulic, now_ms)) {
        node->command.hydraulic.valid = false;
        changed = true;
    }
    return changed;
}

static bool receive_demand(node_t *node, const messages_frame_t *frame, uint32_t now_ms)
{
    wheel_demand_t demand;
    const bool plausible = messages_read_demand(frame, &demand);
    if (!is_usable(e2e_receive(&node->demand, frame->data, frame->identifier, plausible, now_ms))) {
        return false;
    }
    node->command.demand = demand;
    node->command.demand_time_ms = now_ms;
    node->command.demand_known = true;
    node->demand_counter = node->demand.counter;
    return true;
}

static bool receive_battery(node_t *node, const messages_frame_t *frame, uint32_t now_ms)
{
    battery_limits_t battery;
    const bool plausible = messages_read_battery(frame, &battery);
    if (!is_usable(
            e2e_receive(&node->battery, frame->data, frame->identifier, plausible, now_ms))) {
        return false;
    }
    battery.charge_peak_current_mA = node->command.bms.charge_peak_current_mA;
    node->command.bms = battery;
    return true;
}

static bool receive_peak(node_t *node, const messages_frame_t *frame, uint32_t now_ms)
{
    battery_limits_t limits = node->command.bms;
    const bool plausible = messages_read_peak(frame, &limits);
    if (!is_usable(e2e_receive(&node->peak, frame->data, frame->identifier, plausible, now_ms))) {
        return false;
    }
    node->command.bms = limits;
    return true;
}

static bool receive_hydraulic(node_t *node, const messages_frame_t *frame, uint32_t now_ms)
{
    hydraulic_feedback_t feedback = {.valid = false};
    const bool plausible = messages_read_hydraulic(frame, &feedback);
    if (!is_usable(
            e2e_receive(&node->hydraulic, frame->data, frame->identifier, plausible, now_ms))) {
        return false;
    }
    node->command.hydraulic = feedback;
    node->command.hydraulic_time_ms = now_ms;
    return true;
}

bool node_receive(node_t *node, const messages_frame_t *frame, uint32_t now_ms)
{
    const bool lapsed = node_tick(node, now_ms);
    if (frame->identifier == messages_identifier(MESSAGES_DEMAND, node->wheel)) {
        return receive_demand(node, frame, now_ms) || lapsed;
    }
    if (frame->identifier == messages_identifier(MESSAGES_BATTERY_LIMITS, node->wheel)) {
        return receive_battery(node, frame, now_ms) || lapsed;
    }
    if (frame->identifier == messages_identifier(MESSAGES_HYDRAULIC_FEEDBACK, node->wheel)) {
        return receive_hydraulic(node, frame, now_ms) || lapsed;
    }
    if (frame->identifier == messages_identifier(MESSAGES_BATTERY_PEAK, node->wheel)) {
        return receive_peak(node, frame, now_ms) || lapsed;
    }
    node->foreign++;
    return lapsed;
}

static bool is_due(uint32_t due_ms, uint32_t now_ms)
{
    return now_ms - due_ms <
           UINT32_MAX / 2U; /* not in the future, also when the clock has wrapped in between */
}

bool node_next(node_t *node, uint32_t now_ms, const slow_output_t *output,
               const wheel_temperatures_t *temperature, messages_frame_t *frame)
{
    for (uint32_t i = 0; i < MESSAGES_SENT; i++) {
        if (!is_due(node->due_ms[i], now_ms)) {
            continue;
        }
        const messages_values_t values = {
            .output = output,
            .temperature = temperature,
            .links = {.demand = node->demand.link,
                      .battery = node->battery.link,
                      .hydraulic = node->hydraulic.link,
                      .peak = node->peak.link,
                      .demand_errors = e2e_errors(&node->demand.counts),
                      .battery_errors = e2e_errors(&node->battery.counts),
                      .demand_counter = node->demand_counter},
        };
        node->offered = sent_kind(i);
        *frame = messages_output(node->offered, &values, node->wheel, node->counter[i]);
        return true;
    }
    node->offered = MESSAGES_KINDS;
    return false;
}

void node_sent(node_t *node, uint32_t now_ms)
{
    if (node->offered == MESSAGES_KINDS) {
        return;
    }
    const uint32_t i = (uint32_t)node->offered - MESSAGES_RECEIVED;
    const uint32_t cycle_ms = messages_cycle_ms(node->offered);
    node->counter[i]++;
    node->due_ms[i] += cycle_ms;
    if (is_due(node->due_ms[i], now_ms)) {
        node->due_ms[i] = now_ms + cycle_ms; /* a whole cycle late: no hurry to catch up */
    }
    node->offered = MESSAGES_KINDS;
}

uint32_t node_demand_age_ms(const node_command_t *command, uint32_t now_ms)
{
    return command->demand_known ? now_ms - command->demand_time_ms : UINT32_MAX;
}

hydraulic_feedback_t node_hydraulic(const node_command_t *command, uint32_t now_ms)
{
    hydraulic_feedback_t out = command->hydraulic;
    out.age_ms = now_ms - command->hydraulic_time_ms;
    return out;
}
