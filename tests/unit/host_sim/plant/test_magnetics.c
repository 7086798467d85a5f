/* SPDX-License-Identifier: Apache-2.0 */
/* Saturation: currents are gradients of one energy, inductances in closed form, one flux for every
 * current. */
#include "plant/magnetics.h"

#include <math.h>

#include "unity.h"

static const double L_D = 150e-6;
static const double L_Q = 230e-6;
static const double I_SD = 80.0;
static const double I_SQ = 60.0;

void setUp(void) {}

void tearDown(void) {}

static magnetics_data_t iron(double cross_share, double bias_a)
{
    const magnetics_data_t out = {
        .d_inductance_h = L_D,
        .q_inductance_h = L_Q,
        .d_saturation_a = I_SD,
        .q_saturation_a = I_SQ,
        .cross_share = cross_share,
        .bias_a = bias_a,
    };
    return out;
}

static const magnetics_data_t *sample_of_iron(int k)
{
    static magnetics_data_t data[4];
    data[0] = iron(0.0, 0.0);
    data[1] = iron(1.0, 0.0);
    data[2] = iron(0.6, 15.0);
    data[3] = iron(0.0, 20.0);
    return &data[k];
}

/* Solution of X + X^3 = k, by Cardano: the flux over its knee where one axis saturates alone. */
static double knees(double k)
{
    const double root = sqrt(0.25 * k * k + 1.0 / 27.0);
    return cbrt(0.5 * k + root) + cbrt(0.5 * k - root);
}

void test_flux_and_inductance_of_one_axis_equal_the_closed_form(void)
{
    const magnetics_data_t data = iron(0.0, 0.0);
    const magnetics_t m = magnetics_of(&data);
    for (int k = -40; k <= 40; k++) {
        const plant_dq_t i = {.d = 10.0 * k, .q = 0.0};
        const double x = knees(2.0 * i.d / I_SD);
        const plant_dq_t flux = magnetics_flux(&m, i);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.5 * L_D * I_SD * x, flux.d);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, flux.q);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12 * L_D, L_D / (1.0 + 3.0 * x * x),
                                  1.0 / magnetics_slope(&m, flux).dd);
        const plant_dq_t j = {.d = 0.0, .q = 10.0 * k};
        const double y = knees(2.0 * j.q / I_SQ);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.5 * L_Q * I_SQ * y, magnetics_flux(&m, j).q);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12 * L_Q, L_Q / (1.0 + 3.0 * y * y),
                                  1.0 / magnetics_slope(&m, magnetics_flux(&m, j)).qq);
    }
}

void test_at_the_saturation_current_the_flux_is_half_the_linear_one(void)
{
    const magnetics_data_t data = iron(0.7, 0.0);
    const magnetics_t m = magnetics_of(&data);
    const plant_dq_t d = {.d = I_SD, .q = 0.0};
    const plant_dq_t q = {.d = 0.0, .q = -I_SQ};
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 0.5 * L_D * I_SD, magnetics_flux(&m, d).d);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, -0.5 * L_Q * I_SQ, magnetics_flux(&m, q).q);
}

void test_inductances_at_zero_current_equal_the_data_with_any_saturation(void)
{
    const plant_dq_t none = {0.0, 0.0};
    for (int k = 0; k < 4; k++) {
        const magnetics_t m = magnetics_of(sample_of_iron(k));
        const magnetics_slope_t s = magnetics_slope(&m, none);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12 / L_D, 1.0 / L_D, s.dd);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12 / L_Q, 1.0 / L_Q, s.qq);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, s.dq);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, magnetics_current(&m, none).d);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, magnetics_energy_j(&m, none));
    }
}

/* Central difference of the energy along d (0), q (1), over 3/2. */
static double energy_slope(const magnetics_t *m, plant_dq_t at, int axis)
{
    const double h = 1e-6;
    plant_dq_t above = at;
    plant_dq_t below = at;
    *(axis == 0 ? &above.d : &above.q) += h;
    *(axis == 0 ? &below.d : &below.q) -= h;
    return (magnetics_energy_j(m, above) - magnetics_energy_j(m, below)) / (3.0 * h);
}

void test_currents_are_gradients_of_one_energy_so_mutual_inductances_are_equal(void)
{
    const double h = 1e-7;
    for (int k = 0; k < 4; k++) {
        const magnetics_t m = magnetics_of(sample_of_iron(k));
        for (int n = 0; n < 49; n++) {
            const plant_dq_t flux = {.d = 4e-3 * (n % 7 - 3), .q = 5e-3 * ((double)n / 7 - 3)};
            const plant_dq_t i = magnetics_current(&m, flux);
            const double scale_a = 1.0 + fabs(i.d) + fabs(i.q);
            TEST_ASSERT_DOUBLE_WITHIN(1e-6 * scale_a, i.d, energy_slope(&m, flux, 0));
            TEST_ASSERT_DOUBLE_WITHIN(1e-6 * scale_a, i.q, energy_slope(&m, flux, 1));
            const plant_dq_t d_up = {.d = flux.d + h, .q = flux.q};
            const plant_dq_t d_down = {.d = flux.d - h, .q = flux.q};
            const plant_dq_t q_up = {.d = flux.d, .q = flux.q + h};
            const plant_dq_t q_down = {.d = flux.d, .q = flux.q - h};
            const double d_by_q =
                (magnetics_current(&m, q_up).d - magnetics_current(&m, q_down).d) / (2.0 * h);
            const double q_by_d =
                (magnetics_current(&m, d_up).q - magnetics_current(&m, d_down).q) / (2.0 * h);
            const magnetics_slope_t s = magnetics_slope(&m, flux);
            TEST_ASSERT_DOUBLE_WITHIN(1e-6 * (s.dd + s.qq), d_by_q, q_by_d);
            TEST_ASSERT_DOUBLE_WITHIN(1e-6 * (s.dd + s.qq), s.dq, d_by_q);
        }
    }
}

void test_flux_maps_are_reciprocal_and_a_closed_cycle_of_currents_has_zero_energy(void)
{
    const double h = 1e-3;
    for (int k = 0; k < 4; k++) {
        const magnetics_t m = magnetics_of(sample_of_iron(k));
        const int steps = 20000;
        double around_j = 0.0;
        for (int n = 0; n < steps; n++) {
            const double angle = PLANT_TWO_PI * (n + 0.5) / steps;
            const plant_dq_t i = {.d = -30.0 + 90.0 * cos(angle), .q = 20.0 + 70.0 * sin(angle)};
            const plant_dq_t flux = magnetics_flux(&m, i);
            around_j +=
                (flux.q * 70.0 * cos(angle) - flux.d * 90.0 * sin(angle)) * PLANT_TWO_PI / steps;
            if (n % 1000 == 0) {
                const plant_dq_t d_up = {.d = i.d + h, .q = i.q};
                const plant_dq_t d_down = {.d = i.d - h, .q = i.q};
                const plant_dq_t q_up = {.d = i.d, .q = i.q + h};
                const plant_dq_t q_down = {.d = i.d, .q = i.q - h};
                const double d_by_q =
                    (magnetics_flux(&m, q_up).d - magnetics_flux(&m, q_down).d) / (2.0 * h);
                const double q_by_d =
                    (magnetics_flux(&m, d_up).q - magnetics_flux(&m, d_down).q) / (2.0 * h);
                TEST_ASSERT_DOUBLE_WITHIN(1e-6 * L_Q, d_by_q, q_by_d);
            }
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, around_j); /* against 2 J exchanged */
    }
}

void test_flux_is_unique_for_currents_up_to_ten_times_the_knee(void)
{
    for (int k = 0; k < 4; k++) {
        const magnetics_t m = magnetics_of(sample_of_iron(k));
        for (int n = 0; n < 441; n++) {
            const plant_dq_t i = {.d = 80.0 * (n % 21 - 10), .q = 60.0 * ((double)n / 21 - 10)};
            const plant_dq_t back = magnetics_current(&m, magnetics_flux(&m, i));
            TEST_ASSERT_DOUBLE_WITHIN(1e-11 * (fabs(i.d) + fabs(i.q)), i.d, back.d);
            TEST_ASSERT_DOUBLE_WITHIN(1e-11 * (fabs(i.d) + fabs(i.q)), i.q, back.q);
        }
    }
}

void test_q_current_reduces_d_flux_with_cross_saturation_and_magnet_flux(void)
{
    const plant_dq_t i = {.d = 0.0, .q = 50.0};
    const magnetics_t shared = magnetics_of(sample_of_iron(2));
    const magnetics_t apart = magnetics_of(sample_of_iron(3));
    const magnetics_t unfilled = magnetics_of(sample_of_iron(1));
    TEST_ASSERT_TRUE(magnetics_flux(&shared, i).d < -1e-4);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, magnetics_flux(&apart, i).d);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, magnetics_flux(&unfilled, i).d);
}

void test_magnet_flux_makes_saturation_asymmetric_in_d_current(void)
{
    const magnetics_t m = magnetics_of(sample_of_iron(3));
    const plant_dq_t with = {.d = 60.0, .q = 0.0};
    const plant_dq_t against = {.d = -60.0, .q = 0.0};
    TEST_ASSERT_TRUE(magnetics_flux(&m, with).d < -0.8 * magnetics_flux(&m, against).d);
}

void test_without_a_saturation_current_the_iron_is_linear_with_any_other_parameters(void)
{
    magnetics_data_t data = iron(1.0, 10.0);
    data.d_saturation_a = 0.0;
    data.q_saturation_a = 0.0;
    const magnetics_t m = magnetics_of(&data);
    TEST_ASSERT_FALSE(m.saturates);
    const plant_dq_t i = {.d = 300.0, .q = -400.0};
    TEST_ASSERT_EQUAL_DOUBLE(L_D * 300.0, magnetics_flux(&m, i).d);
    TEST_ASSERT_EQUAL_DOUBLE(L_Q * -400.0, magnetics_flux(&m, i).q);
}

void test_magnet_flux_beyond_full_saturation_is_refused(void)
{
    magnetics_data_t data = iron(0.0, 0.28 * I_SD);
    TEST_ASSERT_TRUE(magnetics_is_possible(&data));
    data.bias_a = 0.29 * I_SD; /* the bound is 1/sqrt 12 */
    TEST_ASSERT_FALSE(magnetics_is_possible(&data));
    data = iron(1.0, 0.25 * I_SD);
    data.q_saturation_a = 10.0; /* 4 sqrt(150/230) 20^2 = 1292 over 80 * 10 */
    TEST_ASSERT_FALSE(magnetics_is_possible(&data));
    data.q_saturation_a = 17.0;
    TEST_ASSERT_TRUE(magnetics_is_possible(&data));
}
