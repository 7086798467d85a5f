/* SPDX-License-Identifier: Apache-2.0 */
/* One wheel: timing of the loop, energy accounts, sensor values. */
#include "bench/wheel.h"

#include <math.h>

#include "unity.h"
#include "vehicle_fixture.h"

static bench_t *bench;
static wheel_t *wheel;

void setUp(void)
{
    bench_params_t params = fixture_quarter_vehicle();
    params.run.initial_speed_m_per_s = 6.0;
    config_t config =
        fixture_config_with_sensor(CONFIG_STRATEGY_SERIES_OPTIMAL, CONFIG_ROTOR_ANGLE);
    config.modes.coast_delay_ms = 0; /* PWM also without demand */
    bench = fixture_start(&params, &config);
    wheel = &bench->wheel[0];
}

void tearDown(void) {}

void test_compare_values_act_one_period_after_their_computation(void)
{
    for (int k = 0; k < 100; k++) {
        const fast_output_t computed = wheel->next;
        bench_period(bench);
        TEST_ASSERT_EQUAL_UINT16(computed.compare_counts[0], wheel->active.compare_counts[0]);
        TEST_ASSERT_EQUAL_UINT16(computed.compare_counts[1], wheel->active.compare_counts[1]);
        TEST_ASSERT_EQUAL_UINT16(computed.compare_counts[2], wheel->active.compare_counts[2]);
        TEST_ASSERT_EQUAL_INT(computed.bridge, wheel->active.bridge);
    }
}

void test_the_current_responds_to_a_reference_step_exactly_after_the_delay(void)
{
    /* Between two slow steps the reference is constant: change it by hand, and compare with a twin
     * that keeps it. */
    while (bench->period % 20 != 2) {
        bench_period(bench);
    }
    static bench_t twin;
    twin = *bench;
    bench_refresh(&twin);
    wheel->to_fast.i_reference_pu.q = (int16_t)(wheel->to_fast.i_reference_pu.q + 2000); /* 10 A */
    wheel->to_fast.sequence++; /* a setpoint is applied when its number changes */
    bench_period(bench);       /* samples and computes */
    bench_period(&twin);
    TEST_ASSERT_EQUAL_DOUBLE(twin.wheel[0].rotor.i_t.q, wheel->rotor.i_t.q);
    bench_period(bench); /* acts */
    bench_period(&twin);
    TEST_ASSERT_TRUE(wheel->rotor.i_t.q - twin.wheel[0].rotor.i_t.q > 0.5);
}

void test_one_slow_step_runs_every_twenty_periods(void)
{
    uint16_t last = wheel->to_fast.sequence;
    int64_t at = -1;
    for (int k = 0; k < 400; k++) {
        bench_period(bench);
        if (wheel->to_fast.sequence != last) {
            TEST_ASSERT_EQUAL_UINT16((uint16_t)(last + 1U), wheel->to_fast.sequence);
            TEST_ASSERT_TRUE(at < 0 || bench->period - at == 20);
            at = bench->period;
            last = wheel->to_fast.sequence;
        }
    }
    TEST_ASSERT_TRUE(at > 0);
}

void test_bus_energy_equals_heat_work_and_field_energy(void)
{
    bench->params.driver.drive_demand_nm = 25.0;
    const wheel_totals_t before = wheel->totals;
    const double field_before_j = pmsm_magnetic_energy_j(&wheel->machine, &wheel->rotor);
    fixture_run(bench, 0.5);
    const wheel_totals_t *now = &wheel->totals;
    const double heat_j = now->copper_j - before.copper_j + now->iron_j - before.iron_j +
                          now->conduction_j - before.conduction_j + now->diode_j - before.diode_j +
                          now->switching_j - before.switching_j;
    const double field_j = pmsm_magnetic_energy_j(&wheel->machine, &wheel->rotor) - field_before_j;
    const double dc_j = now->dc_j - before.dc_j;
    TEST_ASSERT_TRUE(dc_j > 100.0);
    /* Where a current passes through the zone in which dead time is undecided, the balance closes
     * to second order only. */
    TEST_ASSERT_DOUBLE_WITHIN(3e-6 * dc_j, dc_j, heat_j + now->shaft_j - before.shaft_j + field_j);
}

void test_the_first_fault_is_recorded_with_its_time(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_NONE, wheel->first_fault);
    bench->params.driver.drive_demand_nm = 25.0; /* an open phase shows by the missing current */
    fixture_run(bench, 0.1);
    bench->params.fault.phase_open = 1.0;
    bench_refresh(bench);
    fixture_run(bench, 0.1);
    TEST_ASSERT_EQUAL_INT(REASON_PHASE_OPEN, wheel->first_fault);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.12, wheel->first_fault_s);
}

void test_losses_heat_the_winding_with_the_thermal_model_on(void)
{
    bench_params_t params = fixture_quarter_vehicle();
    params.run.initial_speed_m_per_s = 6.0;
    params.driver.drive_demand_nm = 30.0;
    params.thermal.active = 1.0;
    params.thermal.winding_heat_capacity_j_per_k = 50.0;
    params.thermal.winding_thermal_resistance_k_per_w = 0.0;
    params.thermal.housing_heat_capacity_j_per_k = 0.0;
    params.thermal.housing_thermal_resistance_k_per_w = 0.0;
    const config_t config = fixture_config(CONFIG_STRATEGY_SERIES_OPTIMAL);
    bench = fixture_start(&params, &config);
    const double cold_ohm = bench->wheel[0].machine.resistance_ohm;
    fixture_run(bench, 1.0);
    const wheel_t *w = &bench->wheel[0];
    TEST_ASSERT_TRUE(w->totals.copper_j > 20.0);
    /* The last millisecond's heat has not been handed over yet. */
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 25.0 + w->totals.copper_j / 50.0, w->winding.temperature_c);
    TEST_ASSERT_TRUE(w->machine.resistance_ohm > cold_ohm);
}
