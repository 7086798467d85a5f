/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A fault at 34 km/h whose rotor sensor shows standstill: no acknowledgement while the wheel turns,
 * whatever the sensor.
 */
#include "unity.h"
#include "vehicle_fixture.h"

static const double SPEED_M_PER_S = 34.0 / 3.6;
static const double FAULT_S = 0.3;
static const double WATCHED_S = 3.0;

/* Stands between one wheel's plant and its controller. */
typedef struct {
    wheel_t *wheel;
    const config_t *config;
    fast_output_t next;
    bool break_input;
    int milliseconds;
} between_t;

static between_t between;

void setUp(void) {}

void tearDown(void) {}

static fast_output_t period(void *context, const fast_input_t *in)
{
    between_t *own = context;
    fast_input_t changed = *in;
    changed.power_stage_fault = own->break_input;
    const fast_output_t now = own->next;
    own->next = *controller_fast_step(&own->wheel->controller.fast, own->config,
                                      &own->wheel->to_fast, &changed);
    return now;
}

/* No demand, and the acknowledgement every 100 ms. */
static slow_output_t millisecond(void *context, const slow_input_t *in)
{
    between_t *own = context;
    slow_input_t changed = *in;
    changed.demand.drive_torque_mNm = 0;
    changed.demand.brake_torque_mNm = 0;
    changed.demand.fault_reset = own->milliseconds++ / 50 % 2 == 1;
    fast_report_t report;
    controller_fast_report(&own->wheel->controller.fast, &report);
    return controller_slow_step(&own->wheel->controller.slow, own->config, &report, &changed,
                                &own->wheel->to_fast);
}

static void run_at_speed(bench_t *bench, double duration_s)
{
    for (double s = 0.0; s < duration_s; s += bench->world.step_s) {
        bench->vehicle.speed_m_per_s = SPEED_M_PER_S;
        bench->vehicle.acceleration_m_per_s2 = 0.0;
        bench_period(bench);
    }
}

static void assert_not_acknowledged_while_turning(int32_t sensor, bool frozen)
{
    bench_params_t params = fixture_one_wheel(fixture_vehicle());
    params.run.initial_speed_m_per_s = SPEED_M_PER_S;
    const config_t config = fixture_config_with_sensor(CONFIG_STRATEGY_SERIES_OPTIMAL, sensor);
    bench_t *bench = fixture_start(&params, &config);
    static const wheel_coupling_t COUPLING = {
        .context = &between, .period = period, .millisecond = millisecond};
    wheel_t *wheel = &bench->wheel[0];
    const between_t start = {.wheel = wheel, .config = bench->world.config, .next = wheel->next};
    between = start;
    wheel->coupling = &COUPLING;
    run_at_speed(bench, FAULT_S);
    between.break_input = true;
    bench->params.fault.rotor_frozen = frozen ? 1.0 : 0.0;
    bench_refresh(bench);
    run_at_speed(bench, 0.01);
    between.break_input = false;
    TEST_ASSERT_EQUAL_INT(MODE_FAULT, wheel->slow.mode);
    run_at_speed(bench, 0.2);
    /* The sensor in question is of no help: it shows what it would show at standstill. */
    TEST_ASSERT_EQUAL(frozen, wheel->slow.speed_mrad_s < config.brake.blend_out_end_mrad_s);
    for (double s = 0.0; s < WATCHED_S; s += 0.01) {
        run_at_speed(bench, 0.01);
        TEST_ASSERT_EQUAL_INT(MODE_FAULT, wheel->slow.mode);
        TEST_ASSERT_EQUAL_INT(REASON_HARDWARE_BREAK, wheel->slow.fault_reason);
        TEST_ASSERT_EQUAL_INT(WAITS_FOR_REST, wheel->slow.waits_for);
    }
}

void test_frozen_halls_do_not_permit_an_acknowledgement_at_34_km_h(void)
{
    assert_not_acknowledged_while_turning(CONFIG_ROTOR_HALL, true);
}

void test_a_frozen_angle_does_not_permit_an_acknowledgement_at_34_km_h(void)
{
    assert_not_acknowledged_while_turning(CONFIG_ROTOR_ANGLE, true);
}

void test_a_healthy_sensor_does_not_permit_an_acknowledgement_at_34_km_h(void)
{
    assert_not_acknowledged_while_turning(CONFIG_ROTOR_HALL, false);
}
