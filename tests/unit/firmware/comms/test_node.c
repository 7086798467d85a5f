/* SPDX-License-Identifier: Apache-2.0 */
#include "node_rig.h"

static const battery_limits_t PACK = {.charge_current_mA = 50000, .discharge_current_mA = 150000};
enum { DEMAND_CYCLE_ms = 10, BATTERY_CYCLE_ms = 100 }; /* the DBC's */

void setUp(void)
{
    node_up();
}

void tearDown(void) {}

static bool receive_battery(uint8_t counter, int32_t charge_current_mA, uint32_t now_ms)
{
    const battery_limits_t battery = {.charge_current_mA = charge_current_mA,
                                      .discharge_current_mA = 90000,
                                      .contactor = CONTACTOR_OPEN};
    const messages_frame_t frame = messages_battery(&battery, node.address, counter);
    return node_receive(&node, &frame, now_ms);
}

/* ---- the demand ---- */

void test_before_the_first_frame_torque_is_zero_and_disabled(void)
{
    TEST_ASSERT_EQUAL_INT32(0, node.command.demand.drive_torque_mNm);
    TEST_ASSERT_FALSE(node.command.demand.enable);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, node_demand_age_ms(&node.command, 5));
}

void test_demand_of_a_qualified_sender_applies_with_its_time(void)
{
    TEST_ASSERT_FALSE(receive_demand(5, 1000, 0));
    TEST_ASSERT_FALSE(receive_demand(6, 2000, 10));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, node_demand_age_ms(&node.command, 10));
    TEST_ASSERT_TRUE(receive_demand(7, 3000, 20));
    assert_demand_is_still_of(20, 27);
}

void test_damaged_demand_does_not_reset_the_age(void)
{
    qualify_demand();
    messages_frame_t frame = demand_frame(3, 9000);
    frame.data[3] ^= 0x40;
    TEST_ASSERT_FALSE(node_receive(&node, &frame, 30));
    assert_demand_is_still_of(20, 30);
    TEST_ASSERT_EQUAL_UINT32(1, node.demand.counts.damaged);
}

void test_stuck_counter_does_not_reset_the_age(void)
{
    qualify_demand();
    for (uint32_t ms = 30; ms < 1000; ms += DEMAND_CYCLE_ms) {
        TEST_ASSERT_FALSE(receive_demand(2, 3000, ms));
        assert_demand_is_still_of(20, ms);
    }
    TEST_ASSERT_TRUE(node.demand.counts.repeated > 0);
    TEST_ASSERT_TRUE(node.demand.counts.timeouts > 0);
}

void test_jumping_counter_does_not_reset_the_age(void)
{
    qualify_demand();
    uint8_t counter = 2;
    for (uint32_t ms = 30; ms < 1000; ms += DEMAND_CYCLE_ms) {
        counter = (uint8_t)(counter + 7U);
        TEST_ASSERT_FALSE(receive_demand(counter, 9000, ms));
        assert_demand_is_still_of(20, ms);
    }
    TEST_ASSERT_TRUE(node.demand.counts.wrong_sequence > 0);
}

void test_late_demand_resets_the_age_only_after_requalification(void)
{
    qualify_demand();
    const uint32_t late_ms = 20 + NODE_TIMEOUT_CYCLES * DEMAND_CYCLE_ms;
    TEST_ASSERT_FALSE(receive_demand(3, 9000, late_ms));
    assert_demand_is_still_of(20, late_ms);
    TEST_ASSERT_FALSE(receive_demand(4, 9000, late_ms + 10));
    assert_demand_is_still_of(20, late_ms + 10);
    TEST_ASSERT_TRUE(receive_demand(5, 9000, late_ms + 20));
    TEST_ASSERT_EQUAL_INT32(9000, node.command.demand.drive_torque_mNm);
    TEST_ASSERT_EQUAL_UINT32(0, node_demand_age_ms(&node.command, late_ms + 20));
}

void test_two_lost_demands_in_a_row_are_tolerated(void)
{
    qualify_demand();
    TEST_ASSERT_TRUE(receive_demand(5, 9000, 50));
    TEST_ASSERT_EQUAL_UINT32(0, node_demand_age_ms(&node.command, 50));
    TEST_ASSERT_EQUAL_UINT32(2, node.demand.counts.lost);
}

void test_demand_above_its_range_is_an_error_and_does_not_reset_the_age(void)
{
    qualify_demand();
    messages_frame_t frame = demand_frame(3, 0);
    frame.data[3] |= 0xE0; /* a motor share of 127 %, more than the 100 % of the DBC */
    frame.data[4] |= 0x0F;
    e2e_protect(E2E_PROFILE_5, frame.data, frame.identifier, 3);
    TEST_ASSERT_TRUE(node_receive(&node, &frame, 30));
    assert_demand_is_still_of(20, 30);
    TEST_ASSERT_EQUAL_UINT32(1, node.demand.counts.implausible);
}

void test_demand_for_another_wheel_is_ignored(void)
{
    qualify_demand();
    const wheel_demand_t demand = {.drive_torque_mNm = 9000, .enable = true};
    messages_frame_t frame = messages_demand(&demand, address_of(MESSAGES_REAR_LEFT), 3);
    TEST_ASSERT_FALSE(node_receive(&node, &frame, 30));
    TEST_ASSERT_EQUAL_UINT32(1, node.foreign);
    frame.identifier =
        messages_identifier(MESSAGES_DEMAND, node.address); /* a gateway that mixes wheels up */
    TEST_ASSERT_FALSE(node_receive(&node, &frame, 30));
    TEST_ASSERT_EQUAL_UINT32(1, node.demand.counts.damaged);
    assert_demand_is_still_of(20, 30);
}

/* A clock of 32 bits wraps after 49 days. An old demand must not appear new after that. */
void test_old_demand_stays_old_over_a_wrap_of_the_clock(void)
{
    qualify_demand();
    const uint32_t forgotten_ms = 20 + NODE_DEMAND_EXPIRY_ms;
    TEST_ASSERT_FALSE(node_tick(&node, forgotten_ms - 1));
    assert_demand_is_still_of(20, forgotten_ms - 1);
    TEST_ASSERT_TRUE(node_tick(&node, forgotten_ms));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, node_demand_age_ms(&node.command, forgotten_ms));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, node_demand_age_ms(&node.command, 20));
    TEST_ASSERT_FALSE(node_tick(&node, forgotten_ms + 1));
}

/* ---- the battery ---- */

void test_configured_battery_limits_apply_without_a_bms(void)
{
    TEST_ASSERT_FALSE(node_tick(&node, 1000000));
    TEST_ASSERT_EQUAL_INT32(PACK.charge_current_mA, node.command.bms.charge_current_mA);
    TEST_ASSERT_EQUAL_INT32(PACK.discharge_current_mA, node.command.bms.discharge_current_mA);
}

void test_charge_limit_is_zero_after_a_bms_timeout_until_requalification(void)
{
    TEST_ASSERT_FALSE(receive_battery(0, 10000, 0));
    TEST_ASSERT_FALSE(receive_battery(1, 10000, BATTERY_CYCLE_ms));
    TEST_ASSERT_TRUE(receive_battery(2, 10000, 2 * BATTERY_CYCLE_ms));
    TEST_ASSERT_EQUAL_INT32(10000, node.command.bms.charge_current_mA);
    TEST_ASSERT_EQUAL_INT(CONTACTOR_OPEN, node.command.bms.contactor);
    const uint32_t silent_ms = 2 * BATTERY_CYCLE_ms + NODE_TIMEOUT_CYCLES * BATTERY_CYCLE_ms;
    TEST_ASSERT_FALSE(node_tick(&node, silent_ms - 1));
    TEST_ASSERT_TRUE(node_tick(&node, silent_ms));
    TEST_ASSERT_EQUAL_INT32(0, node.command.bms.charge_current_mA);
    TEST_ASSERT_EQUAL_INT32(PACK.discharge_current_mA, node.command.bms.discharge_current_mA);
    TEST_ASSERT_EQUAL_INT(CONTACTOR_NOT_REPORTED, node.command.bms.contactor);
    (void)receive_battery(3, 8000, silent_ms + 100);
    (void)receive_battery(4, 8000, silent_ms + 200);
    TEST_ASSERT_EQUAL_INT32(0, node.command.bms.charge_current_mA);
    TEST_ASSERT_TRUE(receive_battery(5, 8000, silent_ms + 300));
    TEST_ASSERT_EQUAL_INT32(8000, node.command.bms.charge_current_mA);
}

/* A frame arrives after the timeout without a step in between: the timeout still applies. */
void test_bms_timeout_between_two_calls_sets_the_charge_limit_to_zero(void)
{
    for (uint8_t i = 0; i < 3; i++) {
        (void)receive_battery(i, 10000, i * BATTERY_CYCLE_ms);
    }
    TEST_ASSERT_TRUE(receive_battery(3, 10000, 5000));
    TEST_ASSERT_EQUAL_INT32(0, node.command.bms.charge_current_mA);
}

void test_battery_limits_above_their_range_count_as_missing(void)
{
    for (uint8_t i = 0; i < 3; i++) {
        (void)receive_battery(i, 10000, i * BATTERY_CYCLE_ms);
    }
    const battery_limits_t battery = {.charge_current_mA = 0, .discharge_current_mA = 0};
    for (uint32_t k = 3; k < 20; k++) {
        messages_frame_t frame = messages_battery(&battery, node.address, (uint8_t)k);
        frame.data[3] |= 0xFC; /* 0x7FFFF = 52 428.7 A, more than the 32 000 A of the DBC */
        frame.data[4] = 0xFF;
        frame.data[5] |= 0x1F;
        e2e_protect(E2E_PROFILE_5, frame.data, frame.identifier, (uint8_t)k);
        (void)node_receive(&node, &frame, k * BATTERY_CYCLE_ms);
    }
    TEST_ASSERT_EQUAL_INT32(0, node.command.bms.charge_current_mA);
    TEST_ASSERT_EQUAL_UINT32(17, node.battery.counts.implausible);
}

/* ---- transmission ---- */

static bool next_frame(uint32_t now_ms, const slow_output_t *output, messages_frame_t *frame)
{
    static const wheel_temperatures_t TEMPERATURE = {2500, 2500};
    return node_next(&node, now_ms, output, &TEMPERATURE, frame);
}

static bool next_is(messages_kind_t kind, uint8_t counter, uint32_t now_ms,
                    const slow_output_t *output)
{
    messages_frame_t frame;
    return next_frame(now_ms, output, &frame) &&
           frame.identifier == messages_identifier(kind, node.address) &&
           e2e_counter(messages_profile(kind), frame.data) == counter &&
           e2e_intact(messages_profile(kind), frame.data, frame.identifier);
}

void test_messages_are_sent_in_their_cycle_and_in_order_of_urgency(void)
{
    const slow_output_t output = {.mode = MODE_READY};
    messages_frame_t frame;
    TEST_ASSERT_FALSE(next_frame(9, &output, &frame));
    TEST_ASSERT_TRUE(next_is(MESSAGES_WHEEL_STATE, 0, 10, &output));
    offered_leaves(10);
    TEST_ASSERT_TRUE(next_is(MESSAGES_WHEEL_BRAKE, 0, 10, &output));
    offered_leaves(10);
    TEST_ASSERT_FALSE(next_frame(19, &output, &frame));
    TEST_ASSERT_TRUE(next_is(MESSAGES_WHEEL_STATE, 1, 20, &output));
}

void test_unsent_message_is_offered_again_with_the_same_counter_and_new_values(void)
{
    slow_output_t output = {.mode = MODE_READY};
    messages_frame_t first;
    messages_frame_t second;
    TEST_ASSERT_TRUE(next_frame(10, &output, &first));
    output.mode = MODE_FAULT;
    TEST_ASSERT_TRUE(next_frame(17, &output, &second));
    TEST_ASSERT_EQUAL_HEX16(first.identifier, second.identifier);
    TEST_ASSERT_EQUAL_HEX8(0x30, first.data[1]); /* WheelState.mode is bits 12 .. 15 */
    TEST_ASSERT_EQUAL_HEX8(0x60, second.data[1]);
}

/* After a second without transmission the newest values are sent once. */
void test_missed_cycles_are_not_sent_later(void)
{
    const slow_output_t output = {.mode = MODE_READY};
    messages_frame_t frame;
    int sent = 0;
    while (next_frame(1000, &output, &frame)) {
        offered_leaves(1000);
        sent++;
        TEST_ASSERT_TRUE(sent <= MESSAGES_SENT);
    }
    TEST_ASSERT_EQUAL_INT(MESSAGES_SENT - 1, sent); /* all but WheelEnergy */
    TEST_ASSERT_FALSE(next_frame(1009, &output, &frame));
    TEST_ASSERT_TRUE(next_is(MESSAGES_WHEEL_STATE, 1, 1010, &output));
}

/* With a call every 3 ms, a message with a cycle of 10 ms is still sent 100 times a second. */
void test_irregular_calls_do_not_lengthen_the_cycle(void)
{
    const slow_output_t output = {.mode = MODE_READY};
    int states = 0;
    for (uint32_t ms = 0; ms <= 3000; ms += 3) {
        messages_frame_t frame;
        while (next_frame(ms, &output, &frame)) {
            states += node.offered == MESSAGES_WHEEL_STATE ? 1 : 0;
            offered_leaves(ms);
        }
    }
    TEST_ASSERT_EQUAL_INT(300, states);
}

void test_cycle_continues_over_a_wrap_of_the_clock(void)
{
    const uint32_t start_ms = UINT32_MAX - 500U;
    node_init(&node, address_of(MESSAGES_REAR_RIGHT), &LIMITS, start_ms);
    const slow_output_t output = {.mode = MODE_READY};
    int states = 0;
    for (uint32_t k = 0; k <= 1000; k++) {
        messages_frame_t frame;
        while (next_frame(start_ms + k, &output, &frame)) {
            states += node.offered == MESSAGES_WHEEL_STATE ? 1 : 0;
            offered_leaves(start_ms + k);
        }
    }
    TEST_ASSERT_EQUAL_INT(100, states);
}

static const messages_energy_t STARTED = {360, 0, 0}, FOR_LIFE = {1800, 0, 0};

static bool next_energy(uint32_t now_ms, messages_frame_t *frame)
{
    return node_next_energy(&node, now_ms, &STARTED, &FOR_LIFE, frame);
}

/* Bit 12 is the account; bits 13 to 34 are 1 Wh in steps of 0.1 Wh, or 5 Wh in those of 5 Wh. */
void test_the_energy_accounts_are_sent_in_turn_each_once_a_second(void)
{
    const slow_output_t output = {.mode = MODE_READY};
    int count[2] = {0};
    messages_frame_t frame;
    for (uint32_t now_ms = 1; now_ms <= 10000; now_ms++) {
        while (next_frame(now_ms, &output, &frame)) {
            TEST_ASSERT_TRUE(frame.identifier < 0x19C);
            offered_leaves(now_ms);
        }
        TEST_ASSERT_EQUAL(now_ms % 500 == 0, node_energy_is_due(&node, now_ms));
        if (next_energy(now_ms, &frame)) {
            TEST_ASSERT_EQUAL_HEX16(0x19F, frame.identifier);
            const uint32_t account = frame.data[1] >> 4 & 1U;
            TEST_ASSERT_EQUAL_UINT32(account == 0 ? 10 : 1,
                                     frame.data[1] >> 5 | frame.data[2] << 3);
            count[account]++;
            offered_leaves(now_ms);
        }
    }
    TEST_ASSERT_EQUAL_INT(10, count[0]);
    TEST_ASSERT_EQUAL_INT(10, count[1]);
}

/* It leaves its place to a more urgent frame, and no account is passed over. */
void test_an_energy_frame_that_was_given_up_is_due_again_with_the_same_account(void)
{
    messages_frame_t first, second;
    TEST_ASSERT_TRUE(next_energy(500, &first));
    node_taken(&node, 500);
    TEST_ASSERT_FALSE(next_energy(501, &second));
    node_aborted(&node, MESSAGES_WHEEL_ENERGY - MESSAGES_RECEIVED, 502);
    TEST_ASSERT_TRUE(next_energy(502, &second));
    TEST_ASSERT_EQUAL_HEX8_ARRAY(first.data, second.data, 8);
}

static void assert_taken_has_no_effect(void)
{
    const node_t before = node;
    node_taken(&node, 10);
    TEST_ASSERT_EQUAL_MEMORY(&before, &node, sizeof before);
}

void test_only_an_offered_frame_can_be_marked_as_taken_and_only_once(void)
{
    const slow_output_t output = {.mode = MODE_READY};
    messages_frame_t frame;
    assert_taken_has_no_effect();
    TEST_ASSERT_TRUE(next_frame(10, &output, &frame));
    offered_leaves(10);
    assert_taken_has_no_effect();
    TEST_ASSERT_TRUE(next_frame(10, &output, &frame));
    TEST_ASSERT_FALSE(next_frame(9, &output, &frame)); /* offered, and then no longer due */
    assert_taken_has_no_effect();
    TEST_ASSERT_TRUE(next_frame(10, &output, &frame));
    TEST_ASSERT_FALSE(next_energy(10, &frame));
    assert_taken_has_no_effect();
}

enum { STATE, BRAKE }; /* places of WheelState and WheelBrake among the messages sent */

/* A frame that the controller has is not offered before its next cycle, then with the counter of
 * the one that it replaces; the counter goes on when it has left. */
void test_a_pending_frame_is_due_again_after_a_cycle_with_the_same_counter(void)
{
    const slow_output_t output = {.mode = MODE_READY};
    uint16_t identifier;
    TEST_ASSERT_FALSE(node_pending(&node, STATE, &identifier));
    TEST_ASSERT_TRUE(next_is(MESSAGES_WHEEL_STATE, 0, 10, &output));
    node_taken(&node, 10);
    TEST_ASSERT_TRUE(node_pending(&node, STATE, &identifier));
    TEST_ASSERT_EQUAL_HEX16(0x183, identifier);
    TEST_ASSERT_TRUE(next_is(MESSAGES_WHEEL_BRAKE, 0, 19, &output));
    TEST_ASSERT_TRUE(next_is(MESSAGES_WHEEL_STATE, 0, 20, &output));
    node_taken(&node, 20);
    TEST_ASSERT_FALSE(node_left(&node, STATE, 24));
    TEST_ASSERT_FALSE(node_pending(&node, STATE, &identifier));
    TEST_ASSERT_TRUE(next_is(MESSAGES_WHEEL_STATE, 1, 30, &output));
}

void test_an_aborted_frame_is_due_at_once_with_the_same_counter(void)
{
    const slow_output_t output = {.mode = MODE_READY};
    uint16_t identifier;
    TEST_ASSERT_TRUE(next_is(MESSAGES_WHEEL_STATE, 0, 10, &output));
    node_taken(&node, 10);
    node_aborted(&node, STATE, 13);
    TEST_ASSERT_FALSE(node_pending(&node, STATE, &identifier));
    TEST_ASSERT_TRUE(next_is(MESSAGES_WHEEL_STATE, 0, 13, &output));
}

/* ---- WheelBrake that does not leave ---- */

static void brake_leaves(uint32_t now_ms)
{
    (void)node_tick(&node, now_ms);
    TEST_ASSERT_TRUE(node_left(&node, BRAKE, now_ms));
}

/* Against the receiver of e2e.h, which is the brake system's: frames leave after gaps of 1 to
 * 70 ms. */
void test_what_does_not_leave_is_known_as_the_brake_system_knows_it(void)
{
    e2e_receiver_t receiver;
    e2e_receiver_init(&receiver, E2E_PROFILE_5, NODE_TIMEOUT_CYCLES * 10);
    uint32_t now_ms = 0;
    uint8_t counter = 0;
    int unsent = 0;
    for (uint32_t k = 0; k < 4000; k++) {
        /* From the third frame on, which is the first that the receiver uses. */
        const uint32_t gap_ms = k < 3 ? 10 : 1 + k * 2654435761U / 65536U % (k % 40 < 20 ? 25 : 70);
        for (uint32_t ms = 0; ms < gap_ms; ms++, now_ms++) {
            (void)node_tick(&node, now_ms);
            (void)e2e_timed_out(&receiver, now_ms);
            if (k >= 3) {
                TEST_ASSERT_EQUAL(receiver.link != E2E_VALID,
                                  node_is_unsent(&node.command, now_ms));
                unsent += node_is_unsent(&node.command, now_ms) ? 1 : 0;
            }
        }
        uint8_t data[E2E_FRAME_BYTES] = {0};
        e2e_protect(E2E_PROFILE_5, data, 0x187, counter++);
        (void)e2e_receive(&receiver, data, 0x187, true, now_ms);
        brake_leaves(now_ms);
    }
    TEST_ASSERT_TRUE(unsent > 1000);
}

static slow_input_t handed_over(uint32_t now_ms)
{
    slow_input_t in = {.demand = node.command.demand, .demand_age_ms = 3};
    node_hand_over(&node.command, now_ms, &in);
    return in;
}

/* 50 ms: the five cycles after which the brake system takes its own path. Without a demand the
 * controller may be alone on its bus. */
void test_a_demand_is_lost_by_its_name_50_ms_after_the_last_wheel_brake_has_left(void)
{
    TEST_ASSERT_EQUAL_UINT32(3, handed_over(1000).demand_age_ms);
    node_up();
    qualify_demand();
    brake_leaves(20);
    TEST_ASSERT_EQUAL_UINT32(3, handed_over(69).demand_age_ms);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, handed_over(69).demand.reason);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, handed_over(70).demand_age_ms);
    TEST_ASSERT_EQUAL_INT(REASON_TRANSMIT_TIMEOUT, handed_over(70).demand.reason);
    brake_leaves(72);
    brake_leaves(82);
    TEST_ASSERT_EQUAL_INT(REASON_TRANSMIT_TIMEOUT, handed_over(91).demand.reason);
    brake_leaves(92);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, handed_over(92).demand.reason);
}

/* WheelHealth: demand_link bits 12 and 13, battery_link 14 and 15, errors in byte 6, the warning in
 * byte 7. */
void test_wheel_health_reports_the_warning_and_the_receivers_states(void)
{
    qualify_demand();
    (void)receive_demand(2, 0, 25);
    (void)receive_battery(0, 0, 25);
    (void)receive_battery(0, 0, 26);
    (void)receive_battery(0, 0, 27);
    const slow_output_t output = {.mode = MODE_LIMP, .warning_reason = REASON_ROTOR_UNCERTAIN};
    messages_frame_t frame;
    while (next_frame(100, &output, &frame) && node.offered != MESSAGES_WHEEL_HEALTH) {
        offered_leaves(100);
    }
    TEST_ASSERT_EQUAL_INT(MESSAGES_WHEEL_HEALTH, node.offered);
    TEST_ASSERT_EQUAL_HEX8(E2E_VALID << 4 | E2E_QUALIFYING << 6, frame.data[1]);
    TEST_ASSERT_EQUAL_HEX8(1 | 2 << 4, frame.data[6]);
    TEST_ASSERT_EQUAL_UINT8(REASON_ROTOR_UNCERTAIN, frame.data[7]);
}

/* WheelState byte 1, bits 4 to 7: the mode; WheelAvailable bits 38 to 45: waits_for. */
void test_a_wheel_without_control_sends_its_mode_and_what_it_waits_for_and_nothing_else(void)
{
    int states = 0, available = 0;
    messages_frame_t frame;
    for (uint32_t now_ms = 1; now_ms <= 1000; now_ms++) {
        while (node_next_boot(&node, now_ms, WAITS_FOR_CONFIGURATION, &frame)) {
            TEST_ASSERT_TRUE(
                e2e_intact(messages_profile(node.offered), frame.data, frame.identifier));
            if (node.offered == MESSAGES_WHEEL_STATE) {
                TEST_ASSERT_EQUAL_UINT8(MODE_BOOT, frame.data[1] >> 4);
                states++;
            } else {
                TEST_ASSERT_EQUAL_INT(MESSAGES_WHEEL_AVAILABLE, node.offered);
                TEST_ASSERT_EQUAL_UINT8(WAITS_FOR_CONFIGURATION,
                                        (frame.data[4] >> 6 | frame.data[5] << 2) & 0xFF);
                available++;
            }
            offered_leaves(now_ms);
        }
    }
    TEST_ASSERT_EQUAL_INT(100, states);
    TEST_ASSERT_EQUAL_INT(10, available);
}

void test_a_receive_filter_needs_four_identifiers(void)
{
    uint16_t identifiers[MESSAGES_RECEIVED];
    node_accepted(address_of(MESSAGES_FRONT_RIGHT), identifiers);
    TEST_ASSERT_EQUAL_INT(4, MESSAGES_RECEIVED);
    TEST_ASSERT_EQUAL_HEX16(0x101, identifiers[0]);
    TEST_ASSERT_EQUAL_HEX16(0x121, identifiers[1]);
    TEST_ASSERT_EQUAL_HEX16(0x140, identifiers[2]);
    TEST_ASSERT_EQUAL_HEX16(0x144, identifiers[3]);
}

static uint8_t echoed_counter(uint32_t now_ms)
{
    const slow_output_t output = {.mode = MODE_READY};
    messages_frame_t frame = {.length = 0};
    while (next_frame(now_ms, &output, &frame) && node.offered != MESSAGES_WHEEL_BRAKE) {
        offered_leaves(now_ms);
    }
    TEST_ASSERT_EQUAL_HEX16(0x187, frame.identifier);
    offered_leaves(now_ms);
    return frame.data[7];
}

/* WheelBrake.demand_counter is byte 7. A sender that compares it with its own sees every delay. */
void test_wheel_brake_echoes_the_counter_of_the_newest_demand_in_use(void)
{
    TEST_ASSERT_EQUAL_UINT8(0, echoed_counter(10));
    for (uint8_t k = 0; k < 3; k++) {
        (void)receive_demand((uint8_t)(253 + k), 1000, 10U * k);
        TEST_ASSERT_EQUAL_UINT8(k < 2 ? 0 : 255, echoed_counter(20U + 10U * k));
    }
    TEST_ASSERT_TRUE(receive_demand(1, 1000, 50));
    TEST_ASSERT_EQUAL_UINT8(1, echoed_counter(50));
    messages_frame_t damaged = demand_frame(2, 1000);
    damaged.data[6] ^= 1;
    TEST_ASSERT_FALSE(node_receive(&node, &damaged, 60));
    TEST_ASSERT_FALSE(receive_demand(1, 1000, 60)); /* repeated */
    TEST_ASSERT_EQUAL_UINT8(1, echoed_counter(60));
}

/* ---- the optional messages ---- */

void test_a_short_time_limit_is_kept_beside_the_lasting_one_and_ends_with_its_messages(void)
{
    const battery_limits_t limits = {
        .charge_peak_current_mA = 120000, .current_mA = -3000, .current_given = true};
    for (uint32_t k = 0; k < 3; k++) {
        const messages_frame_t frame = messages_peak(&limits, node.address, (uint8_t)k);
        (void)node_receive(&node, &frame, k * BATTERY_CYCLE_ms);
        (void)receive_battery((uint8_t)k, 10000, k * BATTERY_CYCLE_ms);
    }
    TEST_ASSERT_EQUAL_INT32(120000, node.command.bms.charge_peak_current_mA);
    TEST_ASSERT_EQUAL_INT32(10000, node.command.bms.charge_current_mA);
    (void)receive_battery(3, 0, 3 * BATTERY_CYCLE_ms);
    TEST_ASSERT_EQUAL_INT32(120000, node.command.bms.charge_peak_current_mA);
    TEST_ASSERT_EQUAL_INT32(0, node.command.bms.charge_current_mA);
    TEST_ASSERT_EQUAL_INT32(-3000, node.command.bms.current_mA);
    TEST_ASSERT_TRUE(node.command.bms.current_given);
    TEST_ASSERT_TRUE(node_tick(&node, (2 + NODE_TIMEOUT_CYCLES) * BATTERY_CYCLE_ms));
    TEST_ASSERT_EQUAL_INT32(0, node.command.bms.charge_peak_current_mA);
    TEST_ASSERT_FALSE(node.command.bms.current_given);
}

/* The monitor latches a fault after 200 ms of contradiction, which one wrong value must not make:
 * the frames after it are lost, then they come again. */
void test_one_value_of_the_pack_current_lasts_for_a_cycle_and_a_half_at_most(void)
{
    const battery_limits_t limits = {
        .voltage_mV = 53000, .current_mA = 200000, .current_given = true};
    for (uint32_t ms = 0; ms <= 5 * BATTERY_CYCLE_ms; ms++) {
        const bool lost = ms == 3 * BATTERY_CYCLE_ms || ms == 4 * BATTERY_CYCLE_ms;
        if (ms % BATTERY_CYCLE_ms == 0 && !lost) {
            const messages_frame_t frame =
                messages_peak(&limits, node.address, (uint8_t)(ms / BATTERY_CYCLE_ms));
            (void)node_receive(&node, &frame, ms);
        }
        const bool changed = node_tick(&node, ms);
        TEST_ASSERT_EQUAL_INT((ms >= 200 && ms < 350) || ms == 500, node.command.bms.current_given);
        TEST_ASSERT_EQUAL_INT(ms == 350, changed);
        TEST_ASSERT_EQUAL_INT32(ms >= 200 ? 53000 : 0, node.command.bms.voltage_mV);
    }
}

/* Counters 0 1 2 0 1 2 ... : the first of a round is out of order, the second qualifies again. */
void test_recorded_battery_current_is_given_for_one_frame_of_a_round_at_most(void)
{
    const battery_limits_t limits = {
        .charge_peak_current_mA = 120000, .current_mA = -3000, .current_given = true};
    for (uint32_t k = 0; k < 12; k++) {
        const messages_frame_t frame = messages_peak(&limits, node.address, (uint8_t)(k % 3));
        (void)node_receive(&node, &frame, k * BATTERY_CYCLE_ms);
        TEST_ASSERT_EQUAL_INT(k % 3 == 2, node.command.bms.current_given);
    }
    TEST_ASSERT_EQUAL_INT32(120000, node.command.bms.charge_peak_current_mA);
}

void test_hydraulic_feedback_has_an_age_and_becomes_invalid_with_its_messages(void)
{
    TEST_ASSERT_FALSE(node_hydraulic(&node.command, 5).valid);
    const hydraulic_feedback_t measured = {.torque_mNm = 23400, .valid = true};
    for (uint32_t k = 0; k < 3; k++) {
        const messages_frame_t frame = messages_hydraulic(&measured, node.address, (uint8_t)k);
        TEST_ASSERT_EQUAL_INT(k == 2, node_receive(&node, &frame, k * 20));
    }
    const hydraulic_feedback_t got = node_hydraulic(&node.command, 40 + 13);
    TEST_ASSERT_TRUE(got.valid);
    TEST_ASSERT_EQUAL_INT32(23400, got.torque_mNm);
    TEST_ASSERT_EQUAL_UINT32(13, got.age_ms);
    TEST_ASSERT_TRUE(node_tick(&node, 40 + NODE_TIMEOUT_CYCLES * 20));
    TEST_ASSERT_FALSE(node_hydraulic(&node.command, 140).valid);
}
