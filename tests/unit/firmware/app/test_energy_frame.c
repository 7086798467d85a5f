/* SPDX-License-Identifier: Apache-2.0 */
/* WheelEnergy carries the integral of the electrical power. */
#include "app/energy_frame.h"
#include "mock_can.h"
#include "unity.h"

enum {
    WHEEL_ENERGY = 0x19C, /* of the front left wheel */
    PLACE = MESSAGES_WHEEL_ENERGY - MESSAGES_RECEIVED,
    LIFE_BEFORE_10J = 3600000 /* 10 kWh */
};

static can_link_t can_link;
static energy_t energy;
static can_frame_t sent[16];
static int sent_count;
static bool takes;

static bool transmit(const can_frame_t *frame, int calls)
{
    (void)calls;
    if (takes) {
        sent[sent_count++] = *frame;
    }
    return takes;
}

static bool init(const uint16_t *identifiers, uint32_t count, int calls)
{
    (void)identifiers;
    (void)calls;
    return count > 0;
}

void setUp(void)
{
    static config_t config;
    static const uint32_t before[ENERGY_KINDS] = {LIFE_BEFORE_10J, 0, 0, 0};
    config.vehicle.can_base = 0x100;
    can_init_StubWithCallback(init);
    can_transmit_StubWithCallback(transmit);
    (void)can_link_init(&can_link, &config, NULL, 0);
    energy_init(&energy, before);
    sent_count = 0;
    takes = true;
}

void tearDown(void) {}

/* A second at a power in watts, and a pass of the background after each millisecond. */
static void second(uint32_t begun_ms, int32_t power_W)
{
    slow_output_t output = {.bus_voltage_mV = 50000, .bus_current_mA = power_W * 20};
    for (uint32_t ms = 1; ms <= 1000; ms++) {
        energy_step(&energy, &output, (uint16_t)(begun_ms + ms));
        const int before = sent_count;
        energy_frame_transmit(&can_link, begun_ms + ms, &energy);
        if (sent_count > before) {
            (void)node_left(&can_link.node, PLACE, begun_ms + ms);
        }
    }
}

/* Bits 13 to 34, and 35 to 56. */
static uint32_t bits(const can_frame_t *frame, uint32_t first)
{
    uint64_t all = 0;
    for (uint32_t k = 0; k < 8; k++) {
        all |= (uint64_t)frame->data[k] << (8U * k);
    }
    return (uint32_t)(all >> first) & 0x3FFFFFU;
}

/* 7.2 kW for a second are 2 Wh, half of it at half a second; 3.6 kW back for a second are 1 Wh. */
void test_the_frames_of_two_seconds_are_the_integral_of_the_power(void)
{
    second(0, 7200);
    TEST_ASSERT_EQUAL_INT(2, sent_count);
    TEST_ASSERT_EQUAL_HEX16(WHEEL_ENERGY, sent[0].identifier);
    TEST_ASSERT_EQUAL_UINT8(8, sent[0].length);
    TEST_ASSERT_EQUAL_UINT32(10, bits(&sent[0], 13));   /* 1.0 Wh since the start */
    TEST_ASSERT_EQUAL_UINT32(2000, bits(&sent[1], 13)); /* 10 002 Wh for life, in steps of 5 Wh */
    second(1000, -3600);
    TEST_ASSERT_EQUAL_INT(4, sent_count);
    TEST_ASSERT_EQUAL_UINT32(20, bits(&sent[2], 13));
    TEST_ASSERT_EQUAL_UINT32(5, bits(&sent[2], 35)); /* half a second of it */
    second(2000, -3600);
    TEST_ASSERT_EQUAL_UINT32(20, bits(&sent[4], 13));
    TEST_ASSERT_EQUAL_UINT32(15, bits(&sent[4], 35));
}

/* It stays due, and the account goes on meanwhile. */
void test_a_frame_that_the_controller_does_not_take_is_sent_later_with_the_newest_values(void)
{
    takes = false;
    second(0, 7200);
    TEST_ASSERT_EQUAL_INT(0, sent_count);
    takes = true;
    energy_frame_transmit(&can_link, 1001, &energy);
    TEST_ASSERT_EQUAL_INT(1, sent_count);
    TEST_ASSERT_EQUAL_UINT32(20, bits(&sent[0], 13));
}
