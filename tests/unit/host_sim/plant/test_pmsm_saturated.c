/* SPDX-License-Identifier: Apache-2.0 */
/* Machine model with saturation and cogging: circuit laws and conservation as for the linear model.
 */
#include <math.h>

#include "machines.h"
#include "plant/phases.h"
#include "unity.h"

static const double PERIOD_S = 50e-6;

void setUp(void) {}

void tearDown(void) {}

static pmsm_step_t step_of(double omega_rad_s, double duration_s)
{
    const pmsm_step_t out = {
        .omega_rad_s = omega_rad_s, .duration_s = duration_s, .series_resistance_ohm = 0.0};
    return out;
}

/* Energy residual of a large transient, relative to the energy exchanged. */
static double wild_residual(const pmsm_params_t *params, double step_s)
{
    const pmsm_t machine = pmsm_at_temperature(params, 80.0);
    pmsm_state_t state = pmsm_at_rest(0.77);
    pmsm_step_t step = step_of(1000.0, step_s);
    step.series_resistance_ohm = 0.004;
    const double begin_j = pmsm_magnetic_energy_j(&machine, &state);
    double residual_j = begin_j;
    double turned_over_j = 0.0;
    double largest_a = 0.0;
    for (int k = 0; k < 8000; k++) {
        const double time_s = k * step_s;
        const plant_ab_t u = {.alpha = 20.0 * sin(7400.0 * time_s),
                              .beta = 20.0 * cos(1.1e3 * time_s)};
        const pmsm_flow_t flow = pmsm_step(&machine, &state, u, &step);
        const double work_j = flow.torque_nms * step.omega_rad_s / params->pole_pairs;
        residual_j += flow.source_j - flow.copper_j - flow.series_j - flow.iron_j - work_j;
        turned_over_j += fabs(flow.source_j);
        largest_a = fmax(largest_a, hypot(state.i_t.d, state.i_t.q));
    }
    TEST_ASSERT_TRUE(largest_a > 80.0); /* well into the knee */
    return fabs(residual_j - pmsm_magnetic_energy_j(&machine, &state)) / turned_over_j;
}

void test_energy_is_conserved_within_1e_9_and_the_residual_is_of_the_scheme(void)
{
    const pmsm_params_t params = saturating_machine();
    const double coarse = wild_residual(&params, PERIOD_S);
    const double fine = wild_residual(&params, PERIOD_S / 16.0);
    TEST_ASSERT_TRUE(coarse < 2e-5);
    TEST_ASSERT_TRUE(fine < 1e-9);
    TEST_ASSERT_TRUE(
        fine < coarse / 4096.0); /* third order at least: the residual is that of the step length */
}

void test_steady_state_currents_equal_those_of_the_circuit_with_saturated_fluxes(void)
{
    pmsm_params_t params = saturating_machine();
    params.cogging_torque_nm = 0.0;
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    const double fine_s = 1e-6;
    const double omegas[] = {-700.0, 60.0, 900.0};
    const plant_dq_t fluxes[] = {{1e-3, 7e-3}, {-5e-3, -9e-3}};
    for (int n = 0; n < 6; n++) {
        const double w = omegas[n % 3];
        const plant_dq_t flux = fluxes[n / 3];
        const plant_dq_t i_t = magnetics_current(&machine.magnetics, flux);
        const plant_dq_t v = {.d = -w * flux.q, .q = w * (flux.d + params.flux_linkage_wb)};
        const double iron_ohm =
            params.iron_loss_resistance_ohm + params.iron_loss_resistance_slope_ohm_s * fabs(w);
        const plant_dq_t i = {.d = i_t.d + v.d / iron_ohm, .q = i_t.q + v.q / iron_ohm};
        const plant_dq_t u = {.d = v.d + params.phase_resistance_ohm * i.d,
                              .q = v.q + params.phase_resistance_ohm * i.q};
        pmsm_state_t state = pmsm_at_rest(0.3);
        pmsm_flow_t last = {.source_j = 0.0};
        for (int k = 0; k < 60000; k++) {
            const plant_phasor_t middle =
                plant_phasor_of_turn(state.theta_turn + 0.5 * w * fine_s / PLANT_TWO_PI);
            const pmsm_step_t step = step_of(w, fine_s);
            last = pmsm_step(&machine, &state, plant_inverse_park(u, middle), &step);
        }
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, i_t.d, state.i_t.d);
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, i_t.q, state.i_t.q);
        /* Airgap power over speed: in the steady state v . i_t is entirely mechanical. */
        const double torque_nm = 1.5 * (v.d * i_t.d + v.q * i_t.q) * params.pole_pairs / w;
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * fabs(torque_nm) + 1e-4, torque_nm,
                                  last.torque_nms / fine_s);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * fabs(torque_nm) + 1e-4, torque_nm,
                                  pmsm_torque_nm(&machine, i_t));
    }
}

void test_a_small_current_step_has_the_incremental_inductance_of_the_operating_point(void)
{
    /* Locked rotor, negligible resistance: di/dt = S v, with S the derivative of the currents at
     * the flux of i_d. */
    pmsm_params_t params = saturating_machine();
    params.phase_resistance_ohm = 1e-6;
    params.iron_loss_resistance_ohm = 0.0;
    params.iron_loss_resistance_slope_ohm_s = 0.0;
    params.cross_saturation = 0.0;
    params.magnet_bias_current_a = 0.0;
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    pmsm_state_t state = pmsm_at_rest(0.0);
    state.i_t.d = params.d_saturation_current_a; /* X = 1: L / 4 */
    const plant_ab_t u = {.alpha = 1.0, .beta = 0.0};
    const pmsm_step_t step = step_of(0.0, 1e-7);
    pmsm_step(&machine, &state, u, &step);
    const double rise_a = state.i_t.d - params.d_saturation_current_a;
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * rise_a, 1e-7 / (0.25 * params.d_inductance_h), rise_a);
}

void test_torque_per_ampere_falls_under_load_with_saturation(void)
{
    const pmsm_params_t params = saturating_machine();
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    const plant_dq_t light = {.d = 0.0, .q = 1.0};
    const plant_dq_t heavy = {.d = 0.0, .q = 90.0};
    const double straight_nm = 1.5 * params.pole_pairs * params.flux_linkage_wb;
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * straight_nm, straight_nm, pmsm_torque_nm(&machine, light));
    TEST_ASSERT_TRUE(pmsm_torque_nm(&machine, heavy) < 0.97 * 90.0 * straight_nm);
}

void test_parameters_of_a_disabled_saturation_have_no_effect_bit_for_bit(void)
{
    const pmsm_params_t plain = salient_machine();
    pmsm_params_t off = plain;
    off.cross_saturation = 1.0;
    off.magnet_bias_current_a = 30.0;
    off.cogging_per_turn = 84.0;
    off.cogging_deg = 40.0;
    const pmsm_t machines[] = {pmsm_at_temperature(&plain, 40.0), pmsm_at_temperature(&off, 40.0)};
    pmsm_state_t states[] = {pmsm_at_rest(0.1), pmsm_at_rest(0.1)};
    const pmsm_step_t step = step_of(800.0, PERIOD_S);
    for (int k = 0; k < 500; k++) {
        const plant_ab_t u = {.alpha = 15.0 * sin(0.2 * k), .beta = 12.0 * cos(0.31 * k)};
        pmsm_flow_t flows[2];
        for (int n = 0; n < 2; n++) {
            flows[n] = k % 100 < 90 ? pmsm_step(&machines[n], &states[n], u, &step)
                                    : pmsm_step_rectified(&machines[n], &states[n], 9.0, &step);
        }
        TEST_ASSERT_EQUAL_MEMORY(&states[0].i_t, &states[1].i_t, sizeof(states[0].i_t));
        TEST_ASSERT_EQUAL_MEMORY(&flows[0], &flows[1], sizeof(flows[0]));
    }
}

void test_with_a_very_large_saturation_current_the_machine_is_the_linear_one(void)
{
    const pmsm_params_t plain = salient_machine();
    pmsm_params_t far = plain;
    far.d_saturation_current_a = 1e5;
    far.q_saturation_current_a = 1e5;
    far.cross_saturation = 1.0;
    const pmsm_t machines[] = {pmsm_at_temperature(&plain, 40.0), pmsm_at_temperature(&far, 40.0)};
    pmsm_state_t states[] = {pmsm_at_rest(0.1), pmsm_at_rest(0.1)};
    const pmsm_step_t step = step_of(800.0, PERIOD_S);
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
        /* (2 i / I_s)^2 = 1.2e-5 of the flux at 170 A. */
        TEST_ASSERT_DOUBLE_WITHIN(5e-5 * largest_a, states[0].i_t.d, states[1].i_t.d);
        TEST_ASSERT_DOUBLE_WITHIN(5e-5 * largest_a, states[0].i_t.q, states[1].i_t.q);
    }
    TEST_ASSERT_TRUE(largest_a > 30.0);
}

void test_a_saturated_machine_on_diodes_settles_with_a_closed_power_balance(void)
{
    pmsm_params_t params = saturating_machine();
    params.cogging_torque_nm = 0.0;
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    pmsm_state_t state = pmsm_at_rest(0.2);
    state.i_t.q = 90.0;
    const pmsm_step_t step = step_of(900.0, PERIOD_S);
    pmsm_flow_t flow = {.source_j = 0.0};
    for (int k = 0; k < 4000; k++) {
        flow = pmsm_step_rectified(&machine, &state, 8.0, &step); /* against 18 V of back-EMF */
        TEST_ASSERT_TRUE(hypot(state.i_t.d, state.i_t.q) < 300.0);
    }
    TEST_ASSERT_TRUE(flow.torque_nms < 0.0);
    TEST_ASSERT_TRUE(flow.source_j < 0.0);
    /* Steady state: constant field energy; shaft power is heat plus the power of the source.
     */
    const double shaft_j = -flow.torque_nms * 900.0 / params.pole_pairs;
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * shaft_j, shaft_j, flow.copper_j + flow.iron_j - flow.source_j);
    state.i_t.q = 50.0;
    for (int k = 0; k < 4000; k++) {
        flow = pmsm_step_rectified(&machine, &state, 60.0, &step);
    }
    TEST_ASSERT_EQUAL_DOUBLE(0.0, flow.copper_j); /* above the back-EMF: zero current */
}

void test_cogging_torque_has_zero_mean_and_zero_work_over_a_turn(void)
{
    const cogging_t cogging = {.amplitude_nm = 1.5, .per_turn = 84.0, .phase_turn = 0.13};
    const double step_turn = 1.0 / 3000.0;
    const double speed_rad_s = PLANT_TWO_PI * step_turn / PERIOD_S;
    double impulse_nms = 0.0;
    double largest_nm = 0.0;
    for (int k = 0; k < 3000; k++) {
        const double one_nms = cogging_impulse_nms(&cogging, k * step_turn, step_turn, PERIOD_S);
        const double given_j = cogging_energy_j(&cogging, k * step_turn) -
                               cogging_energy_j(&cogging, (k + 1) * step_turn);
        TEST_ASSERT_DOUBLE_WITHIN(1e-13, given_j, one_nms * speed_rad_s);
        impulse_nms += one_nms;
        largest_nm = fmax(largest_nm, fabs(one_nms) / PERIOD_S);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 1.5, largest_nm);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12 * 1.5 * 3000 * PERIOD_S, 0.0, impulse_nms);
}

void test_cogging_holds_a_shaft_at_rest_up_to_its_amplitude(void)
{
    const cogging_t cogging = {.amplitude_nm = 2.0, .per_turn = 12.0, .phase_turn = 0.0};
    /* A quarter period away the torque is the full amplitude; at the rest position it is zero. */
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, -2.0 * PERIOD_S,
                              cogging_impulse_nms(&cogging, 0.25 / 12.0, 0.0, PERIOD_S));
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.0, cogging_impulse_nms(&cogging, 0.0, 0.0, PERIOD_S));
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 4.0 / 12.0, cogging_energy_j(&cogging, 0.5 / 12.0));
}

void test_cogging_torque_is_included_with_every_kind_of_supply(void)
{
    pmsm_params_t params = salient_machine();
    const pmsm_t smooth = pmsm_at_temperature(&params, 25.0);
    params.cogging_torque_nm = 0.8;
    params.cogging_per_turn = 42.0;
    params.cogging_deg = 90.0;
    const pmsm_t cogs = pmsm_at_temperature(&params, 25.0);
    const plant_ab_t u = {.alpha = 3.0, .beta = 1.0};
    const pmsm_step_t step = step_of(70.0, PERIOD_S);
    for (int way = 0; way < 2; way++) {
        pmsm_state_t a = pmsm_at_rest(0.0);
        pmsm_state_t b = pmsm_at_rest(0.0);
        double turn = 0.0;
        for (int k = 0; k < 1000; k++) {
            const pmsm_flow_t without = way == 0 ? pmsm_step(&smooth, &a, u, &step)
                                                 : pmsm_step_rectified(&smooth, &a, 1.0, &step);
            const pmsm_flow_t with = way == 0 ? pmsm_step(&cogs, &b, u, &step)
                                              : pmsm_step_rectified(&cogs, &b, 1.0, &step);
            const double middle =
                turn + 0.5 * 10.0 * PERIOD_S / PLANT_TWO_PI; /* 70 rad/s of 7 pole pairs */
            TEST_ASSERT_DOUBLE_WITHIN(5e-5 * PERIOD_S,
                                      -0.8 * sin(PLANT_TWO_PI * (42.0 * middle + 0.25)) * PERIOD_S,
                                      with.torque_nms - without.torque_nms);
            turn += 10.0 * PERIOD_S / PLANT_TWO_PI;
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, turn - floor(turn), b.shaft_turn);
    }
}

void test_invalid_machine_data_are_refused_with_the_parameter(void)
{
    pmsm_params_t params = saturating_machine();
    TEST_ASSERT_NULL(pmsm_objection(&params));
    params.magnet_bias_current_a = 0.3 * params.d_saturation_current_a;
    TEST_ASSERT_NOT_NULL(pmsm_objection(&params));
    params = saturating_machine();
    params.cogging_per_turn = 12.5;
    TEST_ASSERT_NOT_NULL(pmsm_objection(&params));
    params.cogging_torque_nm = 0.0;
    TEST_ASSERT_NULL(pmsm_objection(&params));
}
