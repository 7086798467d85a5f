/* SPDX-License-Identifier: Apache-2.0 */
/* The examination of the current sensors, one period at a time, where no current is predicted: what
 * a reading explains of a sum, and the counts that name a sensor. */
#include "sensor_isolation.h"

#include <math.h>

#include "design_response.h"

#include "foc_rig.h"

enum { SUM_PU = 5120, EXPLAINED = 320 /* codes of 16 */, NONE = SENSE_PHASES };

static sensor_isolation_t *const isolation = &foc.current.isolation;
static foc_period_t now;

/* A motor without current, of which none is wanted. */
static void begin(void)
{
    const foc_period_t none = {.step_count = 0};
    restart();
    now = none;
}

void setUp(void)
{
    rig_up();
    begin();
}

void tearDown(void) {}

/* ---- constants ---- */

static void assert_ratios(int32_t d_nH, int32_t q_nH, int32_t q_over_d, int32_t d_over_q)
{
    config.motor.d_inductance_nH = d_nH;
    config.motor.q_inductance_nH = q_nH;
    sensor_isolation_init(isolation, &config);
    TEST_ASSERT_EQUAL_INT32(q_over_d, isolation->l_q_over_l_d_q10);
    TEST_ASSERT_EQUAL_INT32(d_over_q, isolation->l_d_over_l_q_q10);
}

void test_ratio_of_inductances_is_at_most_16(void)
{
    assert_ratios(300000, 100000, 341, 3 * 1024);
    assert_ratios(100000, 300000, 3 * 1024, 341);
    assert_ratios(100000, 1700000, 16 * 1024, 60);
    assert_ratios(1700000, 100000, 60, 16 * 1024);
}

/* a (1 - a), each step in Q24 rounded down, the result to the nearest of Q15. */
void test_share_that_the_controller_removes_is_a_times_one_minus_a(void)
{
    for (int32_t bandwidth_Hz = 10; bandwidth_Hz < 1600; bandwidth_Hz++) {
        config.current_loop.bandwidth_Hz = bandwidth_Hz;
        sensor_isolation_init(isolation, &config);
        const double b = (double)design_half_period_q24(&config);
        const double a = floor(b * b / 16777216.0);
        const double share = floor(a * (16777216.0 - a) / 16777216.0);
        TEST_ASSERT_EQUAL_INT32((int32_t)floor((share + 256.0) / 512.0),
                                isolation->removed_share_q15);
    }
}

/* ---- one period ---- */

/* The next period, in which the sensors show so many codes; the answer. */
static uint8_t examine(int32_t a, int32_t b, int32_t c, int32_t sum_pu)
{
    const uint16_t shown[SENSE_PHASES] = {(uint16_t)(2048 + a), (uint16_t)(2048 + b),
                                          (uint16_t)(2048 + c)};
    now.step_count++;
    sensor_isolation_examine(&now, shown, &foc.current, sum_pu);
    return isolation->answer;
}

/* Of 5 120 and 5 135 alike 5/16 are 1 600, in whole sixteenths: 100 codes. */
void test_a_sensor_explains_a_sum_if_both_others_are_within_5_sixteenths(void)
{
    static const int32_t CASES[][4] = {
        {400, 100, -100, 0}, {400, -100, 100, 0}, {400, 101, -100, 3}, {400, 100, -101, 3},
        {100, 400, -100, 1}, {-100, 400, 100, 1}, {101, 400, 100, 3},  {-101, 400, 100, 3},
        {100, 400, 101, 3},  {100, -100, 400, 2}, {-100, 100, 400, 2}, {-101, 100, 400, 3},
        {100, 101, 400, 3},  {400, 0, 400, 3},    {0, 400, 400, 3},    {400, 400, 0, 3},
        {0, -101, 400, 3},   {400, 400, 400, 3},  {400, 0, -101, 3}};
    for (unsigned k = 0; k < sizeof CASES / sizeof CASES[0]; k++) {
        const int32_t *at = CASES[k];
        begin();
        TEST_ASSERT_EQUAL_UINT8(at[3], examine(at[0], at[1], at[2], SUM_PU));
        begin();
        TEST_ASSERT_EQUAL_UINT8(at[3], examine(at[0], at[1], at[2], -SUM_PU - 15));
    }
}

void test_a_sum_of_exactly_the_implausible_one_is_plausible(void)
{
    const int32_t implausible_pu = config.monitor.current_sum_pu_q15;
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        begin();
        TEST_ASSERT_EQUAL_UINT8(NONE, examine(EXPLAINED, 0, 0, sign * implausible_pu));
        TEST_ASSERT_EQUAL_UINT16(0, isolation->unknown);
        TEST_ASSERT_EQUAL_UINT8(0, examine(EXPLAINED, 0, 0, sign * (implausible_pu + 1)));
    }
}

/* What has grown since the prediction began is what a reading can show: of 5 120 these are 3 200.
 */
void test_a_sum_that_has_not_grown_by_5_eighths_is_used_as_measured(void)
{
    static const int32_t BEGAN_PU[][2] = {{1921, NONE}, {1920, 0}, {8319, NONE}, {8320, 0}};
    for (int k = 0; k < 4; k++) {
        begin();
        now.current_sum_pu = BEGAN_PU[k][0];
        TEST_ASSERT_EQUAL_UINT8(BEGAN_PU[k][1], examine(EXPLAINED, 0, 0, SUM_PU));
        TEST_ASSERT_EQUAL_UINT16(k % 2 == 0 ? 1 : 0, isolation->unknown);
    }
}

/* ---- from one period to the next ---- */

static void explained(uint8_t phase)
{
    const int32_t of[SENSE_PHASES] = {phase == 0, phase == 1, phase == 2};
    TEST_ASSERT_EQUAL_UINT8(
        phase, examine(of[0] * EXPLAINED, of[1] * EXPLAINED, of[2] * EXPLAINED, SUM_PU));
}

static void unexplained(void)
{
    TEST_ASSERT_EQUAL_UINT8(NONE, examine(EXPLAINED, EXPLAINED, 0, SUM_PU));
}

void test_two_answers_in_a_row_that_agree_name_a_sensor(void)
{
    TEST_ASSERT_EQUAL_UINT8(0, sensor_isolation_named(isolation));
    explained(1);
    unexplained();
    explained(1);
    explained(2);
    TEST_ASSERT_EQUAL_UINT8(0, sensor_isolation_named(isolation));
    TEST_ASSERT_FALSE(sensor_isolation_due(isolation, 1));
    explained(2);
    TEST_ASSERT_EQUAL_UINT8(3, sensor_isolation_named(isolation));
    static const int32_t SUMS_PU[] = {-196608, -1, 0, 1, 196608}; /* every one is examined now */
    for (int k = 0; k < 5; k++) {
        TEST_ASSERT_TRUE(sensor_isolation_due(isolation, SUMS_PU[k]));
    }
}

void test_the_eighth_unexplained_sum_in_a_row_is_undetermined_until_acknowledged(void)
{
    for (int round = 0; round < 2; round++) {
        unexplained();
        explained(1);
        for (int n = 1; n <= 8; n++) {
            TEST_ASSERT_FALSE(isolation->undetermined);
            unexplained();
        }
        TEST_ASSERT_TRUE(isolation->undetermined);
        explained(1);
        unexplained();
        TEST_ASSERT_TRUE(isolation->undetermined);
        sensor_isolation_acknowledge(isolation);
    }
    TEST_ASSERT_EQUAL_UINT16(0, isolation->periods);
}

void test_a_name_in_time_determines_the_sum(void)
{
    for (int n = 1; n <= 8; n++) {
        unexplained();
    }
    explained(2);
    TEST_ASSERT_TRUE(isolation->undetermined);
    explained(2);
    TEST_ASSERT_FALSE(isolation->undetermined);
    TEST_ASSERT_EQUAL_UINT8(3, sensor_isolation_named(isolation));
}

/* A period without a suspect sum is between them. */
void test_a_prediction_begins_anew_after_a_period_without_examination(void)
{
    explained(1);
    TEST_ASSERT_EQUAL_UINT16(1, isolation->periods);
    explained(1);
    TEST_ASSERT_EQUAL_UINT8(2, sensor_isolation_named(isolation));
    begin();
    explained(1);
    now.step_count++;
    explained(1);
    TEST_ASSERT_EQUAL_UINT16(1, isolation->periods);
    TEST_ASSERT_EQUAL_UINT8(0, sensor_isolation_named(isolation));
}

void test_current_without_the_wrong_sensor_is_where_the_prediction_goes_on(void)
{
    setpoint.i_reference_pu.q = 4000;
    for (int n = 0; n < 10; n++) {
        step(true);
    }
    codes[0] = 2048 + 300; /* the current did not come, the sensor of phase a is wrong */
    step(true);
    TEST_ASSERT_EQUAL_UINT8(0, isolation->answer);
    TEST_ASSERT_EQUAL_INT32(q_pair_x(period->i_pu.v), isolation->predicted_pu.d);
    TEST_ASSERT_EQUAL_INT32(q_pair_y(period->i_pu.v), isolation->predicted_pu.q);
    TEST_ASSERT_INT32_WITHIN(1, 0, isolation->predicted_pu.q);
}
