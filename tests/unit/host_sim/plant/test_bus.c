/* SPDX-License-Identifier: Apache-2.0 */
/* Pack, cable, contactor and capacitor as one circuit: closed-form solutions, conservation of
 * energy, an open contactor. */
#include "plant/bus.h"

#include <math.h>

#include "unity.h"

static const double STEP_S = 50e-6;
static battery_params_t pack;
static bus_params_t params;
static battery_state_t battery;
static bus_state_t bus;

void setUp(void)
{
    const battery_params_t p = {.series_resistance_ohm = 0.02,
                                .polarisation_resistance_ohm = 0.01,
                                .polarisation_capacitance_f = 3000.0,
                                .capacity_ah = 100.0,
                                .initial_soc = 0.5,
                                .open_circuit_voltage_v = curve_constant(50.0)};
    const bus_params_t b = {.capacitance_f = 3e-3, .cable_resistance_ohm = 0.03};
    pack = p;
    params = b;
    battery = battery_init(&pack, STEP_S);
    bus = bus_init(&battery);
}

void tearDown(void) {}

/* Sources less sinks less storage of a number of steps, and the heat of pack and cable. */
static double run(int steps, double dc_j, double *pack_heat_j, double *cable_heat_j)
{
    const double stored_j = battery_stored_j(&pack, &battery) + bus_stored_j(&params, &bus);
    double left_j = 0.0;
    *pack_heat_j = 0.0;
    *cable_heat_j = 0.0;
    for (int k = 0; k < steps; k++) {
        const bus_flow_t flow = bus_step(&params, &bus, &pack, &battery, dc_j);
        left_j += flow.battery.chemical_j - flow.battery.heat_j - flow.cable_j - dc_j;
        *pack_heat_j += flow.battery.heat_j;
        *cable_heat_j += flow.cable_j;
    }
    return left_j - (battery_stored_j(&pack, &battery) + bus_stored_j(&params, &bus) - stored_j);
}

void test_without_capacitor_and_cable_the_result_is_bit_identical_to_the_pack(void)
{
    params.capacitance_f = 0.0;
    params.cable_resistance_ohm = 0.0;
    battery_state_t alone = battery;
    for (int k = 0; k < 100; k++) {
        const double dc_j = 0.1 * sin(0.3 * k);
        const battery_flow_t expected = battery_step(&pack, &alone, dc_j);
        const bus_flow_t flow = bus_step(&params, &bus, &pack, &battery, dc_j);
        TEST_ASSERT_EQUAL_MEMORY(&expected, &flow.battery, sizeof(expected));
        TEST_ASSERT_EQUAL_DOUBLE(alone.terminal_v, bus.voltage_v);
    }
}

void test_without_a_capacitor_the_cable_is_a_series_resistance(void)
{
    params.capacitance_f = 0.0;
    const bus_flow_t flow = bus_step(&params, &bus, &pack, &battery, 1000.0 * STEP_S);
    const double i = battery.current_a;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1000.0, bus.voltage_v * i);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.03 * i * i * STEP_S, flow.cable_j);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 50.0 - 0.05 * i, bus.voltage_v);
}

void test_charging_an_empty_capacitor_is_exponential_and_dissipates_the_stored_energy(void)
{
    /* RC charging: v = E (1 - exp(-t/RC)); half of the energy drawn is stored and half is heat, at
     * any resistance. */
    pack.polarisation_resistance_ohm = 0.0;
    battery = battery_init(&pack, STEP_S);
    bus.voltage_v = 0.0;
    double pack_heat_j;
    double cable_heat_j;
    const double tau_s = 0.05 * 3e-3;
    run(3, 0.0, &pack_heat_j, &cable_heat_j);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 50.0 * (1.0 - exp(-3.0 * STEP_S / tau_s)), bus.voltage_v);
    double more_pack_j;
    double more_cable_j;
    run(1000, 0.0, &more_pack_j, &more_cable_j);
    const double heat_j = pack_heat_j + cable_heat_j + more_pack_j + more_cable_j;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.5 * 3e-3 * 2500.0, heat_j);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.6 * heat_j, cable_heat_j + more_cable_j);
}

void test_the_steady_state_equals_that_of_the_circuit_without_capacitor(void)
{
    pack.polarisation_resistance_ohm = 0.0;
    battery = battery_init(&pack, STEP_S);
    double pack_heat_j;
    double cable_heat_j;
    run(2000, 2000.0 * STEP_S, &pack_heat_j, &cable_heat_j);
    const double i = 2.0 * 2000.0 / (50.0 + sqrt(2500.0 - 4.0 * 0.05 * 2000.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, i, battery.current_a);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 50.0 - 0.05 * i, bus.voltage_v);
}

void test_energy_is_conserved_for_any_load_and_time_constant(void)
{
    const double capacitances_f[] = {1e-6, 1e-4, 3e-3, 1.0};
    const double resistances_ohm[] = {0.0, 1e-3, 0.03, 0.3};
    for (int c = 0; c < 4; c++) {
        for (int r = 0; r < 4; r++) {
            setUp();
            params.capacitance_f = capacitances_f[c];
            params.cable_resistance_ohm = resistances_ohm[r];
            for (int k = 0; k < 200; k++) {
                double pack_heat_j;
                double cable_heat_j;
                const double dc_j = 0.05 * sin(0.2 * k) + 0.01;
                TEST_ASSERT_DOUBLE_WITHIN(1e-11, 0.0, run(1, dc_j, &pack_heat_j, &cable_heat_j));
                TEST_ASSERT_TRUE(pack_heat_j >= -1e-15 && cable_heat_j >= -1e-15);
            }
            TEST_ASSERT_FALSE(bus.collapsed);
        }
    }
}

void test_with_the_contactor_open_braking_power_charges_the_capacitor(void)
{
    params.contactor_open = 1.0;
    double pack_heat_j;
    double cable_heat_j;
    const double residual_j = run(10, -4000.0 * STEP_S, &pack_heat_j, &cable_heat_j);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, residual_j);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, sqrt(2500.0 + 2.0 * 4000.0 * 10 * STEP_S / 3e-3),
                              bus.voltage_v);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, battery.current_a);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, battery.soc);
}

/* Bridges on a bus that a contactor has left empty it. What they drew too much of in that step is
 * booked, and energy that comes back charges it again. */
void test_discharged_bus_is_empty_and_charges_again(void)
{
    params.contactor_open = 1.0;
    double pack_heat_j;
    double cable_heat_j;
    run(1, 0.5 * 3e-3 * 2500.0 * 0.99, &pack_heat_j, &cable_heat_j);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 5.0, bus.voltage_v);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, cable_heat_j);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, run(1, 1.0, &pack_heat_j, &cable_heat_j));
    TEST_ASSERT_FALSE(bus.collapsed);
    TEST_ASSERT_EQUAL_DOUBLE(0.1, bus.voltage_v);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.5 * 3e-3 * (25.0 - 0.01) - 1.0, cable_heat_j);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, run(1, -1.0, &pack_heat_j, &cable_heat_j));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, sqrt(0.01 + 2.0 / 3e-3), bus.voltage_v);
}
