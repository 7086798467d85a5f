/* SPDX-License-Identifier: Apache-2.0 */
/* Park and inverse Park: known vectors, round trips and the largest inputs. The property tests give
 * maximum errors over millions of inputs. */
#include <math.h>
#include <stdlib.h>

#include "transforms.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

/* The kernels take and give packed vectors; the tests count in their components. */
static dq_t park(ab_t x, rotation_t angle)
{
    const ab16_t packed = {.v = q_pair(x.alpha, x.beta)};
    return dq_of(transforms_park(packed, angle));
}

static const double PI = 3.14159265358979323846;

void test_park_at_the_quarter_turns_swaps_and_negates(void)
{
    const ab_t x = {.alpha = 12000, .beta = -7000};
    const int32_t expected[4][2] = {
        {12000, -7000}, {-7000, -12000}, {-12000, 7000}, {7000, 12000}}; /* d, q */
    for (int k = 0; k < 4; k++) {
        const dq_t out = park(x, angle_rotation((uint16_t)(k * ANGLE_QUARTER_TURN)));
        TEST_ASSERT_INT32_WITHIN(1, expected[k][0], out.d);
        TEST_ASSERT_INT32_WITHIN(1, expected[k][1], out.q);
    }
}

void test_q_leads_d_by_a_quarter_turn(void)
{
    /* A vector that is a quarter turn ahead of the rotor lies on the positive q axis. */
    for (uint32_t theta = 0; theta < 65536U; theta += 1111U) {
        const sincos_t ahead = angle_sincos((uint16_t)(theta + ANGLE_QUARTER_TURN));
        const ab_t x = {.alpha = (ahead.cos * 20000) / 32768, .beta = (ahead.sin * 20000) / 32768};
        const dq_t out = park(x, angle_rotation((uint16_t)theta));
        TEST_ASSERT_INT32_WITHIN(4, 0, out.d);
        TEST_ASSERT_INT32_WITHIN(4, 20000, out.q);
    }
}

void test_park_and_inverse_park_return_the_vector_at_every_angle(void)
{
    /* Each direction rounds down (1 LSB) and uses sine and cosine within 1.5 LSB of Q15, which at
     * length 25 000 is 1.6 LSB of the result for two terms; twice that. */
    static const int32_t VECTORS[][2] = {
        {25000, 0}, {0, 25000}, {-17677, 17677}, {3, -25000}, {-25000, -1}};
    for (uint32_t theta = 0; theta < 65536U; theta++) {
        const rotation_t angle = angle_rotation((uint16_t)theta);
        for (unsigned i = 0; i < sizeof(VECTORS) / sizeof(VECTORS[0]); i++) {
            const ab_t x = {.alpha = VECTORS[i][0], .beta = VECTORS[i][1]};
            const ab_t back = transforms_inverse_park(dq16_of(park(x, angle)), angle);
            TEST_ASSERT_INT32_WITHIN(5, x.alpha, back.alpha);
            TEST_ASSERT_INT32_WITHIN(5, x.beta, back.beta);
        }
    }
}

void test_the_longest_measured_vector_saturates_its_components_at_every_angle(void)
{
    static const ab_t LONGEST[] = {
        {-32768, 32767}, {-32768, -32768}, {32767, -32768}, {32767, 32767}};
    for (uint32_t theta = 0; theta < 65536U; theta++) {
        const double turn = theta * 2.0 * PI / 65536.0;
        const rotation_t angle = angle_rotation((uint16_t)theta);
        for (int i = 0; i < 4; i++) {
            const ab_t x = LONGEST[i];
            const dq_t out = park(x, angle);
            const double d = x.alpha * cos(turn) + x.beta * sin(turn);
            const double q = x.beta * cos(turn) - x.alpha * sin(turn);
            TEST_ASSERT_DOUBLE_WITHIN(4.0, fmax(fmin(d, 32767.0), -32768.0), out.d);
            TEST_ASSERT_DOUBLE_WITHIN(4.0, fmax(fmin(q, 32767.0), -32768.0), out.q);
        }
    }
}

void test_advancing_an_angle_equals_adding_the_angles(void)
{
    /* Two products of factors that are each 1.5 LSB off the truth, rounded down: 1.5 sqrt 2 * 2
     * + 1. */
    for (uint32_t theta = 0; theta < 65536U; theta += 7U) {
        for (uint32_t by = 0; by < 65536U; by += 4099U) {
            const rotation_t out =
                transforms_advance(angle_rotation((uint16_t)theta), angle_rotation((uint16_t)by));
            const double exact = (theta + by) * 2.0 * PI / 65536.0;
            TEST_ASSERT_DOUBLE_WITHIN(5.3, 32768.0 * sin(exact), q_pair_y(out.v));
            TEST_ASSERT_DOUBLE_WITHIN(5.3, 32768.0 * cos(exact), q_pair_x(out.v));
        }
    }
}

void test_phases_of_a_vector_are_exact_to_the_last_unit(void)
{
    const ab_t i = {.alpha = 1001, .beta = 30001}; /* sqrt(3)/2 of it: 25 981.7 */
    const abc_t phases = transforms_inverse_clarke(i);
    TEST_ASSERT_EQUAL_INT32(1001, phases.a);
    TEST_ASSERT_EQUAL_INT32(25981 - 500, phases.b);
    TEST_ASSERT_EQUAL_INT32(-25981 - 500, phases.c);
}

void test_phases_add_up_to_zero_but_for_rounding(void)
{
    for (int32_t alpha = -65535; alpha <= 65535; alpha += 4369) {
        for (int32_t beta = -65535; beta <= 65535; beta += 4369) {
            const ab_t x = {.alpha = alpha, .beta = beta};
            const abc_t phases = transforms_inverse_clarke(x);
            TEST_ASSERT_INT32_WITHIN(1, 0, phases.a + phases.b + phases.c);
            TEST_ASSERT_DOUBLE_WITHIN(2.0, beta, (phases.b - phases.c) / sqrt(3.0));
        }
    }
}
