/* SPDX-License-Identifier: Apache-2.0 */
#include "comms/node.h"

#include "core/q15.h"

void node_accepted(messages_address_t address, uint16_t identifiers[MESSAGES_RECEIVED])
{
    identifiers[MESSAGES_DEMAND] = messages_identifier(MESSAGES_DEMAND, address);
    identifiers[MESSAGES_HYDRAULIC_FEEDBACK] =
        messages_identifier(MESSAGES_HYDRAULIC_FEEDBACK, address);
    identifiers[MESSAGES_BATTERY_PEAK] = messages_identifier(MESSAGES_BATTERY_PEAK, address);
    identifiers[MESSAGES_BATTERY_LIMITS] = messages_identifier(MESSAGES_BATTERY_LIMITS, address);
}

static messages_kind_t sent_kind(uint32_t index)
{
    return (messages_kind_t)(MESSAGES_RECEIVED + index);
}

/* A gap of more would take longer than the timeout. */
enum { LOST_MAX = NODE_TIMEOUT_CYCLES - 2 };

static void init_receiver(e2e_receiver_t *receiver, messages_kind_t kind)
{
    e2e_receiver_init(receiver, messages_profile(kind),
                      NODE_TIMEOUT_CYCLES * messages_cycle_ms(kind));
}

void node_init(node_t *node, messages_address_t address, const node_limits_t *limits,
               uint32_t now_ms)
{
    const node_t zero = {.refused = false};
    *node = zero;
    node->address = address;
    node->limits = *limits;
    node->command.bms = limits->pack;
    node->offered = MESSAGES_KINDS;
    node->command.brake_received = true;
    node->command.brake_received_ms = now_ms;
    node->left_in_order = E2E_QUALIFYING_FRAMES;
    init_receiver(&node->demand, MESSAGES_DEMAND);
    node->demand.step_max = (uint32_t)q_clamp(limits->demand_lost_frames, 0, LOST_MAX) + 1U;
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
    node->command.bms.discharge_current_mA = node->limits.pack.discharge_current_mA;
    node->command.bms.contactor = CONTACTOR_NOT_REPORTED;
    return true;
}

/* The brake system's receiver of WheelBrake, as e2e_timed_out(). */
static void expire_transmission(node_t *node, uint32_t now_ms)
{
    if (now_ms - node->command.brake_received_ms >= NODE_UNSENT_ms) {
        node->command.brake_received = false;
        node->left_in_order = 0;
    }
}

/* command.demand: the accepted one, without driving torque and with the larger braking torque while
 * there is a second sender. */
static void set_demand(node_t *node, uint32_t now_ms)
{
    const node_senders_t *senders = &node->senders;
    wheel_demand_t *demand = &node->command.demand;
    *demand = node->accepted;
    demand->reason = node->refused ? REASON_DEMAND_IMPLAUSIBLE : REASON_NONE;
    if (!senders->contradicts) {
        return;
    }
    demand->reason = REASON_DEMAND_CONTRADICTED;
    demand->drive_torque_mNm = 0;
    demand->fault_reset = false;
    if (now_ms - senders->contradicted_ms < NODE_CONTRADICTION_BRAKE_ms) {
        demand->brake_torque_mNm = q_max(demand->brake_torque_mNm, senders->larger_brake_mNm);
    }
}

static bool expire_contradiction(node_t *node, uint32_t now_ms)
{
    node_senders_t *senders = &node->senders;
    const uint32_t since_ms = now_ms - senders->contradicted_ms;
    if (!senders->contradicts || since_ms < NODE_CONTRADICTION_BRAKE_ms) {
        return false;
    }
    senders->contradicts = since_ms < NODE_CONTRADICTION_SHOWN_ms;
    set_demand(node, now_ms);
    return true;
}

bool node_tick(node_t *node, uint32_t now_ms)
{
    bool changed = false;
    expire_transmission(node, now_ms);          /* also known by its time */
    (void)e2e_timed_out(&node->demand, now_ms); /* the torque follows from the demand's age */
    if (node->command.demand_known &&
        now_ms - node->command.demand_time_ms >= NODE_DEMAND_EXPIRY_ms) {
        node->command.demand_known = false;
        changed = true;
    }
    if (node->refused && now_ms - node->refused_ms >= NODE_REFUSAL_SHOWN_ms) {
        node->refused = false;
        set_demand(node, now_ms);
        changed = true;
    }
    changed = expire_contradiction(node, now_ms) || changed;
    if (e2e_timed_out(&node->battery, now_ms)) {
        changed = expire_battery_limits(node) || changed;
    }
    if (node->command.bms.current_given &&
        now_ms - node->peak.refreshed_ms >= NODE_PACK_CURRENT_AGE_ms) {
        node->command.bms.current_given = false;
        changed = true;
    }
    if (e2e_timed_out(&node->peak, now_ms)) {
        node->command.bms.charge_peak_current_mA = 0;
        node->command.bms.voltage_mV = 0;
        changed = true;
    }
    if (e2e_timed_out(&node->hydraulic, now_ms)) {
        node->command.hydraulic.valid = false;
        changed = true;
    }
    return changed;
}

/* How much more torque, in either direction, than before. */
static int32_t rise_mNm(int32_t from_mNm, int32_t to_mNm)
{
    const int32_t before_mNm = to_mNm >= 0 ? q_max(from_mNm, 0) : q_max(-from_mNm, 0);
    return q_abs(to_mNm) - before_mNm;
}

static bool plausible_demand(const node_t *node, const wheel_demand_t *demand, uint32_t now_ms)
{
    const node_limits_t *limits = &node->limits;
    const wheel_demand_t *last = &node->command.demand;
    if (q_abs(demand->drive_torque_mNm) > limits->largest_drive_mNm ||
        demand->brake_torque_mNm > limits->largest_brake_mNm) {
        return false;
    }
    const uint32_t elapsed_ms = now_ms - node->command.demand_time_ms;
    if (!node->command.demand_known || elapsed_ms >= (uint32_t)limits->demand_rise_ms) {
        return true;
    }
    /* Frames may come closer together than they were sent. */
    const uint32_t cycle_ms = messages_cycle_ms(MESSAGES_DEMAND);
    const int32_t within_ms = (int32_t)(elapsed_ms > cycle_ms ? elapsed_ms : cycle_ms);
    return rise_mNm(last->drive_torque_mNm, demand->drive_torque_mNm) <=
               q_scale(limits->largest_drive_mNm, within_ms, limits->demand_rise_ms) &&
           rise_mNm(last->brake_torque_mNm, demand->brake_torque_mNm) <=
               q_scale(limits->largest_brake_mNm, within_ms, limits->demand_rise_ms);
}

static bool show_refusal(node_t *node, e2e_status_t status, uint32_t now_ms)
{
    if (status != E2E_IMPLAUSIBLE) {
        return false;
    }
    node->refused = true;
    node->refused_ms = now_ms;
    set_demand(node, now_ms);
    return true;
}

static bool is_other_content(const node_senders_t *senders, const uint8_t data[E2E_FRAME_BYTES])
{
    bool other = false;
    for (uint32_t i = 0; i < E2E_FRAME_BYTES; i++) {
        other = other || senders->data[i] != data[i];
    }
    return other;
}

/* Whether this Demand contradicts the one before it. A frame that is refused counts as well: its
 * torque may be too much only beside the other sender's. */
static bool watch_senders(node_t *node, const messages_frame_t *frame, int32_t brake_torque_mNm,
                          uint32_t now_ms)
{
    const e2e_profile_t profile = messages_profile(MESSAGES_DEMAND);
    node_senders_t *senders = &node->senders;
    if (!e2e_intact(profile, frame->data, frame->identifier)) {
        return false;
    }
    /* After a gap it may be a sender that has started again. */
    const bool follows =
        senders->received && now_ms - senders->received_ms < node->demand.timeout_ms;
    const bool repeats = e2e_counter(profile, senders->data) == e2e_counter(profile, frame->data);
    const bool contradicts = follows && repeats && is_other_content(senders, frame->data);
    const int32_t usable_mNm =
        brake_torque_mNm <= node->limits.largest_brake_mNm ? brake_torque_mNm : 0;
    if (contradicts) {
        senders->contradicts = true;
        senders->contradicted_ms = now_ms;
        senders->larger_brake_mNm = q_max(senders->brake_torque_mNm, usable_mNm);
    }
    for (uint32_t i = 0; i < E2E_FRAME_BYTES; i++) {
        senders->data[i] = frame->data[i];
    }
    senders->received = true;
    senders->received_ms = now_ms;
    senders->brake_torque_mNm = usable_mNm;
    return contradicts;
}

static bool receive_demand(node_t *node, const messages_frame_t *frame, uint32_t now_ms)
{
    wheel_demand_t demand = {.drive_torque_mNm = 0};
    const bool in_range = messages_read_demand(frame, &demand);
    const bool contradicts =
        watch_senders(node, frame, in_range ? demand.brake_torque_mNm : 0, now_ms);
    const bool plausible = in_range && plausible_demand(node, &demand, now_ms);
    const e2e_status_t status =
        e2e_receive(&node->demand, frame->data, frame->identifier, plausible, now_ms);
    const bool usable = is_usable(status);
    if (usable) {
        node->accepted = demand;
        node->command.demand_time_ms = now_ms;
        node->command.demand_known = true;
        node->demand_counter = node->demand.counter;
    }
    const bool refused = show_refusal(node, status, now_ms);
    if (usable || contradicts) {
        set_demand(node, now_ms);
    }
    return usable || contradicts || refused;
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
    battery.voltage_mV = node->command.bms.voltage_mV;
    battery.current_mA = node->command.bms.current_mA;
    battery.current_given = node->command.bms.current_given;
    node->command.bms = battery;
    return true;
}

static bool receive_peak(node_t *node, const messages_frame_t *frame, uint32_t now_ms)
{
    battery_limits_t limits = node->command.bms;
    const bool plausible = messages_read_peak(frame, &limits);
    if (!is_usable(e2e_receive(&node->peak, frame->data, frame->identifier, plausible, now_ms))) {
        /* The current accuses sensors of this controller, so only a link without a flaw gives it:
         * a recording that comes again and again is out of order once a round. */
        const bool was_given = node->command.bms.current_given;
        node->command.bms.current_given = false;
        return was_given;
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
    if (frame->identifier == messages_identifier(MESSAGES_DEMAND, node->address)) {
        return receive_demand(node, frame, now_ms) || lapsed;
    }
    if (frame->identifier == messages_identifier(MESSAGES_BATTERY_LIMITS, node->address)) {
        return receive_battery(node, frame, now_ms) || lapsed;
    }
    if (frame->identifier == messages_identifier(MESSAGES_HYDRAULIC_FEEDBACK, node->address)) {
        return receive_hydraulic(node, frame, now_ms) || lapsed;
    }
    if (frame->identifier == messages_identifier(MESSAGES_BATTERY_PEAK, node->address)) {
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

static uint32_t bit_of(messages_kind_t kind)
{
    return UINT32_C(1) << ((uint32_t)kind - MESSAGES_RECEIVED);
}

/* One of the kinds whose bits are set. */
static bool next_of(node_t *node, uint32_t kinds, uint32_t now_ms, const slow_output_t *output,
                    const wheel_temperatures_t *temperature, messages_frame_t *frame)
{
    for (uint32_t i = 0; i < MESSAGES_SENT; i++) {
        if ((kinds & bit_of(sent_kind(i))) == 0 || !is_due(node->due_ms[i], now_ms)) {
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
        *frame = messages_output(node->offered, &values, node->address, node->counter[i]);
        return true;
    }
    node->offered = MESSAGES_KINDS;
    return false;
}

bool node_next(node_t *node, uint32_t now_ms, const slow_output_t *output,
               const wheel_temperatures_t *temperature, messages_frame_t *frame)
{
    return next_of(node, ~bit_of(MESSAGES_WHEEL_ENERGY), now_ms, output, temperature, frame);
}

bool node_energy_is_due(const node_t *node, uint32_t now_ms)
{
    return is_due(node->due_ms[MESSAGES_WHEEL_ENERGY - MESSAGES_RECEIVED], now_ms);
}

bool node_next_energy(node_t *node, uint32_t now_ms, const messages_energy_t *since_start,
                      const messages_energy_t *for_life, messages_frame_t *frame)
{
    if (!node_energy_is_due(node, now_ms)) {
        node->offered = MESSAGES_KINDS;
        return false;
    }
    node->offered = MESSAGES_WHEEL_ENERGY;
    *frame = messages_energy(since_start, for_life, node->address,
                             node->counter[MESSAGES_WHEEL_ENERGY - MESSAGES_RECEIVED]);
    return true;
}

bool node_next_state(node_t *node, uint32_t now_ms, const slow_output_t *output,
                     const wheel_temperatures_t *temperature, messages_frame_t *frame)
{
    return next_of(node, bit_of(MESSAGES_WHEEL_STATE), now_ms, output, temperature, frame);
}

bool node_next_boot(node_t *node, uint32_t now_ms, waits_for_t waits_for, messages_frame_t *frame)
{
    static const wheel_temperatures_t unknown = {INT32_MAX, INT32_MAX};
    const slow_output_t output = {.mode = MODE_BOOT, .waits_for = waits_for};
    return next_of(node, bit_of(MESSAGES_WHEEL_STATE) | bit_of(MESSAGES_WHEEL_AVAILABLE), now_ms,
                   &output, &unknown, frame);
}

void node_taken(node_t *node, uint32_t now_ms)
{
    if (node->offered == MESSAGES_KINDS) {
        return;
    }
    const uint32_t i = (uint32_t)node->offered - MESSAGES_RECEIVED;
    const uint32_t cycle_ms = messages_cycle_ms(node->offered);
    node->pending[i] = true;
    node->due_ms[i] += cycle_ms;
    if (is_due(node->due_ms[i], now_ms)) {
        node->due_ms[i] = now_ms + cycle_ms; /* a whole cycle late: no hurry to catch up */
    }
    node->offered = MESSAGES_KINDS;
}

bool node_pending(const node_t *node, uint32_t place, uint16_t *identifier)
{
    *identifier = messages_identifier(sent_kind(place), node->address);
    return node->pending[place];
}

/* As e2e_receive() of the brake system: the third in order is the first to be used. */
static void note_brake_sent(node_t *node, uint32_t now_ms)
{
    expire_transmission(node, now_ms);
    node->left_in_order = (uint8_t)q_min(node->left_in_order + 1, (int32_t)E2E_QUALIFYING_FRAMES);
    node->command.brake_received = node->left_in_order == E2E_QUALIFYING_FRAMES;
    if (node->command.brake_received || node->left_in_order == 1U) {
        node->command.brake_received_ms = now_ms;
    }
}

bool node_left(node_t *node, uint32_t place, uint32_t now_ms)
{
    node->pending[place] = false;
    node->counter[place]++;
    if (sent_kind(place) != MESSAGES_WHEEL_BRAKE) {
        return false;
    }
    note_brake_sent(node, now_ms);
    return true;
}

void node_aborted(node_t *node, uint32_t place, uint32_t now_ms)
{
    node->pending[place] = false;
    node->due_ms[place] = now_ms;
}

bool node_is_unsent(const node_command_t *command, uint32_t now_ms)
{
    return !command->brake_received || now_ms - command->brake_received_ms >= NODE_UNSENT_ms;
}

void node_hand_over(const node_command_t *command, uint32_t now_ms, slow_input_t *in)
{
    if (command->demand_known && node_is_unsent(command, now_ms)) {
        in->demand.reason = REASON_TRANSMIT_TIMEOUT;
        in->demand_age_ms = UINT32_MAX;
    }
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
