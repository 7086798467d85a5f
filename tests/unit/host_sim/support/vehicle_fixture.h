/* SPDX-License-Identifier: Apache-2.0 */
/*
 * vehicle_fixture.h: the paper's vehicle ready to run, for tests of the bench and in closed loop.
 *
 * Plant truth comes from tools/motors/lu2013.toml, the controllers' belief from the checked-in
 * image made of it.
 */
#ifndef TEST_VEHICLE_FIXTURE_H
#define TEST_VEHICLE_FIXTURE_H

#include "bench/bench.h"

/* The vehicle of tools/motors/NAME.toml, or of tools/motors/bench, as fixture_vehicle() has the
 * paper's, and the image made of that file. */
bench_params_t fixture_drive(const char *name);
config_t fixture_drive_config(const char *name);

/* Four driven wheels, flat road, no air drag or rolling resistance, 25 degrees everywhere, pedals
 * at rest. */
bench_params_t fixture_vehicle(void);

/* One driven wheel with its share of everything: the same motion and shares, quicker to simulate.
 */
bench_params_t fixture_one_wheel(bench_params_t params);
bench_params_t fixture_quarter_vehicle(void);

/* The checked-in configuration with another strategy (CONFIG_STRATEGY_...) or rotor sensor, sealed
 * anew. */
config_t fixture_config(int32_t strategy);
config_t fixture_config_with_sensor(int32_t strategy, int32_t sensor);

/* Boots, brings to speed; fails the test when a controller does not run. The bench is one for all
 * tests of a program. */
bench_t *fixture_start(const bench_params_t *params, const config_t *config);

/* Runs until the vehicle stands; fails the test when it still moves after limit_s. */
void fixture_run_to_standstill(bench_t *bench, double limit_s);

void fixture_run(bench_t *bench, double duration_s);

#endif
