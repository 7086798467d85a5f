/* SPDX-License-Identifier: Apache-2.0 */
/* Three-phase model against the dq model, and single legs. */
#include "plant/phases.h"

#include <math.h>

#include "machines.h"
#include "unity.h"

static const double STEP_S = 50e-6;
static const double SERIES_OHM = 0.01;
enum {
    PIECES = 4
}; /* of a period: compares the models, not the truncation errors of two schemes */

void setUp(void) {}

void tearDown(void) {}

static void legs_at(plant_abc_t volts, phases_leg_t legs[PHASES])
{
    const double v[PHASES] = {volts.a, volts.b, volts.c};
    for (int x = 0; x < PHASES; x++) {
        const phases_leg_t leg = {
            .volts = v[x] + 25.0, .ohms = SERIES_OHM, .open = false}; /* the star point floats */
        legs[x] = leg;
    }
}

/* Both models from the same state with the same voltages, a new vector every period, for half a
 * second. */
static void compare(const pmsm_params_t *params, double omega_rad_s)
{
    const pmsm_t machine = pmsm_at_temperature(params, 60.0);
    const pmsm_step_t step = {.omega_rad_s = omega_rad_s,
                              .duration_s = STEP_S / PIECES,
                              .series_resistance_ohm = SERIES_OHM};
    phases_t phases = phases_at(&machine, omega_rad_s);
    phases.iron_sees_ripple = true;
    pmsm_state_t dq = pmsm_at_rest(0.1);
    pmsm_state_t abc = dq;
    pmsm_flow_t sum_dq = {.copper_j = 0.0};
    phases_flow_t sum_abc = {.iron_j = 0.0};
    double largest_a = 0.0;
    double apart_a = 0.0;
    for (int k = 0; k < 10000; k++) {
        const double angle = 2.0 * 3.14159265358979 * dq.theta_turn + 1.9 + 0.3 * sin(0.01 * k);
        const double v = omega_rad_s * 0.02 + 1.0;
        const plant_ab_t u = {.alpha = v * cos(angle), .beta = v * sin(angle)};
        phases_leg_t legs[PHASES];
        legs_at(plant_inverse_clarke(u), legs);
        for (int n = 0; n < PIECES; n++) {
            const pmsm_flow_t flow = pmsm_step(&machine, &dq, u, &step);
            sum_dq.copper_j += flow.copper_j;
            sum_dq.iron_j += flow.iron_j;
            sum_dq.torque_nms += flow.torque_nms;
            phases_state_t state = phases_from(&phases, &abc);
            phases_advance(&phases, &state, legs, STEP_S / PIECES, &sum_abc);
            phases_to(&phases, &state, &abc);
            sum_abc.torque_nms += pmsm_turn(&machine, &abc, &step);
        }
        largest_a = fmax(largest_a, hypot(dq.i_t.d, dq.i_t.q));
        apart_a = fmax(apart_a, hypot(dq.i_t.d - abc.i_t.d, dq.i_t.q - abc.i_t.q));
        apart_a = fmax(apart_a, hypot(dq.terminal.alpha - abc.terminal.alpha,
                                      dq.terminal.beta - abc.terminal.beta));
    }
    const double copper_j = machine.resistance_ohm *
                            (sum_abc.square_a2s[0] + sum_abc.square_a2s[1] + sum_abc.square_a2s[2]);
    TEST_ASSERT_TRUE(largest_a > 20.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * largest_a, 0.0, apart_a);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * sum_dq.copper_j, sum_dq.copper_j, copper_j);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * sum_dq.copper_j, sum_dq.iron_j, sum_abc.iron_j);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * fabs(sum_dq.torque_nms), sum_dq.torque_nms,
                              sum_abc.torque_nms);
}

void test_three_phase_and_dq_model_agree_within_1e_6(void)
{
    const pmsm_params_t salient = salient_machine();
    const pmsm_params_t plain = plain_machine();
    compare(&salient, 300.0);
    compare(&salient, 900.0);
    compare(&plain, 600.0);
}

void test_three_phase_and_dq_model_agree_with_saturation_and_cogging_within_1e_6(void)
{
    const pmsm_params_t saturating = saturating_machine();
    compare(&saturating, 300.0);
    compare(&saturating, 900.0);
}

void test_iron_loss_with_rotating_flux_equals_that_of_the_steady_state_circuit(void)
{
    /* A rotating voltage, integrated until the transient has decayed: then v = j w lambda, and both
     * iron branches are equal. */
    const pmsm_params_t params = salient_machine();
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    const double omega = 500.0;
    double iron_j[2];
    for (int k = 0; k < 2; k++) {
        phases_t phases = phases_at(&machine, omega);
        phases.iron_sees_ripple = k == 1;
        pmsm_state_t rotor = pmsm_at_rest(0.0);
        phases_state_t state = phases_from(&phases, &rotor);
        phases_flow_t flow = {.iron_j = 0.0};
        double angle = 1.7;
        for (int n = 0; n < 200000; n++) {
            const plant_ab_t u = {.alpha = 11.0 * cos(angle), .beta = 11.0 * sin(angle)};
            angle += omega * 1e-6;
            phases_leg_t legs[PHASES];
            legs_at(plant_inverse_clarke(u), legs);
            if (n == 150000) {
                const phases_flow_t empty = {.iron_j = 0.0};
                flow = empty;
            }
            phases_advance(&phases, &state, legs, 1e-6, &flow);
        }
        iron_j[k] = flow.iron_j;
    }
    TEST_ASSERT_TRUE(iron_j[1] > 0.1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * iron_j[1], iron_j[1], iron_j[0]);
}

void test_an_open_leg_has_zero_current_and_its_terminal_the_back_emf(void)
{
    const pmsm_params_t params = plain_machine();
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    const double omega = 400.0;
    const phases_t phases = phases_at(&machine, omega);
    const pmsm_state_t rotor = pmsm_at_rest(0.15);
    phases_state_t state = phases_from(&phases, &rotor);
    const phases_leg_t legs[PHASES] = {{.open = true}, {.open = true}, {.open = true}};
    phases_flow_t flow = {.iron_j = 0.0};
    for (int k = 0; k < 1000; k++) {
        phases_advance(&phases, &state, legs, 1e-6, &flow);
        double current_a[PHASES];
        double end_v[PHASES];
        phases_terminals(&phases, &state, legs, current_a, end_v);
        const double angle = 2.0 * 3.14159265358979 * 0.15 + omega * 1e-6 * (k + 1);
        for (int x = 0; x < PHASES; x++) {
            TEST_ASSERT_EQUAL_DOUBLE(0.0, current_a[x]);
            /* d/dt psi cos(angle - x 120 deg) */
            TEST_ASSERT_DOUBLE_WITHIN(0.02, -omega * 0.02 * sin(angle - x * 2.0943951023931953),
                                      end_v[x]);
        }
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, flow.torque_nms);
}

/* Iron losses included, so a current flows in the windings although none does in the wires. */
static void coast_at(const pmsm_params_t *params, double omega_rad_s)
{
    const pmsm_t machine = pmsm_at_temperature(params, 25.0);
    const phases_t phases = phases_at(&machine, omega_rad_s);
    const pmsm_state_t rotor = pmsm_at_rest(0.15);
    phases_state_t steps = phases_from(&phases, &rotor);
    const phases_leg_t legs[PHASES] = {{.open = true}, {.open = true}, {.open = true}};
    phases_flow_t settling = {.iron_j = 0.0};
    TEST_ASSERT_EQUAL(omega_rad_s == 0.0, phases_coast(&phases, &steps, 1000.0, STEP_S, &settling));
    for (int k = 0; k < 1000; k++) {
        phases_advance(&phases, &steps, legs, 1e-7, &settling);
    }
    phases_state_t once = steps;
    phases_flow_t of_steps = {.iron_j = 0.0};
    phases_flow_t of_once = {.iron_j = 0.0};
    for (int k = 0; k < 500; k++) {
        phases_advance(&phases, &steps, legs, 1e-7, &of_steps);
    }
    TEST_ASSERT_TRUE(phases_coast(&phases, &once, 1000.0, STEP_S, &of_once));
    for (int x = 0; x < PHASES; x++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, steps.flux_wb[x], once.flux_wb[x]);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, once.current_a[x]);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, steps.axis.cos, once.axis.cos);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, steps.axis.sin, once.axis.sin);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15 + 1e-6 * fabs(of_steps.iron_j), of_steps.iron_j,
                              of_once.iron_j);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15 + 1e-6 * fabs(of_steps.torque_nms), of_steps.torque_nms,
                              of_once.torque_nms);
    TEST_ASSERT_EQUAL(omega_rad_s != 0.0, of_once.iron_j > 1e-6);
}

void test_open_windings_coast_at_once_to_where_small_steps_take_them(void)
{
    const pmsm_params_t salient = salient_machine();
    const pmsm_params_t saturating = saturating_machine();
    coast_at(&salient, 0.0);
    coast_at(&salient, 500.0);
    coast_at(&salient, -900.0);
    coast_at(&saturating, 500.0);
}

void test_windings_do_not_coast_while_current_flows_or_the_emf_may_open_a_diode(void)
{
    const pmsm_params_t params = plain_machine();
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    const phases_t phases = phases_at(&machine, 400.0);
    pmsm_state_t rotor = pmsm_at_rest(0.15);
    const double line_v = sqrt(3.0) * 400.0 * machine.flux_wb;
    phases_flow_t flow = {.iron_j = 0.0};
    phases_state_t state = phases_from(&phases, &rotor);
    const phases_state_t before = state;
    TEST_ASSERT_FALSE(phases_coast(&phases, &state, 0.999 * line_v, STEP_S, &flow));
    TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof(state));
    TEST_ASSERT_FALSE(phases_coast(&phases, &state, 1.001 * line_v, 0.51 / 400.0, &flow));
    TEST_ASSERT_TRUE(phases_coast(&phases, &state, 1.001 * line_v, STEP_S, &flow));
    rotor.i_t.q = 1e-3;
    state = phases_from(&phases, &rotor);
    TEST_ASSERT_FALSE(phases_coast(&phases, &state, 1000.0, STEP_S, &flow));
}
