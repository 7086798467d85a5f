/* SPDX-License-Identifier: Apache-2.0 */
/* The least current that must flow at a setpoint. */
#include "controller/current_expectation.h"

#include <math.h>

#include "paper_vehicle.h"
#include "unity.h"

static config_t config;
static dq_t before_pu;

void setUp(void)
{
    config = paper_vehicle();
    config.current_loop.max_current_pu_q15 = 14895;
    before_pu.d = 0;
    before_pu.q = 0;
}

void tearDown(void) {}

static uint32_t step(dq_t reference_pu, bool switching)
{
    const uint32_t square = current_expectation(&config, reference_pu, before_pu, switching);
    before_pu = reference_pu;
    return square;
}

static uint32_t after(int32_t d, int32_t q)
{
    const dq_t reference_pu = {.d = d, .q = q};
    return step(reference_pu, true);
}

void test_quarter_of_the_shorter_reference_must_flow(void)
{
    after(0, 8000);
    TEST_ASSERT_EQUAL_UINT32(2000 * 2000, after(0, 8000));
    TEST_ASSERT_EQUAL_UINT32(1000 * 1000, after(0, 4000));
    TEST_ASSERT_EQUAL_UINT32(1000 * 1000, after(0, 12000));
    after(-6000, 8000);
    TEST_ASSERT_EQUAL_UINT32(2500 * 2500, after(-6000, 8000));
}

void test_reference_that_turns_around_promises_no_current(void)
{
    after(0, 8000);
    TEST_ASSERT_EQUAL_UINT32(0, after(0, -8000));
    TEST_ASSERT_EQUAL_UINT32(0, after(-8000, 0));
}

/* Twice the six codes that a dead sensor may show, and not below. */
void test_small_reference_promises_no_current(void)
{
    after(0, 767);
    TEST_ASSERT_EQUAL_UINT32(0, after(0, 767));
    after(0, 768);
    TEST_ASSERT_EQUAL_UINT32(192 * 192, after(0, 768));
}

void test_first_reference_of_a_bridge_that_begins_to_switch_promises_no_current(void)
{
    const dq_t reference_pu = {.d = 0, .q = 8000};
    step(reference_pu, false);
    TEST_ASSERT_EQUAL_UINT32(0, step(reference_pu, false));
    TEST_ASSERT_EQUAL_UINT32(2000 * 2000, step(reference_pu, true));
}

/* The fast loop shortens it to the largest current, and so does this: any 16-bit values. */
void test_reference_beyond_the_largest_current_counts_as_that(void)
{
    after(INT16_MIN, INT16_MIN);
    TEST_ASSERT_EQUAL_UINT32(14895 * 14895 / 16, after(INT16_MIN, INT16_MIN));
}
