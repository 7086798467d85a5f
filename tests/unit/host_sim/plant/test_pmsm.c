/* SPDX-License-Identifier: Apache-2.0 */
/* Machine model against circuit laws: steady states in closed form, exact transients, conservation
 * of energy. */
#include "plant/pmsm.h"

#include <math.h>

#include "machines.h"
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

static const double FINE_S = 1e-6;

/* Applies a voltage that rotates with the rotor, in steps short enough to be constant in its frame.
 * Mean current of the last step in *mean. */
static pmsm_flow_t feed_turning(const pmsm_t *machine, pmsm_state_t *state, plant_dq_t u,
                                double omega, double time_s, plant_dq_t *mean)
{
    pmsm_flow_t last = {.source_j = 0.0};
    plant_phasor_t middle = state->axis;
    const int steps = (int)lround(time_s / FINE_S);
    for (int k = 0; k < steps; k++) {
        middle = plant_phasor_of_turn(state->theta_turn + 0.5 * omega * FINE_S / PLANT_TWO_PI);
        const pmsm_step_t step = step_of(omega, FINE_S);
        last = pmsm_step(machine, state, plant_inverse_park(u, middle), &step);
    }
    const plant_ab_t current = {.alpha = last.charge_as.alpha / FINE_S,
                                .beta = last.charge_as.beta / FINE_S};
    *mean = plant_park(current, middle);
    return last;
}

/* Phasor equations of the iron-loss circuit, solved backwards from the torque current: v, then i,
 * then u. */
typedef struct {
    plant_dq_t v, i, u;
    double torque_nm;
} circuit_t;

static circuit_t circuit(const pmsm_params_t *p, double w, plant_dq_t i_t)
{
    const double r_i = p->iron_loss_resistance_ohm + p->iron_loss_resistance_slope_ohm_s * fabs(w);
    circuit_t c;
    c.v.d = -w * p->q_inductance_h * i_t.q;
    c.v.q = w * (p->d_inductance_h * i_t.d + p->flux_linkage_wb);
    c.i.d = i_t.d + c.v.d / r_i;
    c.i.q = i_t.q + c.v.q / r_i;
    c.u.d = p->phase_resistance_ohm * c.i.d + c.v.d;
    c.u.q = p->phase_resistance_ohm * c.i.q + c.v.q;
    c.torque_nm =
        1.5 * p->pole_pairs *
        (p->flux_linkage_wb * i_t.q + (p->d_inductance_h - p->q_inductance_h) * i_t.d * i_t.q);
    return c;
}

void test_steady_state_currents_equal_those_of_the_iron_loss_circuit(void)
{
    const pmsm_params_t params = salient_machine();
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    const double omegas[] = {-900.0, -120.0, 60.0, 400.0, 1500.0};
    const plant_dq_t currents[] = {{0.0, 20.0}, {-15.0, -30.0}, {5.0, 8.0}};
    for (int w = 0; w < 5; w++) {
        for (int k = 0; k < 3; k++) {
            const circuit_t expected = circuit(&params, omegas[w], currents[k]);
            pmsm_state_t state = pmsm_at_rest(0.3);
            state.i_t = currents[k];
            state.i_t.d += 5.0; /* different from the initial value */
            plant_dq_t seen;
            const pmsm_flow_t flow =
                feed_turning(&machine, &state, expected.u, omegas[w], 0.06, &seen);
            TEST_ASSERT_DOUBLE_WITHIN(1e-3, currents[k].d, state.i_t.d);
            TEST_ASSERT_DOUBLE_WITHIN(1e-3, currents[k].q, state.i_t.q);
            TEST_ASSERT_DOUBLE_WITHIN(1e-3, expected.i.d, seen.d);
            TEST_ASSERT_DOUBLE_WITHIN(1e-3, expected.i.q, seen.q);
            TEST_ASSERT_DOUBLE_WITHIN(1e-3, expected.torque_nm, flow.torque_nms / FINE_S);
            const double i2 = expected.i.d * expected.i.d + expected.i.q * expected.i.q;
            const double iron_w = 1.5 * (expected.v.d * (expected.i.d - currents[k].d) +
                                         expected.v.q * (expected.i.q - currents[k].q));
            TEST_ASSERT_DOUBLE_WITHIN(0.02, 1.5 * params.phase_resistance_ohm * i2,
                                      flow.copper_j / FINE_S);
            TEST_ASSERT_DOUBLE_WITHIN(0.02, iron_w, flow.iron_j / FINE_S);
        }
    }
}

void test_locked_rotor_behaves_as_resistance_and_inductance(void)
{
    const pmsm_params_t params = plain_machine();
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    pmsm_state_t state = pmsm_at_rest(0.0);
    const plant_ab_t u = {.alpha = 0.0, .beta = 2.0}; /* the q axis of a rotor at angle 0 */
    const pmsm_step_t step = step_of(0.0, PERIOD_S);
    const double tau_s = params.q_inductance_h / params.phase_resistance_ohm;
    for (int k = 1; k <= 200; k++) {
        pmsm_step(&machine, &state, u, &step);
        const double exact_a = 2.0 / params.phase_resistance_ohm * -expm1(-k * PERIOD_S / tau_s);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, exact_a, state.i_t.q);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, state.i_t.d);
    }
}

void test_the_series_resistance_adds_its_voltage_drop_and_loss(void)
{
    const pmsm_params_t params = plain_machine();
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    pmsm_state_t state = pmsm_at_rest(0.0);
    const plant_ab_t u = {.alpha = 3.0, .beta = 0.0};
    pmsm_step_t step = step_of(0.0, PERIOD_S);
    step.series_resistance_ohm = 0.01;
    pmsm_flow_t flow = {.source_j = 0.0};
    for (int k = 0; k < 4000; k++) {
        flow = pmsm_step(&machine, &state, u, &step);
    }
    const double current_a = 3.0 / (params.phase_resistance_ohm + 0.01);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, current_a, state.i_t.d);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, flow.copper_j * 0.01 / params.phase_resistance_ohm,
                              flow.series_j);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.5 * 3.0 * current_a * PERIOD_S,
                              flow.copper_j + flow.series_j);
}

void test_short_circuit_torque_equals_the_closed_form(void)
{
    const pmsm_params_t params = plain_machine();
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    const double r = params.phase_resistance_ohm;
    const double l = params.d_inductance_h;
    const double psi = params.flux_linkage_wb;
    const double omegas[] = {30.0, 333.3, 1200.0}; /* below, near and above R/L */
    for (int k = 0; k < 3; k++) {
        const double w = omegas[k];
        pmsm_state_t state = pmsm_at_rest(0.1);
        const plant_dq_t zero = {0.0, 0.0};
        plant_dq_t current;
        const pmsm_flow_t flow = feed_turning(&machine, &state, zero, w, 0.05, &current);
        const double torque_nm =
            -1.5 * params.pole_pairs * psi * psi * r * w / (r * r + w * w * l * l);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, torque_nm, flow.torque_nms / FINE_S);
    }
}

void test_energy_is_conserved_in_every_period_of_a_large_transient(void)
{
    const pmsm_params_t params = salient_machine();
    const pmsm_t machine = pmsm_at_temperature(&params, 80.0);
    pmsm_state_t state = pmsm_at_rest(0.77);
    pmsm_step_t step = step_of(1000.0, PERIOD_S);
    step.series_resistance_ohm = 0.004;
    double residual_j = 0.0;
    double turned_over_j = 0.0;
    for (int k = 0; k < 4000; k++) {
        const plant_ab_t u = {.alpha = 20.0 * sin(0.37 * k), .beta = 20.0 * cos(0.053 * k * k)};
        const double before_j = pmsm_magnetic_energy_j(&machine, &state);
        const pmsm_flow_t flow = pmsm_step(&machine, &state, u, &step);
        const double work_j = flow.torque_nms * step.omega_rad_s / params.pole_pairs;
        residual_j += fabs(flow.source_j - flow.copper_j - flow.series_j - flow.iron_j - work_j -
                           (pmsm_magnetic_energy_j(&machine, &state) - before_j));
        turned_over_j += fabs(flow.source_j);
    }
    TEST_ASSERT_TRUE(turned_over_j > 1.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, residual_j / turned_over_j);
}

static pmsm_params_t round_machine(void)
{
    pmsm_params_t out = salient_machine();
    out.q_inductance_h = out.d_inductance_h;
    return out;
}

/* Error at the end of a millisecond at 700 rad/s with a constant stator voltage, in i_t and in the
 * wires, against steps a sixteenth as long. */
static double error_after_1_ms_a(const pmsm_params_t *params, int steps)
{
    const pmsm_t machine = pmsm_at_temperature(params, 25.0);
    const plant_ab_t u = {.alpha = 12.0, .beta = -5.0};
    pmsm_state_t end[2];
    const int counts[2] = {steps, steps * 16};
    for (int n = 0; n < 2; n++) {
        pmsm_state_t state = pmsm_at_rest(0.2);
        const pmsm_step_t step = step_of(700.0, 1e-3 / counts[n]);
        for (int k = 0; k < counts[n]; k++) {
            pmsm_step(&machine, &state, u, &step);
        }
        end[n] = state;
    }
    return fmax(hypot(end[0].i_t.d - end[1].i_t.d, end[0].i_t.q - end[1].i_t.q),
                hypot(end[0].terminal.alpha - end[1].terminal.alpha,
                      end[0].terminal.beta - end[1].terminal.beta));
}

void test_a_step_of_any_length_is_the_exact_solution(void)
{
    const pmsm_params_t round = round_machine();
    const pmsm_params_t salient = salient_machine();
    TEST_ASSERT_DOUBLE_WITHIN(1e-11, 0.0, error_after_1_ms_a(&round, 20)); /* 20 kHz */
    TEST_ASSERT_DOUBLE_WITHIN(1e-11, 0.0, error_after_1_ms_a(&salient, 20));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, error_after_1_ms_a(&salient, 10));
}

void test_a_non_salient_machine_is_the_limit_of_salient_ones(void)
{
    pmsm_params_t params = round_machine();
    const pmsm_t round = pmsm_at_temperature(&params, 25.0);
    params.q_inductance_h *= 1.0 + 1e-12;
    const pmsm_t almost = pmsm_at_temperature(&params, 25.0);
    const plant_ab_t u = {.alpha = 12.0, .beta = -5.0};
    const pmsm_step_t step = step_of(700.0, 50e-6);
    pmsm_state_t a = pmsm_at_rest(0.2);
    pmsm_state_t b = a;
    for (int k = 0; k < 20; k++) {
        const pmsm_flow_t of_a = pmsm_step(&round, &a, u, &step);
        const pmsm_flow_t of_b = pmsm_step(&almost, &b, u, &step);
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, of_b.source_j, of_a.source_j);
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, of_b.torque_nms, of_a.torque_nms);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, b.i_t.d, a.i_t.d);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, b.i_t.q, a.i_t.q);
}

void test_a_fast_rotor_is_integrated_in_several_substeps(void)
{
    const pmsm_params_t params = salient_machine();
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    const plant_ab_t u = {.alpha = 30.0, .beta = 10.0};
    pmsm_state_t coarse = pmsm_at_rest(0.4);
    pmsm_state_t fine = pmsm_at_rest(0.4);
    const pmsm_step_t long_step = step_of(20000.0, PERIOD_S); /* a radian a period */
    const pmsm_step_t short_step = step_of(20000.0, PERIOD_S / 200.0);
    pmsm_step(&machine, &coarse, u, &long_step);
    for (int k = 0; k < 200; k++) {
        pmsm_step(&machine, &fine, u, &short_step);
    }
    TEST_ASSERT_TRUE(hypot(fine.i_t.d, fine.i_t.q) > 10.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, fine.i_t.d, coarse.i_t.d);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, fine.i_t.q, coarse.i_t.q);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, fine.theta_turn, coarse.theta_turn);
}

void test_reverse_rotation_is_symmetric_to_forward_rotation(void)
{
    const pmsm_params_t params = salient_machine();
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    pmsm_state_t forward = pmsm_at_rest(0.0);
    pmsm_state_t backward = pmsm_at_rest(0.0);
    const pmsm_step_t ahead = step_of(500.0, PERIOD_S);
    const pmsm_step_t back = step_of(-500.0, PERIOD_S);
    for (int k = 0; k < 300; k++) {
        const plant_ab_t u = {.alpha = 6.0 * cos(0.025 * k), .beta = 6.0 * sin(0.025 * k)};
        const plant_ab_t mirrored = {.alpha = u.alpha, .beta = -u.beta};
        const pmsm_flow_t a = pmsm_step(&machine, &forward, u, &ahead);
        const pmsm_flow_t b = pmsm_step(&machine, &backward, mirrored, &back);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, forward.i_t.d, backward.i_t.d);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, forward.i_t.q, -backward.i_t.q);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, a.torque_nms, -b.torque_nms);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, a.source_j, b.source_j);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, a.iron_j, b.iron_j);
    }
}

void test_charge_and_rectified_charge_are_the_integrals_of_the_phase_currents(void)
{
    const pmsm_params_t params = plain_machine();
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    pmsm_state_t state = pmsm_at_rest(0.0);
    state.i_t.q = 10.0;
    /* With the voltage of i_q = 10 A the phase currents are sinusoidal, and the rectified charge of
     * a turn is 6 I / pi. */
    const double w = 500.0;
    const plant_dq_t u = {.d = -w * params.q_inductance_h * 10.0,
                          .q = params.phase_resistance_ohm * 10.0 + w * params.flux_linkage_wb};
    const int steps = 4000;
    const double h = PLANT_TWO_PI / w / steps;
    double rectified_as = 0.0;
    plant_ab_t quarter_as = {0.0, 0.0};
    for (int k = 0; k < steps; k++) {
        const plant_phasor_t middle = plant_phasor_of_turn((k + 0.5) / steps);
        const pmsm_step_t step = step_of(w, h);
        const pmsm_flow_t flow = pmsm_step(&machine, &state, plant_inverse_park(u, middle), &step);
        rectified_as += flow.rectified_as;
        if (k < steps / 4) {
            quarter_as.alpha += flow.charge_as.alpha;
            quarter_as.beta += flow.charge_as.beta;
        }
    }
    const double pi = PLANT_TWO_PI / 2.0;
    TEST_ASSERT_DOUBLE_WITHIN(1e-5 * 60.0 / pi, 60.0 / pi, rectified_as * w / PLANT_TWO_PI);
    /* i_alpha = -10 sin, i_beta = 10 cos over the first quarter turn */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -10.0 / w, quarter_as.alpha);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 10.0 / w, quarter_as.beta);
}

void test_the_angle_wraps_and_turns_are_counted_in_both_directions(void)
{
    const pmsm_params_t params = salient_machine();
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    const plant_ab_t zero = {0.0, 0.0};
    const double omegas[] = {333.0, -333.0};
    for (int n = 0; n < 2; n++) {
        pmsm_state_t state = pmsm_at_rest(0.25);
        const pmsm_step_t step = step_of(omegas[n], PERIOD_S);
        for (int k = 0; k < 20000; k++) {
            pmsm_step(&machine, &state, zero, &step);
            TEST_ASSERT_TRUE(state.theta_turn >= 0.0 && state.theta_turn < 1.0);
        }
        const double turns = 0.25 + omegas[n] / PLANT_TWO_PI; /* after a second */
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, turns - floor(turns), state.theta_turn);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, cos(state.theta_turn * PLANT_TWO_PI), state.axis.cos);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, sin(state.theta_turn * PLANT_TWO_PI), state.axis.sin);
    }
}

void test_resistance_rises_and_torque_falls_with_temperature(void)
{
    pmsm_params_t params = salient_machine();
    params.flux_temperature_coefficient_per_k = -0.0011;
    const pmsm_t warm = pmsm_at_temperature(&params, 125.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.05 * 1.393, warm.resistance_ohm);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.02 * 0.89, warm.flux_wb);
}

void test_a_winding_time_constant_shorter_than_the_period_is_reported_as_unresolved(void)
{
    pmsm_params_t params = salient_machine();
    const pmsm_t slow = pmsm_at_temperature(&params, 25.0);
    TEST_ASSERT_TRUE(pmsm_is_resolved(&slow, 0.01, PERIOD_S));
    params.phase_resistance_ohm = 4.0; /* R T = 200 uVs/A against 150 uH */
    const pmsm_t quick = pmsm_at_temperature(&params, 25.0);
    TEST_ASSERT_FALSE(pmsm_is_resolved(&quick, 0.01, PERIOD_S));
}
