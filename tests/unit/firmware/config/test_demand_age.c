/* SPDX-License-Identifier: Apache-2.0 */
#include "config/demand_age.h"
#include "unity.h"

extern const config_t CONFIG_LU2013;

void setUp(void) {}

void tearDown(void) {}

void test_a_demand_is_lost_one_millisecond_after_its_timeout(void)
{
    const uint32_t timeout_ms = (uint32_t)CONFIG_LU2013.brake.demand_timeout_ms;
    TEST_ASSERT_FALSE(demand_is_lost(&CONFIG_LU2013, 0));
    TEST_ASSERT_FALSE(demand_is_lost(&CONFIG_LU2013, timeout_ms));
    TEST_ASSERT_TRUE(demand_is_lost(&CONFIG_LU2013, timeout_ms + 1));
    TEST_ASSERT_TRUE(demand_is_lost(&CONFIG_LU2013, UINT32_MAX));
}
