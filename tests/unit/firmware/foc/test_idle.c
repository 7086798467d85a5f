/* SPDX-License-Identifier: Apache-2.0 */
/* A period with the bridge off. */
#include "idle.c" /* its functions are private */

#include "foc_rig.h"

void setUp(void)
{
    rig_up();
}

void tearDown(void) {}

void test_idle_step_resets_the_controller_state(void)
{
    setpoint.i_reference_pu.q = 5000;
    for (int n = 0; n < 100; n++) {
        step(true);
    }
    TEST_ASSERT_NOT_EQUAL(0, foc.current.controller.q.integrator_q30);
    idle_step(&foc, &setpoint, codes);
    TEST_ASSERT_EQUAL_INT32(0, foc.current.controller.q.integrator_q30);
    TEST_ASSERT_EQUAL_INT32(0, dq_of(period->i_reference_pu).d);
    TEST_ASSERT_EQUAL_INT32(0, dq_of(period->i_reference_pu).q);
    TEST_ASSERT_EQUAL_INT32(0, q_pair_y(foc.current.predictor.predicted_pu.v));
    TEST_ASSERT_EQUAL_INT32(FOC_NO_SETPOINT, foc.sequence);
    for (int x = 0; x < SENSE_PHASES; x++) {
        TEST_ASSERT_EQUAL_INT32(PERIOD_COUNTS / 2, foc.current.on_q16[x] >> 16);
    }
}

void test_idle_step_applies_no_voltage_and_weakens_no_field(void)
{
    foc.period.voltage.unsaturated_d_q25 = 1;
    foc.period.voltage.unsaturated_q_q25 = 2;
    foc.period.voltage.applied.v = q_pair(3, 4);
    foc.period.u_ab.v = q_pair(3, 4);
    foc.u_acting.v = q_pair(3, 4);
    foc.weakening.current_q28 = -5;
    foc.observer.periods = 6;
    foc.observer.x.v = q_pair(7, 8);
    idle_step(&foc, &setpoint, codes);
    TEST_ASSERT_EQUAL_INT32(0, period->voltage.unsaturated_d_q25);
    TEST_ASSERT_EQUAL_INT32(0, period->voltage.unsaturated_q_q25);
    TEST_ASSERT_EQUAL_INT32(0, q_pair_x(period->voltage.applied.v));
    TEST_ASSERT_EQUAL_INT32(0, q_pair_y(period->voltage.applied.v));
    TEST_ASSERT_EQUAL_INT32(0, q_pair_x(period->u_ab.v));
    TEST_ASSERT_EQUAL_INT32(0, q_pair_y(period->u_ab.v));
    TEST_ASSERT_EQUAL_INT32(0, q_pair_x(foc.u_acting.v));
    TEST_ASSERT_EQUAL_INT32(0, q_pair_y(foc.u_acting.v));
    TEST_ASSERT_EQUAL_INT32(0, foc.weakening.current_q28);
    TEST_ASSERT_EQUAL_UINT32(0, foc.observer.periods);
    TEST_ASSERT_EQUAL_INT32(0, q_pair_x(foc.observer.x.v));
}

/* Codes of 100 in phase b and -100 in c: no alpha current, beta 2 * 1600/sqrt 3 = 1847.5; then 50
 * more in b, so that the sum is 800 and phase a is reconstructed as minus 800. */
void test_idle_step_sums_up_the_current_of_the_stator(void)
{
    codes[1] = 2148;
    codes[2] = 1948;
    idle_step(&foc, &setpoint, codes);
    TEST_ASSERT_EQUAL_INT32(0, q_pair_x(period->i_ab_pu.v));
    TEST_ASSERT_INT32_WITHIN(1, 1847, q_pair_y(period->i_ab_pu.v));
    TEST_ASSERT_EQUAL_INT32(0, period->current_sum_pu);
    const int32_t beta = q_pair_y(period->i_ab_pu.v);
    codes[1] = 2198;
    idle_step(&foc, &setpoint, codes);
    TEST_ASSERT_EQUAL_INT32(800, period->current_sum_pu);
    TEST_ASSERT_EQUAL_INT32(-800, (int32_t)foc.idle_alpha_pu);
    TEST_ASSERT_EQUAL_INT32(beta + q_pair_y(period->i_ab_pu.v), (int32_t)foc.idle_beta_pu);
}

/* An axis belongs to the quadrant that follows it in the upper half plane, and the negative beta
 * axis to the last one. */
void test_quadrants_are_counted_from_the_alpha_axis(void)
{
    static const int32_t VECTORS[][3] = {{0, 0, 0},  {5, 1, 0},   {0, 5, 0},  {-1, 5, 1},
                                         {-1, 0, 1}, {-5, -1, 2}, {0, -1, 3}, {1, -1, 3},
                                         {1, 0, 0},  {1, 1, 0}};
    for (unsigned k = 0; k < sizeof VECTORS / sizeof VECTORS[0]; k++) {
        const ab16_t i = {.v = q_pair(VECTORS[k][0], VECTORS[k][1])};
        count_quadrants(&foc, i);
        TEST_ASSERT_EQUAL_UINT32(VECTORS[k][2], foc.quadrant);
    }
}

void test_centred_on_times_are_half_the_period(void)
{
    foc.current.on_q16[1] = 0;
    idle_centre_on_times(&foc.current);
    TEST_ASSERT_EQUAL_INT32(PERIOD_COUNTS / 2, foc.current.on_q16[1] >> 16);
}
