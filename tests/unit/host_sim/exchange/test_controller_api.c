/* SPDX-License-Identifier: Apache-2.0 */
/* The interface for other languages: what is refused, in which words, and that a refused call
 * changes nothing. */
#include "config/bases.h"
#include "exchange/controller_api.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "config/config.h"
#include "unity.h"
#include "vehicle_fixture.h"

enum { FAST_INPUTS = 10, FAST_OUTPUTS = 4, SLOW_INPUTS = 23 };
static hubsim_controller_t *controller;
static config_t config;

void setUp(void)
{
    controller = hubsim_controller_new();
    TEST_ASSERT_NOT_NULL(controller);
    config = fixture_config(CONFIG_STRATEGY_SERIES_OPTIMAL);
    TEST_ASSERT_EQUAL_INT(0, hubsim_controller_load_config(controller, &config, sizeof(config)));
}

void tearDown(void)
{
    hubsim_controller_delete(controller);
}

void test_the_ports_have_the_sizes_assumed_by_these_tests(void)
{
    TEST_ASSERT_EQUAL_INT(FAST_INPUTS, hubsim_variable_count(HUBSIM_PORT_FAST_INPUT));
    TEST_ASSERT_EQUAL_INT(FAST_OUTPUTS, hubsim_variable_count(HUBSIM_PORT_FAST_OUTPUT));
    TEST_ASSERT_EQUAL_INT(SLOW_INPUTS, hubsim_variable_count(HUBSIM_PORT_SLOW_INPUT));
    TEST_ASSERT_EQUAL_INT(0, hubsim_variable_count(7));
    TEST_ASSERT_NULL(hubsim_variable_name(HUBSIM_PORT_FAST_INPUT, FAST_INPUTS));
    TEST_ASSERT_NULL(hubsim_variable_name(-1, 0));
    TEST_ASSERT_EQUAL_INT32(config.drive.pwm_frequency_Hz,
                            hubsim_controller_fast_rate_hz(controller));
}

void test_a_step_without_a_configuration_is_refused(void)
{
    hubsim_controller_t *fresh = hubsim_controller_new();
    const double in[FAST_INPUTS] = {0.0};
    double out[FAST_OUTPUTS];
    TEST_ASSERT_EQUAL_INT(-1, hubsim_controller_fast_step(fresh, in, out));
    TEST_ASSERT_EQUAL_STRING("no configuration was loaded", hubsim_controller_error(fresh));
    TEST_ASSERT_EQUAL_INT32(0, hubsim_controller_fast_rate_hz(fresh));
    hubsim_controller_delete(fresh);
}

void test_a_damaged_configuration_is_refused_and_the_previous_one_stays(void)
{
    config_t damaged = config;
    damaged.motor.pole_pairs++;
    TEST_ASSERT_EQUAL_INT(-1, hubsim_controller_load_config(controller, &damaged, sizeof(damaged)));
    TEST_ASSERT_NOT_NULL(strstr(hubsim_controller_error(controller), "configuration refused"));
    TEST_ASSERT_EQUAL_INT(-1, hubsim_controller_load_config(controller, &config, 16));
    TEST_ASSERT_EQUAL_INT32(config.drive.pwm_frequency_Hz,
                            hubsim_controller_fast_rate_hz(controller));
}

void test_a_nan_is_refused_with_its_name_and_no_step_runs(void)
{
    const uint32_t size = hubsim_controller_state_bytes();
    void *before = malloc(size);
    void *after = malloc(size);
    TEST_ASSERT_EQUAL_INT(0, hubsim_controller_save(controller, before));
    double in[FAST_INPUTS] = {0.0};
    double out[FAST_OUTPUTS];
    in[3] = NAN;
    TEST_ASSERT_EQUAL_INT(-1, hubsim_controller_fast_step(controller, in, out));
    TEST_ASSERT_EQUAL_STRING("bus_voltage_v: not a finite number",
                             hubsim_controller_error(controller));
    int32_t raw[FAST_INPUTS] = {0};
    int32_t raw_out[FAST_OUTPUTS];
    raw[0] = 4096;
    TEST_ASSERT_EQUAL_INT(-1, hubsim_controller_fast_step_raw(controller, raw, raw_out));
    TEST_ASSERT_EQUAL_STRING("phase_current_code_a: 4096, accepted: 0 to 4095",
                             hubsim_controller_error(controller));
    TEST_ASSERT_EQUAL_INT(0, hubsim_controller_save(controller, after));
    TEST_ASSERT_EQUAL_INT(0, memcmp(before, after, size));
    free(before);
    free(after);
}

void test_invalid_state_bytes_are_refused(void)
{
    void *state = calloc(1, hubsim_controller_state_bytes());
    TEST_ASSERT_EQUAL_INT(-1, hubsim_controller_restore(controller, state));
    TEST_ASSERT_EQUAL_STRING("these bytes are no controller's state",
                             hubsim_controller_error(controller));
    free(state);
}

void test_engineering_and_raw_steps_give_the_same_outputs(void)
{
    hubsim_controller_t *other = hubsim_controller_new();
    TEST_ASSERT_EQUAL_INT(0, hubsim_controller_load_config(other, &config, sizeof(config)));
    for (int n = 0; n < 3000; n++) {
        const int32_t raw[FAST_INPUTS] = {
            2048 + n % 40, 2048 - n % 30, 2048 - n % 10, 3400, (n * 30) & 0xFFFF, n, n, 0, 5, 0};
        int32_t raw_out[FAST_OUTPUTS];
        double in[FAST_INPUTS];
        double out[FAST_OUTPUTS];
        for (int k = 0; k < FAST_INPUTS; k++) {
            double zero = 0.0;
            double per_unit = 1.0;
            TEST_ASSERT_EQUAL_INT(0, hubsim_controller_scale(controller, HUBSIM_PORT_FAST_INPUT, k,
                                                             &zero, &per_unit));
            in[k] = (raw[k] - zero) / per_unit;
        }
        TEST_ASSERT_EQUAL_INT(0, hubsim_controller_fast_step_raw(controller, raw, raw_out));
        TEST_ASSERT_EQUAL_INT(0, hubsim_controller_fast_step(other, in, out));
        for (int k = 0; k < FAST_OUTPUTS - 1; k++) {
            TEST_ASSERT_EQUAL_DOUBLE((double)raw_out[k] /
                                         bases_pwm_period_counts(&config, BASES_MODEL_TIMER_Hz),
                                     out[k]);
        }
    }
    hubsim_controller_delete(other);
}
