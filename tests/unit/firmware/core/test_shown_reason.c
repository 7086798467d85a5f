/* SPDX-License-Identifier: Apache-2.0 */
/* A reason for people: shown at once after rest, never more than five changes within a second, and
 * the present one in the end. */
#include "core/shown_reason.h"

#include <math.h>

#include "random_values.h"
#include "unity.h"

enum { SECOND_ms = 1000, MOST_CHANGES = 5, LIFE_ms = 200000 };

static shown_reason_t state;

void setUp(void)
{
    state = shown_reason_init();
}

void tearDown(void) {}

static reason_t after(reason_t reason, int32_t ms)
{
    reason_t out = state.reason;
    for (int32_t n = 0; n < ms; n++) {
        out = shown_reason_step(&state, reason);
    }
    return out;
}

void test_nothing_is_shown_at_first(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_NONE, state.reason);
}

void test_a_limit_after_a_third_of_a_second_of_another_shows_at_once(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_VOLTAGE, after(REASON_VOLTAGE, 1));
    TEST_ASSERT_EQUAL_INT(REASON_VOLTAGE, after(REASON_VOLTAGE, 333));
    TEST_ASSERT_EQUAL_INT(REASON_MAX_POWER, after(REASON_MAX_POWER, 1));
}

void test_a_limit_sooner_shows_as_soon_as_that_is_over(void)
{
    after(REASON_VOLTAGE, 1);
    TEST_ASSERT_EQUAL_INT(REASON_VOLTAGE, after(REASON_MAX_POWER, 333));
    TEST_ASSERT_EQUAL_INT(REASON_MAX_POWER, after(REASON_MAX_POWER, 1));
}

void test_what_comes_and_goes_meanwhile_is_not_shown(void)
{
    after(REASON_VOLTAGE, 1);
    after(REASON_MAX_POWER, 100);
    TEST_ASSERT_EQUAL_INT(REASON_VOLTAGE, after(REASON_VOLTAGE, 1000));
}

void test_a_limit_follows_the_torque_rate_and_that_no_reason_at_once(void)
{
    after(REASON_VOLTAGE, 1);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, after(REASON_NONE, 334));
    TEST_ASSERT_EQUAL_INT(REASON_TORQUE_RATE, after(REASON_TORQUE_RATE, 1));
    TEST_ASSERT_EQUAL_INT(REASON_VOLTAGE, after(REASON_VOLTAGE, 1));
    TEST_ASSERT_EQUAL_INT(REASON_VOLTAGE, after(REASON_TORQUE_RATE, 3 * 334 - 3));
    TEST_ASSERT_EQUAL_INT(REASON_TORQUE_RATE, after(REASON_TORQUE_RATE, 1));
}

static reason_t drawn_reason(random_t *random)
{
    static const reason_t OFTEN[2] = {REASON_NONE, REASON_TORQUE_RATE};
    return random_chance(random, 0.5)
               ? OFTEN[random_between(random, 0, 1)]
               : (reason_t)random_between(random, 1, REASON_SWITCH_TEMPERATURE);
}

/* Reasons that stay for 1 ms to a second, drawn evenly in the logarithm: each change against the
 * fifth one before. What is shown was present within the last second; it is no reason only where
 * there is none. */
void test_no_more_than_five_changes_within_any_second(void)
{
    random_t random = random_seeded(31);
    int32_t changed_ms[MOST_CHANGES];
    int32_t seen_ms[REASON_TORQUE_RATE + 1];
    int32_t changes = 0;
    int32_t lasts_ms = 0;
    reason_t reason = REASON_NONE;
    for (int k = 0; k <= REASON_TORQUE_RATE; k++) {
        seen_ms[k] = -2 * SECOND_ms;
    }
    for (int32_t now_ms = 0; now_ms < LIFE_ms; now_ms++) {
        if (lasts_ms-- == 0) {
            reason = drawn_reason(&random);
            lasts_ms = (int32_t)pow(1000.0, random_fraction(&random));
        }
        seen_ms[reason] = now_ms;
        const reason_t before = state.reason;
        const reason_t shown = shown_reason_step(&state, reason);
        TEST_ASSERT_TRUE(shown != REASON_NONE || reason == REASON_NONE);
        TEST_ASSERT_LESS_THAN_INT32(3 * SHOWN_REASON_STANDS_ms, now_ms - seen_ms[shown]);
        if (shown != before) {
            int32_t *const oldest_ms = &changed_ms[changes % MOST_CHANGES];
            TEST_ASSERT_TRUE(changes < MOST_CHANGES || now_ms - *oldest_ms >= SECOND_ms);
            *oldest_ms = now_ms;
            changes++;
        }
    }
    TEST_ASSERT_GREATER_THAN_INT32(LIFE_ms / SECOND_ms, changes);
}
