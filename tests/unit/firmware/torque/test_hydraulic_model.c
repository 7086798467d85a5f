/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "paper_vehicle.h"
#include "random_values.h"
#include "torque/hydraulic_model.h"
#include "unity.h"

static config_t config;
static hydraulic_model_t model;

void setUp(void)
{
    config = paper_vehicle();
    config.brake.hydraulic_dead_time_ms = 40;
    config.brake.hydraulic_time_constant_ms = 60;
    config.brake.hydraulic_rate_mNm_s = 2000000;
    config.brake.max_hydraulic_torque_mNm = 300000;
    hydraulic_model_init(&model);
}

void tearDown(void) {}

static int32_t after(int milliseconds, int32_t command_mNm)
{
    for (int n = 0; n < milliseconds; n++) {
        hydraulic_model_step(&model, &config, command_mNm);
    }
    return hydraulic_model_torque_mNm(&model);
}

void test_torque_is_zero_during_the_dead_time(void)
{
    TEST_ASSERT_EQUAL_INT32(0, after(40, 50000));
    TEST_ASSERT_GREATER_THAN_INT32(0, after(1, 50000));
}

void test_torque_follows_as_a_first_order_lag_after_the_dead_time(void)
{
    for (int n = 1; n <= 600; n++) {
        const int32_t torque_mNm = after(1, 50000);
        const double expected = n <= 40 ? 0.0 : 50000.0 * (1.0 - exp(-(n - 40) / 60.0));
        TEST_ASSERT_DOUBLE_WITHIN(500.0, expected, torque_mNm); /* half a step of 1 ms of 60 ms */
    }
    for (int n = 1; n <= 600; n++) {
        const int32_t torque_mNm = after(1, 0);
        const double expected = n <= 40 ? 50000.0 : 50000.0 * exp(-(n - 40) / 60.0);
        TEST_ASSERT_DOUBLE_WITHIN(500.0, expected, torque_mNm);
    }
}

/* As long ago as commands are kept, 540 ms; never before or behind them. */
void test_a_damaged_dead_time_reads_a_command_that_is_kept(void)
{
    config.brake.hydraulic_dead_time_ms = 1 << 29;
    TEST_ASSERT_EQUAL_INT32(0, after(540, 50000));
    TEST_ASSERT_GREATER_THAN_INT32(0, after(1, 50000));
    hydraulic_model_init(&model);
    config.brake.hydraulic_dead_time_ms = -(1 << 29);
    TEST_ASSERT_GREATER_THAN_INT32(0, after(1, 50000));
    TEST_ASSERT_INT32_WITHIN(1, 50000, after(3000, 50000));
}

void test_torque_settles_on_the_command_within_1_mNm(void)
{
    TEST_ASSERT_INT32_WITHIN(1, 123457, after(3000, 123457));
    TEST_ASSERT_INT32_WITHIN(1, 0, after(3000, 0));
}

void test_torque_changes_no_faster_than_the_hydraulic_rate(void)
{
    config.brake.hydraulic_rate_mNm_s = 500000;
    after(40, 200000);
    for (int n = 1; n <= 100; n++) { /* 200 N m over 60 ms would be 3333 N m/s */
        TEST_ASSERT_INT32_WITHIN(2, 500 * n, after(1, 200000));
    }
}

void test_torque_equals_the_command_without_delay(void)
{
    config.brake.hydraulic_dead_time_ms = 0;
    config.brake.hydraulic_time_constant_ms = 0;
    config.brake.hydraulic_rate_mNm_s = 2000000000;
    TEST_ASSERT_EQUAL_INT32(77000, after(1, 77000));
    TEST_ASSERT_EQUAL_INT32(1, after(1, 1));
}

void test_torque_stays_between_zero_and_max_hydraulic_torque(void)
{
    random_t random = random_seeded(1);
    for (int c = 0; c < 50; c++) {
        config.brake.hydraulic_dead_time_ms = random_between(&random, 0, 250);
        config.brake.hydraulic_time_constant_ms = random_between(&random, 0, 2000);
        config.brake.hydraulic_rate_mNm_s = random_between(&random, 100, 2000000000);
        config.brake.max_hydraulic_torque_mNm = random_between(&random, 0, 20000000);
        hydraulic_model_init(&model);
        for (int n = 0; n < 2000; n++) {
            const int32_t torque_mNm = after(1, random_wild(&random));
            TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, torque_mNm);
            TEST_ASSERT_LESS_OR_EQUAL_INT32(config.brake.max_hydraulic_torque_mNm, torque_mNm);
        }
    }
}

/* ---- to the unit ---- */

/* Without lag and limit of the rate the three models are the command of some time ago: of the dead
 * time, of half of it and of twice of it, the latter two as a report shows them. Longest delays:
 * the oldest command of all, over two rounds of the memory. */
static void assert_delays(int dead_ms, int report_ms)
{
    enum { STEPS = 3 * HYDRAULIC_MODEL_COMMANDS };
    static int32_t commands_mNm[STEPS];
    config.brake.hydraulic_dead_time_ms = dead_ms;
    config.brake.hydraulic_time_constant_ms = 0;
    config.brake.hydraulic_rate_mNm_s = 2000000000;
    config.brake.hydraulic_report_delay_ms = report_ms;
    hydraulic_model_init(&model);
    TEST_ASSERT_EQUAL_INT32(0, model.next);
    random_t random = random_seeded(5);
    for (int n = 0; n < STEPS; n++) {
        const int32_t command_mNm = random_between(&random, -10000, 300000);
        const int early = n - dead_ms / 2 - report_ms;
        const int late = n - 2 * dead_ms - report_ms;
        commands_mNm[n] = command_mNm > 0 ? command_mNm : 0;
        hydraulic_model_step(&model, &config, command_mNm);
        TEST_ASSERT_EQUAL_INT32(n < dead_ms ? 0 : 64 * commands_mNm[n - dead_ms],
                                model.torque_q6_mNm);
        TEST_ASSERT_EQUAL_INT32(early < 0 ? 0 : 64 * commands_mNm[early], model.early_q6_mNm);
        TEST_ASSERT_EQUAL_INT32(late < 0 ? 0 : 64 * commands_mNm[late], model.late_q6_mNm);
    }
}

void test_without_lag_each_model_is_the_command_of_its_delay_before(void)
{
    assert_delays(40, 10);
    assert_delays(0, 0);
    assert_delays(HYDRAULIC_MODEL_DEAD_TIME_MOST_ms, HYDRAULIC_MODEL_REPORT_DELAY_MOST_ms);
}

void test_early_and_late_model_have_half_and_twice_the_lag(void)
{
    config.brake.hydraulic_dead_time_ms = 0;
    config.brake.hydraulic_report_delay_ms = 0;
    for (int n = 1; n <= 300; n++) {
        (void)after(1, 50000);
        /* half a step of 1 ms of 30 and of 120 ms */
        TEST_ASSERT_DOUBLE_WITHIN(1000.0, 50000.0 * (1.0 - exp(-n / 30.0)),
                                  hydraulic_model_early_mNm(&model));
        TEST_ASSERT_DOUBLE_WITHIN(250.0, 50000.0 * (1.0 - exp(-n / 120.0)),
                                  hydraulic_model_late_mNm(&model));
    }
}

/* A rate is cut to 64ths of 1 mN m in a millisecond, 15.6 mN m/s; one of a multiple of that is
 * exact. */
void test_any_rate_is_kept_within_a_64th_of_1_mNm_in_a_millisecond(void)
{
    static const int32_t RATES_mNm_s[] = {125, 250, 1000, 1125, 999, 1999, 123457};
    for (int n = 0; n < 7; n++) {
        const int32_t rate_mNm_s = RATES_mNm_s[n];
        config.brake.hydraulic_dead_time_ms = 0;
        config.brake.hydraulic_time_constant_ms = 0;
        config.brake.hydraulic_rate_mNm_s = rate_mNm_s;
        hydraulic_model_init(&model);
        const int32_t torque_mNm = after(1000, 300000);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(rate_mNm_s, torque_mNm);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(rate_mNm_s - (rate_mNm_s % 125 == 0 ? 0 : 16),
                                           torque_mNm);
    }
}

/* All commands of the dead time of a late brake, the report's delay and the time between two
 * reports, 143 ms; and none that is older than twice that. */
void test_the_range_of_commands_holds_all_that_may_still_move_a_report(void)
{
    enum { WHILE_ms = 2 * 35 + 10 + HYDRAULIC_MODEL_BETWEEN_MOST_ms, STEPS = 3000 };
    static int32_t given_mNm[STEPS];
    random_t random = random_seeded(51);
    config.brake.hydraulic_dead_time_ms = 35;
    config.brake.hydraulic_report_delay_ms = 10;
    config.brake.max_hydraulic_torque_mNm = 300000;
    hydraulic_model_init(&model);
    for (int n = 0; n < STEPS; n++) {
        given_mNm[n] = n > 0 && random_chance(&random, 0.95) ? given_mNm[n - 1]
                                                             : random_between(&random, 0, 300000);
        hydraulic_model_step(&model, &config, given_mNm[n]);
        const hydraulic_range_t range = hydraulic_model_commanded(&model);
        int32_t inner[2] = {INT32_MAX, 0}, outer[2] = {INT32_MAX, 0};
        for (int ago = 0; ago < 2 * WHILE_ms; ago++) {
            const int32_t c = n >= ago ? given_mNm[n - ago] : 0;
            outer[0] = c < outer[0] ? c : outer[0];
            outer[1] = c > outer[1] ? c : outer[1];
            if (ago <= WHILE_ms) {
                inner[0] = outer[0];
                inner[1] = outer[1];
            }
        }
        TEST_ASSERT_TRUE(outer[0] <= range.least_mNm && range.least_mNm <= inner[0]);
        TEST_ASSERT_TRUE(inner[1] <= range.most_mNm && range.most_mNm <= outer[1]);
    }
}
