/* SPDX-License-Identifier: Apache-2.0 */
/*
 * record_cycle CYCLE.csv: drives the paper's vehicle through its urban cycle (scenario ece15) and
 * writes what the first wheel's controller is given into CYCLE_FILE. Prints the digest of what
 * that controller answers; replay_cycle.c on the emulated core must print the same.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "config/bases.h"
#include "cycle.h"
#include "digest.h"
#include "print.h"
#include "unity.h"
#include "vehicle_fixture.h"

enum { POINTS_MAX = 64, LINE_BYTES = 400 };
static const double SPEED_SCALE = 0.75, M_PER_S_IN_KMH = 3.6;
static const double TOLERANCE_KMH = 2.0; /* of the regulation, on speed */

/* A wheel's controller whose inputs are kept. */
typedef struct {
    const config_t *config;
    controller_t controller;
    fast_setpoint_t setpoint;
    fast_output_t next;
    digest_t digest;
    uint32_t mode_steps[PRINT_MODES];
    FILE *file;
} recorded_t;

static const char *cycle_path;
static recorded_t recorded;
static bench_t bench;

void setUp(void) {}

void tearDown(void) {}

static fast_output_t period(void *context, const fast_input_t *in)
{
    recorded_t *r = context;
    const cycle_fast_t kept = cycle_of_fast(in);
    TEST_ASSERT_EQUAL_INT(1, fwrite(&kept, sizeof kept, 1, r->file));
    const fast_output_t active = r->next;
    r->next = *controller_fast_step(&r->controller.fast, r->config, &r->setpoint, in);
    digest_fast(&r->digest, &r->next, &r->controller.fast);
    return active;
}

static slow_output_t millisecond(void *context, const slow_input_t *in)
{
    recorded_t *r = context;
    const cycle_slow_t kept = cycle_of_slow(in);
    TEST_ASSERT_EQUAL_INT(1, fwrite(&kept, sizeof kept, 1, r->file));
    fast_report_t report;
    controller_fast_report(&r->controller.fast, &report);
    const slow_output_t out =
        controller_slow_step(&r->controller.slow, r->config, &report, in, &r->setpoint);
    digest_slow(&r->digest, &out, &r->setpoint);
    r->mode_steps[out.mode]++;
    return out;
}

static driver_trace_t read_cycle(const char *path)
{
    static double time_s[POINTS_MAX], speed_m_per_s[POINTS_MAX];
    int points = 0;
    char line[LINE_BYTES];
    FILE *file = fopen(path, "r");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, path);
    while (fgets(line, sizeof line, file) != NULL) {
        char *rest;
        const double time = strtod(line, &rest);
        if (rest != line && *rest == ',') {
            TEST_ASSERT_LESS_THAN_INT(POINTS_MAX, points);
            time_s[points] = time;
            speed_m_per_s[points] = strtod(rest + 1, NULL) * SPEED_SCALE / M_PER_S_IN_KMH;
            points++;
        }
    }
    TEST_ASSERT_EQUAL_INT(0, fclose(file));
    const driver_trace_t trace = {time_s, speed_m_per_s, points};
    return trace;
}

static bench_params_t vehicle_that_follows(void)
{
    bench_params_t params = fixture_drive("lu2013");
    params.driver.follow_trace = 1.0;
    params.driver.bandwidth_rad_per_s = 2.0;
    params.driver.preview_s = 0.1;
    params.vehicle.rolling_resistance = 0.014;
    params.road.air_density_kg_per_m3 = 1.204;
    params.thermal.active = 1.0;
    return params;
}

static void test_the_cycle_is_simulated_and_recorded(void)
{
    const config_t config = fixture_drive_config("lu2013");
    const bench_params_t params = vehicle_that_follows();
    const driver_trace_t trace = read_cycle(cycle_path);
    TEST_ASSERT_GREATER_THAN_INT(20, trace.points);
    recorded.config = &config;
    controller_init(&recorded.controller, &config, BASES_MODEL_TIMER_Hz);
    recorded.setpoint = controller_initial_setpoint(&config, BASES_MODEL_TIMER_Hz);
    recorded.next.bridge = BRIDGE_OFF;
    digest_begin(&recorded.digest);
    recorded.file = fopen(CYCLE_FILE, "wb");
    TEST_ASSERT_NOT_NULL(recorded.file);
    const wheel_coupling_t coupling = {
        .context = &recorded, .period = period, .millisecond = millisecond};

    bench_init(&bench, &params, &config, &trace);
    bench.wheel[0].coupling = &coupling;
    TEST_ASSERT_EQUAL_INT(BENCH_READY, bench_start(&bench));
    double worst_m_per_s = 0.0;
    const double end_s = trace.time_s[trace.points - 1];
    while (bench.time_s < end_s) {
        bench_period(&bench);
        worst_m_per_s =
            fmax(worst_m_per_s, fabs(bench.vehicle.speed_m_per_s - bench.demand.reference_m_per_s));
    }
    TEST_ASSERT_EQUAL_INT(0, fclose(recorded.file));
    TEST_ASSERT_TRUE(worst_m_per_s * M_PER_S_IN_KMH < TOLERANCE_KMH);
    print_trace(digest_end(&recorded.digest), CYCLE_NAME, recorded.mode_steps);
}

int main(int count, char **arguments)
{
    if (count != 2) {
        fprintf(stderr, "usage: record_cycle CYCLE.csv\n");
        return 2;
    }
    cycle_path = arguments[1];
    UNITY_BEGIN();
    RUN_TEST(test_the_cycle_is_simulated_and_recorded);
    return UNITY_END();
}
