/* SPDX-License-Identifier: Apache-2.0 */
/* Modulation: line voltages, shortest pulses, and the voltage limit. */
#include <math.h>
#include <stdlib.h>

#include "modulation.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

static const double PI = 3.14159265358979323846;
static const int32_t PERIODS[] = {256, 1000, 2100, 4200, 8400, 16384};
enum { PERIOD_COUNT = 6 };
static const abc_t NO_TRIM = {0, 0, 0};

/* The compare values: whole parts of the on-times. */
static void step(const modulation_t *modulation, ab_t u, abc_t trim, int32_t compare[3])
{
    modulation_step(modulation, u, trim, compare);
    for (int x = 0; x < 3; x++) {
        compare[x] >>= 16;
    }
}

/* Phase voltages of a vector of length r at an angle, counts: one modulation unit is beta_counts =
 * limit * period between two lines. */
static void ideal_counts(const modulation_t *modulation, ab_t u, double phase[3])
{
    const double unit = modulation->beta_counts / sqrt(3.0) / 32768.0;
    phase[0] = unit * u.alpha;
    phase[1] = unit * (-0.5 * u.alpha + sqrt(0.75) * u.beta);
    phase[2] = unit * (-0.5 * u.alpha - sqrt(0.75) * u.beta);
}

static ab_t vector(double length, double angle)
{
    const ab_t u = {.alpha = (int32_t)(length * cos(angle)),
                    .beta = (int32_t)(length * sin(angle))};
    return u;
}

void test_zero_voltage_is_half_a_period_on_every_leg(void)
{
    for (int p = 0; p < PERIOD_COUNT; p++) {
        const modulation_t modulation = modulation_of(PERIODS[p], PERIODS[p] / 20, 0, 32767);
        const ab_t zero = {0, 0};
        int32_t on[3];
        step(&modulation, zero, NO_TRIM, on);
        for (int x = 0; x < 3; x++) {
            TEST_ASSERT_EQUAL_INT32((PERIODS[p] + 1) / 2, on[x]);
        }
    }
}

void test_line_voltages_are_within_one_count_of_the_ideal_ones(void)
{
    for (int p = 0; p < PERIOD_COUNT; p++) {
        const modulation_t modulation =
            modulation_of(PERIODS[p], PERIODS[p] / 20, PERIODS[p] / 50, 32767);
        for (int r = 0; r <= 32; r++) {
            for (int k = 0; k < 3600; k++) {
                const ab_t u = vector(1023.9 * r, k * PI / 1800.0);
                double phase[3];
                int32_t on[3];
                ideal_counts(&modulation, u, phase);
                step(&modulation, u, NO_TRIM, on);
                for (int x = 0; x < 3; x++) {
                    const int y = (x + 1) % 3;
                    TEST_ASSERT_DOUBLE_WITHIN(1.0, phase[x] - phase[y], on[x] - on[y]);
                }
            }
        }
    }
}

void test_pulses_are_centred_so_both_margins_are_equal(void)
{
    for (int p = 0; p < PERIOD_COUNT; p++) {
        const modulation_t modulation = modulation_of(PERIODS[p], PERIODS[p] / 20, 0, 32767);
        for (int k = 0; k < 360; k++) {
            int32_t on[3];
            step(&modulation, vector(32767.0, k * PI / 180.0), NO_TRIM, on);
            const int32_t longest =
                on[0] > on[1] ? (on[0] > on[2] ? on[0] : on[2]) : (on[1] > on[2] ? on[1] : on[2]);
            const int32_t shortest =
                on[0] < on[1] ? (on[0] < on[2] ? on[0] : on[2]) : (on[1] < on[2] ? on[1] : on[2]);
            TEST_ASSERT_INT32_WITHIN(2, PERIODS[p] - longest, shortest);
        }
    }
}

void test_a_vector_on_the_circle_with_the_largest_trim_leaves_the_shortest_pulse_on_either_side(
    void)
{
    for (int p = 0; p < PERIOD_COUNT; p++) {
        const int32_t min_pulse = PERIODS[p] / 16;
        const int32_t trim = PERIODS[p] / 40;
        const modulation_t modulation = modulation_of(PERIODS[p], min_pulse, trim, 32767);
        for (int signs = 0; signs < 8; signs++) {
            const abc_t trims = {signs & 1 ? 32767 : -32768, signs & 2 ? 32767 : -32768,
                                 signs & 4 ? 32767 : -32768};
            for (int k = 0; k < 3600; k++) {
                int32_t on[3];
                step(&modulation, vector(32768.0, k * PI / 1800.0), trims, on);
                for (int x = 0; x < 3; x++) {
                    TEST_ASSERT_TRUE(on[x] >= min_pulse);
                    TEST_ASSERT_TRUE(on[x] <= PERIODS[p] - min_pulse);
                }
            }
        }
    }
}

void test_configured_limit_applies_where_the_pulses_allow_it(void)
{
    /* The limit is moved to the next whole scale below: by less than sqrt 3 / period. */
    const modulation_t modulation = modulation_of(4200, 100, 0, 26000);
    TEST_ASSERT_INT32_WITHIN(14, 26000 - 7, modulation.limit_q15);
    TEST_ASSERT_TRUE(modulation.limit_q15 <= 26001);
}

void test_the_limit_shrinks_for_pulse_and_trim_but_never_below_a_quarter(void)
{
    const modulation_t wide = modulation_of(4200, 100, 0, 32767);
    const modulation_t narrow = modulation_of(4200, 400, 0, 32767);
    TEST_ASSERT_TRUE(narrow.limit_q15 < wide.limit_q15);
    /* min pulse 400, twice, of 4200: 1 - 0.19 = 0.81, less the rounding reserve */
    TEST_ASSERT_DOUBLE_WITHIN(0.003, 1.0 - 800.0 / 4200.0, narrow.limit_q15 / 32768.0);
    TEST_ASSERT_TRUE(modulation_of(4200, 2000, 500, 32767).limit_q15 >= 8192 - 14);
}

void test_trim_adds_to_its_own_phase_only(void)
{
    const modulation_t modulation = modulation_of(4200, 100, 64, 32767);
    const ab_t u = vector(12000.0, 1.0);
    int32_t plain[3];
    step(&modulation, u, NO_TRIM, plain);
    for (int x = 0; x < 3; x++) {
        const int32_t share_q15 = 37 * 32768 / 64;
        const abc_t trim = {x == 0 ? share_q15 : 0, x == 1 ? share_q15 : 0, x == 2 ? share_q15 : 0};
        int32_t on[3];
        step(&modulation, u, trim, on);
        for (int y = 0; y < 3; y++) {
            TEST_ASSERT_EQUAL_INT32(plain[y] + (x == y ? 37 : 0), on[y]);
        }
    }
}

void test_opposite_vectors_have_mirrored_pulses(void)
{
    const modulation_t modulation = modulation_of(4200, 100, 0, 32767);
    for (int k = 0; k < 3600; k++) {
        const ab_t u = vector(25000.0, k * PI / 1800.0);
        const ab_t opposite = {-u.alpha, -u.beta};
        int32_t on[3];
        int32_t mirrored[3];
        step(&modulation, u, NO_TRIM, on);
        step(&modulation, opposite, NO_TRIM, mirrored);
        for (int x = 0; x < 3; x++) {
            TEST_ASSERT_INT32_WITHIN(1, 4200, on[x] + mirrored[x]);
        }
    }
}

/* ---- in whole numbers ---- */

/* Shortest pulse, correction and two counts of rounding on either side of the outer lines: of 16
 * 384 counts 16 384 - 2 (100 + 50 + 2) = 16 080, less one as one is 1 - 2^-15; two units of Q15 a
 * count. */
void test_the_circle_leaves_pulse_correction_and_two_counts_of_rounding(void)
{
    const modulation_t modulation = modulation_of(16384, 100, 50, 32767);
    TEST_ASSERT_EQUAL_INT32(16079, modulation.beta_counts);
    TEST_ASSERT_EQUAL_INT32(2 * 16079, modulation.limit_q15);
    TEST_ASSERT_EQUAL_INT32(100, modulation.trim_doubled_counts);
    TEST_ASSERT_EQUAL_INT32(lround(16079 * sqrt(3.0)), modulation.alpha_counts);
    TEST_ASSERT_EQUAL_INT32(16384 * 32768 + 32768, modulation.centre_q16);
    TEST_ASSERT_EQUAL_INT32(16075, modulation_of(16384, 101, 51, 32767).beta_counts);
}

/* 29 491 of 900 counts of 1000: 29491.2; of 16 383 a quarter is 4095.75. */
void test_the_circle_is_a_whole_number_of_counts(void)
{
    const modulation_t part = modulation_of(1000, 10, 0, 29520);
    TEST_ASSERT_EQUAL_INT32(900, part.beta_counts);
    TEST_ASSERT_EQUAL_INT32(29491, part.limit_q15);
    TEST_ASSERT_EQUAL_INT32(4095, modulation_of(16383, 8000, 0, 32767).beta_counts);
    TEST_ASSERT_EQUAL_INT32(4096, modulation_of(16384, 8000, 0, 32767).beta_counts);
}

/* A margin of 8 192 counts on both sides of 32 767: 16 384.50 of 32 768, rounded down, less than
 * the largest radius, and then to whole counts. */
void test_circle_keeps_the_shortest_pulse_to_the_last_unit(void)
{
    const modulation_t modulation = modulation_of(32767, 8190, 0, 32767);
    TEST_ASSERT_EQUAL_INT32(16382, modulation.beta_counts); /* 32 767 * 16 383/32 768 */
}

/* With one count for a unit of voltage: a is 2 and its half 1, so on_a is 1 above the middle. What
 * it is beyond half a count comes off the others, half of what b is beyond it off c. */
void test_rounding_of_a_leg_is_passed_on_to_the_last_fraction(void)
{
    const modulation_t modulation = {
        .centre_q16 = (1000 << 16) + 0x8000, .alpha_counts = 1, .beta_counts = 1};
    const ab_t u = {.alpha = 2, .beta = 0};
    int32_t on_q16[3];
    modulation_step(&modulation, u, NO_TRIM, on_q16);
    TEST_ASSERT_EQUAL_HEX32((1000 << 16) + 0x8001, on_q16[0]);
    TEST_ASSERT_EQUAL_HEX32((1000 << 16) + 0x7FFE, on_q16[1]); /* - 1 - 1 */
    TEST_ASSERT_EQUAL_HEX32((1000 << 16) + 0x7FFF, on_q16[2]); /* - 2 + 2/2 */
}

void test_centred_legs_are_on_for_half_the_period(void)
{
    for (int p = 0; p < PERIOD_COUNT; p++) {
        const modulation_t modulation = modulation_of(PERIODS[p], 2, 0, Q15_ONE);
        int32_t on_q16[3] = {0, 1, 2};
        modulation_centre(&modulation, on_q16);
        for (int x = 0; x < 3; x++) {
            TEST_ASSERT_EQUAL_INT32(PERIODS[p] / 2, on_q16[x] >> 16);
        }
    }
}
