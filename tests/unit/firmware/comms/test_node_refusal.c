/* SPDX-License-Identifier: Apache-2.0 */
/* Demands that are beyond the configured torque, or rise too fast, or come after a gap. */
#include "node_rig.h"

void setUp(void)
{
    node_up();
}

void tearDown(void) {}

static bool receive_torques(uint8_t counter, int32_t drive_mNm, int32_t brake_mNm, uint32_t now_ms)
{
    const wheel_demand_t demand = {.drive_torque_mNm = drive_mNm,
                                   .brake_torque_mNm = brake_mNm,
                                   .abs_active = true,
                                   .enable = true};
    const messages_frame_t frame = messages_demand(&demand, node.address, counter);
    return node_receive(&node, &frame, now_ms);
}

void test_demand_beyond_the_configured_torque_is_refused_with_a_reason_for_a_second(void)
{
    static const int32_t WRONG_mNm[][2] = {{40200, 0}, {-40200, 0}, {0, 100200}, {3000, 3276600}};
    for (int k = 0; k < 4; k++) {
        setUp();
        qualify_demand();
        node.limits.demand_rise_ms = 0;
        TEST_ASSERT_TRUE(receive_torques(3, WRONG_mNm[k][0], WRONG_mNm[k][1], 30));
        assert_demand_is_still_of(20, 30);
        TEST_ASSERT_EQUAL_INT32(0, node.command.demand.brake_torque_mNm);
        TEST_ASSERT_FALSE(node.command.demand.abs_active);
        TEST_ASSERT_EQUAL_INT(REASON_DEMAND_IMPLAUSIBLE, node.command.demand.reason);
        TEST_ASSERT_EQUAL_UINT32(1, node.demand.counts.implausible);
        for (uint32_t n = 4; n < 103; n++) {
            TEST_ASSERT_TRUE(receive_torques((uint8_t)n, 40000, 100000, 10 * n));
            TEST_ASSERT_EQUAL_INT(REASON_DEMAND_IMPLAUSIBLE, node.command.demand.reason);
        }
        TEST_ASSERT_TRUE(receive_torques(103, 40000, 100000, 1030));
        TEST_ASSERT_EQUAL_INT(REASON_NONE, node.command.demand.reason);
    }
}

/* 40 N m in 20 ms: 20 N m in a cycle of 10 ms. The demand before is 3 N m. */
void test_demand_that_rises_too_fast_is_refused_until_the_rise_had_its_time(void)
{
    qualify_demand();
    TEST_ASSERT_TRUE(receive_torques(3, 23200, 0, 30));
    TEST_ASSERT_EQUAL_INT(REASON_DEMAND_IMPLAUSIBLE, node.command.demand.reason);
    assert_demand_is_still_of(20, 30);
    TEST_ASSERT_TRUE(receive_torques(4, 40000, 0, 40));
    TEST_ASSERT_EQUAL_INT32(40000, node.command.demand.drive_torque_mNm);

    setUp();
    qualify_demand();
    TEST_ASSERT_TRUE(receive_torques(3, 23000, 0, 30));
    TEST_ASSERT_EQUAL_INT32(23000, node.command.demand.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, node.command.demand.reason);
    TEST_ASSERT_TRUE(receive_torques(4, 0, 50200, 40));
    TEST_ASSERT_EQUAL_INT(REASON_DEMAND_IMPLAUSIBLE, node.command.demand.reason);
    TEST_ASSERT_TRUE(receive_torques(5, 0, 50000, 41)); /* 21 ms after the last one in use */
    TEST_ASSERT_EQUAL_INT32(50000, node.command.demand.brake_torque_mNm);
}

/* From +20 N m: to -20.2 N m is a rise of 20.2 N m in the other direction. */
void test_demand_that_reverses_counts_from_zero_and_one_that_falls_is_always_accepted(void)
{
    for (int32_t last_mNm = -20000; last_mNm <= 20000; last_mNm += 40000) {
        const int32_t sign = last_mNm < 0 ? -1 : 1;
        setUp();
        qualify_demand();
        (void)receive_torques(3, last_mNm, 50000, 30);
        TEST_ASSERT_TRUE(receive_torques(4, -20200 * sign, 50000, 40));
        TEST_ASSERT_EQUAL_INT32(last_mNm, node.command.demand.drive_torque_mNm);
        TEST_ASSERT_TRUE(receive_torques(5, -20000 * sign, 50000, 40));
        TEST_ASSERT_EQUAL_INT32(-20000 * sign, node.command.demand.drive_torque_mNm);
        TEST_ASSERT_TRUE(receive_torques(6, 0, 0, 40));
        TEST_ASSERT_EQUAL_INT32(0, node.command.demand.drive_torque_mNm);
        TEST_ASSERT_EQUAL_INT32(0, node.command.demand.brake_torque_mNm);
    }
}

/* As a lost frame does: refused for the timeout, the sender has to qualify again, and torque that
 * is too large never gets through. */
void test_refused_demands_time_out_as_lost_ones_do(void)
{
    qualify_demand();
    for (uint32_t n = 3; n < 100; n++) {
        (void)receive_torques((uint8_t)n, 50000, 0, 10 * n);
        assert_demand_is_still_of(20, 10 * n);
    }
    TEST_ASSERT_EQUAL_INT(E2E_TIMED_OUT, node.demand.link);
    TEST_ASSERT_EQUAL_INT(REASON_DEMAND_IMPLAUSIBLE, node.command.demand.reason);
    TEST_ASSERT_FALSE(receive_torques(100, 30000, 0, 1000));
    TEST_ASSERT_FALSE(receive_torques(101, 30000, 0, 1010));
    TEST_ASSERT_TRUE(receive_torques(102, 30000, 0, 1020));
    TEST_ASSERT_EQUAL_INT32(30000, node.command.demand.drive_torque_mNm);
}

void test_as_many_demands_may_be_missing_as_configured(void)
{
    for (int32_t lost = -1; lost < 6; lost++) {
        for (uint32_t step = 1; step < 255; step++) {
            node_limits_t limits = LIMITS;
            limits.demand_lost_frames = lost;
            node_init(&node, address_of(MESSAGES_REAR_RIGHT), &limits, 0);
            qualify_demand();
            const uint32_t most = (uint32_t)(lost < 0 ? 0 : lost > 3 ? 3 : lost) + 1U;
            TEST_ASSERT_EQUAL(step <= most, receive_demand((uint8_t)(2 + step), 3000, 30));
        }
    }
}
