/* SPDX-License-Identifier: Apache-2.0 */
/* What the slow loop makes of the fast loop's sums. */
#include <string.h>

#include "core/angle.h"
#include "foc/mean_values.h"
#include "sense.h"
#include "transforms.h"
#include "unity.h"

static mean_values_state_t state;
static foc_report_t report;
static uint16_t steps;

void setUp(void)
{
    memset(&report, 0, sizeof(report));
    for (int x = 0; x < SENSE_PHASES; x++) {
        report.offset_q4[x] = SENSE_CODE_MID * 16;
    }
    steps = 0;
    mean_values_init(&state, 12345);
}

void tearDown(void) {}

/* One fast step with these values. */
static void add(int32_t d, int32_t q, int32_t power, int32_t v_dc)
{
    report.sums.i_d_pu += (uint32_t)d;
    report.sums.i_q_pu += (uint32_t)q;
    report.sums.power_pu += (uint32_t)power;
    report.sums.v_dc_pu += (uint32_t)v_dc;
    steps++;
}

static void set_applied(int32_t d, int32_t q)
{
    const dq_t applied = {.d = d, .q = q};
    report.current.voltage.applied = dq16_of(applied);
}

void test_before_the_first_step_the_given_bus_voltage_and_no_current_count(void)
{
    const mean_values_t out = mean_values_step(&state, &report, steps);
    TEST_ASSERT_EQUAL_INT32(12345, out.v_dc_pu);
    TEST_ASSERT_EQUAL_INT32(0, out.i_pu.q);
    TEST_ASSERT_FALSE(out.voltage_limited);
    TEST_ASSERT_FALSE(out.adc_saturated);
}

void test_each_look_has_the_mean_of_its_own_steps_only(void)
{
    for (int look = 0; look < 4; look++) {
        int32_t sum = 0;
        for (int n = 0; n < 20; n++) {
            add(-100 * look, 7 * n - 50 * look, 3000 * look, 28000 + n);
            sum += 7 * n - 50 * look;
        }
        const mean_values_t out = mean_values_step(&state, &report, steps);
        TEST_ASSERT_EQUAL_INT32(-100 * look, out.i_pu.d);
        TEST_ASSERT_EQUAL_INT32(sum / 20, out.i_pu.q);
        TEST_ASSERT_EQUAL_INT32(3000 * look, out.power_pu);
        TEST_ASSERT_EQUAL_INT32(28009, out.v_dc_pu); /* 28000 + 9.5, towards zero */
    }
}

void test_without_a_new_step_the_last_mean_stays(void)
{
    add(-300, 400, 500, 28000);
    (void)mean_values_step(&state, &report, steps);
    const mean_values_t out = mean_values_step(&state, &report, steps);
    TEST_ASSERT_EQUAL_INT32(-300, out.i_pu.d);
    TEST_ASSERT_EQUAL_INT32(28000, out.v_dc_pu);
}

void test_sums_and_counter_may_wrap_in_either_direction(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        for (int look = 0; look < 10000;
             look++) { /* 200 000 steps: the sums wrap twice, the counter three times */
            for (int n = 0; n < 20; n++) {
                add(sign * 50000, -sign * 50000, sign * 40000, 32760);
            }
            const mean_values_t out = mean_values_step(&state, &report, steps);
            TEST_ASSERT_EQUAL_INT32(sign * 50000, out.i_pu.d);
            TEST_ASSERT_EQUAL_INT32(-sign * 50000, out.i_pu.q);
            TEST_ASSERT_EQUAL_INT32(sign * 40000, out.power_pu);
            TEST_ASSERT_EQUAL_INT32(32760, out.v_dc_pu);
        }
    }
}

void test_the_largest_values_over_the_most_steps_do_not_overflow(void)
{
    for (int32_t n = 0; n < 40000; n++) {
        add(-50200, 50200, -50200, 32760);
    }
    const mean_values_t out = mean_values_step(&state, &report, steps);
    TEST_ASSERT_EQUAL_INT32(-50200, out.i_pu.d);
    TEST_ASSERT_EQUAL_INT32(50200, out.i_pu.q);
}

void test_the_voltage_was_limited_when_either_axis_got_less_than_it_wanted(void)
{
    for (int axis = 0; axis < 3; axis++) {
        report.current.voltage.unsaturated_d = 100;
        report.current.voltage.unsaturated_q = 200;
        set_applied(axis == 1 ? 99 : 100, axis == 2 ? 199 : 200);
        add(0, 0, 0, 0);
        TEST_ASSERT_EQUAL_INT(axis != 0, mean_values_step(&state, &report, steps).voltage_limited);
    }
}

/* A converter at its end is found at every angle of the rotor, through sense_step() and Park as in
 * the fast step; one code inside its range is not, and neither is an end reading that was not used.
 */
void test_a_converter_that_was_used_and_stands_at_its_end_is_seen_at_every_angle(void)
{
    static const uint16_t ENDS[2] = {0, SENSE_CODE_MAX};
    sense_state_t sense;
    sense_init(&sense);
    for (uint32_t theta = 0; theta < 65536U; theta += 331U) {
        report.current.rotor.theta_turn = (uint16_t)theta;
        for (int phase = 0; phase < 3; phase++) {
            for (int unused = 0; unused < 3; unused++) {
                const int32_t on[3] = {unused == 0, unused == 1, unused == 2};
                for (int e = 0; e < 2; e++) {
                    for (int inside = 0; inside <= 1; inside++) {
                        uint16_t codes[3] = {2000, 2048, 2080};
                        codes[phase] = (uint16_t)(ENDS[e] + (e == 0 ? inside : -inside));
                        /* The third one is worked out: halves, so that it stays inside its own
                         * range. */
                        for (int x = 0; x < 3; x++) {
                            if (x != phase) {
                                codes[x] = (uint16_t)(2048 + (2048 - codes[phase]) / 2);
                            }
                        }
                        report.current.i_pu = transforms_park(sense_step(&sense, codes, on).i,
                                                              angle_rotation((uint16_t)theta));
                        add(0, 0, 0, 0);
                        const bool seen = mean_values_step(&state, &report, steps).adc_saturated;
                        if (phase != unused) {
                            TEST_ASSERT_EQUAL_INT(inside == 0, seen);
                        }
                    }
                }
                uint16_t codes[3] = {2000, 2050, 2040};
                codes[unused] = SENSE_CODE_MAX;
                report.current.i_pu = transforms_park(sense_step(&sense, codes, on).i,
                                                      angle_rotation((uint16_t)theta));
                add(0, 0, 0, 0);
                TEST_ASSERT_FALSE(mean_values_step(&state, &report, steps).adc_saturated);
            }
        }
    }
}

void test_the_use_of_the_voltage_is_its_square_with_q_unsaturated(void)
{
    add(0, 0, 0, 20000);
    set_applied(16384, 28377);                    /* a half, sqrt 3 / 2 */
    report.current.voltage.unsaturated_q = 28377; /* sqrt 3 / 2 */
    TEST_ASSERT_INT32_WITHIN(2, 32768,
                             mean_values_step(&state, &report, steps).modulation_square_q15);
    add(0, 0, 0, 20000);
    report.current.voltage.unsaturated_q = 100000; /* counts as one */
    TEST_ASSERT_INT32_WITHIN(4, 8192 + 32766,
                             mean_values_step(&state, &report, steps).modulation_square_q15);
    add(0, 0, 0, 20000);
    set_applied(0, 28377);
    report.current.voltage.unsaturated_q = 0;
    TEST_ASSERT_EQUAL_INT32(0, mean_values_step(&state, &report, steps).modulation_square_q15);
}
