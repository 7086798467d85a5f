/* SPDX-License-Identifier: Apache-2.0 */
/* Two senders of Demand. The first is the driver's, who brakes; the second drives. */
#include "core/q15.h"
#include "node_rig.h"

enum { DRIVER_BRAKE_mNm = 90000, INTRUDER_DRIVE_mNm = 20000, INTRUDER_BRAKE_mNm = 30000 };

void setUp(void)
{
    node_up();
}

void tearDown(void) {}

static void receive(uint8_t counter, int32_t drive_mNm, int32_t brake_mNm, uint32_t now_ms)
{
    const wheel_demand_t demand = {.drive_torque_mNm = drive_mNm,
                                   .brake_torque_mNm = brake_mNm,
                                   .direction = DRIVE_DIRECTION_FORWARD,
                                   .enable = true,
                                   .fault_reset = true};
    const messages_frame_t frame = messages_demand(&demand, node.address, counter);
    (void)node_receive(&node, &frame, now_ms);
}

static const wheel_demand_t *demand_at(uint32_t now_ms)
{
    (void)node_tick(&node, now_ms);
    return &node.command.demand;
}

static void assert_brakes_by_the_larger(int32_t brake_mNm, uint32_t now_ms)
{
    const wheel_demand_t *demand = demand_at(now_ms);
    TEST_ASSERT_EQUAL_INT(REASON_DEMAND_CONTRADICTED, demand->reason);
    TEST_ASSERT_EQUAL_INT32(0, demand->drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(brake_mNm, demand->brake_torque_mNm);
    TEST_ASSERT_FALSE(demand->fault_reset);
}

/* 100 a second each, for 4 s; the second sender begins after one. Its counter is `ahead` of the
 * driver's, and its frames come so many milliseconds later, 0: before. The driver brakes from 2 s
 * on. After 120 ms, a demand's timeout and two cycles, the demand is lost, which is driving torque
 * of nobody, or contradicted. Returns how often there was any torque that drives. */
static int two_senders(uint8_t ahead, uint32_t later_ms, int32_t intruder_brake_mNm)
{
    int driven_ms = 0;
    for (uint32_t ms = 0; ms < 4000; ms++) {
        const int32_t brake_mNm = ms < 2000 ? 0 : DRIVER_BRAKE_mNm;
        const bool there = ms >= 1000;
        const uint8_t counter = (uint8_t)(ms / 10);
        const bool intrudes = there && ms % 10 == later_ms;
        if (intrudes && later_ms == 0) {
            receive((uint8_t)(counter + ahead), INTRUDER_DRIVE_mNm, intruder_brake_mNm, ms);
        }
        if (ms % 10 == 0) {
            receive(counter, 0, brake_mNm, ms);
        }
        if (intrudes && later_ms > 0) {
            receive((uint8_t)(counter + ahead), INTRUDER_DRIVE_mNm, intruder_brake_mNm, ms);
        }
        const bool lost = node_demand_age_ms(&node.command, ms) > 100;
        driven_ms += ms >= 1120 && !lost && demand_at(ms)->drive_torque_mNm != 0 ? 1 : 0;
        const bool settled = ms >= 2020 || ms < 2000;
        if (ms >= 1120 && !lost && settled) {
            assert_brakes_by_the_larger(q_max(intruder_brake_mNm, brake_mNm), ms);
        }
    }
    return driven_ms;
}

void test_of_two_senders_with_equal_counters_none_drives_and_the_larger_brake_counts(void)
{
    for (uint32_t later_ms = 0; later_ms < 10; later_ms++) {
        for (int32_t brake_mNm = 0; brake_mNm <= INTRUDER_BRAKE_mNm; brake_mNm += 30000) {
            node_up();
            TEST_ASSERT_EQUAL_INT(0, two_senders(0, later_ms, brake_mNm));
            TEST_ASSERT_TRUE(node_demand_age_ms(&node.command, 4000) <= 20);
        }
    }
}

/* One ahead: the later frame of a counter is the other one's, or no frame is in order, as with all
 * other differences, and the demand is lost. */
void test_counters_that_differ_drive_as_little(void)
{
    int lost = 0;
    for (uint32_t ahead = 1; ahead < 256; ahead++) {
        for (uint32_t later_ms = 0; later_ms < 10; later_ms += 3) {
            node_up();
            TEST_ASSERT_EQUAL_INT(0, two_senders((uint8_t)ahead, later_ms, 0));
            lost += node_demand_age_ms(&node.command, 4000) > 2000 ? 1 : 0;
        }
    }
    TEST_ASSERT_TRUE(lost > 900);
}

/* The name stays for a second after the last frame that contradicts, the larger brake 50 ms. */
void test_a_contradiction_ends_a_second_after_its_last_frame(void)
{
    for (uint32_t ms = 0; ms < 3000; ms += 10) {
        receive((uint8_t)(ms / 10), 5000, 0, ms);
        if (ms == 100) {
            receive((uint8_t)(ms / 10), 0, INTRUDER_BRAKE_mNm, ms + 1);
        }
        if (ms >= 110 && ms < 1100) {
            assert_brakes_by_the_larger(ms < 150 ? INTRUDER_BRAKE_mNm : 0, ms + 1);
        } else if (ms >= 1120) {
            TEST_ASSERT_EQUAL_INT(REASON_NONE, demand_at(ms)->reason);
            TEST_ASSERT_EQUAL_INT32(5000, demand_at(ms)->drive_torque_mNm);
        }
    }
}

static void assert_no_contradiction(uint32_t now_ms)
{
    TEST_ASSERT_NOT_EQUAL_INT(REASON_DEMAND_CONTRADICTED, demand_at(now_ms)->reason);
}

void test_repeated_frames_lost_frames_and_restarts_are_no_second_sender(void)
{
    for (uint32_t ms = 0; ms < 6000; ms += 10) { /* more than the counter's 256 */
        if (ms % 50 != 0) {                      /* a fifth is lost, others come twice */
            receive((uint8_t)(ms / 10), (int32_t)(ms % 900), 0, ms);
            receive((uint8_t)(ms / 10), (int32_t)(ms % 900), 0, ms + 1);
        }
        assert_no_contradiction(ms + 1);
    }
    receive(7, 1000, 0, 6000);
    receive(7, 0, 0, 6050); /* it has started again, with the same counter by chance */
    assert_no_contradiction(6050);
}

/* A torque beyond the configured one is no torque to brake with. */
void test_a_contradiction_beyond_the_largest_brake_only_ends_the_drive(void)
{
    qualify_demand();
    receive(2, 0, LIMITS.largest_brake_mNm + 1000, 21);
    assert_brakes_by_the_larger(0, 21);
    receive(2, 0, LIMITS.largest_brake_mNm, 22);
    assert_brakes_by_the_larger(LIMITS.largest_brake_mNm, 22);
}
