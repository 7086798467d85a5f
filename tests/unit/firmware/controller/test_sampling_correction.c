/* SPDX-License-Identifier: Apache-2.0 */
/* Difference between sampled and mean current, against a motor with a stepwise constant voltage,
 * integrated in double precision. */
#include "sampling_correction.h"

#include <math.h>

#include "core/q15.h"
#include "paper_vehicle.h"
#include "unity.h"

static const double PI = 3.14159265358979323846;

/* In per-unit volts, amperes, and periods. */
typedef struct {
    double l_d, l_q, psi;
} machine_t;

typedef struct {
    double sampled_d, sampled_q, mean_d, mean_q; /* of 1.0 */
} seen_t;

static sampling_correction_t correction(const config_t *config, int32_t speed_q32,
                                        int32_t winding_temperature_cC)
{
    return sampling_correction_at(config, sampling_correction_magnets_pu(config), speed_q32,
                                  winding_temperature_cC);
}

void setUp(void) {}

void tearDown(void) {}

/* One period of a constant stator voltage, without resistance. In the rotor's frame
 * d i_d/dt = (u_d + w l_q i_q)/l_d, d i_q/dt = (u_q - w l_d i_d - w psi)/l_q, u turning backwards
 * by w. Midpoint rule. */
static seen_t period(const machine_t *m, double turn, double u_d, double u_q, double begin_d,
                     double begin_q, double *end_d, double *end_q)
{
    enum { STEPS = 64 }; /* wrong by the square of 1/64 of w: below an LSB */
    const double h = 1.0 / STEPS;
    const double w = 2.0 * PI * turn;
    double d = begin_d;
    double q = begin_q;
    seen_t out = {.sampled_d = begin_d, .sampled_q = begin_q, .mean_d = 0.0, .mean_q = 0.0};
    for (int n = 0; n < STEPS; n++) {
        const double angle = w * ((n + 0.5) * h - 0.5);
        const double v_d = u_d * cos(angle) + u_q * sin(angle);
        const double v_q = u_q * cos(angle) - u_d * sin(angle);
        const double half_d = d + 0.5 * h * (v_d + w * m->l_q * q) / m->l_d;
        const double half_q = q + 0.5 * h * (v_q - w * m->l_d * d - w * m->psi) / m->l_q;
        out.mean_d += half_d * h;
        out.mean_q += half_q * h;
        d += h * (v_d + w * m->l_q * half_q) / m->l_d;
        q += h * (v_q - w * m->l_d * half_d - w * m->psi) / m->l_q;
    }
    *end_d = d;
    *end_q = q;
    return out;
}

/* The steady state with about this mean current. Where a period ends is linear in where it begins;
 * it must be the same. */
static seen_t stepped_supply(const machine_t *m, double turn, double i_d, double i_q)
{
    const double w = 2.0 * PI * turn;
    const double longer =
        w / 2.0 / sin(w / 2.0); /* what standing still takes from the mean voltage */
    const double u_d = -w * m->l_q * i_q * longer;
    const double u_q = w * (m->l_d * i_d + m->psi) * longer;
    double o_d;
    double o_q;
    double d_d;
    double d_q;
    double q_d;
    double q_q;
    (void)period(m, turn, u_d, u_q, 0.0, 0.0, &o_d, &o_q);
    (void)period(m, turn, u_d, u_q, 1.0, 0.0, &d_d, &d_q);
    (void)period(m, turn, u_d, u_q, 0.0, 1.0, &q_d, &q_q);
    const double a = 1.0 - (d_d - o_d);
    const double b = -(q_d - o_d);
    const double c = -(d_q - o_q);
    const double e = 1.0 - (q_q - o_q);
    const double determinant = a * e - b * c;
    return period(m, turn, u_d, u_q, (o_d * e - b * o_q) / determinant,
                  (a * o_q - c * o_d) / determinant, &o_d, &o_q);
}

static void check(const config_t *config, double turn, double i_d, double i_q)
{
    const double per_w =
        16.0 / (2.0 * PI) / 65536.0; /* reactances at the base of speed, 1/16 turn a period */
    const machine_t machine = {
        .l_d = config->current_loop.inductance_d_pu_q16 * per_w,
        .l_q = config->current_loop.inductance_q_pu_q16 * per_w,
        .psi = config->current_loop.flux_pu_q16 * per_w,
    };
    const seen_t seen = stepped_supply(&machine, turn, i_d, i_q);
    const sampling_correction_t at = correction(config, (int32_t)lround(turn * 4294967296.0),
                                                config->motor.reference_temperature_cC);
    const dq_t mean = {.d = (int32_t)lround(seen.mean_d * 32768.0),
                       .q = (int32_t)lround(seen.mean_q * 32768.0)};
    const dq_t found = sampling_correction_to_sampled(&at, mean);
    /* What the approximation leaves out is of the fourth power of w T. */
    const double w = 2.0 * PI * turn;
    const double tolerance =
        2.0 + 32768.0 * pow(w, 4.0) / 100.0 * (fabs(i_d) + fabs(i_q) + machine.psi / machine.l_d);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, seen.sampled_d * 32768.0, found.d);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, seen.sampled_q * 32768.0, found.q);
    const dq_t back = sampling_correction_to_mean(&at, found);
    TEST_ASSERT_INT32_WITHIN(2, mean.d, back.d);
    TEST_ASSERT_INT32_WITHIN(2, mean.q, back.q);
    const dq_t weakened = {.d = found.d - 3000, .q = found.q};
    TEST_ASSERT_INT32_WITHIN(1, sampling_correction_to_mean(&at, weakened).d - back.d,
                             sampling_correction_mean_change(&at, -3000));
    const dq_t no_sample = {.d = 0, .q = 0};
    TEST_ASSERT_EQUAL_INT32(q_clamp(sampling_correction_to_mean(&at, no_sample).d, -32767, 0),
                            sampling_correction_d_pu(&at));
}

void test_sampled_current_is_that_of_a_motor_with_stepwise_constant_voltage(void)
{
    const config_t config = salient_vehicle();
    const double turns[] = {0.005, 0.01, 0.02, 0.03, 0.05, -0.02, -0.05};
    for (int n = 0; n < 7; n++) {
        check(&config, turns[n], 0.0, 0.3);
        check(&config, turns[n], -0.4, -0.3);
        check(&config, turns[n], -0.2, 0.0);
    }
}

void test_sampled_and_mean_current_are_equal_at_standstill(void)
{
    const config_t config = paper_vehicle();
    const sampling_correction_t at = correction(&config, 0, 2500);
    const dq_t i = {.d = -12345, .q = 23456};
    TEST_ASSERT_EQUAL_INT32(i.d, sampling_correction_to_sampled(&at, i).d);
    TEST_ASSERT_EQUAL_INT32(i.q, sampling_correction_to_sampled(&at, i).q);
    TEST_ASSERT_EQUAL_INT32(i.d, sampling_correction_to_mean(&at, i).d);
    TEST_ASSERT_EQUAL_INT32(20000, sampling_correction_mean_voltage(&at, 20000));
}

void test_mean_voltage_in_the_rotor_frame_is_reduced_by_sinc(void)
{
    const config_t config = paper_vehicle();
    for (double turn = -0.05; turn <= 0.05; turn += 0.005) {
        const sampling_correction_t at =
            correction(&config, (int32_t)lround(turn * 4294967296.0), 2500);
        const double half = PI * turn;
        const double share = fabs(half) < 1e-9 ? 1.0 : sin(half) / half;
        TEST_ASSERT_DOUBLE_WITHIN(4.0, 20000.0 * share,
                                  sampling_correction_mean_voltage(&at, 20000));
    }
}

void test_correction_stays_in_its_format_at_any_speed_and_temperature(void)
{
    const config_t config = salient_vehicle();
    const int32_t extremes[] = {INT32_MIN, -1, 0, 1, INT32_MAX};
    for (int s = 0; s < 5; s++) {
        for (int t = 0; t < 5; t++) {
            const sampling_correction_t at = correction(&config, extremes[s], extremes[t]);
            TEST_ASSERT_TRUE(at.gain_q24 >= 0 && at.gain_q24 <= 1 << 20);
            TEST_ASSERT_TRUE(at.inverse_q24 >= 0 && at.inverse_q24 <= at.gain_q24);
            TEST_ASSERT_TRUE(at.magnets_pu >= 0 && at.magnets_pu <= 16 * 32768);
            const dq_t far = {.d = -131072, .q = 131072};
            (void)sampling_correction_to_sampled(&at, far);
            (void)sampling_correction_to_mean(&at, far);
        }
    }
}
