/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What the slow step expects of a hydraulic brake that takes its own path: it makes the braking
 * torque that was asked for last, without a command, and has to let go of it afterwards.
 */
#include "torque_rig.h"
#include "unity.h"

enum { ASKED_mNm = 60000 };

void setUp(void)
{
    torque_rig_reset();
}

void tearDown(void) {}

/* Ten time constants and the dead time: all but 1/20 000 of the torque. */
static int settled_ms(void)
{
    return config.brake.hydraulic_dead_time_ms + 10 * config.brake.hydraulic_time_constant_ms +
           ASKED_mNm / (config.brake.hydraulic_rate_mNm_s / 1000);
}

static int32_t modelled_mNm(void)
{
    return hydraulic_model_torque_mNm(&state.blending.hydraulic);
}

static void lose_the_demand(void)
{
    in.brake_torque_mNm = ASKED_mNm;
    run(settled_ms());
    in.demand_age_ms = UINT32_MAX;
    run(config.driver.lost_hold_ms + config.brake.hydraulic_dead_time_ms);
    run(settled_ms());
}

/* The lag of whole numbers of a 64th ends up to its own length, in ms, of 64ths short. */
void test_on_its_own_path_the_brake_makes_the_braking_torque_asked_for_last(void)
{
    lose_the_demand();
    TEST_ASSERT_FALSE(step().hydraulic_valid);
    TEST_ASSERT_INT32_WITHIN(config.brake.hydraulic_time_constant_ms / 64 + 1 + ASKED_mNm / 20000,
                             ASKED_mNm, modelled_mNm());
}

void test_the_brake_lets_go_of_its_own_path_as_the_demand_comes_back(void)
{
    lose_the_demand();
    in.demand_age_ms = 0;
    in.brake_torque_mNm = 0;
    TEST_ASSERT_TRUE(step().hydraulic_valid);
    TEST_ASSERT_GREATER_THAN_INT32(ASKED_mNm / 2, modelled_mNm());
    run(settled_ms());
    TEST_ASSERT_LESS_OR_EQUAL_INT32(
        config.brake.hydraulic_time_constant_ms / 64 + 1 + ASKED_mNm / 20000, modelled_mNm());
}

/* A valid demand has no path beside its commands: not a millinewton-metre is added to them. */
void test_a_valid_demand_adds_zero_to_its_commands(void)
{
    TEST_ASSERT_EQUAL_INT32(0, step().hydraulic_added_mNm);
    in.brake_torque_mNm = ASKED_mNm;
    for (int n = 0; n < settled_ms(); n++) {
        TEST_ASSERT_EQUAL_INT32(0, step().hydraulic_added_mNm);
    }
}
