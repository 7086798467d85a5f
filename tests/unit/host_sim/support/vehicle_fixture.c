/* SPDX-License-Identifier: Apache-2.0 */
#include "vehicle_fixture.h"

#include <stddef.h>
#include <string.h>

#include "config/validate.h"
#include "plant_values.h"
#include "unity.h"

extern const config_t CONFIG_LU2013, CONFIG_EBIKE36V, CONFIG_SCOOTER48V, CONFIG_IPM400V,
    CONFIG_WHEEL24V;

static bench_t bench;

static void set(bench_params_t *params, const char *name, double value)
{
    const int index = parameters_find(name);
    TEST_ASSERT_TRUE_MESSAGE(index >= 0, name);
    TEST_ASSERT_TRUE_MESSAGE(parameters_set(params, index, value), name);
}

static const plant_drive_t *drive_named(const char *name)
{
    for (int k = 0; k < PLANT_DRIVES_COUNT; k++) {
        if (strcmp(PLANT_DRIVES[k].name, name) == 0) {
            return &PLANT_DRIVES[k];
        }
    }
    TEST_FAIL_MESSAGE(name);
    return NULL;
}

bench_params_t fixture_drive(const char *name)
{
    bench_params_t params = {.run = {.seed = 1.0}};
    const plant_drive_t *drive = drive_named(name);
    for (int k = 0; k < drive->count; k++) {
        set(&params, drive->values[k].name, drive->values[k].value);
    }
    TEST_ASSERT_TRUE(curve_set(&params.battery.open_circuit_voltage_v, drive->soc, drive->voltage_v,
                               drive->voltage_points));
    set(&params, "vehicle.rolling_resistance", 0.0);
    set(&params, "road.gravity_m_per_s2", 9.81);
    set(&params, "driver.bandwidth_rad_per_s", 1.0);
    set(&params, "driver.preview_s", 0.4);
    set(&params, "driver.most_drive_nm", 40.0);
    set(&params, "driver.most_brake_nm", 340.0);
    set(&params, "driver.enable", 1.0);
    set(&params, "driver.direction", 1.0);
    set(&params, "thermal.winding_temperature_c", 25.0);
    set(&params, "thermal.switch_temperature_c", 25.0);
    set(&params, "thermal.ambient_temperature_c", 25.0);
    set(&params, "run.record_interval_s", 0.01);
    set(&params, "run.rotor_spread_turn", 0.23);
    return params;
}

config_t fixture_drive_config(const char *name)
{
    static const config_t *const IMAGES[] = {&CONFIG_LU2013, &CONFIG_EBIKE36V, &CONFIG_SCOOTER48V,
                                             &CONFIG_IPM400V, &CONFIG_WHEEL24V};
    for (int k = 0; k < (int)(sizeof IMAGES / sizeof IMAGES[0]); k++) {
        if (strcmp(IMAGES[k]->name, name) == 0) {
            return *IMAGES[k];
        }
    }
    TEST_FAIL_MESSAGE(name);
    return CONFIG_LU2013;
}

bench_params_t fixture_vehicle(void)
{
    return fixture_drive("lu2013");
}

bench_params_t fixture_one_wheel(bench_params_t params)
{
    const double wheels = params.vehicle.driven_wheels;
    params.vehicle.driven_wheels = 1.0;
    params.vehicle.mass_kg /= wheels;
    params.vehicle.frontal_area_m2 /= wheels;
    params.battery.series_resistance_ohm *= wheels;
    params.battery.polarisation_resistance_ohm *= wheels;
    params.battery.polarisation_capacitance_f /= wheels;
    params.battery.capacity_ah /= wheels;
    /* The current limits stay the whole pack's: the controller divides by the wheels its
     * configuration names. */
    return params;
}

bench_params_t fixture_quarter_vehicle(void)
{
    return fixture_one_wheel(fixture_vehicle());
}

config_t fixture_config_with_sensor(int32_t strategy, int32_t sensor)
{
    config_t config = CONFIG_LU2013;
    config.brake.strategy = strategy;
    config.rotor.sensor = sensor;
    config.crc32 = config_crc32(&config, (uint32_t)offsetof(config_t, crc32));
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, config_validate(&config, sizeof(config)).code);
    return config;
}

config_t fixture_config(int32_t strategy)
{
    return fixture_config_with_sensor(strategy, CONFIG_LU2013.rotor.sensor);
}

bench_t *fixture_start(const bench_params_t *params, const config_t *config)
{
    const driver_trace_t none = {.points = 0};
    bench_init(&bench, params, config, &none);
    TEST_ASSERT_EQUAL_INT(BENCH_READY, bench_start(&bench));
    return &bench;
}

void fixture_run(bench_t *b, double duration_s)
{
    const double until_s = b->time_s + duration_s - 1e-9;
    while (b->time_s < until_s) {
        bench_period(b);
    }
}

void fixture_run_to_standstill(bench_t *b, double limit_s)
{
    b->params.run.stop_at_standstill = 1.0;
    while (!bench_has_ended(b)) {
        TEST_ASSERT_TRUE_MESSAGE(b->time_s < limit_s, "the vehicle still moves");
        bench_period(b);
    }
}
