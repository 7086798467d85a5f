/* SPDX-License-Identifier: Apache-2.0 */
/* Voltage that opposes the current of each phase: closed-form solutions at standstill, order of the
 * integration scheme, energy balance. */
#include "plant/pmsm.h"

#include <math.h>

#include "machines.h"
#include "unity.h"

static const double PERIOD_S = 50e-6;
static const double VOLTS = 1.5;
static const double ZONE_A = 2.0;

void setUp(void) {}

void tearDown(void) {}

static pmsm_step_t step_of(double omega_rad_s, double duration_s)
{
    const pmsm_step_t out = {.omega_rad_s = omega_rad_s,
                             .duration_s = duration_s,
                             .opposition = {.volts = VOLTS, .zone_a = ZONE_A}};
    return out;
}

/* Free decay of a current along phase a, rotor at standstill at angle 0. */
static pmsm_state_t with_current(double current_a)
{
    pmsm_state_t out = pmsm_at_rest(0.0);
    out.i_t.d = current_a;
    out.terminal.alpha = current_a;
    return out;
}

/* Phases i, -i/2, -i/2: signs +, -, - are a vector of 4/3, so L di/dt = -R i - 4/3 V while all are
 * outside the zone. */
void test_outside_the_zone_the_full_voltage_opposes_the_current(void)
{
    const pmsm_params_t params = plain_machine();
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    pmsm_state_t state = with_current(30.0);
    const plant_ab_t zero = {0.0, 0.0};
    const pmsm_step_t step = step_of(0.0, PERIOD_S);
    const double end_a = -4.0 / 3.0 * VOLTS / params.phase_resistance_ohm;
    const double per_s = params.phase_resistance_ohm / params.d_inductance_h;
    double current_a = 30.0;
    for (int k = 1; k <= 20; k++) {
        const pmsm_flow_t flow = pmsm_step(&machine, &state, zero, &step);
        const double before_a = current_a;
        current_a = end_a + (30.0 - end_a) * exp(-k * PERIOD_S * per_s);
        TEST_ASSERT_TRUE(0.5 * current_a > ZONE_A);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, current_a, state.terminal.alpha);
        /* The sum of |i_x| is twice the largest; its integral lies between those of a chord and a
         * step. */
        TEST_ASSERT_DOUBLE_WITHIN((before_a - current_a) * PERIOD_S, 2.0 * current_a * PERIOD_S,
                                  flow.opposed_as);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, -VOLTS * flow.opposed_as, flow.source_j);
    }
}

/* Inside the zone each phase has the additional resistance V/zone. While b and c are inside and a
 * is outside, the factor is (2 + i/zone)/3. This gives three exponentials in sequence. */
static double left_after(double time_s, double current_a, const pmsm_params_t *params)
{
    const double more_ohm = VOLTS / ZONE_A;
    const double r[] = {params->phase_resistance_ohm, params->phase_resistance_ohm + more_ohm / 3.0,
                        params->phase_resistance_ohm + more_ohm};
    const double v[] = {4.0 / 3.0 * VOLTS, 2.0 / 3.0 * VOLTS, 0.0};
    const double until_a[] = {2.0 * ZONE_A, ZONE_A, 0.0};
    double i = current_a;
    double left_s = time_s;
    for (int k = 0; k < 3; k++) {
        const double end_a = -v[k] / r[k];
        const double tau_s = params->d_inductance_h / r[k];
        const double needed_s =
            k < 2 && i > until_a[k] ? tau_s * log((i - end_a) / (until_a[k] - end_a)) : 0.0;
        const double spent_s = k < 2 ? fmin(needed_s, left_s) : left_s;
        i = end_a + (i - end_a) * exp(-spent_s / tau_s);
        left_s -= spent_s;
    }
    return i;
}

void test_the_current_in_the_zone_follows_three_exponentials(void)
{
    const pmsm_params_t params = plain_machine();
    const pmsm_t machine = pmsm_at_temperature(&params, 25.0);
    const plant_ab_t zero = {0.0, 0.0};
    const double steps_s[] = {PERIOD_S, PERIOD_S / 10.0};
    /* A change of slope inside a step gives an error of up to an eighth of the change times h^2:
     * V/zone/L * (V/L) h^2 / 8, two thirds. */
    const double tolerances_a[] = {0.04, 0.0004};
    for (int n = 0; n < 2; n++) {
        pmsm_state_t state = with_current(9.0);
        const pmsm_step_t step = step_of(0.0, steps_s[n]);
        for (int k = 1; k * steps_s[n] < 2e-3; k++) {
            pmsm_step(&machine, &state, zero, &step);
            TEST_ASSERT_DOUBLE_WITHIN(tolerances_a[n], left_after(k * steps_s[n], 9.0, &params),
                                      state.terminal.alpha);
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, state.terminal.beta);
        }
        TEST_ASSERT_TRUE(fabs(state.terminal.alpha) < 0.01);
    }
}

/* Rotor turning, iron loss, phases always inside the zone, at the largest zone a bench has: the
 * terminal current is i_t + G e, and the energy balance of the source closes. */
void test_energy_is_conserved_inside_the_zone(void)
{
    const double w = 60.0;
    const pmsm_params_t salient = salient_machine();
    pmsm_params_t round = salient;
    round.q_inductance_h = round.d_inductance_h;
    const pmsm_params_t *const both[] = {&salient, &round};
    for (int n = 0; n < 2; n++) {
        TEST_ASSERT_TRUE(both[n]->iron_loss_resistance_ohm > 0.0);
        const pmsm_t machine = pmsm_at_temperature(both[n], 25.0);
        pmsm_step_t step = {.omega_rad_s = w, .duration_s = PERIOD_S};
        pmsm_state_t state = pmsm_at_rest(0.1);
        step.opposition.volts = VOLTS;
        step.opposition.zone_a = VOLTS * pmsm_amperes_per_volt(&machine, &state, &step);
        double residual_j = 0.0;
        double turned_over_j = 0.0;
        for (int k = 0; k < 400; k++) {
            /* against the back-EMF, so that little current flows */
            const plant_phasor_t axis = plant_phasor_of_turn(state.theta_turn);
            const plant_dq_t emf = {.d = 0.0, .q = w * machine.flux_wb + (k % 40 < 20 ? 0.2 : 0.1)};
            const double before_j = pmsm_magnetic_energy_j(&machine, &state);
            const pmsm_flow_t flow =
                pmsm_step(&machine, &state, plant_inverse_park(emf, axis), &step);
            const double work_j = flow.torque_nms * w / both[n]->pole_pairs;
            const double gained_j = pmsm_magnetic_energy_j(&machine, &state) - before_j;
            residual_j +=
                flow.source_j - flow.copper_j - flow.series_j - flow.iron_j - work_j - gained_j;
            turned_over_j += fabs(flow.source_j) + fabs(flow.iron_j) + fabs(work_j);
            TEST_ASSERT_TRUE(hypot(state.terminal.alpha, state.terminal.beta) <
                             0.5 * step.opposition.zone_a);
        }
        TEST_ASSERT_TRUE(turned_over_j > 1e-4);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, residual_j / turned_over_j);
    }
}

typedef struct {
    double error_a;    /* largest error of the terminal current at the end of a period */
    double residual;   /* relative to the energy exchanged */
    double opposed_as; /* smallest of a step */
} turning_t;

/* Small currents on a turning rotor, phases enter and leave the zone repeatedly: against steps an
 * eighth as long. */
static turning_t turn(const pmsm_params_t *params, int pieces)
{
    const pmsm_t machine = pmsm_at_temperature(params, 25.0);
    pmsm_state_t coarse = pmsm_at_rest(0.1);
    pmsm_state_t fine = coarse;
    const double omega = 700.0;
    const pmsm_step_t coarse_step = step_of(omega, PERIOD_S / pieces);
    const pmsm_step_t fine_step = step_of(omega, PERIOD_S / (8 * pieces));
    turning_t out = {.error_a = 0.0};
    double turned_over_j = 0.0;
    double residual_j = 0.0;
    for (int k = 0; k < 2000; k++) {
        const double middle = PLANT_TWO_PI * fine.theta_turn + 0.5 * omega * PERIOD_S;
        const plant_ab_t u = {.alpha = -15.5 * sin(middle + 0.02),
                              .beta = 15.5 * cos(middle + 0.02)};
        for (int n = 0; n < pieces; n++) {
            const double before_j = pmsm_magnetic_energy_j(&machine, &coarse);
            const pmsm_flow_t flow = pmsm_step(&machine, &coarse, u, &coarse_step);
            const double work_j = flow.torque_nms * omega / params->pole_pairs;
            residual_j += fabs(flow.source_j - flow.copper_j - flow.series_j - flow.iron_j -
                               work_j - (pmsm_magnetic_energy_j(&machine, &coarse) - before_j));
            turned_over_j += fabs(flow.source_j);
            out.opposed_as = fmin(out.opposed_as, flow.opposed_as);
        }
        for (int n = 0; n < 8 * pieces; n++) {
            pmsm_step(&machine, &fine, u, &fine_step);
        }
        out.error_a = fmax(out.error_a, hypot(coarse.terminal.alpha - fine.terminal.alpha,
                                              coarse.terminal.beta - fine.terminal.beta));
    }
    out.residual = residual_j / turned_over_j;
    return out;
}

void test_small_currents_are_integrated_through_the_zone_with_a_closed_energy_balance(void)
{
    const pmsm_params_t machines[] = {salient_machine(), saturating_machine()};
    for (int m = 0; m < 2; m++) {
        const turning_t whole = turn(&machines[m], 1);
        const turning_t half = turn(&machines[m], 2);
        TEST_ASSERT_TRUE(whole.error_a < 0.01);
        TEST_ASSERT_TRUE(half.error_a <
                         0.35 * whole.error_a); /* at changes of slope: second order at least */
        TEST_ASSERT_TRUE(whole.residual < 1e-4);
        TEST_ASSERT_TRUE(whole.opposed_as >= 0.0);
    }
}
