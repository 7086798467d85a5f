/* The firmware on a bridge that switches edge by edge, beside the same on the averaged one. */
#include "bench/bench.h"

#include <math.h>

#include "unity.h"
#include "vehicle_fixture.h"

void setUp(void) {}

void tearDown(void) {}

typedef struct {
    double torque_nm, loss_w;
    double residual;
} braking_t;

/* Half a second of braking from 8 m/s. */
static braking_t brake(double demand_nm, double switching)
{
    bench_params_t params = fixture_quarter_vehicle();
    params.run.initial_speed_m_per_s = 8.0;
    params.driver.brake_demand_nm = demand_nm;
    params.inverter.switching = switching;
    params.sensors.current_noise_a = 0.0;
    params.sensors.bus_voltage_noise_v = 0.0;
    const config_t config = fixture_config_with_sensor(CONFIG_STRATEGY_SERIES_OPTIMAL, CONFIG_ROTOR_ANGLE);
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.3);
    const ledger_t before = bench_ledger(bench);
    const double impulse_nms = bench->wheel[0].totals.torque_impulse_nms;
    fixture_run(bench, 0.5);
    const ledger_t after = bench_ledger(bench);
    const double loss_j = after.copper_j + after.iron_j + after.conduction_j + after.diode_j + after.switching_j -
                          before.copper_j - before.iron_j - before.conduction_j - before.diode_j - before.switching_j;
    const braking_t out = {
        .torque_nm = (bench->wheel[0].totals.torque_impulse_nms - impulse_nms) / 0.5,
        .loss_w = loss_j / 0.5,
        .residual = fabs(after.residual_j) / after.turned_over_j,
    };
    return out;
}

void test_the_firmware_brakes_alike_on_both_bridges(void)
{
    const double demands_nm[] = {15.0, 40.0};
    for (int k = 0; k < 2; k++) {
        const braking_t averaged = brake(demands_nm[k], 0.0);
        const braking_t switched = brake(demands_nm[k], 1.0);
        TEST_ASSERT_DOUBLE_WITHIN(0.05 * demands_nm[k], -demands_nm[k], averaged.torque_nm);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * demands_nm[k], averaged.torque_nm, switched.torque_nm);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * averaged.loss_w, averaged.loss_w, switched.loss_w);
        TEST_ASSERT_TRUE(switched.residual < 1e-5);
    }
}
