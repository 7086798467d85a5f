/* SPDX-License-Identifier: Apache-2.0 */
/*
 * From where the back-EMF judges angle and flux, and how much a step counts, in whole numbers: one
 * pole pair at 1000 rad/s, an EMF of 100 V (0.1 Wb), 10 uOhm and 100 uOhm of reactance. Without
 * current and bus voltage U is 1 mV; the tolerance of the flux is 10 V. Then e_d = u_d and e_q =
 * u_q.
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
    const monitor_emf_state_t fresh = {.steady_mrad_s = 1000000, .steady_steps = UINT16_MAX};
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

/* ---- the angle ---- */

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

/* A current along d alone, of which 0.1 mOhm of saliency make so many microvolts. */
static void with_reluctance(int32_t reluctance_uV)
{
    config.motor.phase_resistance_uOhm = 0;
    config.motor.d_inductance_nH = 0;
    config.motor.q_inductance_nH = 100;
    in.now.latest_i_d_mA = -10 * reluctance_uV;
}

/* An EMF of so many millivolts is below 4 U here: it is judged by the sign of e_q alone, which is
 * opposite from U_q on, as is w psi at the least; with a current whose saliency makes half of it.
 */
static void assert_opposite_from(int32_t emf_mV, int32_t u_q_mV)
{
    with_reluctance(emf_mV * 500);
    config.motor.flux_linkage_nWb = emf_mV * 1000;
    TEST_ASSERT_TRUE(is_wrong(0, u_q_mV));
    TEST_ASSERT_FALSE(is_wrong(0, u_q_mV + 1));
    config.motor.flux_linkage_nWb = emf_mV * 1000 - 1;
    TEST_ASSERT_FALSE(is_wrong(0, u_q_mV));
}

/* At least a millivolt; 2/3 of 1.5 % of dead time at 8.75 V are 87.5 mV, a quarter of the
 * saliency's 50 mV 12.5 mV. */
void test_an_opposite_e_q_is_judged_beyond_dead_time_and_a_millivolt(void)
{
    assert_opposite_from(1, -1);
    config.drive.dead_time_ns = 750;
    config.drive.pwm_frequency_Hz = 20000;
    in.now.bus_voltage_mV = 8750;
    assert_opposite_from(100, -100);
}

/* Near zero current the dead time's compensation may be wrong altogether, and the observer sees a
 * half turn there. */
void test_an_opposite_e_q_is_not_judged_beside_a_small_current(void)
{
    config.motor.flux_linkage_nWb = 100000;
    config.drive.dead_time_ns = 750;
    config.drive.pwm_frequency_Hz = 20000;
    in.now.bus_voltage_mV = 8750;
    with_reluctance(50000);
    TEST_ASSERT_TRUE(is_wrong(0, -100));
    in.now.latest_i_d_mA += 1;
    TEST_ASSERT_FALSE(is_wrong(0, -100));
    in.now.latest_i_d_mA = 0;
    TEST_ASSERT_FALSE(is_wrong(0, -100));
}

/* L_q = L_d, or below: a current up to psi/L leaves w psi above 4 U, which decides alone. A wheel
 * that rolls back while its halls still show the way forward is below that. */
void test_an_opposite_e_q_alone_is_not_judged_without_saliency(void)
{
    static const int32_t D_nH[] = {100, 100, 0};
    static const int32_t Q_nH[] = {0, 100, 100};
    config.motor.flux_linkage_nWb = 100000;
    with_reluctance(50000);
    config.drive.dead_time_ns = 750;
    config.drive.pwm_frequency_Hz = 20000;
    in.now.bus_voltage_mV = 8750;
    for (int k = 0; k < 3; k++) {
        config.motor.d_inductance_nH = D_nH[k];
        config.motor.q_inductance_nH = Q_nH[k];
        TEST_ASSERT_EQUAL_INT(k == 2, is_wrong(0, k == 2 ? -100 : -100 - 50));
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
