/* SPDX-License-Identifier: Apache-2.0 */
/* Transfer of frames between the CAN port and the node. Tests of their content: firmware/comms. */
#include "app/can_link.h"
#include "mock_can.h"
#include "unity.h"

static const battery_limits_t PACK = {.charge_current_mA = 50000, .discharge_current_mA = 150000};

static const wheel_temperatures_t TEMPERATURE = {2500, 2500};

static can_link_t can_link;
static uint16_t accepted[MESSAGES_RECEIVED + 1];
static uint32_t service_accepted; /* identifiers of XCP */
static can_frame_t waiting[16];   /* what the bus has for us */
static int waiting_count, delivered;
static can_frame_t sent[64];
static int sent_count, free_mailboxes;
static can_progress_t progress_now;
static bool starts;

static bool init(const uint16_t *identifiers, uint32_t count, int calls)
{
    (void)calls;
    TEST_ASSERT_EQUAL_UINT32(MESSAGES_RECEIVED + service_accepted, count);
    for (uint32_t i = 0; i < count; i++) {
        accepted[i] = identifiers[i];
    }
    return starts;
}

static bool receive(can_frame_t *frame, int calls)
{
    (void)calls;
    if (delivered == waiting_count) {
        return false;
    }
    *frame = waiting[delivered++];
    return true;
}

static bool transmit(const can_frame_t *frame, int calls)
{
    (void)calls;
    if (free_mailboxes == 0) {
        return false;
    }
    free_mailboxes--;
    sent[sent_count++] = *frame;
    return true;
}

static can_progress_t progress(uint32_t identifier, int calls)
{
    (void)identifier;
    (void)calls;
    return progress_now;
}

static const config_t *configured(messages_wheel_t wheel)
{
    static config_t config;
    config.vehicle.wheel_position = (int32_t)wheel;
    config.vehicle.can_base = 0x320;
    config.battery.driven_wheels = 2;
    config.battery.max_charge_current_mA = PACK.charge_current_mA / 2;
    config.battery.max_discharge_current_mA = PACK.discharge_current_mA / 2;
    config.driver.largest_drive_mNm = 200000;
    config.driver.largest_brake_mNm = 200000;
    config.driver.demand_rise_ms = 0;
    config.driver.demand_lost_frames = 2;
    return &config;
}

void setUp(void)
{
    service_accepted = 0;
    waiting_count = 0;
    delivered = 0;
    sent_count = 0;
    free_mailboxes = 64;
    starts = true;
    can_init_StubWithCallback(init);
    can_receive_StubWithCallback(receive);
    can_transmit_StubWithCallback(transmit);
    can_progress_StubWithCallback(progress);
    progress_now = CAN_SENT;
    TEST_ASSERT_TRUE(can_link_init(&can_link, configured(MESSAGES_REAR_LEFT), NULL, 0));
}

void tearDown(void) {}

static void arrive(uint8_t counter, int32_t drive_torque_mNm)
{
    const wheel_demand_t demand = {.drive_torque_mNm = drive_torque_mNm, .enable = true};
    const messages_frame_t frame = messages_demand(&demand, can_link.node.address, counter);
    can_frame_t *to = &waiting[waiting_count++];
    to->identifier = frame.identifier;
    to->length = frame.length;
    for (uint32_t i = 0; i < frame.length; i++) {
        to->data[i] = frame.data[i];
    }
}

/* From the base 0x320 as far as in the DBC from 0x100: Demand 0 and HydraulicFeedback 0x20, the
 * rear left wheel +2; BatteryLimits 0x40 and BatteryPeak 0x44 for every wheel. */
void test_filter_accepts_only_frames_for_this_wheel(void)
{
    TEST_ASSERT_EQUAL_HEX16(0x322, accepted[0]);
    TEST_ASSERT_EQUAL_HEX16(0x342, accepted[1]);
    TEST_ASSERT_EQUAL_HEX16(0x360, accepted[2]);
    TEST_ASSERT_EQUAL_HEX16(0x364, accepted[3]);
}

/* It is not one of the node's, and is handed over once; of two the tool waits for the latter. */
void test_a_command_of_the_service_is_kept_for_it(void)
{
    const uint16_t identifier = 0x7F2;
    service_accepted = 1;
    TEST_ASSERT_TRUE(can_link_init(&can_link, configured(MESSAGES_REAR_LEFT), &identifier, 0));
    TEST_ASSERT_EQUAL_HEX16(identifier, accepted[MESSAGES_RECEIVED]);
    TEST_ASSERT_NULL(can_link_service(&can_link));
    for (uint8_t k = 1; k <= 2; k++) {
        const can_frame_t frame = {.identifier = identifier, .length = 1, .data = {k}};
        waiting[waiting_count++] = frame;
    }
    (void)can_link_receive(&can_link, 1);
    TEST_ASSERT_EQUAL_UINT32(0, can_link.node.foreign);
    const can_frame_t *command = can_link_service(&can_link);
    TEST_ASSERT_NOT_NULL(command);
    TEST_ASSERT_EQUAL_UINT8(2, command->data[0]);
    TEST_ASSERT_NULL(can_link_service(&can_link));
}

void test_demand_is_received_with_its_time(void)
{
    arrive(7, 1000);
    arrive(8, 2000);
    arrive(9, -123400);
    TEST_ASSERT_TRUE(can_link_receive(&can_link, 42));
    TEST_ASSERT_EQUAL_INT32(-123400, can_link.node.command.demand.drive_torque_mNm);
    TEST_ASSERT_TRUE(can_link.node.command.demand.enable);
    TEST_ASSERT_EQUAL_UINT32(42, can_link.node.command.demand_time_ms);
    TEST_ASSERT_FALSE(can_link_receive(&can_link, 43));
}

void test_timeout_is_reported_without_any_frame(void)
{
    const battery_limits_t full = {.charge_current_mA = 20000, .discharge_current_mA = 90000};
    for (uint8_t counter = 0; counter < 3; counter++) {
        const messages_frame_t frame = messages_battery(&full, can_link.node.address, counter);
        (void)node_receive(&can_link.node, &frame, 100);
    }
    TEST_ASSERT_EQUAL_INT32(20000, can_link.node.command.bms.charge_current_mA);
    TEST_ASSERT_TRUE(can_link_receive(&can_link, 100000));
    TEST_ASSERT_EQUAL_INT32(0, can_link.node.command.bms.charge_current_mA);
}

void test_number_of_frames_per_call_is_bounded(void)
{
    for (uint8_t i = 0; i < 16; i++) {
        arrive(i, i);
    }
    (void)can_link_receive(&can_link, 0);
    TEST_ASSERT_TRUE(delivered > 0 && delivered < 16);
}

/* In a second: state and brake 100 times, drive 50, ahead 20, the others 10 times each. */
void test_every_message_is_sent_in_its_cycle_with_free_mailboxes(void)
{
    const slow_output_t output = {.mode = MODE_READY};
    int count[MESSAGES_SENT] = {0};
    for (uint32_t ms = 1; ms <= 1000; ms++) {
        sent_count = 0;
        free_mailboxes = 64;
        (void)can_link_receive(&can_link, ms);
        can_link_transmit(&can_link, ms, &output, &TEMPERATURE);
        (void)can_link_receive(&can_link, ms);
        can_link_transmit(&can_link, ms, &output, &TEMPERATURE);
        for (int i = 0; i < sent_count; i++) {
            TEST_ASSERT_EQUAL_UINT8(8, sent[i].length);
            TEST_ASSERT_TRUE(sent[i].identifier >= 0x3A2 && sent[i].identifier <= 0x3BA);
            TEST_ASSERT_EQUAL_HEX16(2, sent[i].identifier & 3);
            count[(sent[i].identifier - 0x3A0) / 4]++;
        }
    }
    TEST_ASSERT_EQUAL_INT(100, count[0]);
    TEST_ASSERT_EQUAL_INT(100, count[1]);
    TEST_ASSERT_EQUAL_INT(50, count[2]);
    TEST_ASSERT_EQUAL_INT(10, count[3]);
    TEST_ASSERT_EQUAL_INT(10, count[4]);
    TEST_ASSERT_EQUAL_INT(20, count[5]);
    TEST_ASSERT_EQUAL_INT(10, count[6]);
}

/* Three mailboxes and seven messages due: the three most urgent are sent first, the others when the
 * mailboxes are empty again. */
void test_messages_without_a_free_mailbox_are_sent_in_the_next_call(void)
{
    const slow_output_t output = {.mode = MODE_READY};
    free_mailboxes = 3;
    can_link_transmit(&can_link, 100, &output, &TEMPERATURE);
    TEST_ASSERT_EQUAL_INT(3, sent_count);
    TEST_ASSERT_EQUAL_HEX16(0x3A2, sent[0].identifier);
    TEST_ASSERT_EQUAL_HEX16(0x3A6, sent[1].identifier);
    TEST_ASSERT_EQUAL_HEX16(0x3AA, sent[2].identifier);
    free_mailboxes = 3;
    can_link_transmit(&can_link, 101, &output, &TEMPERATURE);
    TEST_ASSERT_EQUAL_INT(6, sent_count);
    TEST_ASSERT_EQUAL_HEX16(0x3AE, sent[3].identifier);
    TEST_ASSERT_EQUAL_HEX16(0x3B2, sent[4].identifier);
    TEST_ASSERT_EQUAL_HEX16(0x3B6, sent[5].identifier);
}

/* WheelState's counter, bits 0 to 3 of byte 1, goes on with a frame that has left. */
void test_a_frame_that_was_given_up_is_sent_again_at_once(void)
{
    const slow_output_t output = {.mode = MODE_READY};
    free_mailboxes = 1;
    can_link_transmit(&can_link, 10, &output, &TEMPERATURE);
    progress_now = CAN_PENDING;
    (void)can_link_receive(&can_link, 11);
    free_mailboxes = 1;
    can_link_transmit(&can_link, 11, &output, &TEMPERATURE);
    TEST_ASSERT_EQUAL_HEX16(0x3A6, sent[1].identifier); /* WheelState is pending */
    progress_now = CAN_ABORTED;
    (void)can_link_receive(&can_link, 12);
    free_mailboxes = 1;
    can_link_transmit(&can_link, 12, &output, &TEMPERATURE);
    TEST_ASSERT_EQUAL_HEX16(0x3A2, sent[2].identifier);
    TEST_ASSERT_EQUAL_HEX8(0, sent[2].data[1] & 0xF);
    progress_now = CAN_SENT;
    TEST_ASSERT_FALSE(can_link_receive(&can_link, 13)); /* WheelBrake was aborted, too */
    free_mailboxes = 2;
    can_link_transmit(&can_link, 22, &output, &TEMPERATURE);
    TEST_ASSERT_EQUAL_HEX16(0x3A2, sent[3].identifier);
    TEST_ASSERT_EQUAL_HEX8(1, sent[3].data[1] & 0xF);
    TEST_ASSERT_TRUE(can_link_receive(&can_link, 23)); /* now it has left */
}

/* The transceiver may be supplied later than the controller. Until then the port accepts no frame.
 */
void test_can_works_after_a_late_start_of_the_transceiver(void)
{
    starts = false;
    TEST_ASSERT_FALSE(can_link_init(&can_link, configured(MESSAGES_FRONT_LEFT), NULL, 0));
    const slow_output_t output = {.mode = MODE_READY};
    free_mailboxes = 0;
    can_link_transmit(&can_link, 1000, &output, &TEMPERATURE);
    TEST_ASSERT_EQUAL_INT(0, sent_count);
    free_mailboxes = 64;
    arrive(1, 1);
    (void)can_link_receive(&can_link, 2000);
    can_link_transmit(&can_link, 2000, &output, &TEMPERATURE);
    TEST_ASSERT_EQUAL_INT(1, delivered);
    TEST_ASSERT_EQUAL_INT(MESSAGES_SENT - 1, sent_count); /* all but WheelEnergy */
}
