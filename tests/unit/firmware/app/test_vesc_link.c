/* SPDX-License-Identifier: Apache-2.0 */
/* When VESC status frames are given to the CAN controller, and what they sum up. */
#include "app/vesc_link.h"

#include "mock_can.h"
#include "unity.h"

enum { CONTROLLER_ID = 40, WHEEL = 2, STATUS_2 = 14 << 8, STATUS_5 = 27 << 8 };

static vesc_link_t link_state;
static config_t config;
static energy_t energy;
static slow_output_t output;
static vesc_link_view_t view;
static uint32_t now_ms;
static can_frame_t sent[64];
static uint32_t given; /* the latest identifier */
static int sent_count, asked;
static bool takes;
static can_progress_t became;

static bool transmit(const can_frame_t *frame, int calls)
{
    (void)calls;
    if (takes) {
        given = frame->identifier;
        sent[sent_count++] = *frame;
    }
    return takes;
}

static can_progress_t progress(uint32_t identifier, int calls)
{
    (void)calls;
    asked++;
    TEST_ASSERT_EQUAL_HEX32(given, identifier);
    return became;
}

void setUp(void)
{
    static const wheel_temperatures_t warm = {2500, 2500};
    static const uint32_t zero[ENERGY_KINDS] = {0};
    const vesc_link_t fresh = {.pending = false};
    const slow_output_t still = {.bus_voltage_mV = 50000};
    const vesc_link_view_t first = {.output = &output, .temperature = &warm};
    link_state = fresh;
    output = still;
    view = first;
    config.motor.pole_pairs = 10;
    config.vehicle.wheel_position = WHEEL;
    config.can.vesc_status = CONTROLLER_ID;
    energy_init(&energy, zero);
    can_transmit_StubWithCallback(transmit);
    can_progress_StubWithCallback(progress);
    now_ms = 0;
    sent_count = 0;
    asked = 0;
    takes = true;
    became = CAN_SENT;
}

void tearDown(void) {}

static void milliseconds(uint32_t count)
{
    for (uint32_t k = 0; k < count; k++) {
        now_ms++;
        view.slow_steps++;
        vesc_link_step(&link_state, &config, &view, &energy, now_ms);
    }
}

static int32_t word(const can_frame_t *frame, uint32_t first)
{
    const uint8_t *d = &frame->data[first];
    return (int32_t)((uint32_t)d[0] << 24 | (uint32_t)d[1] << 16 | (uint32_t)d[2] << 8 | d[3]);
}

static const can_frame_t *latest(uint32_t packet)
{
    const can_frame_t *found = NULL;
    for (int k = 0; k < sent_count; k++) {
        found = sent[k].identifier == (CAN_EXTENDED | packet | (CONTROLLER_ID + WHEEL)) ? &sent[k]
                                                                                        : found;
    }
    TEST_ASSERT_NOT_NULL(found);
    return found;
}

void test_nothing_is_sent_unless_the_configuration_says_so(void)
{
    config.can.vesc_status = 0;
    milliseconds(1000);
    TEST_ASSERT_EQUAL_INT(0, sent_count + asked);
}

void test_one_frame_each_20_ms_and_each_kind_every_100_ms(void)
{
    static const uint32_t PACKETS[] = {9, 14, 15, 16, 27};
    milliseconds(200);
    TEST_ASSERT_EQUAL_INT(10, sent_count);
    for (int k = 0; k < sent_count; k++) {
        TEST_ASSERT_EQUAL_HEX32(CAN_EXTENDED | PACKETS[k % 5] << 8 | (CONTROLLER_ID + WHEEL),
                                sent[k].identifier);
        TEST_ASSERT_EQUAL_UINT8(8, sent[k].length);
    }
}

/* Frames of our own go first: it is offered again in each pass, but takes no second one's time. */
void test_a_frame_that_is_not_taken_waits_and_the_cycle_with_it(void)
{
    takes = false;
    milliseconds(95);
    takes = true;
    milliseconds(1);
    TEST_ASSERT_EQUAL_INT(1, sent_count);
    milliseconds(19);
    TEST_ASSERT_EQUAL_INT(1, sent_count);
    milliseconds(1);
    TEST_ASSERT_EQUAL_INT(2, sent_count);
}

/* Nobody acknowledges: the newest values replace those that wait. */
void test_a_frame_that_does_not_leave_is_replaced_by_one_of_its_own_kind(void)
{
    became = CAN_PENDING;
    milliseconds(20);
    output.speed_mrad_s = 1000;
    milliseconds(20);
    TEST_ASSERT_EQUAL_INT(2, sent_count);
    TEST_ASSERT_EQUAL_HEX32(sent[0].identifier, sent[1].identifier);
    TEST_ASSERT_EQUAL_INT32(0, word(&sent[0], 0));
    TEST_ASSERT_EQUAL_INT32(95, word(&sent[1], 0)); /* 1 rad/s, ten pole pairs */
    became = CAN_ABORTED;
    milliseconds(20);
    TEST_ASSERT_EQUAL_HEX32(CAN_EXTENDED | STATUS_2 | (CONTROLLER_ID + WHEEL), sent[2].identifier);
}

/* 10 A for an hour out of the battery, 5 A for half an hour back; 1 rad/s forward for the first,
 * and as fast in reverse for the second. A pass of the background each second. */
void test_charge_and_turns_are_the_integrals_of_current_and_speed(void)
{
    for (uint32_t second = 0; second < 5400; second++) {
        output.bus_current_mA = second < 3600 ? 10000 : -5000;
        output.speed_mrad_s = second < 3600 ? 1000 : -1000;
        view.slow_steps = (uint16_t)(view.slow_steps + 1000U);
        now_ms += 1000;
        sent_count = 0;
        vesc_link_step(&link_state, &config, &view, &energy, now_ms);
    }
    sent_count = 0;
    output.bus_current_mA = 0;
    output.speed_mrad_s = 0;
    milliseconds(100);
    TEST_ASSERT_EQUAL_INT32(100000, word(latest(STATUS_2), 0));
    TEST_ASSERT_EQUAL_INT32(25000, word(latest(STATUS_2), 4));
    TEST_ASSERT_EQUAL_INT32(17189, word(latest(STATUS_5), 0)); /* 1800 rad of 60 steps a turn */
}
