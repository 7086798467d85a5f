/* SPDX-License-Identifier: Apache-2.0 */
#include "paper_vehicle.h"
#include "random_values.h"
#include "torque/demand.h"
#include "unity.h"

static config_t config;
static demand_state_t state;

void setUp(void)
{
    config = paper_vehicle();
    config.brake.demand_timeout_ms = 100;
    config.brake.torque_rate_mNm_s = 400000; /* 400 mNm in a step of 1 ms */
    demand_init(&state);
}

void tearDown(void) {}

static demand_t fresh(int32_t drive_mNm, int32_t brake_mNm)
{
    return demand_step(&state, &config, drive_mNm, brake_mNm, 0);
}

void test_a_fresh_demand_passes_unchanged(void)
{
    const demand_t forward = fresh(12345, 0);
    TEST_ASSERT_EQUAL_INT32(12345, forward.drive_mNm);
    TEST_ASSERT_EQUAL_INT32(0, forward.brake_mNm);
    TEST_ASSERT_FALSE(forward.timed_out);
    TEST_ASSERT_EQUAL_INT32(-12345, fresh(-12345, 0).drive_mNm);
    TEST_ASSERT_EQUAL_INT32(20000, fresh(0, 20000).brake_mNm);
}

void test_driving_torque_is_zero_while_braking_is_demanded(void)
{
    const demand_t both = fresh(30000, 1);
    TEST_ASSERT_EQUAL_INT32(0, both.drive_mNm);
    TEST_ASSERT_EQUAL_INT32(1, both.brake_mNm);
    TEST_ASSERT_EQUAL_INT32(30000, fresh(30000, 0).drive_mNm);
}

void test_negative_braking_demand_counts_as_zero(void)
{
    const demand_t out = fresh(5000, -20000);
    TEST_ASSERT_EQUAL_INT32(0, out.brake_mNm);
    TEST_ASSERT_EQUAL_INT32(5000, out.drive_mNm);
    TEST_ASSERT_EQUAL_INT32(0, fresh(0, INT32_MIN).brake_mNm);
}

void test_demand_times_out_one_millisecond_after_demand_timeout(void)
{
    fresh(0, 20000);
    TEST_ASSERT_FALSE(demand_step(&state, &config, 0, 20000, 100).timed_out);
    TEST_ASSERT_TRUE(demand_step(&state, &config, 0, 20000, 101).timed_out);
    TEST_ASSERT_TRUE(demand_step(&state, &config, 0, 20000, UINT32_MAX).timed_out);
}

void test_braking_demand_decays_at_the_torque_rate_after_a_timeout(void)
{
    fresh(0, 20000);
    /* 400 mNm a step: 20 Nm take 50 steps. The demand of the old message is ignored. */
    for (int n = 1; n <= 50; n++) {
        const demand_t out = demand_step(&state, &config, 0, 20000, 101);
        TEST_ASSERT_EQUAL_INT32(20000 - 400 * n, out.brake_mNm);
    }
    TEST_ASSERT_EQUAL_INT32(0, demand_step(&state, &config, 0, 20000, 200).brake_mNm);
}

void test_driving_demand_of_either_sign_decays_at_the_torque_rate_after_a_timeout(void)
{
    fresh(-1000, 0);
    TEST_ASSERT_EQUAL_INT32(-600, demand_step(&state, &config, -1000, 0, 101).drive_mNm);
    TEST_ASSERT_EQUAL_INT32(-200, demand_step(&state, &config, -1000, 0, 102).drive_mNm);
    TEST_ASSERT_EQUAL_INT32(0, demand_step(&state, &config, -1000, 0, 103).drive_mNm);
}

void test_demand_applies_again_in_the_first_step_after_a_timeout(void)
{
    fresh(0, 20000);
    demand_step(&state, &config, 0, 20000, 101);
    const demand_t back = demand_step(&state, &config, 0, 20000, 0);
    TEST_ASSERT_EQUAL_INT32(20000, back.brake_mNm);
    TEST_ASSERT_FALSE(back.timed_out);
}

void test_demand_is_zero_before_the_first_message(void)
{
    const demand_t out = demand_step(&state, &config, 30000, 20000, UINT32_MAX);
    TEST_ASSERT_EQUAL_INT32(0, out.drive_mNm);
    TEST_ASSERT_EQUAL_INT32(0, out.brake_mNm);
}

void test_demand_is_bounded_for_any_message(void)
{
    random_t random = random_seeded(3);
    for (int n = 0; n < 100000; n++) {
        const demand_t out =
            demand_step(&state, &config, (int32_t)random_u64(&random), (int32_t)random_u64(&random),
                        (uint32_t)random_between(&random, 0, 200));
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, out.brake_mNm);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(100000000, out.brake_mNm); /* 100 kNm */
        TEST_ASSERT_INT32_WITHIN(100000000, 0, out.drive_mNm);
        TEST_ASSERT_TRUE(out.brake_mNm == 0 || out.drive_mNm == 0);
    }
}

void test_rate_is_the_configured_one_and_at_least_1_mNm_per_step(void)
{
    TEST_ASSERT_EQUAL_INT32(400, demand_rate_mNm_per_step(&config));
    config.brake.torque_rate_mNm_s = 100; /* 0.1 mNm a step, below the resolution of 1 mNm */
    TEST_ASSERT_EQUAL_INT32(1, demand_rate_mNm_per_step(&config));
}
