/* SPDX-License-Identifier: Apache-2.0 */
/* Every signal has one name and one value. */
#include "bench/signals.h"

#include <stdio.h>
#include <string.h>

#include "unity.h"
#include "vehicle_fixture.h"

enum { NAME_LENGTH = 80 };
static bench_t *bench;

void setUp(void)
{
    bench_params_t params = fixture_vehicle();
    params.run.initial_speed_m_per_s = 5.0;
    params.driver.brake_demand_nm = 20.0;
    const config_t config = fixture_config(CONFIG_STRATEGY_SERIES_OPTIMAL);
    bench = fixture_start(&params, &config);
    fixture_run(bench, 0.3);
}

void tearDown(void) {}

static double value_of(const char *wanted)
{
    const int index = signals_find(bench, wanted);
    TEST_ASSERT_TRUE_MESSAGE(index >= 0, wanted);
    return signals_read(bench, index);
}

void test_names_are_unique(void)
{
    char a[NAME_LENGTH];
    char b[NAME_LENGTH];
    for (int k = 0; k < signals_count(bench); k++) {
        signals_name(bench, k, a, sizeof(a));
        TEST_ASSERT_TRUE(strlen(a) < NAME_LENGTH - 1);
        for (int n = 0; n < k; n++) {
            signals_name(bench, n, b, sizeof(b));
            TEST_ASSERT_TRUE_MESSAGE(strcmp(a, b) != 0, a);
        }
    }
}

void test_signals_and_parameters_have_different_names(void)
{
    char name[NAME_LENGTH];
    for (int k = 0; k < signals_count(bench); k++) {
        signals_name(bench, k, name, sizeof(name));
        TEST_ASSERT_EQUAL_INT_MESSAGE(-1, parameters_find(name), name);
    }
}

static bool ends_with(const char *name, const char *end)
{
    const size_t length = strlen(name);
    return length >= strlen(end) && strcmp(name + length - strlen(end), end) == 0;
}

void test_the_unit_is_that_of_the_suffix_and_every_signal_has_a_description(void)
{
    /* The longest ending counts, so it comes first. */
    static const char *const UNITS[][2] = {{"_m_per_s2", "m/s2"}, {"_rad_per_s", "rad/s"},
                                           {"_m_per_s", "m/s"},   {"_turn", "turn"},
                                           {"_nm", "N.m"},        {"_a", "A"},
                                           {"_c", "degC"},        {"_j", "J"},
                                           {"_m", "m"},           {"_s", "s"},
                                           {"_v", "V"},           {"_w", "W"}};
    char name[NAME_LENGTH];
    for (int k = 0; k < signals_count(bench); k++) {
        signals_name(bench, k, name, sizeof(name));
        const char *unit = NULL;
        for (size_t u = 0; u < sizeof(UNITS) / sizeof(UNITS[0]) && unit == NULL; u++) {
            unit = ends_with(name, UNITS[u][0]) ? UNITS[u][1] : NULL;
        }
        if (unit != NULL) {
            TEST_ASSERT_EQUAL_STRING_MESSAGE(unit, signals_unit(bench, k), name);
        } else {
            TEST_ASSERT_TRUE_MESSAGE(strlen(signals_unit(bench, k)) <= 1, name);
        }
        TEST_ASSERT_TRUE_MESSAGE(strlen(signals_text(bench, k)) > 3, name);
    }
}

void test_signals_are_the_values_of_their_names(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(bench->time_s, value_of("time_s"));
    TEST_ASSERT_EQUAL_DOUBLE(bench->vehicle.speed_m_per_s, value_of("vehicle.speed_m_per_s"));
    TEST_ASSERT_EQUAL_DOUBLE(20.0, value_of("driver.brake_nm"));
    TEST_ASSERT_EQUAL_DOUBLE(bench_ledger(bench).iron_j, value_of("energy.iron_j"));
    const ledger_t now = bench_ledger(bench);
    TEST_ASSERT_EQUAL_DOUBLE(bench_braking_ledger(bench, &now).copper_j,
                             value_of("braking.copper_j"));
    TEST_ASSERT_EQUAL_DOUBLE((double)MODE_RUN, value_of("wheel3.mode"));
    TEST_ASSERT_EQUAL_DOUBLE(25.0, value_of("wheel2.winding_temperature_c"));
}

/* By hand from the controller's table: names follow its lines, values are in N m. */
void test_the_table_of_torque_limits_can_be_recorded_line_by_line(void)
{
    const torque_limits_t *table = controller_limits(&bench->wheel[2].controller.slow);
    TEST_ASSERT_EQUAL_DOUBLE(1e-3 * table->driving[TORQUE_LINE_MAX_TORQUE].torque_mNm,
                             value_of("wheel2.limit_max_torque_driving_nm"));
    TEST_ASSERT_EQUAL_DOUBLE(1e-3 * table->braking[TORQUE_LINE_LOSS_OPTIMUM].torque_mNm,
                             value_of("wheel2.limit_loss_optimum_braking_nm"));
    TEST_ASSERT_EQUAL_DOUBLE(1e-3 * table->braking[TORQUE_LINE_ABS].torque_mNm,
                             value_of("wheel2.limit_abs_braking_nm"));
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 2147483.6, value_of("wheel2.limit_loss_optimum_driving_nm"));
    for (int line = 0; line < (int)TORQUE_LINE_COUNT; line++) {
        const int first = signals_find(bench, "wheel2.limit_enable_driving_nm") + 2 * line;
        TEST_ASSERT_EQUAL_DOUBLE(1e-3 * table->driving[line].torque_mNm,
                                 signals_read(bench, first));
        TEST_ASSERT_EQUAL_DOUBLE(1e-3 * table->braking[line].torque_mNm,
                                 signals_read(bench, first + 1));
    }
}

void test_the_tightest_bound_is_recorded_with_its_reason(void)
{
    const char *const sides[] = {"driving", "braking"};
    for (int s = 0; s < 2; s++) {
        char name[NAME_LENGTH];
        snprintf(name, sizeof(name), "wheel1.limit_%s_nm", sides[s]);
        const double bound_nm = value_of(name);
        snprintf(name, sizeof(name), "wheel1.limit_%s_reason", sides[s]);
        const int reason = (int)value_of(name);
        const torque_limits_t *table = controller_limits(&bench->wheel[1].controller.slow);
        const limit_t *lines = s == 0 ? table->driving : table->braking;
        bool is_there = false;
        for (int line = 0; line < (int)TORQUE_LINE_COUNT; line++) {
            TEST_ASSERT_TRUE(bound_nm <= 1e-3 * lines[line].torque_mNm);
            is_there = is_there || (bound_nm == 1e-3 * lines[line].torque_mNm &&
                                    reason == (int)lines[line].reason);
        }
        TEST_ASSERT_TRUE(is_there);
    }
}

void test_phase_currents_sum_to_zero_and_transform_to_d_and_q(void)
{
    const double a = value_of("wheel1.phase_a_a");
    const double b = value_of("wheel1.phase_b_a");
    const double c = value_of("wheel1.phase_c_a");
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, a + b + c);
    const double square = (a * a + b * b + c * c) / 1.5; /* of the amplitude */
    const double d = value_of("wheel1.current_d_a");
    const double q = value_of("wheel1.current_q_a");
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, square, d * d + q * q);
    TEST_ASSERT_TRUE(square > 100.0);
}

void test_signals_of_each_wheel_are_independent(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, bench->wheel[0].rotor.theta_turn,
                              value_of("wheel0.theta_turn"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, bench->wheel[3].rotor.theta_turn,
                              value_of("wheel3.theta_turn"));
    TEST_ASSERT_TRUE(fabs(value_of("wheel0.theta_turn") - value_of("wheel3.theta_turn")) > 0.1);
}
