/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of a period of the fast loop from chosen states: which angle, which sums, when the
 * field is weakened, and what the observer gets. */
#include "foc.c" /* its functions are private */

#include "foc_rig.h"

void setUp(void)
{
    rig_up();
}

void tearDown(void) {}

void test_first_state_is_zero_but_for_what_is_initialised(void)
{
    memset(&foc, 0x55, sizeof(foc));
    foc_init(&foc, &config, BASES_MODEL_TIMER_Hz);
    TEST_ASSERT_EQUAL_UINT16(0, foc.period.rotor.theta_turn);
    TEST_ASSERT_EQUAL_UINT16(0, foc.period.theta_turn);
    TEST_ASSERT_EQUAL_UINT32(0, foc.period.step_count);
    TEST_ASSERT_EQUAL_INT32(FOC_NO_SETPOINT, foc.sequence);
    TEST_ASSERT_EQUAL_UINT32(66, foc.observer.acquisition_periods); /* 20 000/300 */
    for (int x = 0; x < SENSE_PHASES; x++) {
        TEST_ASSERT_EQUAL_INT32(PERIOD_COUNTS / 2, foc.current.on_q16[x] >> 16);
    }
}

/* ---- Field weakening ---- */

/* The square of 1/2 is 1/4: the aim is `margin` above it. The d axis asks for 744 more than 98 % of
 * the circle, and nothing of it is applied. */
static void weaken(int32_t margin, int32_t current_q28)
{
    restart();
    foc.period.voltage.unsaturated_q_q25 = 16384 * 1024;
    foc.period.voltage.unsaturated_d_q25 = (32256 + 744) * 1024;
    foc.weakening.target_square_q15 = 8192 + margin;
    foc.weakening.current_q28 = current_q28;
    foc.current.controller.d.integrator_q30 = 5;
    foc.sequence = 7;
    config.current_loop.field_weakening_gain_pu_q15 = 20;
    config.current_loop.field_weakening_current_pu_q15 = 6000;
    weaken_field(&foc, &config);
}

static void assert_weakened(int32_t current_q28, int32_t integrator_q30, int32_t sequence)
{
    TEST_ASSERT_EQUAL_INT32(current_q28, foc.weakening.current_q28);
    TEST_ASSERT_EQUAL_INT32(integrator_q30, foc.current.controller.d.integrator_q30);
    TEST_ASSERT_EQUAL_INT32(sequence, foc.sequence);
}

void test_field_is_weakened_and_the_reserve_kept_from_the_first_unit_of_shortfall_on(void)
{
    weaken(-1, 0);
    assert_weakened(-20, 5 - 744 * 32768, FOC_NO_SETPOINT);
}

void test_exactly_sufficient_voltage_changes_only_what_is_weakened_already(void)
{
    weaken(0, 0);
    assert_weakened(0, 5, 7);
    weaken(0, -100);
    assert_weakened(-100, 5, FOC_NO_SETPOINT);
    weaken(2, -100);
    assert_weakened(-60, 5, FOC_NO_SETPOINT);
    weaken(1, 0);
    assert_weakened(0, 5, 7);
}

/* ---- Setpoint, sums, angle ---- */

static bool due(int32_t sensor, int32_t periods_since_edge)
{
    foc.rotor.sensor = sensor;
    foc.rotor.hall.periods_since_edge = periods_since_edge;
    return setpoint_is_due(&foc);
}

void test_setpoint_waits_once_and_for_a_hall_edge_only(void)
{
    foc.postponed = false;
    TEST_ASSERT_TRUE(due(CONFIG_ROTOR_ANGLE, 0));
    TEST_ASSERT_TRUE(due(CONFIG_ROTOR_HALL, 1));
    TEST_ASSERT_FALSE(due(CONFIG_ROTOR_HALL, 0));
    TEST_ASSERT_TRUE(due(CONFIG_ROTOR_HALL, 0));
    TEST_ASSERT_FALSE(due(CONFIG_ROTOR_HALL, 0));
    TEST_ASSERT_TRUE(due(CONFIG_ROTOR_HALL, 1));
    TEST_ASSERT_FALSE(foc.postponed);
}

void test_sums_grow_by_the_values_of_the_period(void)
{
    foc_sums_t sums = {.i_d_pu = 10, .i_q_pu = 20, .power_pu = 30, .v_dc_pu = 40};
    foc.period.i_pu.v = q_pair(-1024, 2048);
    foc.period.voltage.applied.v = q_pair(64, 96); /* - 2 + 6 */
    foc.period.v_dc_pu = 1000;
    add_sums(&sums, &foc.period);
    TEST_ASSERT_EQUAL_INT32(10 - 1024, (int32_t)sums.i_d_pu);
    TEST_ASSERT_EQUAL_UINT32(20 + 2048, sums.i_q_pu);
    TEST_ASSERT_EQUAL_UINT32(30 + 4, sums.power_pu);
    TEST_ASSERT_EQUAL_UINT32(40 + 1000, sums.v_dc_pu);
}

void test_observed_angle_less_its_lead_is_used_if_the_setpoint_asks_for_it(void)
{
    in.rotor_angle_turn = 5000;
    for (int used = 0; used <= 1; used++) {
        restart();
        setpoint.observer.used = used != 0;
        setpoint.observer.lead_turn = 1000;
        foc.observer.theta_q32 = (41000U << 16) + 65535U;
        (void)begin_period(&foc, &config, &setpoint, &in);
        TEST_ASSERT_EQUAL_UINT16(used != 0 ? 40000 : 5000, foc.period.theta_turn);
        TEST_ASSERT_EQUAL_UINT16(5000, foc.period.rotor.theta_turn);
        TEST_ASSERT_EQUAL_UINT32(1, foc.period.step_count);
    }
}

/* ---- The observer's inputs ---- */

void test_observer_meets_the_voltage_that_acts_and_the_current_of_the_period(void)
{
    setpoint.observer.volt = q_pair(5000, 5000);
    setpoint.observer.minus_resistance = q_pair(-300, -300);
    setpoint.tuning.forward_q_q25 = 20000 * 1024;
    step(true);
    /* Without an angle or a speed the voltage is the feed-forward, along beta. */
    const ab16_t acting = foc.period.u_ab;
    TEST_ASSERT_INT32_WITHIN(2, 0, q_pair_x(acting.v));
    TEST_ASSERT_INT32_WITHIN(2, 20000, q_pair_y(acting.v));
    emf_observer_t expected = foc.observer;
    codes[1] = 2148;
    codes[2] = 1948;
    step(true);
    TEST_ASSERT_INT32_WITHIN(1, 1847, q_pair_y(period->i_ab_pu.v)); /* 2 * 1600/sqrt 3 */
    emf_observer_step(&expected, acting, period->i_ab_pu, &setpoint.observer);
    TEST_ASSERT_EQUAL_INT32(expected.alpha_q30, foc.observer.alpha_q30);
    TEST_ASSERT_EQUAL_INT32(expected.beta_q30, foc.observer.beta_q30);
    TEST_ASSERT_EQUAL_HEX32(expected.theta_q32, foc.observer.theta_q32);
    TEST_ASSERT_TRUE(foc.observer.beta_q30 > 4000 * 20000);
}
