/* SPDX-License-Identifier: Apache-2.0 */
/* The firmware on a bridge that switches edge by edge, beside the same on the averaged one. */
#include "bench/bench.h"

#include <math.h>

#include "unity.h"
#include "vehicle_fixture.h"

void setUp(void) {}

void tearDown(void) {}

typedef struct {
    double torque_nm;
    double copper_w, iron_w, conduction_w, diode_w, switching_w;
    double loss_w;
    double residual;
} braking_t;

static braking_t less(const wheel_totals_t *after, const wheel_totals_t *before, double time_s)
{
    braking_t out = {
        .torque_nm = (after->torque_impulse_nms - before->torque_impulse_nms) / time_s,
        .copper_w = (after->copper_j - before->copper_j) / time_s,
        .iron_w = (after->iron_j - before->iron_j) / time_s,
        .conduction_w = (after->conduction_j - before->conduction_j) / time_s,
        .diode_w = (after->diode_j - before->diode_j) / time_s,
        .switching_w = (after->switching_j - before->switching_j) / time_s,
    };
    out.loss_w = out.copper_w + out.iron_w + out.conduction_w + out.diode_w + out.switching_w;
    return out;
}

/* Half a second of braking from 8 m/s, of the motor alone. */
static braking_t brake(double demand_nm, double switching, double delay_s)
{
    bench_params_t params = fixture_quarter_vehicle();
    params.run.initial_speed_m_per_s = 8.0;
    params.driver.brake_demand_nm = demand_nm;
    params.inverter.switching = switching;
    params.sensors.current_noise_a = 0.0;
    params.sensors.bus_voltage_noise_v = 0.0;
    params.sensors.sampling_delay_s = delay_s;
    const config_t config =
        fixture_config_with_sensor(CONFIG_STRATEGY_SERIES_OPTIMAL, CONFIG_ROTOR_ANGLE);
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.3);
    const wheel_totals_t before = bench->wheel[0].totals;
    fixture_run(bench, 0.5);
    braking_t out = less(&bench->wheel[0].totals, &before, 0.5);
    const ledger_t all = bench_ledger(bench);
    out.residual = fabs(all.residual_j) / all.turned_over_j;
    return out;
}

void test_braking_on_averaged_and_switching_bridge_agrees(void)
{
    const double demand_nm = 15.0;
    const braking_t averaged = brake(demand_nm, 0.0, 0.0);
    const braking_t switched = brake(demand_nm, 1.0, 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.05 * demand_nm, -demand_nm, averaged.torque_nm);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * demand_nm, averaged.torque_nm, switched.torque_nm);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * averaged.loss_w, averaged.loss_w, switched.loss_w);
    TEST_ASSERT_TRUE(switched.residual < 1e-5);
}

/*
 * A dead time puts off one edge of every pulse, so the pulses come half a dead time late and the
 * top of the count lies as much before the middle of the time in which all low sides conduct. There
 * the back-EMF E lets the current fall, E/L: a sample at the top is E/L t_d/2 over the mean, and
 * the braking torque too large by 3/2 p psi of that. Sampled half a dead time later, the firmware
 * does on this bridge what it does on the averaged one.
 */
void test_a_sample_at_the_counter_top_is_early_by_half_a_dead_time(void)
{
    const bench_params_t params = fixture_quarter_vehicle();
    const double half_dead_s = 0.5 * params.inverter.dead_time_s;
    const double omega_rad_s = 7.9 / params.vehicle.wheel_radius_m * params.motor.pole_pairs;
    const double slope_a_per_s =
        omega_rad_s * params.motor.flux_linkage_wb / params.motor.q_inductance_h;
    const double too_much_nm =
        1.5 * params.motor.pole_pairs * params.motor.flux_linkage_wb * slope_a_per_s * half_dead_s;
    /* At an edge a phase in line with its voltage E deviates by sqrt(3)/12 E T/L where it passes
     * through zero; a triangle's square is a third of its amplitude's on average, and this is not
     * the largest one. */
    const double ripple_a = sqrt(3.0) / 12.0 * slope_a_per_s / params.inverter.pwm_frequency_hz;
    const double ripple_a2 = 0.5 * ripple_a * ripple_a;
    const double demands_nm[] = {2.0, 5.0, 40.0};
    for (int k = 0; k < 3; k++) {
        const braking_t averaged = brake(demands_nm[k], 0.0, 0.0);
        const braking_t at_top = brake(demands_nm[k], 1.0, 0.0);
        const braking_t later = brake(demands_nm[k], 1.0, half_dead_s);
        TEST_ASSERT_DOUBLE_WITHIN(0.3 * too_much_nm, -too_much_nm,
                                  at_top.torque_nm - later.torque_nm);
        /* Legs whose ripple takes them through zero at every edge are not late at all: a few
         * hundredths of a newton-metre. */
        TEST_ASSERT_DOUBLE_WITHIN(fmax(0.01 * demands_nm[k], 0.03), averaged.torque_nm,
                                  later.torque_nm);
        TEST_ASSERT_DOUBLE_WITHIN(0.002 * averaged.loss_w, averaged.loss_w, later.loss_w);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * averaged.copper_w +
                                      1.5 * params.motor.phase_resistance_ohm * ripple_a2,
                                  averaged.copper_w, later.copper_w);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * averaged.iron_w, averaged.iron_w, later.iron_w);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * averaged.conduction_w +
                                      1.5 * params.inverter.diode_resistance_ohm * ripple_a2,
                                  averaged.conduction_w, later.conduction_w);
        const double share = demands_nm[k] < 5.0
                                 ? 0.1
                                 : 0.01; /* |i| of a current that changes its sign twice a period */
        TEST_ASSERT_DOUBLE_WITHIN(share * averaged.diode_w, averaged.diode_w, later.diode_w);
        TEST_ASSERT_DOUBLE_WITHIN(share * averaged.switching_w, averaged.switching_w,
                                  later.switching_w);
    }
}
