/* SPDX-License-Identifier: Apache-2.0 */
/* What the fast loop gives to the bridge. */
#include "fast_output.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

void test_on_times_are_whole_counts_rounded_down(void)
{
    static controller_fast_t fast;
    const int32_t on_q16[3] = {65535, 65536, 2100 * 65536 + 40000};
    const uint16_t counts[3] = {0, 1, 2100};
    for (int x = 0; x < 3; x++) {
        fast.foc.current.on_q16[x] = on_q16[x];
    }
    fast_output_write(&fast, BRIDGE_SHORT);
    TEST_ASSERT_EQUAL_UINT16_ARRAY(counts, fast.output.compare_counts, 3);
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, fast.output.bridge);
}
