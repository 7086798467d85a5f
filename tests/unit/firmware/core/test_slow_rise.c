/* SPDX-License-Identifier: Apache-2.0 */
/* A limit that falls at once and rises slowly: how slowly, what is forgotten, and what is left of
 * falls that follow each other. */
#include "core/slow_rise.h"
#include "random_values.h"
#include "unity.h"

enum { WHOLE = 1 << 20 };

static slow_rise_t state;

void setUp(void)
{
    state = slow_rise_init();
}

void tearDown(void) {}

static int32_t stay(int32_t limit, int steps)
{
    int32_t out = state.value;
    for (int n = 0; n < steps; n++) {
        out = slow_rise_step(&state, limit, WHOLE);
    }
    return out;
}

static int steps_to_the_whole(void)
{
    int steps = 1;
    while (slow_rise_step(&state, WHOLE, WHOLE) < WHOLE) {
        steps++;
    }
    return steps;
}

void test_the_first_limit_counts_at_once(void)
{
    TEST_ASSERT_EQUAL_INT32(WHOLE, stay(WHOLE, 1));
    setUp();
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, stay(INT32_MAX, 1));
    setUp();
    TEST_ASSERT_EQUAL_INT32(0, stay(0, 1));
}

void test_it_is_never_above_the_limit_and_falls_with_it(void)
{
    random_t random = random_seeded(1);
    int32_t before = INT32_MAX;
    for (int n = 0; n < 100000; n++) {
        const int32_t limit = random_between(&random, 0, INT32_MAX);
        const int32_t out = slow_rise_step(&state, limit, INT32_MAX);
        TEST_ASSERT_TRUE(out <= limit);
        TEST_ASSERT_TRUE(limit > before || out == limit);
        TEST_ASSERT_TRUE(out - before <= (INT32_MAX >> SLOW_RISE_FIRST_LOG2) + 1);
        before = out;
    }
}

/* 2^11 ms, and each time twice as long up to 2^13. */
void test_each_return_takes_twice_as_long_as_the_last(void)
{
    static const int EXPECTED[] = {2048, 4096, 8192, 8192};
    for (int k = 0; k < 4; k++) {
        stay(0, 100);
        TEST_ASSERT_EQUAL_INT(EXPECTED[k], steps_to_the_whole());
    }
}

void test_a_limit_that_falls_step_by_step_has_not_returned(void)
{
    for (int32_t limit = WHOLE; limit >= 0; limit -= WHOLE / 64) {
        stay(limit, 10);
    }
    TEST_ASSERT_EQUAL_INT(2048, steps_to_the_whole());
}

/* Ten quiet seconds, at the top or at the bottom, and not a step less. */
void test_returns_are_forgotten_after_ten_quiet_seconds(void)
{
    static const int32_t QUIET_AT[] = {0, WHOLE};
    for (int more = 0; more <= 1; more++) {
        for (int k = 0; k < 2; k++) {
            setUp();
            for (int n = 0; n < 2; n++) {
                stay(0, 1);
                (void)steps_to_the_whole();
            }
            stay(0, 1 - k);
            stay(QUIET_AT[k], SLOW_RISE_QUIET_STEPS + more);
            stay(0, k);
            TEST_ASSERT_EQUAL_INT(more == 1 ? 2048 : 8192, steps_to_the_whole());
        }
    }
}

/* Also where it is no multiple of the time. */
void test_any_range_returns_in_the_same_time(void)
{
    static const int32_t WHOLES[] = {1, 3, 1000, 32767, 8000000, INT32_MAX};
    for (int k = 0; k < 6; k++) {
        setUp();
        (void)slow_rise_step(&state, 0, WHOLES[k]);
        for (int n = 1; n < 2048; n++) {
            TEST_ASSERT_EQUAL_INT32((int64_t)WHOLES[k] * n / 2048,
                                    slow_rise_step(&state, WHOLES[k], WHOLES[k]));
        }
        TEST_ASSERT_EQUAL_INT32(WHOLES[k], slow_rise_step(&state, WHOLES[k], WHOLES[k]));
    }
}

/* There half of the time, for ten seconds at 1 Hz and more: after n returns of t = 1/(2 f) each
 * t/2.048 + t/4.096 + (n - 2) t/8.192 of the range, at most 0.85 at 1 Hz. */
void test_what_flickers_falls_by_less_than_the_whole_after_its_first_fall(void)
{
    for (int half_ms = 1; half_ms <= 500; half_ms++) {
        setUp();
        stay(WHOLE, 1);
        int64_t fallen = -(int64_t)WHOLE;
        int32_t before = WHOLE;
        for (int ms = 0; ms < 10000; ms++) {
            const int32_t out = slow_rise_step(&state, ms / half_ms % 2 == 0 ? 0 : WHOLE, WHOLE);
            fallen += out < before ? before - out : 0;
            before = out;
        }
        TEST_ASSERT_TRUE(fallen <= (int64_t)(0.86 * WHOLE));
    }
}
