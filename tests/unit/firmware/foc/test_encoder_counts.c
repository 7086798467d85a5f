/* SPDX-License-Identifier: Apache-2.0 */
/* What the counts of an encoder make of a turn, and from which count on an index is missing. */
#include "encoder.h"

#include "unity.h"

extern const config_t CONFIG_LU2013;

static config_t config;
static encoder_t encoder;

static void configure(int32_t counts, int32_t pole_pairs)
{
    config = CONFIG_LU2013;
    config.motor.pole_pairs = pole_pairs;
    config.rotor.sensor = CONFIG_ROTOR_ENCODER;
    config.rotor.encoder_counts = counts;
    config.rotor.encoder_index_turn = 12345;
    config.rotor.encoder_index_tolerance_counts = 4;
    config.rotor.encoder_reversed = 0;
    encoder_init(&encoder, &config);
}

void setUp(void)
{
    configure(1000, 1);
}

void tearDown(void) {}

void test_constants_of_1000_counts_and_one_pole_pair(void)
{
    TEST_ASSERT_EQUAL_INT32(1000, encoder.counts);
    TEST_ASSERT_EQUAL_INT32(4, encoder.tolerance_counts);
    TEST_ASSERT_EQUAL_INT32(1125, encoder.overdue_counts);
    TEST_ASSERT_EQUAL_INT32(126, encoder.max_counts);
    TEST_ASSERT_EQUAL_UINT32(4294967, encoder.turn_per_count_q32); /* 4 294 967.296 */
    TEST_ASSERT_EQUAL_INT32(66, encoder.count_turn);               /* 65.5, and no less */
    TEST_ASSERT_EQUAL_HEX32((12345U << 16) + 2147483U, encoder.origin_q32);
    TEST_ASSERT_EQUAL_HEX32(encoder.origin_q32, encoder.base_q32);
    TEST_ASSERT_FALSE(encoder.started);
}

void test_angle_of_a_count_is_rounded_to_nearest(void)
{
    configure(7, 1);
    TEST_ASSERT_EQUAL_UINT32(613566757, encoder.turn_per_count_q32); /* 613 566 756.57 */
    configure(600, 1);
    TEST_ASSERT_EQUAL_UINT32(7158279, encoder.turn_per_count_q32); /* 7 158 278.83 */
}

void test_an_encoder_without_counts_has_one(void)
{
    configure(0, 1);
    TEST_ASSERT_EQUAL_INT32(1, encoder.counts);
}

void test_first_period_starts_from_any_count(void)
{
    const encoder_input_t at_zero = {.count = 0};
    encoder_step(&encoder, &config, &at_zero);
    TEST_ASSERT_TRUE(encoder.started);
    TEST_ASSERT_EQUAL_UINT16(0, encoder.faults);
    const encoder_input_t next = {.count = 126};
    encoder_step(&encoder, &config, &next);
    TEST_ASSERT_EQUAL_INT32(126, encoder.position_counts);
    TEST_ASSERT_EQUAL_UINT16(0, encoder.faults);
}

/* From the index to 1 100 counts, then a count at a time. */
void test_index_is_missing_more_than_an_eighth_beyond_a_turn(void)
{
    for (int direction = -1; direction <= 1; direction += 2) {
        setUp();
        for (int at = 0; at <= 1126; at += at < 1100 ? 100 : 1) {
            const encoder_input_t in = {.count = (uint16_t)(direction * at), .index = at == 0};
            encoder_step(&encoder, &config, &in);
            TEST_ASSERT_EQUAL_UINT16(at > 1125 ? 1 : 0, encoder.faults);
            TEST_ASSERT_EQUAL_INT32(direction * (at > 1125 ? 126 : at), encoder.position_counts);
        }
    }
}
