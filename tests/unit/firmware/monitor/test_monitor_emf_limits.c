/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The angle check at its limits, in whole numbers: one pole pair at 1000 rad/s, an EMF of 100 V
 * (0.1 Wb), 10 uOhm and 100 uOhm of reactance. Without current and bus voltage U is 1 mV; the
 * tolerance of the flux is 10 V. Then e_d = u_d and e_q = u_q.
 */
#include "monitor/monitor_emf.h"
#include "monitor_case.h"
#include "paper_vehicle.h"
#include "unity.h"

enum { EMF_mV = 100000, TOLERANCE_mV = 10000, UNCERTAIN_mV = 1, HALF_Q20 = 1 << 19 };

static config_t config;
static monitor_emf_state_t state;
static monitor_case_t in;

void setUp(void)
{
    const monitor_emf_state_t fresh = {.level = 0};
    const monitor_case_t turning = {.report = {.bridge = BRIDGE_PWM},
                                    .now = {.angle_valid = true,
                                            .speed_mrad_s = 1000000,
                                            .winding_temperature_cC = 2500,
                                            .latest_u_q_mV = EMF_mV}};
    config = paper_vehicle();
    config.motor.pole_pairs = 1;
    config.motor.phase_resistance_uOhm = 10;
    config.motor.d_inductance_nH = 100;
    config.motor.q_inductance_nH = 100;
    config.motor.flux_linkage_nWb = 100000000;
    config.motor.flux_coefficient_ppm_K = 0;
    config.monitor.flux_tolerance_permille = 100;
    config.monitor.angle_fault_time_ms = 100;
    state = fresh;
    in = turning;
}

void tearDown(void) {}

static void step_with(int32_t e_d_mV, int32_t e_q_mV)
{
    in.now.latest_u_d_mV = e_d_mV;
    in.now.latest_u_q_mV = e_q_mV;
    (void)monitor_emf_step(&state, &config, measured_of(&in));
}

/* One step counts against the angle. */
static bool is_wrong(int32_t e_d_mV, int32_t e_q_mV)
{
    state.level = 0;
    step_with(e_d_mV, e_q_mV);
    return state.level > 0;
}

/* ---- what is measured ---- */

/* Half of 100 Ohm at a milliampere are 50 mV, four of which are more than an EMF of 100 mV; e_q is
 * not negative. */
void test_the_current_counts_by_its_magnitude(void)
{
    int32_t *const currents_mA[] = {&in.now.latest_i_d_mA, &in.now.latest_i_q_mA};
    config.motor.flux_linkage_nWb = 100000;
    config.motor.phase_resistance_uOhm = 100000000;
    TEST_ASSERT_TRUE(is_wrong(1000, 100));
    for (int k = 0; k < 2; k++) {
        for (int32_t i_mA = -1; i_mA <= 1; i_mA += 2) {
            *currents_mA[k] = i_mA;
            TEST_ASSERT_FALSE(is_wrong(1000, 100));
        }
        *currents_mA[k] = 0;
    }
}

/* 1 H at 4000 rad/s; 2^31 uOhm at 1 mA are 2.147 V. */
void test_a_reactance_saturates(void)
{
    in.now.speed_mrad_s = 4000000;
    config.motor.flux_linkage_nWb = 25000000;
    config.motor.d_inductance_nH = 1000000000;
    config.motor.q_inductance_nH = 1000000000;
    in.now.latest_i_q_mA = 1;
    TEST_ASSERT_TRUE(is_wrong(0, 2147));
    TEST_ASSERT_FALSE(is_wrong(0, 2148));
}

/* e_d = x_q i_q, e_q = u_q - x_d i_d: 3 mOhm and 1 mOhm at 1 kA. U is 0.755 V. */
void test_each_axis_has_its_own_reactance(void)
{
    config.motor.d_inductance_nH = 1000;
    config.motor.q_inductance_nH = 3000;
    in.now.latest_i_q_mA = 1000000;
    TEST_ASSERT_TRUE(is_wrong(0, 3010)); /* 10 mV at the resistance */
    TEST_ASSERT_FALSE(is_wrong(0, 3011));
    in.now.latest_i_q_mA = 0;
    in.now.latest_i_d_mA = 1000000;
    TEST_ASSERT_TRUE(is_wrong(3010, 4000));
    TEST_ASSERT_FALSE(is_wrong(3009, 4000));
}

/* 10 kA at 10 uOhm are 0.1 V; U is 0.3 V. */
void test_a_current_counts_up_to_10_kA(void)
{
    static const int32_t CURRENTS_mA[] = {10000000, 2000000000};
    config.motor.d_inductance_nH = 0;
    config.motor.q_inductance_nH = 0;
    for (int k = 0; k < 2; k++) {
        in.now.latest_i_d_mA = CURRENTS_mA[k];
        TEST_ASSERT_TRUE(is_wrong(10100, 10000));
        TEST_ASSERT_FALSE(is_wrong(10099, 10000));
        in.now.latest_i_d_mA = -CURRENTS_mA[k];
        TEST_ASSERT_TRUE(is_wrong(-10100, 10000));
        TEST_ASSERT_FALSE(is_wrong(-10099, 10000));
        in.now.latest_i_d_mA = 0;
        in.now.latest_i_q_mA = CURRENTS_mA[k];
        TEST_ASSERT_TRUE(is_wrong(10000, 10100));
        TEST_ASSERT_FALSE(is_wrong(10000, 10101));
        in.now.latest_i_q_mA = -CURRENTS_mA[k];
        TEST_ASSERT_TRUE(is_wrong(10000, 9900));
        TEST_ASSERT_FALSE(is_wrong(10000, 9901));
        in.now.latest_i_q_mA = 0;
    }
}

/* ---- the angle ---- */

/* 1 uOhm at 1 mA across the axis, and 1 nV less than 1 mV along it. */
void test_a_nanovolt_across_the_axis_is_no_less_than_one_along_it(void)
{
    config.motor.phase_resistance_uOhm = 1;
    config.motor.d_inductance_nH = 999999;
    config.motor.q_inductance_nH = 999999;
    in.now.latest_i_d_mA = 1;
    TEST_ASSERT_TRUE(is_wrong(0, 1));
}

/* A quarter of 4 Ohm at 0.1 A, of the larger reactance and in both directions. */
void test_the_angle_is_judged_beyond_four_times_the_larger_reactance(void)
{
    for (int side = -1; side <= 1; side += 2) {
        config.motor.phase_resistance_uOhm = 0;
        config.motor.d_inductance_nH = 4000000;
        config.motor.q_inductance_nH = 100;
        in.now.speed_mrad_s = side * 1000000;
        in.now.latest_i_q_mA = 100;
        config.motor.flux_linkage_nWb = 400000;
        TEST_ASSERT_TRUE(is_wrong(-400, 0));
        config.motor.flux_linkage_nWb = 400000 - 1;
        TEST_ASSERT_FALSE(is_wrong(-400, 0));
    }
}

/* An EMF of so many millivolts is below 4 U here: it is judged by the sign of e_q alone, which is
 * opposite from U_q on, as is w psi at the least; in a salient motor, by 1 nH here. */
static void assert_opposite_from(int32_t emf_mV, int32_t u_q_mV)
{
    if (config.motor.q_inductance_nH == config.motor.d_inductance_nH) {
        config.motor.q_inductance_nH++;
    }
    config.motor.flux_linkage_nWb = emf_mV * 1000;
    TEST_ASSERT_TRUE(is_wrong(0, u_q_mV));
    TEST_ASSERT_FALSE(is_wrong(0, u_q_mV + 1));
    config.motor.flux_linkage_nWb = emf_mV * 1000 - 1;
    TEST_ASSERT_FALSE(is_wrong(0, u_q_mV));
}

/* At least a millivolt; 2/3 of 1.5 % of dead time at 10 V are 100 mV. */
void test_an_opposite_e_q_is_judged_beyond_dead_time_and_a_millivolt(void)
{
    assert_opposite_from(1, -1);
    config.drive.dead_time_ns = 750;
    config.drive.pwm_frequency_Hz = 20000;
    in.now.bus_voltage_mV = 10000;
    assert_opposite_from(100, -100);
}

/* Half of 100 Ohm at 2 mA are 100 mV, e_q is u_q - R i_q. */
void test_an_opposite_e_q_is_judged_beyond_half_of_the_resistance(void)
{
    config.motor.phase_resistance_uOhm = 100000000;
    in.now.latest_i_q_mA = 2;
    assert_opposite_from(100, -100 + 200);
    in.now.latest_i_q_mA = -2;
    assert_opposite_from(100, -100 - 200);
}

/* A quarter of 4 Ohm at 0.1 A are 100 mV, e_q is u_q - x_d i_d. Turning backwards the EMF and e_q
 * change their signs. */
void test_an_opposite_e_q_is_judged_beyond_a_quarter_of_the_reactance(void)
{
    config.motor.d_inductance_nH = 4000000;
    config.motor.q_inductance_nH = 4000000;
    in.now.latest_i_d_mA = 100;
    assert_opposite_from(100, -100 + 400);
    in.now.latest_i_d_mA = -100;
    assert_opposite_from(100, -100 - 400);
}

/* A quarter of 4 Ohm that the axes differ by, at |i|, at most the larger plus half of the smaller.
 */
void test_an_opposite_e_q_is_judged_beyond_a_quarter_of_the_saliency(void)
{
    config.motor.phase_resistance_uOhm = 1;
    config.motor.d_inductance_nH = 1;
    config.motor.q_inductance_nH = 4000001;
    in.now.latest_i_q_mA = 100;
    assert_opposite_from(100, -100);
    in.now.latest_i_d_mA = -60;
    assert_opposite_from(130, -130);
}

/* L_q = L_d, or below: a current up to psi/L leaves w psi above 4 U, which decides alone. A wheel
 * that rolls back while its halls still show the way forward is below that. */
void test_an_opposite_e_q_alone_is_not_judged_without_saliency(void)
{
    config.motor.flux_linkage_nWb = 100000;
    config.drive.dead_time_ns = 750;
    config.drive.pwm_frequency_Hz = 20000;
    in.now.bus_voltage_mV = 10000;
    for (int32_t q_nH = 999; q_nH <= 1001; q_nH++) {
        config.motor.d_inductance_nH = 1000;
        config.motor.q_inductance_nH = q_nH;
        TEST_ASSERT_EQUAL_INT(q_nH > 1000, is_wrong(0, -100));
    }
}

/* Half of the EMF across, or against it: a step of full weight. */
void test_the_weight_of_a_step_is_exact(void)
{
    TEST_ASSERT_TRUE(is_wrong(EMF_mV / 2, 0));
    TEST_ASSERT_EQUAL_INT(MONITOR_EMF_SEEN, state.level);
    TEST_ASSERT_TRUE(is_wrong(-EMF_mV / 2 + 1, 0));
    TEST_ASSERT_EQUAL_INT(1, state.level);
    TEST_ASSERT_TRUE(is_wrong(0, -EMF_mV / 2));
    TEST_ASSERT_EQUAL_INT(MONITOR_EMF_SEEN, state.level);
    TEST_ASSERT_TRUE(is_wrong(0, -EMF_mV / 2 + 1));
    TEST_ASSERT_EQUAL_INT(1, state.level);
}

void test_a_step_without_a_contradiction_takes_its_full_weight_away(void)
{
    state.level = 3 * MONITOR_EMF_SEEN;
    step_with(0, EMF_mV);
    TEST_ASSERT_EQUAL_INT(2 * MONITOR_EMF_SEEN, state.level);
    in.report.bridge = BRIDGE_OFF;
    step_with(0, EMF_mV);
    TEST_ASSERT_EQUAL_INT(0, state.level);
}

/* ---- the flux ---- */

/* Outside of the tolerance but for U: a plausible flux is on its way back, a weak one is not. */
void test_a_flux_between_tolerance_and_uncertainty_heals_only_what_is_not_qualified(void)
{
    state.flux_level = -3;
    step_with(0, EMF_mV - TOLERANCE_mV - UNCERTAIN_mV);
    TEST_ASSERT_EQUAL_INT(-2, state.flux_level);
    step_with(0, EMF_mV - TOLERANCE_mV - UNCERTAIN_mV - 1);
    TEST_ASSERT_EQUAL_INT(-3, state.flux_level);
    state.flux = MONITOR_EMF_FLUX_WEAK;
    step_with(0, EMF_mV - TOLERANCE_mV - UNCERTAIN_mV);
    TEST_ASSERT_EQUAL_INT(-3, state.flux_level);
    step_with(0, EMF_mV - TOLERANCE_mV);
    TEST_ASSERT_EQUAL_INT(-2, state.flux_level);
}

/* The largest loss of e_q that is not yet judged as weak, beyond the tolerance. */
static int32_t uncertain_mV(int32_t i_d_mA, int32_t i_q_mA)
{
    const config_motor_t *motor = &config.motor;
    in.now.latest_i_d_mA = i_d_mA;
    in.now.latest_i_q_mA = i_q_mA;
    const int32_t r_uOhm = motor->phase_resistance_uOhm;
    int32_t lost_mV = 0;
    do {
        lost_mV++;
        state.flux_level = 0;
        /* 1000 rad/s make an uOhm of a nH. */
        step_with(r_uOhm / 1000 * i_d_mA / 1000 - motor->q_inductance_nH / 1000 * i_q_mA / 1000,
                  EMF_mV - TOLERANCE_mV - lost_mV + r_uOhm / 1000 * i_q_mA / 1000 +
                      motor->d_inductance_nH / 1000 * i_d_mA / 1000);
    } while (state.flux_level == 0 && lost_mV < 10000);
    return lost_mV - 1;
}

/* R/2 |i_q| + x_d/4 |i_d| + |x_q - x_d|/4 times 10 + 4/2 A, with 0.4, 0.8 and 1.2 Ohm. */
void test_the_uncertainty_of_the_flux_is_that_along_the_q_axis(void)
{
    config.motor.phase_resistance_uOhm = 0;
    config.motor.d_inductance_nH = 800000;
    config.motor.q_inductance_nH = 800000;
    TEST_ASSERT_EQUAL_INT32(UNCERTAIN_mV, uncertain_mV(0, 10000));
    TEST_ASSERT_EQUAL_INT32(2000, uncertain_mV(10000, 0));
    TEST_ASSERT_EQUAL_INT32(2000, uncertain_mV(-10000, 0));
    config.motor.phase_resistance_uOhm = 400000;
    TEST_ASSERT_EQUAL_INT32(2000, uncertain_mV(0, 10000));
    TEST_ASSERT_EQUAL_INT32(2000, uncertain_mV(0, -10000));
    config.motor.q_inductance_nH = 1200000;
    TEST_ASSERT_EQUAL_INT32(2000 + 800 + 1200, uncertain_mV(-4000, 10000));
    TEST_ASSERT_EQUAL_INT32(800 + 2000 + 1200, uncertain_mV(10000, -4000));
    config.motor.d_inductance_nH = 1200000;
    config.motor.q_inductance_nH = 800000;
    TEST_ASSERT_EQUAL_INT32(800 + 3000 + 1200, uncertain_mV(10000, -4000));
}

void test_only_a_weak_flux_has_a_missing_share(void)
{
    state.missing_q20 = 1000;
    step_with(0, EMF_mV);
    TEST_ASSERT_EQUAL_INT32(0, state.missing_q20);
}

static int32_t missing_after(int32_t missing_q20, int32_t e_q_mV)
{
    state.flux = MONITOR_EMF_FLUX_WEAK;
    state.flux_level = -MONITOR_EMF_FLUX_STEPS;
    state.missing_q20 = missing_q20;
    step_with(0, e_q_mV);
    return state.missing_q20;
}

/* By a 64th of the difference a step, rounded towards zero. */
void test_the_missing_share_is_filtered_and_at_most_a_half(void)
{
    TEST_ASSERT_EQUAL_INT32(HALF_Q20 / 2 / 64, missing_after(0, EMF_mV * 3 / 4));
    TEST_ASSERT_EQUAL_INT32(HALF_Q20 / 64, missing_after(0, EMF_mV / 5));
    TEST_ASSERT_EQUAL_INT32(HALF_Q20 - 63, missing_after(HALF_Q20 - 64, EMF_mV / 5));
    TEST_ASSERT_EQUAL_INT32(HALF_Q20 - 63, missing_after(HALF_Q20 - 63, EMF_mV / 5));
}

/* 4 mV of 4.096 V: 4095 times too strong is no number of 32 bits with 20 digits. */
void test_a_flux_that_is_too_strong_has_no_missing_share(void)
{
    TEST_ASSERT_EQUAL_INT32(63, missing_after(64, 2 * EMF_mV));
    TEST_ASSERT_EQUAL_INT32(63, missing_after(63, 2 * EMF_mV));
    config.motor.flux_linkage_nWb = 4096;
    TEST_ASSERT_EQUAL_INT32(6400 - 100, missing_after(6400, 16384));
    TEST_ASSERT_EQUAL_INT32(6400 - 100, missing_after(6400, 16380));
}

/* A tenth of 5 mV, the least share of the flux at any temperature. */
void test_an_expected_emf_below_a_millivolt_has_no_missing_share(void)
{
    config.motor.flux_linkage_nWb = 5000;
    config.motor.flux_coefficient_ppm_K = -2000;
    in.now.winding_temperature_cC = 200000;
    TEST_ASSERT_EQUAL_INT32(6400 - 100, missing_after(6400, 1000));
}
