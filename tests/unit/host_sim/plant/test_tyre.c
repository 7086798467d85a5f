/* SPDX-License-Identifier: Apache-2.0 */
/* Tyre contact: steady-state curve, saturation, adhesion, and dissipation of energy. */
#include "plant/tyre.h"

#include <math.h>

#include "unity.h"

static const double STEP_S = 50e-6;
static const double LOAD_N = 1600.0;
static tyre_params_t params;
static tyre_state_t state;

void setUp(void)
{
    const tyre_params_t car = {.bristle_stiffness_per_m = 180.0,
                               .bristle_damping_s_per_m = 0.7,
                               .contact_length_m = 0.15,
                               .sliding_share = 0.7,
                               .stribeck_speed_m_per_s = 6.0};
    const tyre_state_t relaxed = {.deflection_m = 0.0};
    params = car;
    state = relaxed;
}

void tearDown(void) {}

static double hold(double friction, double slip_m_per_s, double rolling_m_per_s, int steps)
{
    const tyre_contact_t contact = {.friction = friction,
                                    .load_n = LOAD_N,
                                    .slip_m_per_s = slip_m_per_s,
                                    .rolling_m_per_s = rolling_m_per_s};
    double force_n = 0.0;
    for (int k = 0; k < steps; k++) {
        force_n = tyre_step(&params, &state, &contact, STEP_S);
    }
    return force_n;
}

/* dz/dt = 0 in the header's equations, solved by hand. */
static double steady_n(double friction, double slip_m_per_s, double rolling_m_per_s)
{
    const double u = fabs(slip_m_per_s);
    const double g = friction * (0.7 + 0.3 * exp(-sqrt(u / 6.0)));
    return LOAD_N * 180.0 * slip_m_per_s /
           (180.0 * u / g + 7.0 / (6.0 * 0.15) * fabs(rolling_m_per_s));
}

void test_steady_state_slip_force_equals_the_closed_form_in_every_direction(void)
{
    const double slips[] = {-8.0, -1.0, -0.1, -0.01, 0.02, 0.5, 3.0};
    for (int k = 0; k < 7; k++) {
        for (int rolling = -10; rolling <= 10; rolling += 5) {
            setUp();
            const double force_n = hold(0.9, slips[k], rolling, 200000);
            TEST_ASSERT_DOUBLE_WITHIN(1e-6 * LOAD_N, steady_n(0.9, slips[k], rolling), force_n);
        }
    }
}

void test_force_slope_at_small_slip_is_stiffness_times_length_over_seven_sixths(void)
{
    const double slip = 1e-6;
    const double force_n = hold(1.0, slip * 10.0, 10.0, 200000);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 180.0 * 0.15 * 6.0 / 7.0, force_n / LOAD_N / slip);
}

void test_force_of_a_locked_wheel_is_sliding_friction_and_lower_on_ice(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * LOAD_N, -0.7 * 0.9 * LOAD_N, hold(0.9, -200.0, 0.0, 20000));
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * LOAD_N, -0.7 * 0.15 * LOAD_N, hold(0.15, -200.0, 0.0, 20000));
}

void test_tyre_in_adhesion_is_a_spring(void)
{
    /* A displacement of 1 mm of the standing wheel: small against mu / s0 = 5 mm, so mostly
     * elastic.
     */
    hold(0.9, 1e-3 / (200 * STEP_S), 0.0, 200);
    const double force_n = hold(0.9, 0.0, 0.0, 1);
    TEST_ASSERT_TRUE(force_n > 0.85 * LOAD_N * 180.0 * 1e-3 && force_n <= LOAD_N * 180.0 * 1e-3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, force_n, hold(0.9, 0.0, 0.0, 1000000)); /* 50 s without creep */
}

void test_the_contact_dissipates_energy_over_every_cycle(void)
{
    double work_j = 0.0;
    double lowest_j = 0.0;
    for (int k = 0; k < 40000; k++) {
        const double slip = 0.4 * sin(0.002 * k) + 0.1 * sin(0.031 * k);
        const tyre_contact_t contact = {
            .friction = 0.8, .load_n = LOAD_N, .slip_m_per_s = slip, .rolling_m_per_s = 3.0};
        work_j += tyre_step(&params, &state, &contact, STEP_S) * slip * STEP_S;
        const double heat_j = work_j - tyre_stored_j(&params, &state, LOAD_N);
        TEST_ASSERT_TRUE(heat_j >= lowest_j - 1e-3);
        lowest_j = fmax(lowest_j, heat_j);
    }
    TEST_ASSERT_TRUE(lowest_j > 10.0);
}
