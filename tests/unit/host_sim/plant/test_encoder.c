/* SPDX-License-Identifier: Apache-2.0 */
/* Counts and index of an incremental encoder on a shaft of 5 pole pairs. */
#include "plant/encoder.h"

#include <math.h>

#include "unity.h"

static const double POLE_PAIRS = 5.0;

static encoder_params_t params;
static encoder_shaft_t shaft;
static double electrical_turns;

void setUp(void)
{
    const encoder_params_t clean = {.counts = 1000.0, .index_deg = 90.0, .index_width_counts = 2.0};
    params = clean;
    electrical_turns = 0.0;
    shaft = encoder_begin(&params, POLE_PAIRS, 0.0, 0);
}

void tearDown(void) {}

static encoder_sample_t turn(double electrical)
{
    electrical_turns += electrical;
    return encoder_read(&params, POLE_PAIRS, &shaft, electrical_turns - floor(electrical_turns));
}

void test_a_mechanical_turn_is_1000_counts_in_either_direction(void)
{
    const uint16_t begin = turn(0.003).count;
    for (int n = 0; n < 50; n++) {
        (void)turn(0.1);
    }
    TEST_ASSERT_EQUAL_UINT16((uint16_t)(begin + 1000U), turn(0.0).count);
    for (int n = 0; n < 100; n++) {
        (void)turn(-0.1);
    }
    TEST_ASSERT_EQUAL_UINT16((uint16_t)(begin - 1000U), turn(0.0).count);
    params.reversed = 1.0;
    const uint16_t reversed = turn(0.0).count;
    (void)turn(0.2);
    TEST_ASSERT_EQUAL_UINT16((uint16_t)(reversed - 40U), turn(0.0).count);
}

/* At 90 electrical degrees of the first electrical turn, once a mechanical turn, with the count of
 * its leading edge. */
void test_the_index_occurs_once_per_turn_at_its_angle(void)
{
    int pulses = 0;
    for (int n = 0; n < 1500; n++) {
        const encoder_sample_t seen = turn(0.01);
        if (seen.index) {
            TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.25 + pulses * POLE_PAIRS, electrical_turns);
            /* 0.01 electrical turns are two counts. */
            TEST_ASSERT_UINT16_WITHIN(2, seen.count, seen.index_count);
            pulses++;
        }
    }
    TEST_ASSERT_EQUAL_INT(3, pulses);
}

void test_in_reverse_the_index_occurs_at_its_other_edge(void)
{
    encoder_sample_t forward = {.index = false};
    while (!forward.index) {
        forward = turn(0.01);
    }
    (void)turn(0.1);
    encoder_sample_t back = {.index = false};
    while (!back.index) {
        back = turn(-0.003);
    }
    TEST_ASSERT_EQUAL_UINT16((uint16_t)(forward.index_count + 2U), back.index_count);
}

void test_counts_can_be_lost_between_two_index_pulses(void)
{
    params.lost_counts = 7.0;
    encoder_sample_t seen = {.index = false};
    while (!seen.index) {
        seen = turn(0.01);
    }
    const uint16_t first = seen.index_count;
    do {
        seen = turn(0.01);
    } while (!seen.index);
    TEST_ASSERT_EQUAL_UINT16((uint16_t)(first + 993U), seen.index_count);
}

void test_zero_counts_per_turn_means_no_encoder(void)
{
    params.counts = 0.0;
    for (int n = 0; n < 1000; n++) {
        const encoder_sample_t seen = turn(0.01);
        TEST_ASSERT_FALSE(seen.index);
        TEST_ASSERT_EQUAL_UINT16(0, seen.count);
    }
}
