/* SPDX-License-Identifier: Apache-2.0 */
/* The examination of the current sensors from chosen states: its constants, the prediction's model,
 * what explains a sum, and the counts that name a sensor. */
#include <math.h>

#include "sensor_isolation.c" /* its functions are private */

#include "foc_rig.h"

static sensor_isolation_t *const isolation = &foc.current.isolation;

void setUp(void)
{
    rig_up();
}

void tearDown(void) {}

/* ---- Constants ---- */

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

void test_no_sensor_is_named_and_none_is_the_answer_at_the_begin(void)
{
    isolation->answer = 1;
    isolation->phase = 1;
    sensor_isolation_init(isolation, &config);
    TEST_ASSERT_EQUAL_UINT8(SENSE_PHASES, isolation->answer);
    TEST_ASSERT_EQUAL_UINT8(SENSE_PHASES, isolation->phase);
    TEST_ASSERT_EQUAL_INT32(config.monitor.current_sum_pu_q15, isolation->implausible_pu);
}

/* a (1 - a), each step in Q24 rounded down, the result to the nearest of Q15. */
void test_share_that_the_controller_removes_is_a_times_one_minus_a(void)
{
    for (int32_t bandwidth_Hz = 10; bandwidth_Hz < 1600; bandwidth_Hz++) {
        config.current_loop.bandwidth_Hz = bandwidth_Hz;
        const double b = (double)design_half_period_q24(&config);
        const double a = floor(b * b / 16777216.0);
        const double share = floor(a * (16777216.0 - a) / 16777216.0);
        TEST_ASSERT_EQUAL_INT32((int32_t)floor((share + 256.0) / 512.0),
                                removed_share_q15(&config));
    }
}

void test_acknowledged_sum_is_examined_from_the_begin(void)
{
    isolation->undetermined = true;
    isolation->unknown = 5;
    isolation->periods = 7;
    sensor_isolation_acknowledge(isolation);
    TEST_ASSERT_FALSE(isolation->undetermined);
    TEST_ASSERT_EQUAL_UINT16(0, isolation->unknown);
    TEST_ASSERT_EQUAL_UINT16(0, isolation->periods);
}

/* ---- Prediction ---- */

/* Half a turn a period less one LSB, so that w T = pi, 102 943 of Q15, and 32 767/32 768 of it with
 * no weight on the target. A quarter of an error is removed in a period. */
static void fast_rotor(void)
{
    isolation->removed_share_q15 = 8192;
    isolation->l_q_over_l_d_q10 = 2048;
    isolation->l_d_over_l_q_q10 = 512;
    foc.current.predictor.weight_q15 = 0;
    foc.period.rotor.speed_q32 = INT32_MAX;
}

static void assert_change(dq_t error, dq_t wrong, int32_t d, int32_t q)
{
    const dq_t change = change_by(&foc.current, &foc.period, error, wrong);
    TEST_ASSERT_EQUAL_INT32(d, change.d);
    TEST_ASSERT_EQUAL_INT32(q, change.q);
}

void test_error_is_reduced_on_an_axis_whose_voltage_is_not_limited(void)
{
    const dq_t error = {.d = 400, .q = -800};
    const dq_t none = {.d = 0, .q = 0};
    fast_rotor();
    assert_change(error, none, 100, -200);
    foc.period.voltage.unsaturated_d_q25 = 1024;
    assert_change(error, none, 0, -200);
    foc.period.voltage.unsaturated_d_q25 = 0;
    foc.period.voltage.unsaturated_q_q25 = -1024;
    assert_change(error, none, 100, 0);
}

void test_wrong_current_is_coupled_to_the_other_axis_by_the_ratio_of_inductances(void)
{
    const dq_t none = {.d = 0, .q = 0};
    const dq_t wrong_d = {.d = 32768, .q = 0};
    const dq_t wrong_q = {.d = 0, .q = 32768};
    fast_rotor();
    assert_change(none, wrong_d, 0, 51469);        /* 102 939/2 */
    assert_change(none, wrong_q, -205878, 0);      /* 102 939 * 2 */
    foc.period.rotor.speed_q32 = INT32_C(1) << 28; /* 205 887/16 = 12 867.94 */
    isolation->l_q_over_l_d_q10 = 1024;
    assert_change(none, wrong_q, -12866, 0);
}

void test_prediction_begins_anew_after_a_period_without_examination(void)
{
    fast_rotor();
    foc.period.rotor.speed_q32 = 0;
    foc.period.i_pu.v = q_pair(1000, -2000);
    foc.period.i_reference_pu.v = q_pair(1400, -2800);
    foc.period.current_sum_pu = 77;
    foc.period.step_count = 12;
    for (uint32_t gap = 2; gap <= 3; gap++) {
        isolation->periods = 5;
        isolation->last_step = 12 - gap;
        isolation->agreeing = 1;
        isolation->unknown = 3;
        isolation->answer = 1;
        predict(&foc.current, &foc.period);
        TEST_ASSERT_EQUAL_UINT16(1, isolation->periods);
        TEST_ASSERT_EQUAL_UINT16(0, isolation->agreeing);
        TEST_ASSERT_EQUAL_UINT16(0, isolation->unknown);
        TEST_ASSERT_EQUAL_UINT8(SENSE_PHASES, isolation->answer);
        TEST_ASSERT_EQUAL_INT32(77, isolation->begin_sum_pu);
        TEST_ASSERT_EQUAL_INT32(1000 + 100, isolation->predicted_pu.d);
        TEST_ASSERT_EQUAL_INT32(-2000 - 200, isolation->predicted_pu.q);
        TEST_ASSERT_EQUAL_INT32(100, isolation->change_pu.d);
        TEST_ASSERT_EQUAL_INT32(-200, isolation->change_pu.q);
        TEST_ASSERT_EQUAL_UINT32(12, isolation->last_step);
    }
}

void test_prediction_is_limited_to_twice_the_largest_current(void)
{
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        const dq_t near = {.d = sign * 65530, .q = -sign * 65530};
        const dq_t change = {.d = sign * 10, .q = -sign * 10};
        isolation->periods = 1;
        isolation->last_step = 11;
        foc.period.step_count = 12;
        isolation->predicted_pu = near;
        isolation->change_pu = change;
        predict(&foc.current, &foc.period);
        TEST_ASSERT_EQUAL_INT32(sign * 65536, isolation->predicted_pu.d);
        TEST_ASSERT_EQUAL_INT32(-sign * 65536, isolation->predicted_pu.q);
        TEST_ASSERT_EQUAL_UINT16(2, isolation->periods);
    }
}

/* ---- Explanation ---- */

/* Of a sum of 1 600 and 1 615 alike 5/16 are 500, in whole sixteenths. */
void test_sensor_explains_a_sum_if_both_others_are_within_5_sixteenths(void)
{
    static const int32_t CASES[][4] = {
        {2000, 500, -500, 0}, {2000, -500, 500, 0},  {2000, 501, -500, 3}, {2000, 500, -501, 3},
        {500, 2000, -500, 1}, {-500, 2000, 500, 1},  {501, 2000, 500, 3},  {-501, 2000, 500, 3},
        {500, 2000, 501, 3},  {500, -500, 2000, 2},  {-500, 500, 2000, 2}, {-501, 500, 2000, 3},
        {500, 501, 2000, 3},  {2000, 0, 2000, 3},    {0, 2000, 2000, 3},   {2000, 2000, 0, 3},
        {0, -501, 2000, 3},   {2000, 2000, 2000, 3}, {2000, 0, -501, 3}};
    for (unsigned k = 0; k < sizeof CASES / sizeof CASES[0]; k++) {
        const abc_t residual = {.a = CASES[k][0], .b = CASES[k][1], .c = CASES[k][2]};
        TEST_ASSERT_EQUAL_UINT8(CASES[k][3], explained_by(residual, 1600));
        TEST_ASSERT_EQUAL_UINT8(CASES[k][3], explained_by(residual, -1615));
    }
}

void test_unexplained_sum_restarts_the_count_of_agreeing_answers(void)
{
    isolation->answer = 1;
    isolation->agreeing = 1;
    count(isolation, SENSE_PHASES);
    TEST_ASSERT_EQUAL_UINT16(0, isolation->agreeing);
    TEST_ASSERT_EQUAL_UINT16(1, isolation->unknown);
    TEST_ASSERT_EQUAL_UINT8(SENSE_PHASES, isolation->answer);
    TEST_ASSERT_FALSE(isolation->undetermined);
    count(isolation, 1);
    TEST_ASSERT_EQUAL_UINT16(1, isolation->agreeing);
    TEST_ASSERT_EQUAL_UINT16(0, isolation->unknown);
    TEST_ASSERT_EQUAL_UINT8(SENSE_PHASES, isolation->phase);
}

void test_eighth_unexplained_sum_in_a_row_is_undetermined_until_acknowledged(void)
{
    for (int n = 1; n <= 8; n++) {
        TEST_ASSERT_FALSE(isolation->undetermined);
        count(isolation, SENSE_PHASES);
    }
    TEST_ASSERT_TRUE(isolation->undetermined);
    count(isolation, 1);
    count(isolation, SENSE_PHASES);
    TEST_ASSERT_TRUE(isolation->undetermined);
}

void test_another_answer_is_the_first_of_its_own(void)
{
    const int32_t suspect = isolation->suspect_pu;
    count(isolation, 0);
    count(isolation, 2);
    TEST_ASSERT_EQUAL_UINT16(1, isolation->agreeing);
    TEST_ASSERT_EQUAL_UINT8(SENSE_PHASES, isolation->phase);
    TEST_ASSERT_EQUAL_INT32(suspect, isolation->suspect_pu);
    count(isolation, 2);
    TEST_ASSERT_EQUAL_UINT8(2, isolation->phase);
    TEST_ASSERT_EQUAL_INT32(0, isolation->suspect_pu); /* every sum but zero is examined now */
    TEST_ASSERT_EQUAL_UINT32(0, isolation->suspect_range_pu);
}

static const abc_t ZERO = {0, 0, 0};

void test_sum_of_exactly_the_implausible_one_is_plausible(void)
{
    isolation->implausible_pu = 1600;
    isolation->periods = 63;
    TEST_ASSERT_EQUAL_UINT8(SENSE_PHASES, isolate(isolation, ZERO, ZERO, 1600));
    TEST_ASSERT_EQUAL_UINT16(0, isolation->unknown);
    TEST_ASSERT_EQUAL_UINT16(63, isolation->periods);
    isolation->periods = 64;
    TEST_ASSERT_EQUAL_UINT8(SENSE_PHASES, isolate(isolation, ZERO, ZERO, -1600));
    TEST_ASSERT_EQUAL_UINT16(0, isolation->periods);
}

void test_sum_that_has_not_grown_by_5_eighths_is_used_as_measured(void)
{
    const abc_t read = {.a = 1600, .b = 0, .c = 0};
    isolation->implausible_pu = 1599;
    isolation->begin_sum_pu = 601;
    TEST_ASSERT_EQUAL_UINT8(SENSE_PHASES, isolate(isolation, read, ZERO, 1600));
    TEST_ASSERT_EQUAL_UINT16(1, isolation->unknown);
    isolation->begin_sum_pu = 600;
    TEST_ASSERT_EQUAL_UINT8(0, isolate(isolation, read, ZERO, 1600));
    isolation->begin_sum_pu = 2601; /* the same the other way */
    TEST_ASSERT_EQUAL_UINT8(0, isolate(isolation, read, ZERO, 1600));
}

/* ---- What is used ---- */

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

void test_named_sensor_is_not_used_with_the_bridge_off(void)
{
    const ab16_t sensed = {.v = q_pair(11, 22)};
    static const uint16_t CODES[SENSE_PHASES] = {2048, 2048, 2148};
    for (uint8_t phase = 0; phase <= SENSE_PHASES; phase++) {
        foc.current.isolation.phase = phase;
        const ab16_t used = sensor_isolation_current(&foc.current, CODES, sensed);
        /* Without phase c no current; with it 1 600 of it, in a or in b. */
        TEST_ASSERT_EQUAL_INT32(phase == SENSE_PHASES ? 11 : (phase == 0 ? -1600 : 0),
                                q_pair_x(used.v));
    }
}
