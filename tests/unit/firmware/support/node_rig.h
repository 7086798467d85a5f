/* SPDX-License-Identifier: Apache-2.0 */
/* node_rig.h: the node of the rear right wheel and the demands that it receives. */
#ifndef NODE_RIG_H
#define NODE_RIG_H

#include <string.h>

#include "comms/node.h"
#include "unity.h"
#include "wheel_address.h"

static const node_limits_t LIMITS = {
    .pack = {.charge_current_mA = 50000, .discharge_current_mA = 150000},
    .largest_drive_mNm = 40000,
    .largest_brake_mNm = 100000,
    .demand_rise_ms = 20,
    .demand_lost_frames = 2,
};

static node_t node;

static inline void node_up(void)
{
    memset(&node, 0xA5, sizeof node); /* uninitialised fields are visible */
    node_init(&node, address_of(MESSAGES_REAR_RIGHT), &LIMITS, 0);
}

static inline messages_frame_t demand_frame(uint8_t counter, int32_t drive_torque_mNm)
{
    const wheel_demand_t demand = {.drive_torque_mNm = drive_torque_mNm, .enable = true};
    return messages_demand(&demand, address_of(MESSAGES_REAR_RIGHT), counter);
}

static inline bool receive_demand(uint8_t counter, int32_t drive_torque_mNm, uint32_t now_ms)
{
    const messages_frame_t frame = demand_frame(counter, drive_torque_mNm);
    return node_receive(&node, &frame, now_ms);
}

/* Counters 0, 1, 2 until 20 ms: 3 N m. */
static inline void qualify_demand(void)
{
    (void)receive_demand(0, 1000, 0);
    (void)receive_demand(1, 2000, 10);
    TEST_ASSERT_TRUE(receive_demand(2, 3000, 20));
}

/* The frame of the last node_next() is taken by the CAN controller and leaves at once. */
static inline void offered_leaves(uint32_t now_ms)
{
    const uint32_t place = (uint32_t)node.offered - MESSAGES_RECEIVED;
    node_taken(&node, now_ms);
    (void)node_left(&node, place, now_ms);
}

static inline void assert_demand_is_still_of(uint32_t time_ms, uint32_t now_ms)
{
    TEST_ASSERT_EQUAL_INT32(3000, node.command.demand.drive_torque_mNm);
    TEST_ASSERT_EQUAL_UINT32(now_ms - time_ms, node_demand_age_ms(&node.command, now_ms));
}

#endif
