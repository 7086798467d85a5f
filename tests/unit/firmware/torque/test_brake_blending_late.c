/* SPDX-License-Identifier: Apache-2.0 */
/* Brake blending with a hydraulic brake that is late (hydraulic_model.h); the split itself:
 * test_brake_blending.c. */
#include <math.h>

#include "random_values.h"
#include "split.h"

void setUp(void)
{
    before_blending();
}

void tearDown(void) {}

static void random_situation(random_t *random)
{
    config.brake.strategy = random_between(random, 0, 2);
    config.brake.max_hydraulic_torque_mNm = 1000000;
    capability.regenerating = limit_init(random_between(random, 0, 60000), REASON_MAX_POWER);
    capability.optimal = capability.regenerating;
    limit_tighten(&capability.optimal, random_between(random, 0, 80000), REASON_LOSS_OPTIMUM);
    in.demand_mNm = random_between(random, 0, 300000);
    in.speed_mrad_s = random_between(random, -70000, 70000);
    abs_active = random_chance(random, 0.05);
    in.torque_enable.brake_q15 =
        (int16_t)(random_chance(random, 0.2) ? random_between(random, 0, Q15_ONE) : Q15_ONE);
    in.torque_enable.reason = REASON_TORQUE_ENABLE;
}

/* 40 ms, then 60 ms of lag, as the paper's vehicle has it. */
static void late_hydraulic_brake(void)
{
    config.brake.hydraulic_dead_time_ms = 40;
    config.brake.hydraulic_time_constant_ms = 60;
    config.brake.hydraulic_rate_mNm_s = 2000000;
    config.brake.torque_rate_mNm_s = 400000;
}

/* One step of a motor that follows at its rate; its torque. */
static int32_t driven_mNm;
static brake_blending_out_t step_with_motor(void)
{
    motor_follows(driven_mNm);
    const brake_blending_out_t out = step();
    driven_mNm = q_clamp(out.electric_mNm, driven_mNm - 400, driven_mNm + 400);
    return out;
}

void test_a_motor_that_may_return_takes_what_the_hydraulic_brake_has_left_and_no_more(void)
{
    late_hydraulic_brake();
    driven_mNm = 0;
    in.demand_mNm = 60000;
    abs_active = true;
    for (int n = 0; n < 1000; n++) {
        step_with_motor();
    }
    TEST_ASSERT_INT32_WITHIN(1, 60000, hydraulic_model_torque_mNm(&state.hydraulic));
    abs_active = false;
    for (int n = 0; n < 2000; n++) {
        const brake_blending_out_t out = step_with_motor();
        TEST_ASSERT_LESS_OR_EQUAL_INT32(60000, out.electric_mNm +
                                                   hydraulic_model_torque_mNm(&state.hydraulic));
    }
    TEST_ASSERT_INT32_WITHIN(2, 24000, driven_mNm);
    assert_split(24000, 36000, REASON_LOSS_OPTIMUM, step());
}

void test_whatever_happens_motor_and_estimated_hydraulic_brake_end_at_the_demand(void)
{
    random_t random = random_seeded(9);
    for (int n = 0; n < 300; n++) {
        late_hydraulic_brake();
        random_situation(&random);
        abs_active = false;
        config.brake.hydraulic_dead_time_ms = random_between(&random, 0, 250);
        config.brake.hydraulic_time_constant_ms = random_between(&random, 0, 300);
        brake_blending_init(&state);
        driven_mNm = random_between(&random, 0, 60000);
        brake_blending_out_t out = {0};
        for (int k = 0; k < 5000; k++) {
            out = step_with_motor();
            TEST_ASSERT_LESS_OR_EQUAL_INT32(in.demand_mNm, out.hydraulic_mNm);
            TEST_ASSERT_LESS_OR_EQUAL_INT32(out.available.torque_mNm, out.electric_mNm);
        }
        /* The estimate rests where a 64th of a mN m is less than the lag has steps: 301/64. */
        TEST_ASSERT_INT32_WITHIN(5, in.demand_mNm, driven_mNm + out.hydraulic_mNm);
        TEST_ASSERT_INT32_WITHIN(5, in.demand_mNm,
                                 driven_mNm + hydraulic_model_torque_mNm(&state.hydraulic));
    }
}

void test_the_hydraulic_command_goes_ahead_of_a_falling_limit_by_dead_time_and_lag(void)
{
    late_hydraulic_brake();
    in.demand_mNm = 30000;
    driven_mNm = 30000;
    brake_blending_out_t out = {0};
    for (int n = 0; n <= 1500; n++) { /* 20 N m/s */
        capability.optimal = limit_init(50000 - 20 * n, REASON_LOSS_OPTIMUM);
        out = step_with_motor();
        if (n > 500) { /* the limit's low-pass has come to its lag of 64 ms; the estimate's to its
                          own */
            TEST_ASSERT_INT32_WITHIN(150, 30000,
                                     driven_mNm + hydraulic_model_torque_mNm(&state.hydraulic));
        }
    }
    /* 20 N m are left: 10 of 30, and 2 N m for the 100 ms. */
    TEST_ASSERT_INT32_WITHIN(60, 10000 + 2000, out.hydraulic_mNm);
}

/* A low-pass is behind a ramp by slope * tau (1 - exp(-t/tau)): one time constant of 64 ms after a
 * limit has begun to fall the command leads by 63 % of dead time and lag, after two by 86 %. */
void test_how_a_limit_falls_is_known_after_64_ms(void)
{
    late_hydraulic_brake();
    in.demand_mNm = 50000;
    driven_mNm = 50000;
    capability.optimal = limit_init(50000, REASON_LOSS_OPTIMUM);
    for (int n = 0; n < 1000; n++) {
        step_with_motor();
    }
    for (int n = 1; n <= 128; n++) { /* 20 N m/s: 2 N m in 100 ms */
        capability.optimal = limit_init(50000 - 20 * n, REASON_LOSS_OPTIMUM);
        const brake_blending_out_t out = step_with_motor();
        if (n == 64 || n == 128) {
            const double lead_mNm = 2000.0 * (1.0 - exp(-n / 64.0));
            TEST_ASSERT_INT32_WITHIN(40, 20 * n + (int32_t)lround(lead_mNm), out.hydraulic_mNm);
        }
    }
}

void test_a_motor_that_must_leave_is_counted_on_for_what_it_still_gives_after_the_dead_time(void)
{
    late_hydraulic_brake();
    in.demand_mNm = 24000;
    motor_follows(24000);
    TEST_ASSERT_EQUAL_INT32(0, step().hydraulic_mNm);
    abs_active = true; /* 400 mN m a step for 40 steps */
    TEST_ASSERT_EQUAL_INT32(16000, step().hydraulic_mNm);
}

void test_a_motor_whose_torque_cannot_grow_is_not_waited_for(void)
{
    in.demand_mNm = 20000;
    motor_follows(5000);
    in.motor_growth_mNm = 0;
    assert_split(20000 - 15000, 15000, REASON_TORQUE_RATE, step());
    in.motor_growth_mNm = -400; /* on its way down */
    TEST_ASSERT_EQUAL_INT32(15000, step().hydraulic_mNm);
    in.motor_growth_mNm = 10; /* a newton-metre in the 100 ms that it has */
    TEST_ASSERT_EQUAL_INT32(14000, step().hydraulic_mNm);
}

/* The hydraulic brake stands in for half of the motor; that must not become a reason to ask the
 * motor for less. */
void test_a_lasting_shortfall_is_filled_and_stays_filled(void)
{
    late_hydraulic_brake();
    in.demand_mNm = 20000;
    driven_mNm = 20000;
    brake_blending_out_t out = {0};
    for (int n = 0; n < 3000; n++) {
        in.motor_command_mNm = -driven_mNm;
        in.motor_achieved_mNm = -driven_mNm / 2;
        out = step();
        driven_mNm = q_clamp(out.electric_mNm, driven_mNm - 400, driven_mNm + 400);
    }
    TEST_ASSERT_EQUAL_INT32(20000, driven_mNm);
    TEST_ASSERT_EQUAL_INT32(8000, out.hydraulic_mNm); /* 10 N m are missing, 2 are tolerated */
}
