/* SPDX-License-Identifier: Apache-2.0 */
/* From ADC codes to currents: the reconstructed phase, the current sum, ADC saturation, offsets. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sense.h"
#include "unity.h"

static const config_drive_t MIDDLE = {
    .offset_a_q4 = 32768, .offset_b_q4 = 32768, .offset_c_q4 = 32768};

/* What is before the state is not the module's. */
static struct {
    uint8_t before[16];
    sense_state_t state;
} memory;
#define state memory.state

void setUp(void)
{
    sense_init(&state, &MIDDLE);
}

void tearDown(void) {}

void test_the_constant_is_the_rounded_root(void)
{
    TEST_ASSERT_EQUAL_INT(lround(131072.0 * (2.0 / sqrt(3.0) - 1.0)),
                          SENSE_TWO_INV_SQRT3_LESS_ONE_Q17);
}

/* beta = (b - c)/sqrt 3, rounded; what is doubled is rounded down before, and the constant is off
 * by 0.02 at most. */
static void check_vector(double a, double b_less_c, ab16_t i)
{
    const double beta = fmin(b_less_c / sqrt(3.0), 32767.0);
    TEST_ASSERT_EQUAL_DOUBLE(a, q_pair_x(i.v));
    TEST_ASSERT_DOUBLE_WITHIN(0.53, fmax(beta, -32768.0), q_pair_y(i.v));
}

void test_mid_range_is_zero_current_and_the_ends_are_full_scale(void)
{
    /* 2048 codes = 1.0 = 32768: 16 a code. Phase c is longest on and worked out from a and b. */
    const int32_t on[3] = {100, 200, 300};
    const uint16_t middle[3] = {2048, 2048, 2048};
    const sense_out_t zero = sense_step(&state, middle, on);
    TEST_ASSERT_EQUAL_INT32(0, q_pair_x(zero.i.v));
    TEST_ASSERT_EQUAL_INT32(0, q_pair_y(zero.i.v));
    const uint16_t ends[3] = {0, 4095, 0};
    /* c = -(a + b) = 16 */
    check_vector(-32768.0, 2047.0 * 16.0 - 16.0, sense_step(&state, ends, on).i);
}

/* Each phase has its own sensor: a reading at its own offset is zero current, and one code above it
 * is 16 in that phase alone. */
void test_each_phase_has_its_own_offset(void)
{
    const config_drive_t offsets = {
        .offset_a_q4 = 16 * 2000, .offset_b_q4 = 16 * 2010, .offset_c_q4 = 16 * 2030};
    sense_init(&state, &offsets);
    for (int phase = 0; phase < SENSE_PHASES; phase++) {
        uint16_t codes[SENSE_PHASES] = {2000, 2010, 2030};
        codes[phase]++;
        const abc_t i_pu = sense_phases(&state, codes);
        TEST_ASSERT_EQUAL_INT32(phase == 0 ? 16 : 0, i_pu.a);
        TEST_ASSERT_EQUAL_INT32(phase == 1 ? 16 : 0, i_pu.b);
        TEST_ASSERT_EQUAL_INT32(phase == 2 ? 16 : 0, i_pu.c);
    }
}

void test_phase_with_the_longest_on_time_is_reconstructed_from_the_others(void)
{
    static const int32_t ON[6][3] = {{9, 5, 1}, {9, 1, 5}, {5, 9, 1},
                                     {1, 9, 5}, {5, 1, 9}, {1, 5, 9}};
    static const int LONGEST[6] = {0, 0, 1, 1, 2, 2};
    const uint16_t codes[3] = {2100, 2200, 1700}; /* 52, 152, -348 codes: the sum is -144 */
    for (int k = 0; k < 6; k++) {
        const sense_out_t out = sense_step(&state, codes, ON[k]);
        int32_t i[3] = {52 * 16, 152 * 16, -348 * 16};
        i[LONGEST[k]] = -i[(LONGEST[k] + 1) % 3] - i[(LONGEST[k] + 2) % 3];
        check_vector(i[0], i[1] - i[2], out.i);
        TEST_ASSERT_EQUAL_INT32(-144 * 16, out.sum_pu);
    }
}

void test_earlier_phase_is_reconstructed_on_a_tie(void)
{
    static const int32_t ON[4][3] = {{7, 7, 7}, {7, 7, 1}, {7, 1, 7}, {1, 7, 7}};
    static const int EARLIER[4] = {0, 0, 0, 1};
    const uint16_t codes[3] = {2100, 2200, 1700};
    for (int k = 0; k < 4; k++) {
        int32_t i[3] = {52 * 16, 152 * 16, -348 * 16};
        i[EARLIER[k]] = -i[(EARLIER[k] + 1) % 3] - i[(EARLIER[k] + 2) % 3];
        check_vector(i[0], i[1] - i[2], sense_step(&state, codes, ON[k]).i);
    }
}

void test_all_codes_give_the_vector_of_their_phases_unless_it_saturates(void)
{
    const int32_t on[3] = {1, 2, 3};
    for (int32_t a = 0; a < 4096; a += 63) {
        for (int32_t b = 0; b < 4096; b += 65) {
            const uint16_t codes[3] = {(uint16_t)a, (uint16_t)b, 17};
            const int32_t b_less_c = 16 * ((a - 2048) + 2 * (b - 2048)); /* c = -a - b */
            const double saturated =
                b_less_c > 65535 ? 65535.0 : (b_less_c < -65536 ? -65536.0 : b_less_c);
            check_vector(16.0 * (a - 2048), saturated, sense_step(&state, codes, on).i);
        }
    }
}

void test_adc_saturation_is_detected_at_the_end_codes_only(void)
{
    /* Zeros away from mid-range: what code 0 and code 4095 stand for moves with them. */
    static const int32_t OFFSETS[3][3] = {
        {2048, 2048, 2048}, {2010, 2048, 2090}, {2148, 1948, 2040}};
    for (int k = 0; k < 3; k++) {
        const int32_t offset_q4[3] = {OFFSETS[k][0] * 16, OFFSETS[k][1] * 16, OFFSETS[k][2] * 16};
        for (int phase = 0; phase < 3; phase++) {
            for (int e = 0; e < 2; e++) {
                const int32_t end_code = e == 0 ? 0 : SENSE_CODE_MAX;
                const int32_t inside_code = e == 0 ? 1 : SENSE_CODE_MAX - 1;
                int32_t i[3] = {320, -160, -160};
                i[phase] = q_saturate16((end_code - OFFSETS[k][phase]) * 16);
                const abc_t at_end = {i[0], i[1], i[2]};
                TEST_ASSERT_TRUE(sense_adc_saturated(offset_q4, at_end));
                i[phase] = (inside_code - OFFSETS[k][phase]) * 16;
                if (i[phase] > -32768 &&
                    i[phase] < 32767) { /* beyond one, both are the end of the number */
                    const abc_t inside = {i[0], i[1], i[2]};
                    TEST_ASSERT_FALSE(sense_adc_saturated(offset_q4, inside));
                }
            }
        }
    }
}

static void calibrate(uint16_t a, uint16_t b, uint16_t c)
{
    const uint16_t codes[3] = {a, b, c};
    for (int n = 0; n < (1 << SENSE_CALIBRATION_LOG2); n++) {
        sense_calibrate_step(&state, codes);
    }
}

void test_calibrated_offsets_make_the_resting_codes_zero(void)
{
    const int32_t on[3] = {1, 2, 3};
    const uint16_t resting[3] = {2061, 2030, 2048};
    TEST_ASSERT_FALSE(state.calibrated);
    calibrate(resting[0], resting[1], resting[2]);
    TEST_ASSERT_TRUE(state.calibrated);
    const sense_out_t out = sense_step(&state, resting, on);
    TEST_ASSERT_EQUAL_INT32(0, q_pair_x(out.i.v));
    TEST_ASSERT_EQUAL_INT32(0, q_pair_y(out.i.v));
    TEST_ASSERT_EQUAL_INT32(0, out.sum_pu);
}

void test_the_average_resolves_a_sixteenth_of_a_code(void)
{
    /* 11 of 16 samples read one more: the mean is 2048 + 11/16 codes. */
    for (int n = 0; n < (1 << SENSE_CALIBRATION_LOG2); n++) {
        const uint16_t code = (uint16_t)(2048 + (n % 16 < 11 ? 1 : 0));
        const uint16_t codes[3] = {code, code, code};
        sense_calibrate_step(&state, codes);
    }
    TEST_ASSERT_EQUAL_INT32(2048 * 16 + 11, state.offset_q4[0]);
}

void test_offsets_stay_in_use_until_a_new_calibration_is_complete(void)
{
    calibrate(2100, 2100, 2100);
    sense_calibrate_restart(&state);
    const uint16_t codes[3] = {1900, 1900, 1900};
    for (int n = 0; n < (1 << SENSE_CALIBRATION_LOG2) - 1; n++) {
        sense_calibrate_step(&state, codes);
        TEST_ASSERT_FALSE(state.calibrated);
        TEST_ASSERT_EQUAL_INT32(2100 * 16, state.offset_q4[1]);
    }
    sense_calibrate_step(&state, codes);
    TEST_ASSERT_TRUE(state.calibrated);
    TEST_ASSERT_EQUAL_INT32(1900 * 16, state.offset_q4[1]);
}

void test_the_highest_codes_do_not_overflow_the_sum(void)
{
    calibrate(4095, 4095, 4095);
    TEST_ASSERT_EQUAL_INT32(4095 * 16, state.offset_q4[2]);
}

void test_samples_after_the_calibration_do_not_change_the_offsets(void)
{
    calibrate(2100, 2100, 2100);
    calibrate(0, 0, 0);
    TEST_ASSERT_EQUAL_INT32(2100 * 16, state.offset_q4[0]);
}

/* ---- limits ---- */

void test_a_start_and_a_calibration_write_to_their_state_only(void)
{
    const uint16_t around[SENSE_PHASES + 2] = {4095, 2100, 2110, 2120, 4095};
    memset(memory.before, 0x5A, sizeof memory.before);
    sense_init(&state, &MIDDLE);
    for (int x = 0; x < SENSE_PHASES; x++) {
        TEST_ASSERT_EQUAL_UINT32(0, state.sum[x]);
    }
    for (int n = 0; n < (1 << SENSE_CALIBRATION_LOG2); n++) {
        for (int x = 0; x < SENSE_PHASES; x++) { /* in use until it is complete */
            TEST_ASSERT_EQUAL_INT32(32768, state.offset_q4[x]);
        }
        sense_calibrate_step(&state, &around[1]);
    }
    for (int x = 0; x < SENSE_PHASES; x++) {
        TEST_ASSERT_EQUAL_INT32(16 * around[1 + x], state.offset_q4[x]);
    }
    TEST_ASSERT_EACH_EQUAL_UINT8(0x5A, memory.before, sizeof memory.before);
}

void test_a_new_calibration_begins_with_empty_sums(void)
{
    const uint16_t codes[SENSE_PHASES] = {2100, 2110, 2120};
    sense_calibrate_step(&state, codes);
    sense_calibrate_restart(&state);
    for (int x = 0; x < SENSE_PHASES; x++) {
        TEST_ASSERT_EQUAL_UINT32(0, state.sum[x]);
        TEST_ASSERT_EQUAL_INT32(32768, state.offset_q4[x]);
    }
    TEST_ASSERT_EQUAL_UINT16(0, state.samples);
}

void test_samples_after_the_calibration_are_not_counted(void)
{
    calibrate(2100, 2100, 2100);
    calibrate(0, 0, 0);
    TEST_ASSERT_EQUAL_UINT16(1 << SENSE_CALIBRATION_LOG2, state.samples);
}

void test_a_code_of_more_than_12_bits_counts_as_the_highest(void)
{
    calibrate(4096, 5000, 65535);
    for (int x = 0; x < SENSE_PHASES; x++) {
        TEST_ASSERT_EQUAL_INT32(SENSE_CODE_MAX * 16, state.offset_q4[x]);
    }
}

static bool saturated_at(int32_t offset_q4, int32_t i_pu)
{
    const int32_t offsets_q4[SENSE_PHASES] = {offset_q4, 32768, 32768};
    const abc_t i = {i_pu, 0, 0};
    return sense_adc_saturated(offsets_q4, i);
}

/* Half a code is 8. Code 4095 of a zero at 2048 is 32 752; of one at 2000 it is beyond the number's
 * end, 32 767, and of one at 2100 code 0 beyond -32 768. */
void test_the_ends_of_a_converter_s_range_are_exact(void)
{
    TEST_ASSERT_TRUE(saturated_at(32768, 32744));
    TEST_ASSERT_FALSE(saturated_at(32768, 32743));
    TEST_ASSERT_TRUE(saturated_at(32768, -32760));
    TEST_ASSERT_FALSE(saturated_at(32768, -32759));
    TEST_ASSERT_TRUE(saturated_at(32000, 32759));
    TEST_ASSERT_FALSE(saturated_at(32000, 32758));
    TEST_ASSERT_TRUE(saturated_at(32000, -31992));
    TEST_ASSERT_FALSE(saturated_at(32000, -31991));
    TEST_ASSERT_TRUE(saturated_at(33600, -32760));
    TEST_ASSERT_FALSE(saturated_at(33600, -32759));
    TEST_ASSERT_TRUE(saturated_at(33600, 31912));
    TEST_ASSERT_FALSE(saturated_at(33600, 31911));
}
