/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The C files of an FMU, called through the functions of the standard without an importer: correct
 * and incorrect sequences of calls. The sanitizer preset checks every memory access.
 */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "unit_functions.h"
#include "unity.h"

enum { STEPS = 60, WARM_UP = 20 };
static const double STEP_S = 1e-3;

static void *unit;

void setUp(void)
{
    unit_message[0] = '\0';
    unit = unit_new(MODEL_TOKEN);
    TEST_ASSERT_NOT_NULL(unit);
}

void tearDown(void)
{
    unit_delete(unit);
    unit = NULL;
}

static bool is_settable(int k)
{
    return MODEL_VARIABLES[k].role != MODEL_OUTPUT;
}

static bool changes_during_a_run(int k)
{
    return MODEL_VARIABLES[k].role == MODEL_INPUT || MODEL_VARIABLES[k].role == MODEL_TUNABLE;
}

static int place_of(const char *name)
{
    for (int k = 0; k < MODEL_VARIABLE_COUNT; k++) {
        if (strcmp(MODEL_VARIABLES[k].name, name) == 0) {
            return k;
        }
    }
    return -1;
}

/* A pedal demand and a motor current: inputs that change the outputs of either FMU. */
static void drive(void *driven, double now_s, double size)
{
    static const struct {
        const char *name;
        double of_size;
    } SET[] = {
        {"fast_input.bus_voltage_v", 50.0}, {"fast_input.phase_a_a", 10.0},
        {"slow_input.enable", 1.0},         {"slow_input.brake_torque_nm", 20.0},
        {"driver.brake_demand_nm", 20.0},   {"road.slope", 0.01},
    };
    for (size_t k = 0; k < sizeof(SET) / sizeof(SET[0]); k++) {
        const int place = place_of(SET[k].name);
        if (place >= 0) {
            const double value = MODEL_VARIABLES[place].type == MODEL_REAL
                                     ? size * SET[k].of_size * (1.0 + now_s)
                                     : 1.0;
            TEST_ASSERT_TRUE_MESSAGE(
                unit_set(driven, (uint32_t)place + 1, MODEL_VARIABLES[place].type, value),
                unit_message);
        }
    }
}

static void read_all(void *from, double *values)
{
    for (int k = 0; k < MODEL_VARIABLE_COUNT; k++) {
        TEST_ASSERT_TRUE_MESSAGE(
            unit_get(from, (uint32_t)k + 1, MODEL_VARIABLES[k].type, &values[k]), unit_message);
    }
}

static size_t all_bytes(void)
{
    return (size_t)MODEL_VARIABLE_COUNT * sizeof(double);
}

/* Steps `first` up to `last`, and every variable after each of them, one row a step. */
static double *run(void *driven, int first, int last, double size)
{
    double *const rows = calloc((size_t)(last - first), all_bytes());
    TEST_ASSERT_NOT_NULL(rows);
    for (int k = first; k < last; k++) {
        drive(driven, k * STEP_S, size);
        TEST_ASSERT_TRUE_MESSAGE(unit_step(driven, k * STEP_S, STEP_S), unit_message);
        read_all(driven, rows + (size_t)(k - first) * (size_t)MODEL_VARIABLE_COUNT);
    }
    return rows;
}

static void assert_same_bits(const double *expected, const double *found, int rows)
{
    TEST_ASSERT_EQUAL_MEMORY(expected, found, (size_t)rows * all_bytes());
}

void test_a_run_advances_and_can_be_repeated_after_a_reset(void)
{
    TEST_ASSERT_TRUE_MESSAGE(unit_begin(unit, 0.0), unit_message);
    double *const first = run(unit, 0, STEPS, 1.0);
    const double *const last_row = first + (size_t)(STEPS - 1) * (size_t)MODEL_VARIABLE_COUNT;
    int moved = 0;
    for (int k = 0; k < MODEL_VARIABLE_COUNT; k++) {
        moved += MODEL_VARIABLES[k].role == MODEL_OUTPUT && last_row[k] != first[k];
    }
    TEST_ASSERT_GREATER_THAN_INT(2, moved);
    TEST_ASSERT_TRUE(unit_terminate(unit));
    TEST_ASSERT_TRUE(unit_reset(unit));
    TEST_ASSERT_TRUE(unit_begin(unit, 0.0));
    double *const again = run(unit, 0, STEPS, 1.0);
    assert_same_bits(first, again, STEPS);
    free(first);
    free(again);
}

void test_instances_in_one_process_are_independent(void)
{
    TEST_ASSERT_TRUE(unit_begin(unit, 0.0));
    double *const alone = run(unit, 0, STEPS, 1.0);
    void *const one = unit_new_without_log(MODEL_TOKEN);
    void *const other = unit_new(MODEL_TOKEN);
    TEST_ASSERT_TRUE(unit_begin(one, 0.0) && unit_begin(other, 0.0));
    for (int k = 0; k < STEPS; k++) {
        double *const row = run(one, k, k + 1, 1.0);
        free(run(other, k, k + 1, 0.5));
        assert_same_bits(alone + (size_t)k * (size_t)MODEL_VARIABLE_COUNT, row, 1);
        free(row);
    }
    unit_delete(other);
    unit_delete(one);
    free(alone);
}

void test_a_restored_state_continues_bit_identically_here_and_in_another_instance(void)
{
    TEST_ASSERT_TRUE(unit_begin(unit, 0.0));
    free(run(unit, 0, WARM_UP, 1.0));
    void *state = NULL;
    TEST_ASSERT_TRUE_MESSAGE(unit_get_state(unit, &state), unit_message);
    double *const expected = run(unit, WARM_UP, STEPS, 1.0);
    TEST_ASSERT_TRUE_MESSAGE(unit_set_state(unit, state), unit_message);
    double *const here = run(unit, WARM_UP, STEPS, 1.0);
    assert_same_bits(expected, here, STEPS - WARM_UP);
    free(here);

    const size_t size = unit_state_bytes(unit, state);
    unsigned char *const bytes = malloc(size);
    TEST_ASSERT_NOT_NULL(bytes);
    TEST_ASSERT_TRUE(unit_to_bytes(unit, state, bytes, size));
    unit_free_state(unit, &state);
    TEST_ASSERT_NULL(state);
    unit_free_state(unit, &state);

    void *const fresh = unit_new(MODEL_TOKEN);
    TEST_ASSERT_TRUE_MESSAGE(unit_from_bytes(fresh, bytes, size, &state), unit_message);
    TEST_ASSERT_TRUE_MESSAGE(unit_set_state(fresh, state), unit_message);
    double *const elsewhere = run(fresh, WARM_UP, STEPS, 1.0);
    assert_same_bits(expected, elsewhere, STEPS - WARM_UP);
    unit_free_state(fresh, &state);
    unit_delete(fresh);
    free(elsewhere);
    free(expected);
    free(bytes);
}

void test_invalid_state_bytes_are_refused(void)
{
    TEST_ASSERT_TRUE(unit_begin(unit, 0.0));
    void *state = NULL;
    void *back = NULL;
    TEST_ASSERT_TRUE(unit_get_state(unit, &state));
    const size_t size = unit_state_bytes(unit, state);
    unsigned char *const bytes = malloc(size);
    TEST_ASSERT_NOT_NULL(bytes);
    TEST_ASSERT_FALSE(unit_to_bytes(unit, state, bytes, size - 1));
    TEST_ASSERT_TRUE(unit_to_bytes(unit, state, bytes, size));
    TEST_ASSERT_FALSE(unit_from_bytes(unit, bytes, size - 1, &back));
    TEST_ASSERT_FALSE(unit_from_bytes(unit, bytes, 0, &back));
    for (size_t at = 0; at < size; at += size / 50 + 1) {
        bytes[at] ^= 0x10;
        TEST_ASSERT_FALSE(unit_from_bytes(unit, bytes, size, &back));
        bytes[at] ^= 0x10;
    }
    TEST_ASSERT_NULL(back);
    TEST_ASSERT_FALSE(unit_set_state(unit, NULL));
    TEST_ASSERT_TRUE(unit_from_bytes(unit, bytes, size, &state)); /* into an existing instance */
    unit_free_state(unit, &state);
    free(bytes);
}

void test_calls_out_of_order_are_refused_and_leave_the_state_unchanged(void)
{
    TEST_ASSERT_NULL(unit_new("{another}"));
    TEST_ASSERT_NULL(unit_new(NULL));
    TEST_ASSERT_NULL(unit_new_without_log(""));
    TEST_ASSERT_NULL(unit_new_of_another_kind());
    unit_delete(NULL);
    TEST_ASSERT_FALSE(unit_step(unit, 0.0, STEP_S));
    TEST_ASSERT_FALSE(unit_exit(unit));
    TEST_ASSERT_FALSE(unit_terminate(unit));
    TEST_ASSERT_FALSE(unit_enter(unit, NAN));
    TEST_ASSERT_TRUE(unit_enter(unit, 0.0));
    TEST_ASSERT_FALSE(unit_enter(unit, 0.0));
    TEST_ASSERT_FALSE(unit_step(unit, 0.0, STEP_S));
    TEST_ASSERT_TRUE(unit_exit(unit));
    TEST_ASSERT_FALSE(unit_exit(unit));
    const double steps_s[] = {0.0, -STEP_S, NAN, INFINITY, -INFINITY};
    for (size_t k = 0; k < sizeof(steps_s) / sizeof(steps_s[0]); k++) {
        TEST_ASSERT_FALSE(unit_step(unit, 0.0, steps_s[k]));
    }
    TEST_ASSERT_FALSE(unit_step(unit, NAN, STEP_S));
    TEST_ASSERT_FALSE(unit_step(unit, 1.0, STEP_S));
    TEST_ASSERT_TRUE(unit_step(unit, 0.0, 1e-9)); /* shorter than a PWM period */
    TEST_ASSERT_TRUE(unit_terminate(unit));
    TEST_ASSERT_FALSE(unit_step(unit, 1e-9, STEP_S));
    TEST_ASSERT_FALSE(unit_terminate(unit));
    void *const never_begun = unit_new(MODEL_TOKEN);
    void *state = NULL;
    TEST_ASSERT_TRUE(unit_get_state(never_begun, &state));
    TEST_ASSERT_TRUE(unit_set_state(never_begun, state));
    unit_free_state(never_begun, &state);
    unit_delete(never_begun);
}

void test_unknown_value_references_and_types_are_refused(void)
{
    TEST_ASSERT_TRUE(unit_begin(unit, 0.0));
    const uint32_t wrong[] = {(uint32_t)MODEL_VARIABLE_COUNT + 1, 0x7fffffffU, 0x80000000U,
                              UINT32_MAX};
    for (size_t k = 0; k < sizeof(wrong) / sizeof(wrong[0]); k++) {
        for (model_type_t type = MODEL_REAL; type <= MODEL_CODE; type++) {
            double value = 0.0;
            TEST_ASSERT_FALSE(unit_get(unit, wrong[k], type, &value));
            TEST_ASSERT_FALSE(unit_set(unit, wrong[k], type, 0.0));
        }
    }
    for (int k = 0; k < MODEL_VARIABLE_COUNT; k++) {
        const model_type_t other = MODEL_VARIABLES[k].type == MODEL_REAL ? MODEL_CODE : MODEL_REAL;
        double value = 0.0;
        TEST_ASSERT_FALSE(unit_get(unit, (uint32_t)k + 1, other, &value));
        TEST_ASSERT_FALSE(unit_set(unit, (uint32_t)k + 1, other, 0.0));
        if (!changes_during_a_run(k)) {
            TEST_ASSERT_FALSE(
                unit_set(unit, (uint32_t)k + 1, MODEL_VARIABLES[k].type, MODEL_VARIABLES[k].start));
        }
    }
    double now_s = -1.0;
    TEST_ASSERT_TRUE(unit_get(unit, 0, MODEL_REAL, &now_s));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, now_s);
}

/* An FMU accepts or refuses any number, and its behaviour stays defined. What does so is the same
 * in both versions: each tries every other number. */
static const double REALS[] = {1e300, -1e300, DBL_MAX,      5e-324,
                               -1.0,  1e9,    4294967296.0, -2147483649.0};
static const double CODES[] = {2147483647.0, -2147483648.0, -1.0, 255.0};
static const double FLAGS[] = {0.0, 1.0, 7.0};

static size_t extremes(model_type_t type, const double **values)
{
    *values = type == MODEL_REAL ? REALS : type == MODEL_CODE ? CODES : FLAGS;
    return (type == MODEL_REAL   ? sizeof(REALS)
            : type == MODEL_CODE ? sizeof(CODES)
                                 : sizeof(FLAGS)) /
           sizeof(double);
}

static void try_during_a_run(int k, double value)
{
    TEST_ASSERT_TRUE(unit_reset(unit));
    TEST_ASSERT_TRUE(unit_begin(unit, 0.0));
    drive(unit, 0.0, 1.0);
    TEST_ASSERT_TRUE(unit_step(unit, 0.0, STEP_S));
    if (unit_set(unit, (uint32_t)k + 1, MODEL_VARIABLES[k].type, value)) {
        double *const rows = calloc(1, all_bytes());
        if (unit_step(unit, STEP_S, STEP_S)) {
            read_all(unit, rows);
        }
        free(rows);
    } else {
        TEST_ASSERT_NOT_EQUAL(0, unit_message[0]);
    }
}

static void try_before_a_run(int k, double value)
{
    TEST_ASSERT_TRUE(unit_reset(unit));
    if (unit_set(unit, (uint32_t)k + 1, MODEL_VARIABLES[k].type, value) && unit_begin(unit, 0.0)) {
        unit_step(unit, 0.0, STEP_S);
    }
}

void test_any_number_is_accepted_or_refused_without_a_crash(void)
{
    for (int k = 0; k < MODEL_VARIABLE_COUNT; k++) {
        const double *values = NULL;
        const size_t count = extremes(MODEL_VARIABLES[k].type, &values);
        for (size_t n = ((size_t)k + unit_version) % 2; n < count && is_settable(k); n += 2) {
            try_before_a_run(k, values[n]);
            if (changes_during_a_run(k)) {
                try_during_a_run(k, values[n]);
            }
        }
        if (MODEL_VARIABLES[k].type == MODEL_REAL && is_settable(k)) {
            TEST_ASSERT_TRUE(unit_reset(unit));
            TEST_ASSERT_FALSE(unit_set(unit, (uint32_t)k + 1, MODEL_REAL, NAN));
            TEST_ASSERT_FALSE(unit_set(unit, (uint32_t)k + 1, MODEL_REAL, INFINITY));
        }
    }
}

void test_unsupported_functions_are_refused(void)
{
    TEST_ASSERT_NULL(unit_offers_too_much(unit));
    TEST_ASSERT_TRUE(unit_begin(unit, 0.0));
    TEST_ASSERT_NULL(unit_offers_too_much(unit));
    TEST_ASSERT_NOT_NULL(strstr(unit_message, "not offered by this unit"));
}
