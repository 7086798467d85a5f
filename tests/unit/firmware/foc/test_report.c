/* SPDX-License-Identifier: Apache-2.0 */
/* What the fast loop reports of its latest period. */
#include "config/bases.h"
#include "core/angle.h"
#include "foc/foc.h"
#include "sense.h"
#include "transforms.h"
#include "unity.h"

extern const config_t CONFIG_LU2013;

static const config_drive_t MIDDLE = {
    .offset_a_q4 = 32768, .offset_b_q4 = 32768, .offset_c_q4 = 32768};

static foc_state_t foc;

void setUp(void)
{
    foc_init(&foc, &CONFIG_LU2013, BASES_MODEL_TIMER_Hz);
}

void tearDown(void) {}

static fast_report_t reported(void)
{
    fast_report_t report;
    foc_report_copy(&foc, &report);
    foc_report_complete(&report);
    return report;
}

static void set_applied(int32_t d, int32_t q)
{
    const dq_t applied = {.d = d, .q = q};
    foc.period.voltage.applied = dq16_of(applied);
}

void test_the_initial_report_is_unlimited_with_mid_range_offsets(void)
{
    const fast_report_t report = reported();
    TEST_ASSERT_EQUAL_UINT16(0, report.sequence);
    TEST_ASSERT_FALSE(report.voltage_limited);
    TEST_ASSERT_FALSE(report.adc_saturated);
    TEST_ASSERT_FALSE(report.offsets_done);
    TEST_ASSERT_EQUAL_INT32(2048 * 16, report.offset_q4[2]);
}

void test_the_view_has_currents_references_and_voltages_of_the_latest_period(void)
{
    fast_view_t view;
    foc.period.i_pu.v = q_pair(-1, 2);
    foc.period.i_reference_pu.v = q_pair(-3, 4); /* behind the prefilter: not shown */
    foc.prefilter.reference_pu.d = -5;
    foc.prefilter.reference_pu.q = 6;
    set_applied(-7, 8);
    foc.period.theta_turn = 65535;
    foc_view(&foc, &view);
    TEST_ASSERT_EQUAL_INT32(-1, view.i_d_pu);
    TEST_ASSERT_EQUAL_INT32(2, view.i_q_pu);
    TEST_ASSERT_EQUAL_INT32(-5, view.i_d_reference_pu);
    TEST_ASSERT_EQUAL_INT32(6, view.i_q_reference_pu);
    TEST_ASSERT_EQUAL_INT32(-7, view.u_d_pu);
    TEST_ASSERT_EQUAL_INT32(8, view.u_q_pu);
    TEST_ASSERT_EQUAL_UINT16(65535, view.theta_turn);
}

void test_every_copied_field_is_that_of_the_state(void)
{
    fast_report_t report = {0};
    foc.period.voltage.unsaturated_d_q25 = 101;
    foc.period.voltage.unsaturated_q_q25 = 102;
    foc.period.voltage.applied.v = q_pair(103, 104);
    foc.observer.x.v = q_pair(105, 106);
    foc.period.theta_turn = 107;
    foc.period.step_count = 65536 + 108;
    foc.sums.i_d_pu = 109;
    foc.period.i_pu.v = q_pair(110, 111);
    foc.period.current_sum_pu = 112;
    foc.current.isolation.phase = 1;
    foc.current.isolation.undetermined = true;
    foc.weakening.current_q28 = -113 * 8192;
    for (int x = 0; x < SENSE_PHASES; x++) {
        foc.current.sense.offset_q4[x] = 114 + x;
    }
    foc.current.sense.calibrated = true;
    foc.period.rotor.speed_q32 = 117;
    foc.period.rotor.valid = true;
    foc.period.rotor.faults = 118;
    foc.period.rotor.theta_turn = 119;
    foc.idle.quadrant_transitions = 123;
    foc.idle.quadrant_step = 124;
    foc.idle.alpha_pu = 125;
    foc.idle.beta_pu = 126;
    foc_report_copy(&foc, &report);
    TEST_ASSERT_EQUAL_INT32(101, report.sample.unsaturated_d_q25);
    TEST_ASSERT_EQUAL_INT32(102, report.sample.unsaturated_q_q25);
    TEST_ASSERT_EQUAL_INT32(103, q_pair_x(report.u_pu.v));
    TEST_ASSERT_EQUAL_INT32(104, q_pair_y(report.u_pu.v));
    TEST_ASSERT_EQUAL_INT32(105, q_pair_x(report.sample.flux_q14.v));
    TEST_ASSERT_EQUAL_UINT16(107, report.sample.theta_turn);
    TEST_ASSERT_EQUAL_UINT16(108, report.sequence);
    TEST_ASSERT_EQUAL_UINT32(109, report.sums.i_d_pu);
    TEST_ASSERT_EQUAL_INT32(111, q_pair_y(report.i_pu.v));
    TEST_ASSERT_EQUAL_INT32(112, report.current_sum_pu);
    TEST_ASSERT_EQUAL_UINT8(2, report.wrong_current_sensor);
    TEST_ASSERT_TRUE(report.current_undetermined);
    TEST_ASSERT_EQUAL_INT32(-113, report.i_d_weakening_pu);
    for (int x = 0; x < SENSE_PHASES; x++) {
        TEST_ASSERT_EQUAL_INT32(114 + x, report.offset_q4[x]);
    }
    TEST_ASSERT_TRUE(report.offsets_done);
    TEST_ASSERT_EQUAL_INT32(117, report.speed_q32);
    TEST_ASSERT_TRUE(report.sensor_valid);
    TEST_ASSERT_EQUAL_UINT16(118, report.rotor_faults);
    TEST_ASSERT_EQUAL_UINT16(119, report.observer.sensor_turn);
    TEST_ASSERT_EQUAL_UINT16(123, report.quadrant_transitions);
    TEST_ASSERT_EQUAL_UINT16(124, report.quadrant_step);
    TEST_ASSERT_EQUAL_UINT32(125, report.idle_alpha_pu);
    TEST_ASSERT_EQUAL_UINT32(126, report.idle_beta_pu);
}

/* Its angle is that at the next sample. */
void test_observer_is_reported_at_the_latest_sample(void)
{
    foc.observer.speed_q32 = 120 << 16;
    foc.observer.theta_q32 = (1000U << 16) + 65535U;
    for (uint32_t short_of = 0; short_of <= 1; short_of++) {
        foc.observer.periods = foc.observer.acquisition_periods - short_of;
        fast_report_t report;
        foc_report_copy(&foc, &report);
        TEST_ASSERT_EQUAL_INT32(120 << 16, report.observer.speed_q32);
        TEST_ASSERT_EQUAL_UINT16(880, report.observer.theta_turn);
        TEST_ASSERT_EQUAL_INT(short_of == 0, report.observer.acquired);
    }
}

/* The slow context may complete the same copy again if the fast loop has made no new one. */
void test_completing_a_report_again_leaves_it_as_it_is(void)
{
    foc.period.theta_turn = 12345;
    foc.observer.theta_q32 = 0x30000000U;
    foc.observer.x.v = q_pair(9000, -4000);
    set_applied(20000, -9000);
    const fast_report_t once = reported();
    fast_report_t twice = once;
    foc_report_complete(&twice);
    TEST_ASSERT_NOT_EQUAL_INT16(0, q_pair_x(once.observer.flux_q14.v));
    TEST_ASSERT_EQUAL_INT16(q_pair_x(once.observer.flux_q14.v),
                            q_pair_x(twice.observer.flux_q14.v));
    TEST_ASSERT_EQUAL_INT16(q_pair_y(once.observer.flux_q14.v),
                            q_pair_y(twice.observer.flux_q14.v));
    TEST_ASSERT_EQUAL_INT32(once.voltage_use_q15, twice.voltage_use_q15);
    TEST_ASSERT_EQUAL_INT(once.voltage_limited, twice.voltage_limited);
    TEST_ASSERT_EQUAL_INT(once.adc_saturated, twice.adc_saturated);
}

void test_faults_of_the_rotor_sensor_are_reported_as_they_are_counted(void)
{
    foc.period.rotor.faults = 40000;
    TEST_ASSERT_EQUAL_UINT16(40000, reported().rotor_faults);
}

void test_limited_flag_is_set_if_either_axis_is_saturated(void)
{
    for (int axis = 0; axis < 3; axis++) {
        foc.period.voltage.unsaturated_d_q25 = 100 * 1024;
        foc.period.voltage.unsaturated_q_q25 = 200 * 1024;
        set_applied(axis == 1 ? 99 : 100, axis == 2 ? 199 : 200);
        TEST_ASSERT_EQUAL_INT(axis != 0, reported().voltage_limited);
    }
}

/* A converter at its end is found at every angle of the rotor, through sense_step() and Park as in
 * the fast step; one code inside its range is not, and neither is an end reading that was not used.
 */
void test_adc_saturation_is_reported_at_every_angle(void)
{
    static const uint16_t ENDS[2] = {0, SENSE_CODE_MAX};
    sense_state_t sense;
    sense_init(&sense, &MIDDLE);
    for (uint32_t theta = 0; theta < 65536U; theta += 331U) {
        foc.period.theta_turn = (uint16_t)theta;
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
                        foc.period.i_pu = transforms_park(sense_step(&sense, codes, on).i,
                                                          angle_rotation((uint16_t)theta));
                        const bool seen = reported().adc_saturated;
                        if (phase != unused) {
                            TEST_ASSERT_EQUAL_INT(inside == 0, seen);
                        }
                    }
                }
                uint16_t codes[3] = {2000, 2050, 2040};
                codes[unused] = SENSE_CODE_MAX;
                foc.period.i_pu = transforms_park(sense_step(&sense, codes, on).i,
                                                  angle_rotation((uint16_t)theta));
                TEST_ASSERT_FALSE(reported().adc_saturated);
            }
        }
    }
}

void test_voltage_use_is_the_squared_magnitude_before_the_circle(void)
{
    foc.period.voltage.unsaturated_d_q25 = 16384 * 1024; /* a half */
    foc.period.voltage.unsaturated_q_q25 = 28377 * 1024; /* sqrt 3 / 2 */
    TEST_ASSERT_INT32_WITHIN(2, 32768, reported().voltage_use_q15);
    foc.period.voltage.unsaturated_q_q25 = 100000 * 1024; /* counts as one */
    TEST_ASSERT_INT32_WITHIN(4, 8192 + 32766, reported().voltage_use_q15);
    foc.period.voltage.unsaturated_d_q25 = 0;
    foc.period.voltage.unsaturated_q_q25 = 0;
    TEST_ASSERT_EQUAL_INT32(0, reported().voltage_use_q15);
}
