/* SPDX-License-Identifier: Apache-2.0 */
/* A period with the bridge off. */
#include "idle.h"

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
    TEST_ASSERT_EQUAL_INT32(0, dq_of(period->i_reference_pu).q);
    TEST_ASSERT_EQUAL_INT32(0, q_pair_y(foc.current.predictor.predicted_pu.v));
    TEST_ASSERT_EQUAL_INT32(FOC_NO_SETPOINT, foc.sequence);
    for (int x = 0; x < SENSE_PHASES; x++) {
        TEST_ASSERT_EQUAL_INT32(PERIOD_COUNTS / 2, foc.current.on_q16[x] >> 16);
    }
}

void test_centred_on_times_are_half_the_period(void)
{
    foc.current.on_q16[1] = 0;
    idle_centre_on_times(&foc.current);
    TEST_ASSERT_EQUAL_INT32(PERIOD_COUNTS / 2, foc.current.on_q16[1] >> 16);
}
