/* SPDX-License-Identifier: Apache-2.0 */
/* State machine of an instance, with an integrator as model: dx/dt = rate. */
#include "fmu/instance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

enum { START, RATE, GAIN, ON, X, VARIABLES };
enum { AT_START = START + 1, AT_RATE = RATE + 1, AT_GAIN = GAIN + 1, AT_ON = ON + 1, AT_X = X + 1 };

const char MODEL_TOKEN[] = "{adder}";
const int MODEL_VARIABLE_COUNT = VARIABLES;
const model_variable_t MODEL_VARIABLES[] = {
    {"start", MODEL_REAL, MODEL_FIXED, 1.0},  {"rate", MODEL_REAL, MODEL_INPUT, 2.0},
    {"gain", MODEL_CODE, MODEL_TUNABLE, 3.0}, {"on", MODEL_FLAG, MODEL_INPUT, 1.0},
    {"x", MODEL_REAL, MODEL_OUTPUT, 0.0},
};
const int MODEL_SETTING_COUNT = 0;
const model_setting_t MODEL_SETTINGS[] = {{"", 0.0}};
const uint32_t MODEL_CONFIG_BYTES = 0;
const unsigned char MODEL_CONFIG[] = {0};
const int MODEL_CURVE_POINTS = 0;
const double MODEL_CURVE_SOC[] = {0.0};
const double MODEL_CURVE_V[] = {0.0};

struct model {
    double x, at_s;
    const char *error;
};

static int begun;
static int living;
static char last_message[300];
static instance_t *instance;

model_t *model_new(void)
{
    model_t *model = calloc(1, sizeof(*model));
    living += model != NULL;
    return model;
}

void model_delete(model_t *model)
{
    living -= model != NULL;
    free(model);
}

const char *model_error(const model_t *model)
{
    return model->error;
}

bool model_begin(model_t *model, double *values)
{
    begun++;
    model->x = values[START];
    values[X] = model->x;
    model->error = "start: below zero";
    return values[START] >= 0.0;
}

bool model_set(model_t *model, int index, double value)
{
    model->error = "gain: too much";
    return index != GAIN || value < 100.0;
}

bool model_advance(model_t *model, double until_s, double *values)
{
    model->x += values[ON] * values[GAIN] * values[RATE] * (until_s - model->at_s);
    model->at_s = until_s;
    values[X] = model->x;
    model->error = "x: left its range";
    return model->x < 1e6;
}

size_t model_state_bytes(void)
{
    return sizeof(struct model);
}

bool model_save(model_t *model, void *state)
{
    memcpy(state, model, sizeof(*model));
    return true;
}

bool model_restore(model_t *model, const void *state)
{
    memcpy(model, state, sizeof(*model));
    return true;
}

static void listen(void *context, const char *message)
{
    TEST_ASSERT_EQUAL_PTR(last_message, context);
    strncpy(last_message, message, sizeof(last_message) - 1);
}

void setUp(void)
{
    begun = 0;
    last_message[0] = '\0';
    instance = instance_new("{adder}", listen, last_message);
    TEST_ASSERT_NOT_NULL(instance);
}

void tearDown(void)
{
    instance_delete(instance);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, living, "a model was left behind");
}

static void begin(double start_s)
{
    TEST_ASSERT_TRUE(instance_enter_initialization(instance, start_s));
    TEST_ASSERT_TRUE(instance_exit_initialization(instance));
}

static double get(uint32_t reference)
{
    double value = NAN;
    TEST_ASSERT_TRUE_MESSAGE(instance_get(instance, reference, MODEL_REAL, &value), last_message);
    return value;
}

void test_instantiation_with_another_token_fails(void)
{
    TEST_ASSERT_NULL(instance_new("{other}", listen, last_message));
    TEST_ASSERT_NULL(instance_new(NULL, NULL, NULL));
    TEST_ASSERT_NOT_NULL(strstr(last_message, "do not belong together"));
}

void test_start_time_is_set_by_the_importer_and_model_time_starts_at_zero(void)
{
    begin(10.0);
    TEST_ASSERT_EQUAL_DOUBLE(10.0, get(0));
    TEST_ASSERT_EQUAL_DOUBLE(1.0, get(AT_X));
    TEST_ASSERT_TRUE(instance_step(instance, 10.0, 0.5));
    TEST_ASSERT_EQUAL_DOUBLE(10.5, get(0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.0 + 3.0 * 2.0 * 0.5, get(AT_X));
}

void test_a_step_must_start_at_the_end_of_the_previous_step(void)
{
    TEST_ASSERT_FALSE(instance_step(instance, 0.0, 1.0));
    begin(0.0);
    TEST_ASSERT_FALSE(instance_step(instance, 0.1, 1.0));
    TEST_ASSERT_FALSE(instance_step(instance, 0.0, 0.0));
    TEST_ASSERT_FALSE(instance_step(instance, 0.0, NAN));
    TEST_ASSERT_FALSE(instance_step(instance, NAN, 1.0));
    TEST_ASSERT_FALSE(instance_step(instance, 0.0, INFINITY));
    TEST_ASSERT_TRUE(instance_step(instance, 0.0, 1.0));
    TEST_ASSERT_EQUAL_DOUBLE(7.0, get(AT_X));
}

void test_communication_times_from_unix_time_on_may_be_summed_or_multiplied(void)
{
    const double today_s = 1.8e9;
    begin(today_s);
    for (int k = 0; k < 1000; k++) {
        TEST_ASSERT_TRUE(instance_step(instance, today_s + 1e-3 * k, 1e-3));
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 1.0 + 3.0 * 2.0 * 1.0, get(AT_X));
    TEST_ASSERT_FALSE(instance_step(instance, today_s + 0.999, 1e-3));
}

void test_outputs_during_initialization_follow_the_present_inputs(void)
{
    TEST_ASSERT_TRUE(instance_enter_initialization(instance, 0.0));
    TEST_ASSERT_EQUAL_DOUBLE(1.0, get(AT_X));
    TEST_ASSERT_EQUAL_DOUBLE(1.0, get(AT_X));
    TEST_ASSERT_EQUAL_INT_MESSAGE(1, begun, "the model began twice for the same inputs");
    TEST_ASSERT_TRUE(instance_set(instance, AT_START, MODEL_REAL, 5.0));
    TEST_ASSERT_EQUAL_DOUBLE(5.0, get(AT_X));
    TEST_ASSERT_TRUE(instance_exit_initialization(instance));
    TEST_ASSERT_EQUAL_INT(2, begun);
}

void test_settable_variables_depend_on_causality_and_state(void)
{
    TEST_ASSERT_FALSE(instance_set(instance, AT_X, MODEL_REAL, 1.0));
    begin(0.0);
    TEST_ASSERT_FALSE(instance_set(instance, AT_START, MODEL_REAL, 2.0));
    TEST_ASSERT_EQUAL_STRING("start: cannot be set during a run", last_message);
    TEST_ASSERT_TRUE(instance_set(instance, AT_RATE, MODEL_REAL, 2.5));
    TEST_ASSERT_TRUE(instance_set(instance, AT_GAIN, MODEL_CODE, 4.0));
    TEST_ASSERT_TRUE(instance_set(instance, AT_ON, MODEL_FLAG, 0.0));
    TEST_ASSERT_FALSE(instance_set(instance, AT_RATE, MODEL_REAL, NAN));
    TEST_ASSERT_EQUAL_STRING("rate: not a finite number", last_message);
    TEST_ASSERT_FALSE(instance_set(instance, AT_GAIN, MODEL_CODE, 100.0));
    TEST_ASSERT_EQUAL_STRING("gain: too much", last_message);
    double kept = 0.0;
    TEST_ASSERT_TRUE(instance_get(instance, AT_GAIN, MODEL_CODE, &kept));
    TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(4.0, kept, "a refused value was taken");
    TEST_ASSERT_TRUE(instance_terminate(instance));
    TEST_ASSERT_FALSE(instance_set(instance, AT_RATE, MODEL_REAL, 1.0));
    TEST_ASSERT_FALSE(instance_step(instance, 0.0, 1.0));
}

void test_unknown_value_references_and_types_are_refused(void)
{
    double value = 0.0;
    TEST_ASSERT_FALSE(instance_get(instance, VARIABLES + 1, MODEL_REAL, &value));
    TEST_ASSERT_FALSE(instance_get(instance, UINT32_MAX, MODEL_REAL, &value));
    TEST_ASSERT_FALSE(instance_get(instance, AT_GAIN, MODEL_REAL, &value));
    TEST_ASSERT_FALSE(instance_set(instance, 0, MODEL_REAL, 1.0));
}

void test_a_model_that_fails_to_start_or_continue_logs_the_cause(void)
{
    TEST_ASSERT_TRUE(instance_set(instance, AT_START, MODEL_REAL, -1.0));
    TEST_ASSERT_TRUE(instance_enter_initialization(instance, 0.0));
    TEST_ASSERT_FALSE(instance_exit_initialization(instance));
    TEST_ASSERT_EQUAL_STRING("start: below zero", last_message);
    TEST_ASSERT_TRUE(instance_reset(instance));
    begin(0.0);
    TEST_ASSERT_TRUE(instance_set(instance, AT_RATE, MODEL_REAL, 1e9));
    TEST_ASSERT_FALSE(instance_step(instance, 0.0, 1.0));
    TEST_ASSERT_EQUAL_STRING("x: left its range", last_message);
}

void test_a_saved_state_contains_the_complete_instance(void)
{
    instance_state_t *state = NULL;
    begin(0.0);
    TEST_ASSERT_TRUE(instance_step(instance, 0.0, 1.0));
    TEST_ASSERT_TRUE(instance_get_state(instance, &state));
    TEST_ASSERT_TRUE(instance_set(instance, AT_RATE, MODEL_REAL, 20.0));
    TEST_ASSERT_TRUE(instance_step(instance, 1.0, 1.0));
    TEST_ASSERT_EQUAL_DOUBLE(67.0, get(AT_X));
    TEST_ASSERT_TRUE(instance_set_state(instance, state));
    TEST_ASSERT_EQUAL_DOUBLE(7.0, get(AT_X));
    TEST_ASSERT_EQUAL_DOUBLE(2.0, get(AT_RATE));
    TEST_ASSERT_TRUE(instance_step(instance, 1.0, 1.0));
    TEST_ASSERT_EQUAL_DOUBLE(13.0, get(AT_X));
    instance_free_state(state);
}

void test_a_serialised_state_continues_in_another_instance(void)
{
    instance_state_t *state = NULL;
    instance_state_t *back = NULL;
    begin(0.0);
    TEST_ASSERT_TRUE(instance_step(instance, 0.0, 1.0));
    TEST_ASSERT_TRUE(instance_get_state(instance, &state));
    void *bytes = malloc(instance_state_bytes());
    instance_state_to_bytes(state, bytes);
    instance_free_state(state);
    instance_delete(instance);
    instance = instance_new("{adder}", listen, last_message);
    TEST_ASSERT_FALSE(instance_state_from_bytes(instance, bytes, 3, &back));
    unsigned char *const last = (unsigned char *)bytes + instance_state_bytes() - 1;
    *last ^= 1;
    TEST_ASSERT_FALSE(instance_state_from_bytes(instance, bytes, instance_state_bytes(), &back));
    TEST_ASSERT_EQUAL_STRING("a state that is damaged, or another unit's", last_message);
    TEST_ASSERT_NULL(back);
    *last ^= 1;
    TEST_ASSERT_TRUE(instance_state_from_bytes(instance, bytes, instance_state_bytes(), &back));
    free(bytes);
    TEST_ASSERT_TRUE(instance_set_state(instance, back));
    instance_free_state(back);
    TEST_ASSERT_TRUE(instance_step(instance, 1.0, 1.0));
    TEST_ASSERT_EQUAL_DOUBLE(13.0, get(AT_X));
    TEST_ASSERT_FALSE(instance_set_state(instance, NULL));
}

void test_a_reset_gives_the_state_of_a_new_instance(void)
{
    begin(0.0);
    TEST_ASSERT_TRUE(instance_set(instance, AT_RATE, MODEL_REAL, 20.0));
    TEST_ASSERT_TRUE(instance_step(instance, 0.0, 1.0));
    TEST_ASSERT_TRUE(instance_reset(instance));
    TEST_ASSERT_EQUAL_DOUBLE(2.0, get(AT_RATE));
    begin(0.0);
    TEST_ASSERT_TRUE(instance_step(instance, 0.0, 1.0));
    TEST_ASSERT_EQUAL_DOUBLE(7.0, get(AT_X));
    TEST_ASSERT_FALSE(instance_refuse(instance, "clocks"));
    TEST_ASSERT_EQUAL_STRING("clocks: not offered by this unit", last_message);
}
