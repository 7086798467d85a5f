/* SPDX-License-Identifier: Apache-2.0 */
/* Machine with the bridge in freewheel: diodes conduct when the line EMF exceeds the bus voltage.
 */
#include <math.h>
#include <stddef.h>

#include "machines.h"
#include "plant/inverter.h"
#include "plant/pmsm.h"
#include "unity.h"

static const double PERIOD_S = 50e-6;
static const double CEILING_V = 30.0;

void setUp(void) {}

void tearDown(void) {}

static pmsm_step_t step_at(double omega_rad_s)
{
    const pmsm_step_t out = {
        .omega_rad_s = omega_rad_s, .duration_s = PERIOD_S, .series_resistance_ohm = 0.005};
    return out;
}

static double residual_j(const pmsm_params_t *params, const pmsm_flow_t *flow, double omega,
                         double gain_j)
{
    return flow->source_j - flow->copper_j - flow->series_j - flow->iron_j -
           flow->torque_nms * omega / params->pole_pairs - gain_j;
}

void test_with_an_emf_below_the_bus_the_current_is_zero_and_only_iron_loss_brakes(void)
{
    const pmsm_params_t params = salient_machine();
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    const double w = 1000.0; /* EMF 20 V peak phase */
    pmsm_state_t state = pmsm_at_rest(0.0);
    const pmsm_step_t step = step_at(w);
    pmsm_flow_t flow = {.source_j = 0.0};
    for (int k = 0; k < 500; k++) {
        flow = pmsm_step_rectified(&machine, &state, CEILING_V, &step);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, flow.charge_as.alpha);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, flow.charge_as.beta);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, flow.copper_j);
    }
    /* With i = 0 the torque current is that of the EMF through R_i: i_qt = -(w psi / R_i) / (1
     * + a^2), i_dt = b i_qt */
    const double r_i =
        params.iron_loss_resistance_ohm + params.iron_loss_resistance_slope_ohm_s * w;
    const double b = w * params.q_inductance_h / r_i;
    const double i_qt =
        -(w * params.flux_linkage_wb / r_i) / (1.0 + b * w * params.d_inductance_h / r_i);
    const double flux =
        params.flux_linkage_wb + (params.d_inductance_h - params.q_inductance_h) * b * i_qt;
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.5 * params.pole_pairs * flux * i_qt,
                              flow.torque_nms / PERIOD_S);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, flow.source_j);
}

void test_without_iron_loss_there_is_no_torque_below_conduction(void)
{
    const pmsm_params_t params = plain_machine();
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    pmsm_state_t state = pmsm_at_rest(0.0);
    const pmsm_step_t step = step_at(-1400.0);
    for (int k = 0; k < 100; k++) {
        const pmsm_flow_t flow = pmsm_step_rectified(&machine, &state, CEILING_V, &step);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, flow.torque_nms);
    }
}

void test_conduction_begins_where_the_line_emf_exceeds_the_bus_voltage(void)
{
    const pmsm_params_t params = plain_machine();
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    const inverter_params_t bridge = {.diode_forward_voltage_v = 0.8, .pwm_frequency_hz = 20000.0};
    const inverter_t inverter = inverter_model(&bridge, 25.0);
    const double bus_v = 48.0;
    const double ceiling_v = inverter_rectifier_ceiling_v(&inverter, bus_v);
    const double threshold = (bus_v + 1.6) / (sqrt(3.0) * params.flux_linkage_wb);
    for (int n = 0; n < 2; n++) {
        const double w = threshold * (n == 0 ? 0.99 : 1.01);
        pmsm_state_t state = pmsm_at_rest(0.0);
        const pmsm_step_t step = step_at(w);
        pmsm_flow_t flow = {.source_j = 0.0};
        for (int k = 0; k < 2000; k++) {
            flow = pmsm_step_rectified(&machine, &state, ceiling_v, &step);
        }
        TEST_ASSERT_EQUAL_INT(n, hypot(flow.charge_as.alpha, flow.charge_as.beta) > 0.0 ? 1 : 0);
    }
}

void test_with_an_emf_above_the_bus_the_machine_brakes_into_it_and_energy_is_conserved(void)
{
    const pmsm_params_t machines[] = {salient_machine(), plain_machine()};
    for (int m = 0; m < 2; m++) {
        const pmsm_t machine = pmsm_at_temperature(&machines[m], 25.0);
        const double w = 2500.0; /* EMF 50 V peak phase */
        pmsm_state_t state = pmsm_at_rest(0.0);
        const pmsm_step_t step = step_at(w);
        for (int k = 0; k < 2000; k++) {
            const double before_j = pmsm_magnetic_energy_j(&machine, &state);
            const pmsm_flow_t flow = pmsm_step_rectified(&machine, &state, CEILING_V, &step);
            const double gain_j = pmsm_magnetic_energy_j(&machine, &state) - before_j;
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, residual_j(&machines[m], &flow, w, gain_j));
            if (k > 1000) {
                TEST_ASSERT_TRUE(flow.source_j < 0.0);
                TEST_ASSERT_TRUE(flow.torque_nms < 0.0);
            }
        }
    }
}

/* Diodes that hold |u| = U against the current are a resistance U/|i| in series with the winding:
 * with z that and r, i = -w psi (w L_q, z)/(z^2 + w^2 L_d L_q). A period turns the rotor by up to
 * 0.3 rad, which a steady state must not notice. */
static void check_phasor_circuit(const pmsm_params_t *params, double w)
{
    const pmsm_t machine = pmsm_at_temperature(params, 25.0);
    pmsm_state_t state = pmsm_at_rest(0.0);
    const pmsm_step_t step = step_at(w);
    pmsm_flow_t flow = {.source_j = 0.0};
    for (int k = 0; k < 20000; k++) {
        flow = pmsm_step_rectified(&machine, &state, CEILING_V, &step);
    }
    const double i = hypot(state.i_t.d, state.i_t.q);
    const double z = CEILING_V / i + params->phase_resistance_ohm + step.series_resistance_ohm;
    const double x_d = w * params->d_inductance_h, x_q = w * params->q_inductance_h;
    const double per_square = w * params->flux_linkage_wb / (z * z + x_d * x_q);
    TEST_ASSERT_TRUE(i > 10.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * i, -x_q * per_square, state.i_t.d);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * i, -z * per_square, state.i_t.q);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9 * i * CEILING_V * PERIOD_S, -1.5 * CEILING_V * i * PERIOD_S,
                              flow.source_j);
}

void test_the_rectified_current_equals_that_of_the_phasor_circuit(void)
{
    static const double SALIENCY[] = {1.0, 0.8, 3.0, 8.0};
    for (size_t n = 0; n < sizeof SALIENCY / sizeof SALIENCY[0]; n++) {
        pmsm_params_t params = plain_machine();
        params.q_inductance_h = SALIENCY[n] * params.d_inductance_h;
        check_phasor_circuit(&params, 1700.0);
        check_phasor_circuit(&params, 2500.0);
        check_phasor_circuit(&params, 6000.0);
    }
}

/* Against the current, not against its flux: at rest L_q = 3 L_d turns the vector towards d. */
void test_a_current_at_rest_decays_against_itself(void)
{
    pmsm_params_t params = plain_machine();
    params.q_inductance_h = 3.0 * params.d_inductance_h;
    params.phase_resistance_ohm = 0.0;
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    pmsm_state_t state = pmsm_at_rest(0.0);
    state.i_t.d = -100.0;
    state.i_t.q = 100.0;
    pmsm_step_t step = step_at(0.0);
    step.duration_s = 1e-6;
    step.series_resistance_ohm = 0.0;
    pmsm_step_rectified(&machine, &state, CEILING_V, &step);
    const double each_as = CEILING_V * step.duration_s / sqrt(2.0);
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, -100.0 + each_as / params.d_inductance_h, state.i_t.d);
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, 100.0 - each_as / params.q_inductance_h, state.i_t.q);
}

void test_residual_current_decays_into_the_bus(void)
{
    const pmsm_params_t params = plain_machine();
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    pmsm_state_t state = pmsm_at_rest(0.0);
    state.i_t.d = -60.0;
    state.i_t.q = 80.0;
    const double magnetic_j = pmsm_magnetic_energy_j(&machine, &state);
    const pmsm_step_t step = step_at(0.0);
    double into_bus_j = 0.0;
    for (int k = 0; k < 20; k++) {
        into_bus_j -= pmsm_step_rectified(&machine, &state, CEILING_V, &step).source_j;
    }
    TEST_ASSERT_EQUAL_DOUBLE(0.0, state.i_t.d);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, state.i_t.q);
    TEST_ASSERT_TRUE(into_bus_j > 0.8 * magnetic_j && into_bus_j < magnetic_j);
}

/* Through the iron branch a current at rest dies out as a geometric series, which would never be 0
 * but, after a second, numbers too small for full speed. */
void test_a_current_at_rest_ends_at_zero_and_its_square_is_never_a_subnormal_number(void)
{
    enum { PERIODS_OF_A_MS = 20, MILLISECONDS = 2000 };
    const pmsm_params_t params = salient_machine();
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    const pmsm_step_t step = step_at(0.0);
    pmsm_state_t state = pmsm_at_rest(0.0);
    state.i_t.d = -60.0;
    state.i_t.q = 80.0;
    int flowing_ms = 0;
    for (int ms = 0; ms < MILLISECONDS; ms++) {
        pmsm_rest(&state);
        flowing_ms += state.i_t.q != 0.0 ? 1 : 0;
        for (int k = 0; k < PERIODS_OF_A_MS; k++) {
            pmsm_step_rectified(&machine, &state, CEILING_V, &step);
            TEST_ASSERT_TRUE(fpclassify(state.i_t.d * state.i_t.d) != FP_SUBNORMAL);
            TEST_ASSERT_TRUE(fpclassify(state.i_t.q * state.i_t.q) != FP_SUBNORMAL);
        }
    }
    TEST_ASSERT_TRUE(flowing_ms > 1 && flowing_ms < MILLISECONDS / 10);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, state.i_t.d);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, state.i_t.q);
}

void test_a_current_that_can_be_measured_is_left_alone(void)
{
    pmsm_state_t state = pmsm_at_rest(0.0);
    state.i_t.d = 1e-29;
    pmsm_rest(&state);
    TEST_ASSERT_EQUAL_DOUBLE(1e-29, state.i_t.d);
}

static void check_no_flow(const pmsm_flow_t *flow)
{
    const pmsm_flow_t none = {.charge_as = {0.0, 0.0}};
    TEST_ASSERT_EQUAL_DOUBLE(none.charge_as.alpha, flow->charge_as.alpha);
    TEST_ASSERT_EQUAL_DOUBLE(none.charge_as.beta, flow->charge_as.beta);
    TEST_ASSERT_EQUAL_DOUBLE(none.source_j, flow->source_j);
    TEST_ASSERT_EQUAL_DOUBLE(none.copper_j + none.series_j, flow->copper_j + flow->series_j);
    TEST_ASSERT_EQUAL_DOUBLE(none.iron_j, flow->iron_j);
    TEST_ASSERT_EQUAL_DOUBLE(none.torque_nms, flow->torque_nms);
}

void test_a_motor_at_rest_stays_as_it_is_and_starts_like_one_that_never_rested(void)
{
    const pmsm_params_t params = salient_machine();
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    const pmsm_step_t still = step_at(0.0);
    const pmsm_step_t driven = step_at(2000.0);
    pmsm_state_t rested = pmsm_at_rest(0.3);
    for (int k = 0; k < 5; k++) {
        const pmsm_flow_t flow = pmsm_step_rectified(&machine, &rested, CEILING_V, &still);
        check_no_flow(&flow);
    }
    pmsm_state_t fresh = pmsm_at_rest(0.3);
    for (int k = 0; k < 5; k++) {
        const pmsm_flow_t a = pmsm_step_rectified(&machine, &rested, CEILING_V, &driven);
        const pmsm_flow_t b = pmsm_step_rectified(&machine, &fresh, CEILING_V, &driven);
        TEST_ASSERT_EQUAL_DOUBLE(b.source_j, a.source_j);
        TEST_ASSERT_EQUAL_DOUBLE(b.torque_nms, a.torque_nms);
    }
    TEST_ASSERT_TRUE(fresh.i_t.q < -1.0);
    TEST_ASSERT_EQUAL_DOUBLE(fresh.i_t.d, rested.i_t.d);
    TEST_ASSERT_EQUAL_DOUBLE(fresh.i_t.q, rested.i_t.q);
    TEST_ASSERT_EQUAL_DOUBLE(fresh.axis.cos, rested.axis.cos);
}

void test_current_that_a_switching_bridge_leaves_ends_the_rest(void)
{
    const pmsm_params_t params = salient_machine();
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    const pmsm_step_t still = step_at(0.0);
    const plant_ab_t u = {.alpha = 1.0, .beta = 0.5};
    pmsm_state_t state = pmsm_at_rest(0.3);
    for (int k = 0; k < 2; k++) {
        (void)pmsm_step_rectified(&machine, &state, CEILING_V, &still);
    }
    (void)pmsm_step(&machine, &state, u, &still);
    const double before_j = pmsm_magnetic_energy_j(&machine, &state);
    TEST_ASSERT_TRUE(before_j > 1e-6);
    const pmsm_flow_t flow = pmsm_step_rectified(&machine, &state, CEILING_V, &still);
    const double gain_j = pmsm_magnetic_energy_j(&machine, &state) - before_j;
    TEST_ASSERT_TRUE(gain_j < -0.5 * before_j);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, residual_j(&params, &flow, 0.0, gain_j));
}
