/* SPDX-License-Identifier: Apache-2.0 */
/* A condition that counts once it has lasted and for a while after it, against its history. */
#include "core/debounce.h"

#include "random_values.h"
#include "unity.h"

static debounce_t state;

void setUp(void)
{
    const debounce_t fresh = {.count = 0};
    state = fresh;
}

void tearDown(void) {}

void test_a_condition_counts_from_the_step_in_which_it_has_lasted(void)
{
    for (int n = 1; n < 5; n++) {
        TEST_ASSERT_FALSE(debounce_step(&state, true, 5, 1));
    }
    TEST_ASSERT_TRUE(debounce_step(&state, true, 5, 1));
    TEST_ASSERT_TRUE(debounce_step(&state, true, 5, 1));
}

void test_a_step_without_the_condition_begins_the_qualify_time_anew(void)
{
    for (int n = 1; n < 5; n++) {
        (void)debounce_step(&state, true, 5, 1);
    }
    TEST_ASSERT_FALSE(debounce_step(&state, false, 5, 1));
    for (int n = 1; n < 5; n++) {
        TEST_ASSERT_FALSE(debounce_step(&state, true, 5, 1));
    }
    TEST_ASSERT_TRUE(debounce_step(&state, true, 5, 1));
}

void test_it_counts_until_the_condition_has_been_absent_for_the_heal_time(void)
{
    TEST_ASSERT_TRUE(debounce_step(&state, true, 1, 4));
    for (int n = 1; n < 4; n++) {
        TEST_ASSERT_TRUE(debounce_step(&state, false, 1, 4));
    }
    TEST_ASSERT_FALSE(debounce_step(&state, false, 1, 4));
}

void test_the_shortest_times_are_the_condition_itself(void)
{
    random_t random = random_seeded(1);
    for (int n = 0; n < 1000; n++) {
        const bool condition = random_chance(&random, 0.5);
        TEST_ASSERT_EQUAL_INT(condition, debounce_step(&state, condition, 1, 1));
    }
}

/* What is shorter than the qualify time does not prolong the heal time. */
void test_a_condition_that_comes_back_for_less_than_the_qualify_time_heals_in_time(void)
{
    for (int n = 0; n < 3; n++) {
        (void)debounce_step(&state, true, 3, 6);
    }
    static const bool AFTER[] = {false, true, true, false, true};
    for (int n = 0; n < 5; n++) {
        TEST_ASSERT_TRUE(debounce_step(&state, AFTER[n], 3, 6));
    }
    TEST_ASSERT_FALSE(debounce_step(&state, false, 3, 6));
}

/* By definition: one of the latest `heal` steps ended `qualify` steps with the condition in a row.
 */
static bool counts(const bool *history, int steps, int qualify, int heal)
{
    for (int end = steps; end > steps - heal && end >= qualify; end--) {
        bool lasted = true;
        for (int n = end - qualify; n < end; n++) {
            lasted = lasted && history[n];
        }
        if (lasted) {
            return true;
        }
    }
    return false;
}

void test_any_sequence_counts_by_the_definition(void)
{
    enum { STEPS = 200 };
    random_t random = random_seeded(2);
    for (int run = 0; run < 200; run++) {
        bool history[STEPS];
        const int qualify = random_between(&random, 1, 8);
        const int heal = random_between(&random, 1, 12);
        const double often = random_real(&random, 0.1, 0.95);
        setUp();
        for (int n = 0; n < STEPS; n++) {
            history[n] = random_chance(&random, often);
            const bool found = debounce_step(&state, history[n], (uint32_t)qualify, (uint32_t)heal);
            TEST_ASSERT_EQUAL_INT(counts(history, n + 1, qualify, heal), found);
        }
    }
}

void test_a_condition_that_lasts_for_ever_stays(void)
{
    for (int n = 0; n < UINT16_MAX + 100; n++) {
        TEST_ASSERT_EQUAL_INT(n >= 99, debounce_step(&state, true, 100, 1));
    }
    TEST_ASSERT_FALSE(debounce_step(&state, false, 100, 1));
}

void test_the_longest_times_are_65535_steps(void)
{
    for (int n = 1; n < UINT16_MAX; n++) {
        TEST_ASSERT_FALSE(debounce_step(&state, true, UINT16_MAX, UINT16_MAX));
    }
    TEST_ASSERT_TRUE(debounce_step(&state, true, UINT16_MAX, UINT16_MAX));
    for (int n = 1; n < UINT16_MAX; n++) {
        TEST_ASSERT_TRUE(debounce_step(&state, false, UINT16_MAX, UINT16_MAX));
    }
    TEST_ASSERT_FALSE(debounce_step(&state, false, UINT16_MAX, UINT16_MAX));
}
