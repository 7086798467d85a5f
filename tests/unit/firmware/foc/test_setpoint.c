/* SPDX-License-Identifier: Apache-2.0 */
/* How the fast loop applies a setpoint: prefilter, current limits, and the current used for
 * dead-time compensation. */
#include <math.h>

#include "current_controller.h"
#include "current_predictor.h"
#include "field_weakening.h"
#include "foc_rig.h"

void setUp(void)
{
    rig_up();
}

void tearDown(void) {}

/* exp(-w T/2) */
static double half_period(void)
{
    return exp(-3.14159265358979323846 * config.current_loop.bandwidth_Hz /
               config.drive.pwm_frequency_Hz);
}

static void run_periods(int periods)
{
    for (int n = 0; n < periods; n++) {
        foc_step(&foc, &config, &setpoint, &in);
    }
}

void test_a_setpoint_is_applied_when_its_number_changes(void)
{
    setpoint.sequence = 7;
    setpoint.i_reference_pu.q = 5000;
    run_periods(3);
    TEST_ASSERT_EQUAL_INT32(5000, dq_of(period->i_reference_pu).q);
    setpoint.i_reference_pu.q = 6000;
    setpoint.tuning.q.proportional_q10 = 1;
    run_periods(3);
    TEST_ASSERT_EQUAL_INT32(5000, dq_of(period->i_reference_pu).q);
    TEST_ASSERT_NOT_EQUAL(1, q_pair_y(foc.current.gains.q_gain_q10));
    setpoint.sequence = 8;
    run_periods(3);
    TEST_ASSERT_EQUAL_INT32(6000, dq_of(period->i_reference_pu).q);
    TEST_ASSERT_EQUAL(1, q_pair_y(foc.current.gains.q_gain_q10));
    foc_idle_step(&foc, &config, &setpoint, &in);
    TEST_ASSERT_EQUAL_INT32(0, dq_of(period->i_reference_pu).q);
    run_periods(3); /* the same one again, after a rest */
    TEST_ASSERT_EQUAL_INT32(6000, dq_of(period->i_reference_pu).q);
}

void test_a_change_of_reference_is_prefiltered_over_two_periods(void)
{
    const double b = half_period();
    setpoint.sequence = 7;
    setpoint.i_reference_pu.d = -2000;
    setpoint.i_reference_pu.q = 5000;
    const double share[4] = {1.0 / (b * b * (1.0 + b)), 1.0 / b, 1.0, 1.0};
    for (int n = 0; n < 4; n++) {
        run_periods(1);
        TEST_ASSERT_DOUBLE_WITHIN(1.0, -2000.0 * share[n], dq_of(period->i_reference_pu).d);
        TEST_ASSERT_DOUBLE_WITHIN(1.0, 5000.0 * share[n], dq_of(period->i_reference_pu).q);
        TEST_ASSERT_EQUAL_INT32(n >= 2 ? 7 : FOC_NO_SETPOINT, foc.sequence);
    }
}

void test_dead_time_compensation_uses_the_predicted_current(void)
{
    config.drive.dead_time_ns = 1000;
    config.drive.diode_drop_mV = 0;
    restart();
    const double step_pu = 6.0 * config.current_loop.dead_time_zone_pu_q15;
    setpoint.i_reference_pu.q = (int32_t)step_pu;
    in.rotor_angle_turn = 16384;            /* q along -a: the whole current flows in phase a */
    setpoint.tuning.q.proportional_q10 = 1; /* no voltage but the compensation */
    const int32_t middle_mV = (config.battery.min_voltage_mV + config.battery.max_voltage_mV) / 2;
    setpoint.dead_time_slope =
        dead_time_slope_at(&config, q_scale(middle_mV, 32768, config.drive.voltage_full_scale_mV));
    setpoint.tuning.q.integral_q15 = 0;
    const double b = half_period();
    double left = 0.5 * (1.0 + b);
    for (int n = 0; n < 20; n++) {
        step(true);
        const double expected =
            fmin(step_pu * (1.0 - left) / config.current_loop.dead_time_zone_pu_q15, 1.0);
        const double others =
            fmin(0.5 * step_pu * (1.0 - left) / config.current_loop.dead_time_zone_pu_q15, 1.0);
        const double line = ((foc.current.on_q16[1] >> 16) - (foc.current.on_q16[0] >> 16)) / 84.0;
        TEST_ASSERT_DOUBLE_WITHIN(0.05, expected + others, line);
        left = n == 0 ? 0.5 * (b + b * b * b) : left * b * b;
    }
}

void test_a_start_after_an_idle_period_predicts_from_zero(void)
{
    config.drive.dead_time_ns = 1000;
    restart();
    setpoint.i_reference_pu.q = 7000;
    for (int n = 0; n < 50; n++) {
        step(true);
    }
    step(false);
    TEST_ASSERT_EQUAL_INT32(0, dq_of(current_predictor_step(&foc.current.predictor)).q);
    step(true);
    /* (1 - b)/2 has come in the middle of the first period; what is missing has shrunk to a share a
     * = b^2 since. */
    const double b = half_period();
    const double left = 7000.0 * 0.5 * (1.0 + b) * b * b;
    TEST_ASSERT_DOUBLE_WITHIN(2.0, 7000.0 - left,
                              dq_of(current_predictor_step(&foc.current.predictor)).q);
}

void test_field_weakening_current_grows_by_gain_times_missing_square_in_every_period(void)
{
    config.current_loop.field_weakening_gain_pu_q15 = 20;
    config.current_loop.field_weakening_current_pu_q15 = 6000;
    restart();
    setpoint.tuning.forward_q_q25 = 40000 * 1024;
    setpoint.tuning.d.proportional_q10 = 1; /* the d axis asks for nothing */
    setpoint.tuning.d.integral_q15 = 0;
    for (int n = 0; n < 400; n++) {
        step(true);
    }
    /* The whole circle, 1 - 30760/32768 beyond the aim: 400 * 20/32768 * 0.0613. */
    const double exact_pu = -32768.0 * 400.0 * 20.0 / 32768.0 * (1.0 - 30760.0 / 32768.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.005 * 490.0, exact_pu, field_weakening_current_pu(&foc.weakening));
}

void test_the_reference_is_kept_inside_the_current_circle_with_d_first(void)
{
    /* Proportional action only, without saturation: the voltage shows the reference that was
     * regulated. */
    setpoint.tuning.d.proportional_q10 = 1024;
    setpoint.tuning.q.proportional_q10 = 1024;
    setpoint.tuning.d.integral_q15 = 0;
    setpoint.tuning.q.integral_q15 = 0;
    const int32_t most = config.current_loop.max_current_pu_q15;
    static const int32_t WANTED[][2] = {
        {-32768, 32767}, {-10000, 32767}, {5000, -32768}, {0, 32767}, {-3000, 4000}};
    for (int k = 0; k < 5; k++) {
        step(false);
        setpoint.i_reference_pu.d = WANTED[k][0];
        setpoint.i_reference_pu.q = WANTED[k][1];
        for (int n = 0; n < 3;
             n++) { /* what exceeds a change in its second period does not exceed the circle */
            step(true);
            const double d = voltage_unsaturated(&period->voltage).d;
            const double q = voltage_unsaturated(&period->voltage).q;
            TEST_ASSERT_TRUE(hypot(d, q) <= most + 2.0);
            TEST_ASSERT_TRUE(q * WANTED[k][1] >= 0.0); /* a limit never turns the torque round */
        }
        TEST_ASSERT_EQUAL_INT32(q_clamp(WANTED[k][0], -most, most),
                                voltage_unsaturated(&period->voltage).d);
    }
    TEST_ASSERT_EQUAL_INT32(4000,
                            voltage_unsaturated(&period->voltage).q); /* the last one was inside */
}

void test_setpoint_in_the_period_of_a_hall_edge_is_applied_one_period_later(void)
{
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    restart();
    run_periods(5);
    setpoint.sequence++;
    setpoint.i_reference_pu.q = 5000;
    in.hall_state = 1; /* the next sector */
    run_periods(1);
    TEST_ASSERT_EQUAL_INT32(0, dq_of(period->i_reference_pu).q);
    in.hall_state = 3; /* another edge at once: no second period of waiting */
    run_periods(1);
    TEST_ASSERT_NOT_EQUAL(0, dq_of(period->i_reference_pu).q);
}

/* Currents of the delay compensation: the mean is the sampled reference and the correction. */
void test_sampling_correction_moves_the_predicted_current_by_at_most_200(void)
{
    static const int32_t CORRECTIONS[][2] = {{150, 150}, {-150, -150}, {200, 200},
                                             {201, 200}, {-200, -200}, {-201, -200}};
    for (int k = 0; k < 6; k++) {
        setpoint.sequence++;
        setpoint.i_reference_pu.d = -100;
        setpoint.i_reference_pu.q = 50; /* too small to be shaped */
        setpoint.i_d_sampling_correction_pu = CORRECTIONS[k][0];
        run_periods(1);
        TEST_ASSERT_EQUAL_INT32(setpoint.sequence, foc.sequence);
        TEST_ASSERT_EQUAL_INT32(-100 + CORRECTIONS[k][1],
                                q_pair_x(foc.current.predictor.settled_pu.v));
        TEST_ASSERT_EQUAL_INT32(50, q_pair_y(foc.current.predictor.settled_pu.v));
    }
}

void test_setpoint_is_applied_again_until_a_change_has_settled(void)
{
    setpoint.sequence = 7;
    run_periods(3);
    TEST_ASSERT_EQUAL_INT32(7, foc.sequence);
    setpoint.sequence = 8;
    setpoint.i_reference_pu.q = 5000;
    run_periods(1);
    TEST_ASSERT_EQUAL_INT32(FOC_NO_SETPOINT, foc.sequence);
    run_periods(2);
    TEST_ASSERT_EQUAL_INT32(8, foc.sequence);
}

/* The decoupling's feed-forward takes the share of the target that has come in the first period. */
void test_first_period_of_a_change_decouples_for_its_target(void)
{
    setpoint.tuning.w_l_d_q10 = 2048;
    setpoint.tuning.w_l_q_q10 = 1024;
    setpoint.tuning.forward_d_q25 = 11;
    setpoint.tuning.forward_q_q25 = 22;
    setpoint.i_reference_pu.d = -4096;
    setpoint.i_reference_pu.q = 8192;
    setpoint.sequence++;
    run_periods(1);
    const current_predictor_t *predictor = &foc.current.predictor;
    const int32_t share_d = (2048 * predictor->weight_q15) >> 15;
    const int32_t share_q = (1024 * predictor->weight_q15) >> 15;
    const int32_t d = -4096 - ((predictor->target_first_q15 * -4096) >> 15);
    const int32_t q = 8192 - ((predictor->target_first_q15 * 8192) >> 15);
    TEST_ASSERT_EQUAL_INT32(11 - share_q * q, foc.current.gains.forward_d_q25);
    TEST_ASSERT_EQUAL_INT32(22 + share_d * d, foc.current.gains.forward_q_q25);
    TEST_ASSERT_TRUE(d > -1024 && d < 0);
}
