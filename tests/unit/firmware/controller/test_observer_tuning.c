/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "config/bases.h"
#include "controller/operating_point.h"
#include "foc/foc.h"
#include "foc/observer_design.h"
#include "observer_tuning.h"
#include "paper_vehicle.h"
#include "unity.h"

extern const config_t CONFIG_IPM400V;

static const double PI = 3.14159265358979323846;
static const double T = 50e-6;
static const double PSI_WB = 0.0204;
static const double FULL_SCALE_WB = 2.0 * 0.0204 + 1.25 * 76e-6 * 165.0;

static config_t config;
static observer_constants_t constants;

/* For the model's timer. */
static observer_constants_t constants_of(const config_t *of)
{
    return observer_constants(of, foc_modulation_limit_q15(of, BASES_MODEL_TIMER_Hz));
}

void setUp(void)
{
    config = CONFIG_LU2013;
    constants = constants_of(&config);
}

void tearDown(void) {}

/* x is the flux over 1 - j lambda/w, in discrete time: by the definition of the recursion, here in
 * complex arithmetic. */
void test_lead_is_the_angle_of_the_leaking_integrator(void)
{
    const double leak = observer_design_leak_q24(&config) / 16777216.0;
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 4.0 * 23.0 * 1e-3 * config.rotor.observer_speed_mrad_s * T,
                              leak);
    for (double w = -1533.0; w < 1534.0; w += 17.0) {
        /* x (e - 1 + leak) = psi (e - 1) */
        const double re = cos(w * T) - 1.0;
        const double im = sin(w * T);
        const double lead = atan2(im, re) - atan2(im, re + leak);
        const int32_t speed_q32 = (int32_t)lround(w * T / (2.0 * PI) * 4294967296.0);
        const uint16_t lead_turn = observer_lead_turn(&constants.start, speed_q32);
        TEST_ASSERT_DOUBLE_WITHIN(0.2, 0.0,
                                  360.0 * remainder(lead_turn / 65536.0 - lead / (2.0 * PI), 1.0));
        const double share = hypot(re, im) / hypot(re + leak, im);
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * 16384.0 * PSI_WB / FULL_SCALE_WB,
                                  16384.0 * PSI_WB / FULL_SCALE_WB * share,
                                  observer_expected_flux_q14(&constants, lead_turn));
    }
}

/* A salient motor's leak follows the speed, w T/2 within its start value and 2^15/2^24, with a time
 * constant of 32 steps; while nothing is acquired, or without saliency, it is the start value. */
void test_the_leak_follows_the_speed_of_a_salient_motor_once_it_is_acquired(void)
{
    static const double SLOW = 4e-4, FAST = 0.1; /* turns per period */
    constants = constants_of(&CONFIG_IPM400V);
    const int32_t start_q24 = constants.start.leak_q24;
    observer_leak_t leak = constants.start;
    for (int n = 0; n < 400; n++) {
        observer_leak_step(&leak, &constants, -(int32_t)(SLOW * 4294967296.0), true);
    }
    const double wanted_q24 = fmax(PI * SLOW, 1.0 / 512.0) * 16777216.0;
    TEST_ASSERT_TRUE(wanted_q24 < start_q24);
    TEST_ASSERT_DOUBLE_WITHIN(33.0, wanted_q24, leak.leak_q24);
    for (int n = 0; n < 400; n++) {
        observer_leak_step(&leak, &constants, (int32_t)(FAST * 4294967296.0), true);
    }
    TEST_ASSERT_INT32_WITHIN(33, start_q24, leak.leak_q24);
    observer_leak_step(&leak, &constants, (int32_t)(SLOW * 4294967296.0), true);
    TEST_ASSERT_LESS_THAN_INT32(start_q24, leak.leak_q24);
    observer_leak_step(&leak, &constants, (int32_t)(SLOW * 4294967296.0), false);
    TEST_ASSERT_EQUAL_INT32(start_q24, leak.leak_q24);

    constants = constants_of(&CONFIG_LU2013);
    leak = constants.start;
    observer_leak_step(&leak, &constants, (int32_t)(SLOW * 4294967296.0), true);
    TEST_ASSERT_EQUAL_INT32(constants.start.leak_q24, leak.leak_q24);
}

/* The speed from which the lead is taken: of a salient motor with a time constant of 4 steps while
 * acquired, else the present one. */
void test_the_speed_of_the_lead_is_smoothed_for_a_salient_motor_once_it_is_acquired(void)
{
    enum { SPEED_Q32 = 1 << 20 };
    const fast_report_t still = {.observer = {.acquired = true}};
    for (int salient = 0; salient < 2; salient++) {
        for (int acquired = 0; acquired < 2; acquired++) {
            static operating_point_state_t state;
            config = salient != 0 ? CONFIG_IPM400V : CONFIG_LU2013;
            operating_point_init(&state, &config, BASES_MODEL_TIMER_Hz);
            (void)operating_point_rotor(&state, &config, &still);
            const fast_report_t turns = {
                .observer = {.speed_q32 = SPEED_Q32, .acquired = acquired != 0}};
            (void)operating_point_rotor(&state, &config, &turns);
            TEST_ASSERT_EQUAL_INT32(salient && acquired ? SPEED_Q32 / 4 : SPEED_Q32,
                                    state.observer_speed_q32);
        }
    }
}

void test_voltage_and_resistance_are_shares_of_the_flux_full_scale(void)
{
    const double r_ohm =
        1e-6 * (config.motor.phase_resistance_uOhm + config.drive.loss_resistance_uOhm);
    const double circle_v =
        61.8 / sqrt(3.0) * foc_modulation_limit_q15(&config, BASES_MODEL_TIMER_Hz) / 32768.0;
    const winding_t winding = {.chord_q_q15 = 4321};
    const int32_t cold_cC = config.motor.reference_temperature_cC;
    for (int k = 1; k <= 4; k++) {
        const observer_tuning_t at = observer_tuning(&constants, &winding, &constants.start,
                                                     &config, 8192 * k, 0, cold_cC + 2500 * k);
        const double warm = 1.0 + 0.00393 * 25.0 * k;
        TEST_ASSERT_DOUBLE_WITHIN(1.5, 32768.0 * T * circle_v * k / 4.0 / FULL_SCALE_WB,
                                  q_pair_x(at.volt));
        TEST_ASSERT_DOUBLE_WITHIN(1.5, -32768.0 * T * r_ohm * warm * 165.0 / FULL_SCALE_WB,
                                  q_pair_y(at.minus_resistance));
        TEST_ASSERT_EQUAL_INT32(-4321, q_pair_x(at.minus_inductance));
        TEST_ASSERT_EQUAL_INT32(-4321, q_pair_y(at.minus_inductance));
        TEST_ASSERT_FALSE(at.used);
    }
}
