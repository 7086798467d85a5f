/* SPDX-License-Identifier: Apache-2.0 */
/*
 * One step of the fold-back against the law of DERIVATIONS.md, Fold-back, in double precision, and
 * its branches where they begin.
 */
#include <math.h>

#include "core/scaled.h"
#include "random_values.h"
#include "torque/foldback.h"
#include "unity.h"

static const double ONE = 16777216.0;
enum { STEPS = 8, UNUSED = 8, LITTLE_q24 = SCALED_ONE / 64 };

void setUp(void) {}

void tearDown(void) {}

static double limited(double x, double lowest, double highest)
{
    return fmin(fmax(x, lowest), highest);
}

/* Share that is allowed after a step. */
static double expected_share(const foldback_t *f, double allowed, double inside_mV,
                             double flowing_mA)
{
    const double most_mA = fmax(f->most_mA, 1.0);
    const double flowing = limited(flowing_mA / most_mA, -8.0, 8.0);
    const double within_mV = limited(inside_mV, -4.0 * f->span_mV, 4.0 * f->span_mV);
    const double error_mV = within_mV - f->rise_mV * (allowed - flowing) - f->width_mV * allowed;
    double from = allowed;
    if (inside_mV < 0.0 && error_mV < 0.0) { /* no more than flows */
        from = fmin(from, fmax(flowing, 0.0) + 1.0 / 64.0);
    }
    const double whole_mV = UNUSED * ((double)f->width_mV + f->rise_mV);
    const double gain = from + 1.0 / 64.0;
    const bool unused = error_mV < 0.0 && flowing < 0.25 * allowed && whole_mV * gain < f->span_mV;
    const double change = unused ? error_mV / whole_mV : gain * error_mV / f->span_mV;
    return limited(from + change / STEPS, 0.0, 1.0);
}

/* A product in whole millivolts is rounded down: two of them are up to 2 mV. A millivolt moves the
 * share by at most 1/8 of it over the span or over eight widths and rises. */
static void assert_step(const foldback_t *f, int32_t allowed_q24, int32_t inside_mV,
                        int32_t flowing_mA)
{
    foldback_state_t state = {.allowed_q24 = allowed_q24};
    const double expected = expected_share(f, allowed_q24 / ONE, inside_mV, flowing_mA);
    const int32_t result_mA = foldback_step(&state, f, inside_mV, flowing_mA);
    const double steepest = fmax(1.1 / f->span_mV, 1.0 / (UNUSED * (f->width_mV + f->rise_mV)));
    TEST_ASSERT_DOUBLE_WITHIN(2.0 * steepest / STEPS + 3.0 / ONE, expected,
                              state.allowed_q24 / ONE);
    const double share_mA = f->most_mA * (state.allowed_q24 / ONE);
    TEST_ASSERT_EQUAL_INT32(inside_mV <= -f->width_mV ? 0 : (int32_t)floor(share_mA), result_mA);
}

/* 2 kV: a millivolt is little. Beside a boundary the two sides of which differ by more than the
 * rounding the step may take either, so that random ones stay away from it. */
void test_a_step_follows_the_law(void)
{
    random_t random = random_seeded(1);
    for (int n = 0; n < 20000; n++) {
        const int32_t span_mV = random_between(&random, 500000, 2000000);
        const foldback_t f = {
            .most_mA = random_between(&random, 1000, 2000000),
            .span_mV = span_mV,
            .width_mV = random_between(&random, 10000, span_mV / 4),
            .rise_mV = random_chance(&random, 0.2) ? 0 : random_between(&random, 0, span_mV / 2),
        };
        const double allowed = random_real(&random, 0.0, 1.0);
        const double flowing = random_chance(&random, 0.5) ? random_real(&random, 0.0, allowed)
                                                           : random_real(&random, -12.0, 12.0);
        const double inside = random_chance(&random, 0.5) ? random_real(&random, -0.3, 0.3)
                                                          : random_real(&random, -6.0, 6.0);
        const double at_rest =
            (f.rise_mV * (allowed - limited(flowing, -8.0, 8.0)) + f.width_mV * allowed) / span_mV;
        if (fabs(limited(inside, -4.0, 4.0) - at_rest) < 1e-4 || fabs(inside) < 1e-4 ||
            fabs(flowing - 0.25 * allowed) < 1e-4) {
            continue;
        }
        assert_step(&f, (int32_t)(allowed * ONE), (int32_t)(inside * span_mV),
                    (int32_t)(flowing * f.most_mA));
    }
}

/* Half of the limit is allowed and an eighth of the limit flows, a quarter of what is allowed: in
 * use, at a gain of 33/64 over the span; with 1 mA less not in use, at one over eight widths. */
void test_a_quarter_of_what_is_allowed_is_a_use(void)
{
    const foldback_t f = {.most_mA = 64000, .width_mV = 1024, .span_mV = 65536, .rise_mV = 0};
    foldback_state_t state = {.allowed_q24 = SCALED_ONE / 2};
    foldback_step(&state, &f, 0, 8000);
    TEST_ASSERT_EQUAL_INT32(SCALED_ONE / 2 - 33 * 512 * 4 / 8, state.allowed_q24);
    state.allowed_q24 = SCALED_ONE / 2;
    foldback_step(&state, &f, 0, 7999);
    TEST_ASSERT_EQUAL_INT32(SCALED_ONE / 2 - SCALED_ONE / 16 / 8, state.allowed_q24);
}

/* Eight widths of 4 V and a rise of 0.5 V are 36 V: times 9/16 + 1/64 more than the span, 20 V. The
 * error is 9/16 of 4.5 V. */
void test_a_limit_that_is_not_in_use_never_falls_slower_than_one_in_use(void)
{
    const foldback_t f = {.most_mA = 64000, .width_mV = 4000, .span_mV = 20000, .rise_mV = 500};
    assert_step(&f, 9 * (SCALED_ONE / 16), 0, 0);
}

/* Eight widths of 40 mV times 0.2997 and a 64th are 100.9 mV, the span in whole millivolts. The
 * line is at 11 mV. */
void test_from_the_span_on_the_gain_is_that_of_a_limit_in_use(void)
{
    const foldback_t f = {.most_mA = 64000, .width_mV = 40, .span_mV = 100, .rise_mV = 0};
    foldback_state_t state = {.allowed_q24 = (int32_t)(0.2997 * ONE)};
    foldback_step(&state, &f, 0, 0);
    const double expected = 0.2997 - (0.2997 + 1.0 / 64.0) * 11.0 / 100.0 / STEPS;
    TEST_ASSERT_DOUBLE_WITHIN(4.0 / ONE, expected, state.allowed_q24 / ONE);
}

/* 3/16 of the limit flow: from 13/64 by 8001 of 8000 mV, 1310457.86 of 2^24. */
void test_a_share_is_rounded_down(void)
{
    const foldback_t f = {.most_mA = 64000, .width_mV = 1000, .span_mV = 65536, .rise_mV = 0};
    foldback_state_t state = {.allowed_q24 = SCALED_ONE};
    TEST_ASSERT_EQUAL_INT32(0, foldback_step(&state, &f, -7001, 12000));
    TEST_ASSERT_EQUAL_INT32(1310457, state.allowed_q24);
}

/* Width 16 mV, eight widths 128 mV; half is allowed, 8 mV of the line. */
void test_one_millivolt_beyond_the_line_lets_the_limit_fall(void)
{
    const foldback_t f = {.most_mA = 64000, .width_mV = 16, .span_mV = 65536, .rise_mV = 0};
    foldback_state_t state = {.allowed_q24 = SCALED_ONE / 2};
    foldback_step(&state, &f, 8, 0);
    TEST_ASSERT_EQUAL_INT32(SCALED_ONE / 2, state.allowed_q24);
    foldback_step(&state, &f, 7, 0);
    TEST_ASSERT_EQUAL_INT32(SCALED_ONE / 2 - SCALED_ONE / 128 / 8, state.allowed_q24);
}

/* The limit drops to what flows, and a 64th, from 1 mV outside the end on. Error 1024 and 1025 mV
 * of eight widths, 16 384 mV. */
void test_the_limit_drops_to_the_current_outside_the_end_only(void)
{
    const foldback_t f = {.most_mA = 64000, .width_mV = 2048, .span_mV = 65536, .rise_mV = 0};
    foldback_state_t state = {.allowed_q24 = SCALED_ONE / 2};
    foldback_step(&state, &f, 0, 0);
    TEST_ASSERT_EQUAL_INT32(SCALED_ONE / 2 - SCALED_ONE / 16 / 8, state.allowed_q24);
    state.allowed_q24 = SCALED_ONE / 2;
    foldback_step(&state, &f, -1, 0);
    TEST_ASSERT_EQUAL_INT32(LITTLE_q24 - 1025 * (SCALED_ONE / 16384) / 8, state.allowed_q24);
}

/* However little the line says: 1 mV outside, a width of 2 mV, of which 0.4 is none in whole
 * millivolts. Of 16 mV, at 8 steps: 1/128. */
void test_the_limit_drops_to_the_current_with_an_error_of_one_millivolt(void)
{
    const foldback_t f = {.most_mA = 64000, .width_mV = 2, .span_mV = 65536, .rise_mV = 0};
    foldback_state_t state = {.allowed_q24 = (int32_t)(0.4 * ONE)};
    foldback_step(&state, &f, -1, 0);
    TEST_ASSERT_EQUAL_INT32(LITTLE_q24 - SCALED_ONE / 128, state.allowed_q24);
}

/* A current the other way is none: exactly a 64th is left to fall from. Error 3 of 32 V. */
void test_the_limit_drops_to_a_64th_where_the_current_flows_the_other_way(void)
{
    const foldback_t f = {.most_mA = 64000, .width_mV = 4096, .span_mV = 65536, .rise_mV = 0};
    for (int32_t flowing_mA = -64000; flowing_mA <= 0; flowing_mA += 32000) {
        foldback_state_t state = {.allowed_q24 = SCALED_ONE / 2};
        foldback_step(&state, &f, -1024, flowing_mA);
        TEST_ASSERT_EQUAL_INT32(LITTLE_q24 - 3 * (SCALED_ONE / 32) / 8, state.allowed_q24);
    }
}

void test_the_share_ends_at_zero_and_one(void)
{
    const foldback_t f = {.most_mA = 64000, .width_mV = 1024, .span_mV = 65536, .rise_mV = 0};
    foldback_state_t state = {.allowed_q24 = SCALED_ONE / 100};
    TEST_ASSERT_EQUAL_INT32(0, foldback_step(&state, &f, -1023, 0));
    TEST_ASSERT_EQUAL_INT32(0, state.allowed_q24);
    for (int n = 0; n < 500; n++) {
        foldback_step(&state, &f, 65536, 0);
    }
    TEST_ASSERT_EQUAL_INT32(SCALED_ONE, state.allowed_q24);
    TEST_ASSERT_EQUAL_INT32(64000, foldback_step(&state, &f, 65536, 0));
}

void test_the_smallest_limits_have_shares_of_their_own(void)
{
    for (int32_t most_mA = 0; most_mA <= 2; most_mA++) {
        const foldback_t f = {
            .most_mA = most_mA, .width_mV = 1000, .span_mV = 60000, .rise_mV = 3000};
        foldback_state_t state = {.allowed_q24 = SCALED_ONE};
        TEST_ASSERT_EQUAL_INT32(most_mA, foldback_step(&state, &f, 60000, 0));
        assert_step(&f, SCALED_ONE / 4, 500, 1);
    }
}

void test_a_line_without_width_lets_no_current_outside_the_end(void)
{
    const foldback_t f = {.most_mA = 64000, .width_mV = 0, .span_mV = 60000, .rise_mV = 0};
    foldback_state_t state = {.allowed_q24 = SCALED_ONE};
    TEST_ASSERT_EQUAL_INT32(64000, foldback_step(&state, &f, 1, 0));
    TEST_ASSERT_EQUAL_INT32(0, foldback_step(&state, &f, -1, 0));
    TEST_ASSERT_EQUAL_INT32(0, state.allowed_q24);
}
