/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A wheel's CAN node under a coverage-guided fuzzer: any frames in any order at any time. Address
 * and undefined-behaviour sanitizers watch the arithmetic; the checks are properties of every run:
 * no torque and no current beyond the configuration or the DBC, a demand is used only with its own
 * frame, an age never falls without one, and what is sent is protected.
 *
 * A frame is twelve bytes of the input: what it is, time since the one before, eight of content. A
 * fuzzer hardly guesses a CRC, so a frame can be given a right one, and the next counter.
 */
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "comms/node.h"
#include "core/q15.h"

enum { BYTES_A_FRAME = 12, LARGEST_DRIVE = 100000, LARGEST_BRAKE = 500000, PACK_mA = 32000000 };
enum { PROTECTED = 0x10, IN_ORDER = 0x20, SHORT = 0x40, ONE_MORE_TICK = 0x80 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds)
{
    if (!holds) {
        abort();
    }
}

static e2e_receiver_t *receiver_of(node_t *node, messages_kind_t kind)
{
    switch (kind) {
    case MESSAGES_DEMAND:
        return &node->demand;
    case MESSAGES_BATTERY_LIMITS:
        return &node->battery;
    case MESSAGES_BATTERY_PEAK:
        return &node->peak;
    default:
        return &node->hydraulic;
    }
}

static messages_frame_t frame_of(node_t *node, const uint8_t *at)
{
    const uint32_t what = at[0];
    const messages_kind_t kind = (messages_kind_t)(what & 0x0FU) % MESSAGES_KINDS;
    messages_frame_t frame = {.identifier = messages_identifier(kind, node->address),
                              .length = (what & SHORT) != 0 ? at[1] % 9U : 8};
    frame.identifier = (uint16_t)(frame.identifier ^ (at[3] < 240U ? 0U : at[1]));
    memcpy(frame.data, at + 4, sizeof frame.data);
    if ((what & PROTECTED) != 0) {
        const e2e_profile_t profile = messages_profile(kind);
        uint32_t counter = e2e_counter(profile, frame.data);
        if ((what & IN_ORDER) != 0) {
            counter = receiver_of(node, kind)->counter + 1U;
        }
        e2e_protect(profile, frame.data, frame.identifier, (uint8_t)counter);
    }
    return frame;
}

static void require_within(const node_t *node, const node_command_t *before, uint32_t used)
{
    const node_command_t *now = &node->command;
    require(q_abs(now->demand.drive_torque_mNm) <= LARGEST_DRIVE);
    require(now->demand.brake_torque_mNm >= 0 && now->demand.brake_torque_mNm <= LARGEST_BRAKE);
    require(now->demand.abs_motor_share_percent <= 100);
    require((uint32_t)now->demand.direction <= (uint32_t)DRIVE_DIRECTION_REVERSE);
    require(now->bms.charge_current_mA >= 0 && now->bms.charge_current_mA <= PACK_mA);
    require(now->bms.discharge_current_mA >= 0 && now->bms.discharge_current_mA <= PACK_mA);
    require(now->bms.charge_peak_current_mA >= 0 && now->bms.charge_peak_current_mA <= PACK_mA);
    require((uint32_t)now->bms.contactor <= (uint32_t)CONTACTOR_OPEN);
    require(now->hydraulic.torque_mNm >= 0 && now->hydraulic.torque_mNm <= 20000000);
    const bool two_senders = before->demand.reason == REASON_DEMAND_CONTRADICTED ||
                             now->demand.reason == REASON_DEMAND_CONTRADICTED;
    require(now->demand.reason != REASON_DEMAND_CONTRADICTED || now->demand.drive_torque_mNm == 0);
    if (node->demand.counts.used == used && !two_senders) {
        require(now->demand.drive_torque_mNm == before->demand.drive_torque_mNm);
        require(now->demand.brake_torque_mNm == before->demand.brake_torque_mNm);
        require(now->demand_time_ms == before->demand_time_ms);
    }
}

static void require_sent(node_t *node, uint32_t now_ms)
{
    static const slow_output_t output = {.mode = MODE_RUN, .hydraulic_torque_mNm = 12300};
    static const wheel_temperatures_t temperature = {2500, 2500};
    messages_frame_t frame;
    for (int k = 0; k < MESSAGES_SENT && node_next(node, now_ms, &output, &temperature, &frame);
         k++) {
        require(e2e_intact(messages_profile(node->offered), frame.data, frame.identifier));
        const uint32_t place = (uint32_t)node->offered - MESSAGES_RECEIVED;
        node_taken(node, now_ms);
        if (k % 2 == 0) {
            (void)node_left(node, place, now_ms);
        }
    }
    const messages_energy_t started = {now_ms, 4711, 50}, life = {UINT32_MAX, now_ms, 255};
    if (node_next_energy(node, now_ms, &started, &life, &frame)) {
        require(e2e_intact(E2E_PROFILE_2, frame.data, frame.identifier));
        node_taken(node, now_ms);
        if (now_ms % 2U == 0) {
            (void)node_left(node, MESSAGES_WHEEL_ENERGY - MESSAGES_RECEIVED, now_ms);
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const node_limits_t limits = {
        .pack = {.charge_current_mA = 50000, .discharge_current_mA = 150000},
        .largest_drive_mNm = LARGEST_DRIVE,
        .largest_brake_mNm = LARGEST_BRAKE,
        .demand_rise_ms = size > 0 ? data[0] % 40 : 0,
        .demand_lost_frames = size > 1 ? data[1] % 5 : 0,
    };
    uint32_t now_ms = size > 2 ? UINT32_MAX - 100U * data[2] : 0; /* over the wrap of the clock */
    static node_t node;
    const messages_address_t address = {.base = 0x740, .wheel = MESSAGES_REAR_LEFT};
    node_init(&node, address, &limits, now_ms);
    for (size_t at = 3; at + BYTES_A_FRAME <= size; at += BYTES_A_FRAME) {
        const messages_frame_t frame = frame_of(&node, data + at);
        now_ms += (uint32_t)data[at + 2] * ((data[at] & ONE_MORE_TICK) != 0 ? 100U : 1U);
        const node_command_t before = node.command;
        const uint32_t used = node.demand.counts.used;
        (void)node_receive(&node, &frame, now_ms);
        require_within(&node, &before, used);
        require_sent(&node, now_ms);
        require(!node.command.demand_known ||
                node_demand_age_ms(&node.command, now_ms) <= NODE_DEMAND_EXPIRY_ms);
    }
    return 0;
}
