/* SPDX-License-Identifier: Apache-2.0 */
/* Battery model against its circuit: exact current, exact relaxation, energy balance closed to
 * rounding. */
#include "plant/battery.h"

#include <math.h>

#include "unity.h"

static const double STEP_S = 50e-6;
static battery_params_t params;
static battery_state_t state;

void setUp(void)
{
    const battery_params_t pack = {.series_resistance_ohm = 0.012,
                                   .polarisation_resistance_ohm = 0.010,
                                   .polarisation_capacitance_f = 3000.0,
                                   .capacity_ah = 100.0,
                                   .initial_soc = 0.9,
                                   .max_charge_current_a = 200.0,
                                   .max_discharge_current_a = 250.0,
                                   .open_circuit_voltage_v = curve_constant(53.0)};
    params = pack;
    state = battery_init(&params, STEP_S);
}

void tearDown(void) {}

void test_the_initial_voltage_drop_is_that_of_the_series_resistance(void)
{
    const double power_w = 4000.0;
    battery_step(&params, &state, power_w * STEP_S);
    /* u = E - R i and u i = P */
    const double i = (53.0 - sqrt(53.0 * 53.0 - 4.0 * 0.012 * power_w)) / (2.0 * 0.012);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, i, state.current_a);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 53.0 - 0.012 * i, state.terminal_v);
}

void test_after_many_time_constants_the_loss_is_that_of_both_resistances(void)
{
    const double powers_w[] = {5000.0, -5000.0};
    for (int k = 0; k < 2; k++) {
        battery_state_t long_state = battery_init(&params, 0.1);
        battery_flow_t flow = {.heat_j = 0.0};
        for (int n = 0; n < 6000; n++) { /* 20 time constants of 30 s */
            flow = battery_step(&params, &long_state, powers_w[k] * 0.1);
        }
        const double r = 0.022;
        const double root = sqrt(53.0 * 53.0 - 4.0 * r * powers_w[k]);
        const double loss_w = (53.0 - root) * (53.0 - root) / (4.0 * r);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, loss_w, flow.heat_j / 0.1);
        TEST_ASSERT_DOUBLE_WITHIN(1e-2, powers_w[k] + loss_w, flow.chemical_j / 0.1);
    }
}

void test_polarisation_relaxes_exponentially_at_rest(void)
{
    state.polarisation_v = 0.5;
    for (int k = 0; k < 20000; k++) {
        battery_step(&params, &state, 0.0);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.5 * exp(-1.0 / 30.0), state.polarisation_v);
    TEST_ASSERT_EQUAL_DOUBLE(0.9, state.soc);
}

void test_chemical_energy_is_the_sum_of_terminal_energy_heat_and_polarisation_energy(void)
{
    const double stored_before_j = battery_stored_j(&params, &state);
    double chemical_j = 0.0;
    double terminal_j = 0.0;
    double heat_j = 0.0;
    double asked_j = 0.0;
    for (int k = 0; k < 50000; k++) {
        const double power_w = 6000.0 * sin(0.0007 * k) + 1500.0 * sin(0.11 * k);
        const battery_flow_t flow = battery_step(&params, &state, power_w * STEP_S);
        chemical_j += flow.chemical_j;
        terminal_j += flow.terminal_j;
        heat_j += flow.heat_j;
        asked_j += power_w * STEP_S;
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, asked_j, terminal_j);
    const double gained_j = battery_stored_j(&params, &state) - stored_before_j;
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, chemical_j, terminal_j + heat_j + gained_j);
    TEST_ASSERT_TRUE(heat_j > 0.0);
}

void test_state_of_charge_is_the_integral_of_the_current(void)
{
    params.series_resistance_ohm = 0.0;
    params.polarisation_resistance_ohm = 0.0;
    battery_state_t ideal = battery_init(&params, 1.0);
    for (int k = 0; k < 360; k++) {
        battery_step(&params, &ideal, 53.0 * 50.0); /* 50 A for 360 s = 5 Ah */
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.85, ideal.soc);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 53.0, ideal.terminal_v);
}

void test_the_open_circuit_voltage_follows_its_curve(void)
{
    const double soc[] = {0.0, 0.5, 1.0};
    const double volts[] = {40.0, 50.0, 58.0};
    TEST_ASSERT_TRUE(curve_set(&params.open_circuit_voltage_v, soc, volts, 3));
    params.initial_soc = 0.75;
    const battery_state_t fresh = battery_init(&params, STEP_S);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 54.0, fresh.terminal_v);
}

void test_power_above_the_maximum_is_reported_and_limited_to_the_maximum(void)
{
    const double largest_w = 53.0 * 53.0 / (4.0 * 0.012);
    battery_step(&params, &state, 0.999 * largest_w * STEP_S);
    TEST_ASSERT_FALSE(state.collapsed);
    setUp();
    const battery_flow_t flow = battery_step(&params, &state, 1.2 * largest_w * STEP_S);
    TEST_ASSERT_TRUE(state.collapsed);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * largest_w, largest_w, flow.terminal_j / STEP_S);
}
