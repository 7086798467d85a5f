/* SPDX-License-Identifier: Apache-2.0 */
/* Rows at regular times; powers that add up to the accounts. */
#include "bench/recorder.h"

#include <string.h>

#include "bench/signals.h"
#include "unity.h"
#include "vehicle_fixture.h"

enum { NAME_LENGTH = 80, ROWS_MAX = 64 };
static bench_t *bench;
static recorder_t recorder;

void setUp(void)
{
    bench_params_t params = fixture_quarter_vehicle();
    params.run.initial_speed_m_per_s = 8.0;
    params.run.record_interval_s = 0.01;
    params.driver.brake_demand_nm = 30.0;
    const config_t config = fixture_config(CONFIG_STRATEGY_SERIES_OPTIMAL);
    bench = fixture_start(&params, &config);
    memset(&recorder, 0, sizeof(recorder));
}

void tearDown(void) {}

static int index_of(const char *wanted)
{
    char name[NAME_LENGTH];
    for (int k = 0; k < signals_count(bench); k++) {
        signals_name(bench, k, name, sizeof(name));
        if (strcmp(name, wanted) == 0) {
            return k;
        }
    }
    TEST_FAIL_MESSAGE(wanted);
    return -1;
}

void test_rows_are_recorded_at_the_interval_from_time_zero(void)
{
    const int chosen[] = {index_of("time_s")};
    double row[1];
    int rows = 0;
    TEST_ASSERT_TRUE(recorder_choose(&recorder, bench, chosen, 1));
    recorder_begin(&recorder, bench);
    while (bench->time_s < 0.5 + 1e-9) {
        if (recorder_is_due(&recorder, bench)) {
            recorder_write(&recorder, bench, row);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.01 * rows, row[0]);
            rows++;
        }
        bench_period(bench);
    }
    TEST_ASSERT_EQUAL_INT(51, rows);
}

void test_the_integral_of_a_recorded_power_is_its_account(void)
{
    const int chosen[] = {index_of("wheel0.copper_w"), index_of("battery.chemical_w"),
                          index_of("wheel0.motor_torque_nm")};
    double row[3];
    double sum[3] = {0.0, 0.0, 0.0};
    TEST_ASSERT_TRUE(recorder_choose(&recorder, bench, chosen, 3));
    recorder_begin(&recorder, bench);
    while (recorder.rows <= 30) {
        if (recorder_is_due(&recorder, bench)) {
            recorder_write(&recorder, bench, row);
            for (int k = 0; k < 3; k++) {
                sum[k] += row[k] * 0.01;
            }
        } else {
            bench_period(bench);
        }
    }
    const ledger_t ledger = bench_ledger(bench);
    TEST_ASSERT_TRUE(ledger.copper_j > 1.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, ledger.copper_j, sum[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, ledger.chemical_j, sum[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, bench->wheel[0].totals.torque_impulse_nms, sum[2]);
}

void test_a_rate_is_zero_at_time_zero(void)
{
    const int chosen[] = {index_of("wheel0.copper_w")};
    double row[1] = {99.0};
    TEST_ASSERT_TRUE(recorder_choose(&recorder, bench, chosen, 1));
    recorder_begin(&recorder, bench);
    recorder_write(&recorder, bench, row);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, row[0]);
}

void test_unknown_signals_are_refused_and_the_selection_stays_empty(void)
{
    const int good[] = {0, 1};
    const int bad[] = {0, 100000};
    TEST_ASSERT_TRUE(recorder_choose(&recorder, bench, good, 2));
    TEST_ASSERT_FALSE(recorder_choose(&recorder, bench, bad, 2));
    TEST_ASSERT_EQUAL_INT(2, recorder.signals);
    TEST_ASSERT_FALSE(recorder_choose(&recorder, bench, good, RECORDER_SIGNALS_MAX + 1));
}
