/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The guarantees of double_buffer.h over every interleaving on one core. Before each step of the
 * low-priority side the high-priority side runs 0, 1 or 2 times to its end, as an interrupt does.
 */
#include "app/double_buffer.h"
#include "unity.h"

enum { STEPS = 8, INTERLEAVINGS = 6561 /* 3^STEPS */ };

typedef struct {
    int first, second; /* always written equal; a difference shows a partly written value */
} payload_t;

static double_buffer_t pair;
static payload_t buffer[2];
static int high_value;

void setUp(void)
{
    double_buffer_init(&pair);
    buffer[0] = (payload_t){0, 0};
    buffer[1] = (payload_t){0, 0};
    high_value = 0;
}

void tearDown(void) {}

void test_each_side_owns_one_of_the_two_buffers(void)
{
    for (int i = 0; i < 5; i++) {
        TEST_ASSERT_EQUAL_UINT(1, double_buffer_low(&pair) + double_buffer_high(&pair));
        double_buffer_swap(&pair);
    }
}

void test_high_side_reads_the_value_the_low_side_has_written(void)
{
    for (int value = 1; value < 10; value++) {
        buffer[double_buffer_low(&pair)] = (payload_t){value, value};
        TEST_ASSERT_EQUAL_INT(value - 1, buffer[double_buffer_high(&pair)].first);
        double_buffer_swap(&pair);
        TEST_ASSERT_EQUAL_INT(value, buffer[double_buffer_high(&pair)].first);
    }
}

static void high_side_writes(int times)
{
    for (int i = 0; i < times; i++) {
        high_value++;
        payload_t *to = &buffer[double_buffer_high(&pair)];
        to->first = high_value;
        to->second = high_value;
        double_buffer_mark(&pair);
    }
}

static void high_side_reads(int times, int *newest)
{
    for (int i = 0; i < times; i++) {
        const payload_t *from = &buffer[double_buffer_high(&pair)];
        TEST_ASSERT_EQUAL_INT(from->first, from->second);
        TEST_ASSERT_TRUE(from->first >= *newest);
        *newest = from->first;
    }
}

static int digit(int interleaving, int place)
{
    for (int i = 0; i < place; i++) {
        interleaving /= 3;
    }
    return interleaving % 3;
}

void test_low_side_never_reads_a_partly_written_or_older_value(void)
{
    for (int interleaving = 0; interleaving < INTERLEAVINGS; interleaving++) {
        setUp();
        int newest = 0;
        int step = 0;
        for (int round = 0; round < 2; round++) {
            high_side_writes(digit(interleaving, step++));
            const bool taken = double_buffer_take(&pair);
            high_side_writes(digit(interleaving, step++));
            const payload_t *from = &buffer[double_buffer_low(&pair)];
            const int first = from->first;
            high_side_writes(digit(interleaving, step++));
            const int second = from->second;
            high_side_writes(digit(interleaving, step++));
            TEST_ASSERT_EQUAL_INT(first, second);
            TEST_ASSERT_TRUE(first >= newest);
            TEST_ASSERT_TRUE(taken ? first > newest : first == newest);
            newest = first;
        }
    }
}

void test_high_side_never_reads_a_partly_written_or_older_value(void)
{
    for (int interleaving = 0; interleaving < INTERLEAVINGS; interleaving++) {
        setUp();
        int newest = 0;
        int step = 0;
        for (int value = 1; value <= 2; value++) {
            high_side_reads(digit(interleaving, step++), &newest);
            payload_t *to = &buffer[double_buffer_low(&pair)];
            to->first = value;
            high_side_reads(digit(interleaving, step++), &newest);
            to->second = value;
            high_side_reads(digit(interleaving, step++), &newest);
            double_buffer_swap(&pair);
            high_side_reads(1 + digit(interleaving, step++), &newest);
            TEST_ASSERT_EQUAL_INT(value, newest);
        }
    }
}

void test_buffers_are_not_swapped_without_a_new_value(void)
{
    high_side_writes(1);
    TEST_ASSERT_TRUE(double_buffer_take(&pair));
    const unsigned low = double_buffer_low(&pair);
    TEST_ASSERT_FALSE(double_buffer_take(&pair));
    TEST_ASSERT_EQUAL_UINT(low, double_buffer_low(&pair));
}
