/* SPDX-License-Identifier: Apache-2.0 */
/* A map of the field's energy: polynomials that a spline holds exactly, currents and inductances as
 * differences of the energy, and machines with a map against circuit laws and conservation. */
#include "plant/energy_map.h"

#include <math.h>

#include "machines.h"
#include "unity.h"

enum { CELLS_D = 60, CELLS_Q = 80, ROW = CELLS_Q + ENERGY_MAP_MORE };

static const double STEP_D_WB = 1e-3;
static const double STEP_Q_WB = 0.75e-3;
static const double PERIOD_S = 50e-6;

static double coefficients[(CELLS_D + ENERGY_MAP_MORE) * ROW];

static energy_map_t empty_map(void)
{
    const energy_map_t out = {
        .d = {.first_wb = -0.5 * CELLS_D * STEP_D_WB, .step_wb = STEP_D_WB, .cells = CELLS_D},
        .q = {.first_wb = -0.5 * CELLS_Q * STEP_Q_WB, .step_wb = STEP_Q_WB, .cells = CELLS_Q},
        .coefficient_j = coefficients,
    };
    return out;
}

/* The spline of a function: c = f - (h_x^2 f_xx + h_y^2 f_yy)/6 + h_x^2 h_y^2 f_xxyy/36, which is
 * exact for polynomials up to the third degree and leaves h^4 of others; derivatives as
 * differences, exact there too. */
static energy_map_t map_of(double (*function)(plant_dq_t flux))
{
    static const double WEIGHT[] = {-1.0 / 6, 4.0 / 3, -1.0 / 6};
    const energy_map_t out = empty_map();
    for (int j = 0; j < CELLS_D + ENERGY_MAP_MORE; j++) {
        for (int k = 0; k < ROW; k++) {
            double sum = 0.0;
            for (int m = 0; m < 3; m++) {
                for (int n = 0; n < 3; n++) {
                    const plant_dq_t at = {.d = out.d.first_wb + (j + m - 2) * STEP_D_WB,
                                           .q = out.q.first_wb + (k + n - 2) * STEP_Q_WB};
                    sum += WEIGHT[m] * WEIGHT[n] * function(at);
                }
            }
            coefficients[j * ROW + k] = sum;
        }
    }
    return out;
}

void setUp(void) {}

void tearDown(void) {}

static double polynomial(plant_dq_t flux)
{
    const double x = flux.d;
    const double y = flux.q;
    return 2.0 - 3.0 * x + 5.0 * y + 700.0 * x * x - 900.0 * y * y + 400.0 * x * y +
           3e4 * x * y * y + 2e6 * x * x * y * y;
}

void test_polynomials_of_second_degree_in_each_flux_are_exact_inside_and_beyond_the_grid(void)
{
    const energy_map_t map = map_of(polynomial);
    const double places[] = {-0.08, -0.03, -0.0113, 0.0, 0.0042, 0.03, 0.05};
    for (int n = 0; n < 49; n++) {
        const double x = places[n % 7];
        const double y = places[n / 7];
        const plant_dq_t flux = {.d = x, .q = y};
        const energy_at_t at = energy_map_at(&map, flux);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, polynomial(flux), at.energy_j);
        TEST_ASSERT_DOUBLE_WITHIN(
            1e-6, -3.0 + 1400.0 * x + 400.0 * y + 3e4 * y * y + 4e6 * x * y * y, at.current_a.d);
        TEST_ASSERT_DOUBLE_WITHIN(
            1e-6, 5.0 - 1800.0 * y + 400.0 * x + 6e4 * x * y + 4e6 * x * x * y, at.current_a.q);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 1400.0 + 4e6 * y * y, at.dd);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, -1800.0 + 6e4 * x + 4e6 * x * x, at.qq);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 400.0 + 6e4 * y + 8e6 * x * y, at.dq);
    }
}

static double slope_of_energy(const energy_map_t *map, plant_dq_t at, double step_d, double step_q)
{
    const plant_dq_t above = {.d = at.d + step_d, .q = at.q + step_q};
    const plant_dq_t below = {.d = at.d - step_d, .q = at.q - step_q};
    return (energy_map_at(map, above).energy_j - energy_map_at(map, below).energy_j) /
           (2.0 * (step_d + step_q));
}

void test_currents_are_slopes_of_the_energy_and_inductances_of_the_currents(void)
{
    /* Coefficients of no function at all, across the edges of cells and of the grid. */
    const energy_map_t map = empty_map();
    uint32_t lot = 1u;
    for (int k = 0; k < (CELLS_D + ENERGY_MAP_MORE) * ROW; k++) {
        lot = 1664525u * lot + 1013904223u;
        coefficients[k] = (double)(lot >> 8) / (1 << 24);
    }
    const double h = 1e-7;
    for (int n = 0; n < 400; n++) {
        const plant_dq_t at = {.d = -0.04 + 0.0041 * (n % 20), .q = -0.04 + 0.0043 * (n / 20)};
        const energy_at_t found = energy_map_at(&map, at);
        const plant_dq_t d_up = {.d = at.d + h, .q = at.q};
        const plant_dq_t d_down = {.d = at.d - h, .q = at.q};
        const plant_dq_t q_up = {.d = at.d, .q = at.q + h};
        const plant_dq_t q_down = {.d = at.d, .q = at.q - h};
        const plant_dq_t by_d = {
            .d = energy_map_at(&map, d_up).current_a.d - energy_map_at(&map, d_down).current_a.d,
            .q = energy_map_at(&map, d_up).current_a.q - energy_map_at(&map, d_down).current_a.q};
        const plant_dq_t by_q = {
            .d = energy_map_at(&map, q_up).current_a.d - energy_map_at(&map, q_down).current_a.d,
            .q = energy_map_at(&map, q_up).current_a.q - energy_map_at(&map, q_down).current_a.q};
        const double a = 1e3;               /* a coefficient over a cell's width, 1 / 1 mWb */
        const double per_h = a / STEP_D_WB; /* likewise of second derivatives */
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * a + 1e-4 * fabs(found.current_a.d),
                                  slope_of_energy(&map, at, h, 0.0), found.current_a.d);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * a + 1e-4 * fabs(found.current_a.q),
                                  slope_of_energy(&map, at, 0.0, h), found.current_a.q);
        TEST_ASSERT_DOUBLE_WITHIN(2e-3 * per_h + 2e-4 * fabs(found.dd), by_d.d / (2.0 * h),
                                  found.dd);
        TEST_ASSERT_DOUBLE_WITHIN(2e-3 * per_h + 2e-4 * fabs(found.qq), by_q.q / (2.0 * h),
                                  found.qq);
        TEST_ASSERT_DOUBLE_WITHIN(2e-3 * per_h + 2e-4 * fabs(found.dq), by_d.q / (2.0 * h),
                                  found.dq);
        TEST_ASSERT_DOUBLE_WITHIN(2e-3 * per_h + 2e-4 * fabs(found.dq), by_q.d / (2.0 * h),
                                  found.dq);
    }
}

/* What the iron of saturating_machine() adds to its inductances at zero current: W of magnetics.h,
 * written down once more. */
static double of_iron(plant_dq_t flux)
{
    const pmsm_params_t p = saturating_machine();
    const double l_d = p.d_inductance_h;
    const double l_q = p.q_inductance_h;
    const double a_d =
        4.0 / (l_d * l_d * l_d * p.d_saturation_current_a * p.d_saturation_current_a);
    const double a_q =
        4.0 / (l_q * l_q * l_q * p.q_saturation_current_a * p.q_saturation_current_a);
    const double a_c = p.cross_saturation * sqrt(a_d * a_q);
    const double z0 = l_d * p.magnet_bias_current_a;
    const double z = flux.d + z0;
    const double y2 = flux.q * flux.q;
    return 0.25 * a_d * (pow(z, 4.0) - pow(z0, 4.0)) + 0.25 * a_q * y2 * y2 +
           0.5 * a_c * (z * z - z0 * z0) * y2 - a_d * z0 * z0 * z0 * flux.d -
           1.5 * a_d * z0 * z0 * flux.d * flux.d;
}

static pmsm_params_t with_map(const energy_map_t *map)
{
    pmsm_params_t out = salient_machine();
    out.energy_map = map;
    return out;
}

void test_the_map_of_a_law_is_the_machine_of_that_law(void)
{
    const energy_map_t map = map_of(of_iron);
    const pmsm_params_t mapped = with_map(&map);
    pmsm_params_t law = saturating_machine();
    law.cogging_torque_nm = 0.0;
    TEST_ASSERT_NULL(pmsm_objection(&mapped));
    const pmsm_t machines[] = {pmsm_at_temperature(&law, 25.0), pmsm_at_temperature(&mapped, 25.0)};
    pmsm_state_t states[] = {pmsm_at_rest(0.1), pmsm_at_rest(0.1)};
    const pmsm_step_t step = {.omega_rad_s = 800.0, .duration_s = PERIOD_S};
    double largest_a = 0.0;
    for (int k = 0; k < 2000; k++) {
        const plant_ab_t u = {.alpha = 15.0 * sin(0.2 * k), .beta = 12.0 * cos(0.31 * k)};
        for (int n = 0; n < 2; n++) {
            if (k % 200 < 150) {
                pmsm_step(&machines[n], &states[n], u, &step);
            } else {
                pmsm_step_rectified(&machines[n], &states[n], 9.0, &step);
            }
        }
        largest_a = fmax(largest_a, hypot(states[0].i_t.d, states[0].i_t.q));
        TEST_ASSERT_DOUBLE_WITHIN(0.1, states[0].i_t.d, states[1].i_t.d); /* cells of 1 mWb */
        TEST_ASSERT_DOUBLE_WITHIN(0.1, states[0].i_t.q, states[1].i_t.q);
    }
    TEST_ASSERT_TRUE(largest_a > 60.0);
}

/* A third of 1/L of both axes of salient_machine(). */
static double straight(plant_dq_t flux)
{
    const pmsm_params_t p = salient_machine();
    return (flux.d * flux.d / p.d_inductance_h + flux.q * flux.q / p.q_inductance_h) / 6.0;
}

void test_a_map_of_constant_inductances_is_the_machine_that_has_them(void)
{
    const energy_map_t map = map_of(straight);
    const pmsm_params_t plain = salient_machine();
    pmsm_params_t mapped = with_map(&map);
    mapped.d_inductance_h *= 1.5; /* 1/L = 2/3 + 1/3 of the plain one's */
    mapped.q_inductance_h *= 1.5;
    const pmsm_t machines[] = {pmsm_at_temperature(&plain, 40.0),
                               pmsm_at_temperature(&mapped, 40.0)};
    pmsm_state_t states[] = {pmsm_at_rest(0.1), pmsm_at_rest(0.1)};
    const pmsm_step_t step = {.omega_rad_s = 800.0, .duration_s = PERIOD_S / 16.0};
    double largest_a = 0.0;
    for (int k = 0; k < 8000; k++) {
        const plant_ab_t u = {.alpha = 15.0 * sin(0.0125 * k), .beta = 12.0 * cos(0.019 * k)};
        pmsm_flow_t flows[2];
        for (int n = 0; n < 2; n++) {
            flows[n] = k % 1600 < 1400 ? pmsm_step(&machines[n], &states[n], u, &step)
                                       : pmsm_step_rectified(&machines[n], &states[n], 9.0, &step);
        }
        largest_a = fmax(largest_a, hypot(states[0].i_t.d, states[0].i_t.q));
        /* The plain one is solved exactly, the other in four stages: (w h)^4 of a thousand steps.
         */
        TEST_ASSERT_DOUBLE_WITHIN(1e-8 * largest_a, states[0].i_t.d, states[1].i_t.d);
        TEST_ASSERT_DOUBLE_WITHIN(1e-8 * largest_a, states[0].i_t.q, states[1].i_t.q);
        TEST_ASSERT_DOUBLE_WITHIN(1e-8 * 10.0 * step.duration_s, flows[0].torque_nms,
                                  flows[1].torque_nms);
    }
    TEST_ASSERT_TRUE(largest_a > 30.0);
}

void test_torque_is_the_slope_of_the_co_energy_over_the_angle_at_constant_currents(void)
{
    const energy_map_t map = map_of(of_iron);
    const pmsm_params_t params = with_map(&map);
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    const double turn_rad = 1e-4;
    for (int n = 0; n < 25; n++) {
        const plant_dq_t i = {.d = -80.0 + 30.0 * (n % 5), .q = -60.0 + 30.0 * (n / 5)};
        double co_energy_j[2];
        for (int side = 0; side < 2; side++) {
            const double angle = side == 0 ? -turn_rad : turn_rad; /* of the rotor, electrical */
            const plant_ab_t constant = {.alpha = i.d, .beta = i.q};
            const plant_phasor_t axis = {.cos = cos(angle), .sin = sin(angle)};
            const plant_dq_t seen = plant_park(constant, axis);
            const plant_dq_t flux = magnetics_flux(&machine.magnetics, seen);
            co_energy_j[side] = 1.5 * ((flux.d + machine.flux_wb) * seen.d + flux.q * seen.q) -
                                magnetics_energy_j(&machine.magnetics, flux);
        }
        const double torque_nm =
            params.pole_pairs * (co_energy_j[1] - co_energy_j[0]) / (2.0 * turn_rad);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, torque_nm, pmsm_torque_nm(&machine, i));
    }
}

/* Energy residual of a large transient, relative to the energy exchanged. */
static double residual(const pmsm_params_t *params, double step_s)
{
    const pmsm_t machine = pmsm_at_temperature(params, 80.0);
    pmsm_state_t state = pmsm_at_rest(0.77);
    const pmsm_step_t step = {
        .omega_rad_s = 1000.0, .duration_s = step_s, .series_resistance_ohm = 0.004};
    double residual_j = pmsm_magnetic_energy_j(&machine, &state);
    double turned_over_j = 0.0;
    for (int k = 0; k < 4000; k++) {
        const double time_s = k * step_s;
        const plant_ab_t u = {.alpha = 20.0 * sin(7400.0 * time_s),
                              .beta = 20.0 * cos(1.1e3 * time_s)};
        const pmsm_flow_t flow = pmsm_step(&machine, &state, u, &step);
        const double work_j = flow.torque_nms * step.omega_rad_s / params->pole_pairs;
        residual_j += flow.source_j - flow.copper_j - flow.series_j - flow.iron_j - work_j;
        turned_over_j += fabs(flow.source_j);
    }
    return fabs(residual_j - pmsm_magnetic_energy_j(&machine, &state)) / turned_over_j;
}

void test_energy_is_conserved_with_a_map_and_the_residual_is_of_the_scheme(void)
{
    const energy_map_t map = map_of(of_iron);
    pmsm_params_t params = with_map(&map);
    params.flux_temperature_coefficient_per_k = -0.0011;
    const double coarse = residual(&params, PERIOD_S);
    const double fine = residual(&params, PERIOD_S / 16.0);
    TEST_ASSERT_TRUE(coarse < 2e-5);
    TEST_ASSERT_TRUE(fine < 1e-8);
    TEST_ASSERT_TRUE(fine < coarse / 500.0); /* second derivatives bend between cells */
}

void test_weaker_magnets_move_the_flux_along_the_map_as_a_smaller_d_current_does(void)
{
    const energy_map_t map = map_of(of_iron);
    pmsm_params_t params = with_map(&map);
    params.flux_temperature_coefficient_per_k = -0.0011;
    const pmsm_t cold = pmsm_at_temperature(&params, params.reference_temperature_c);
    const pmsm_t warm = pmsm_at_temperature(&params, 105.0);
    const plant_dq_t lost = {.d = warm.flux_wb - cold.flux_wb, .q = 0.0};
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -0.088 * params.flux_linkage_wb, lost.d);
    const double as_current_a = magnetics_current(&cold.magnetics, lost).d;
    TEST_ASSERT_TRUE(as_current_a < -5.0);
    for (int n = 0; n < 9; n++) {
        const plant_dq_t i = {.d = -60.0 + 40.0 * (n % 3), .q = -50.0 + 50.0 * (n / 3)};
        const plant_dq_t moved = {.d = i.d + as_current_a, .q = i.q};
        const plant_dq_t found = magnetics_flux(&warm.magnetics, i);
        const plant_dq_t wanted = magnetics_flux(&cold.magnetics, moved);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, wanted.d + cold.flux_wb, found.d + warm.flux_wb);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, wanted.q, found.q);
    }
}

static double hollow(plant_dq_t flux)
{
    return -1e4 * flux.d * flux.d;
}

void test_a_map_without_a_flux_for_every_current_is_refused(void)
{
    const energy_map_t map = map_of(hollow); /* 1/L_d = 6.7e3 - 2e4 */
    const pmsm_params_t params = with_map(&map);
    TEST_ASSERT_NOT_NULL(pmsm_objection(&params));
    const energy_map_t iron = map_of(of_iron);
    pmsm_params_t both = saturating_machine();
    both.energy_map = &iron;
    TEST_ASSERT_NOT_NULL(pmsm_objection(&both));
}
