/* SPDX-License-Identifier: Apache-2.0 */
/* The plausibility of the rotor angle in a salient motor, whose current makes more voltage than its
 * magnets. */
#include "emf_motor.h"
#include "random_values.h"
#include "unity.h"

/* 18 mOhm, 0.37 and 1.2 mH, 66 mWb, 3 pole pairs, 0.5 us at 10 kHz. */
void setUp(void)
{
    config = paper_vehicle();
    config.motor.pole_pairs = 3;
    config.motor.phase_resistance_uOhm = 18000;
    config.motor.d_inductance_nH = 370000;
    config.motor.q_inductance_nH = 1200000;
    config.motor.flux_linkage_nWb = 66000000;
    config.drive.dead_time_ns = 500;
    config.drive.pwm_frequency_Hz = 10000;
    config.rotor.sensor = CONFIG_ROTOR_ANGLE;
    state.level = 0;
}

void tearDown(void) {}

static int time_to(double rpm, double i_d_a, double i_q_a, double offset_deg)
{
    const monitor_case_t in = measured(rpm, i_d_a, i_q_a, offset_deg, &AS_CONFIGURED);
    return time_to_fault(&in);
}

/* 200 A, i_d = -107 A in the estimated frame, the rotor half a turn away. U_q = 1.70 V of R and
 * dead time + w (0.37 mH/4 * 107 A + 0.83 mH/4 * (169 + 107/2) A), the second term 56.1 mWb, is
 * below w psi from 171 rad/s = 545 r/min on; U, 99 mWb w and more, at no speed. */
void test_half_a_turn_with_all_the_current_is_a_fault_within_20_ms(void)
{
    for (int back = -1; back <= 1; back += 2) {
        TEST_ASSERT_EQUAL_INT(-1, time_to(back * 530.0, 107.0, 169.0, 180.0));
        for (double rpm = 560.0; rpm <= 11000.0; rpm *= 1.2) {
            TEST_ASSERT_EQUAL_INT(20, time_to(back * rpm, 107.0, 169.0, 180.0));
            TEST_ASSERT_EQUAL_INT(20, time_to(back * rpm, 107.0, -169.0, 180.0));
            TEST_ASSERT_EQUAL_INT(-1, time_to(back * rpm, -107.0, -169.0, 0.0));
            TEST_ASSERT_EQUAL_INT(-1, time_to(back * rpm, -107.0, 169.0, 0.0));
        }
    }
}

/* A hard stop: the rotor stands, and for 250 ms the halls show the speed of their last edges. What
 * is not compensated of the dead time makes an e_q of -1.8 U_q without a current, more than half of
 * w psi up to 30 r/min. */
void test_a_wheel_that_stands_before_its_halls_show_it_is_no_fault(void)
{
    const plant_t standing = {.resistance = 1.0, .inductance = 1.0, .dead_time_share = 0.9};
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    for (double rpm = 10.0; rpm <= 70.0; rpm *= 1.1) {
        state = emf_steady_at(mrad_s_of_rpm(1.5 * rpm));
        const monitor_case_t in = measured(rpm, 0.0, 0.0, 90.0, &standing);
        TEST_ASSERT_LESS_THAN_INT32(0, in.now.latest_u_q_mV);
        for (int n = 0; n < 250; n++) {
            TEST_ASSERT_FALSE(monitor_emf_step(&state, &config, measured_of(&in)));
        }
    }
}

/* The same half turn as above, from a change of speed on: a turn, and the qualify time. */
void test_halls_half_a_turn_wrong_are_a_fault_after_a_turn(void)
{
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    for (double rpm = 560.0; rpm <= 11000.0; rpm *= 1.2) {
        state = emf_steady_at(mrad_s_of_rpm(1.5 * rpm));
        const int turn_ms = (int)ceil(60e3 / (rpm * config.motor.pole_pairs));
        const monitor_case_t in = measured(rpm, 107.0, 169.0, 180.0, &AS_CONFIGURED);
        TEST_ASSERT_INT_WITHIN(1, turn_ms + 20, time_to_fault_now(&in));
    }
}

/* Of a healthy vehicle: resistance at 120 degC with the bridge's, saturated or badly measured
 * inductance, warm or wrong magnets, half of the dead-time voltage, a rotor angle 10 degrees off:
 * e_q >= 0.7 cos 10 w psi - U_q, so it is never below -U_q. */
void test_parameter_errors_are_no_fault(void)
{
    random_t random = random_seeded(17);
    for (int n = 0; n < 200000; n++) {
        const plant_t plant = {
            .resistance = random_real(&random, 0.7, 1.5),
            .inductance = random_real(&random, 0.75, 1.25),
            .flux = random_real(&random, 0.7, 1.3),
            .dead_time_share = random_real(&random, -0.5, 0.5),
        };
        const monitor_case_t in = emf_measured(
            &config, random_real(&random, -11000.0, 11000.0), random_real(&random, -200.0, 20.0),
            random_real(&random, -200.0, 200.0), random_real(&random, -10.0, 10.0), &plant);
        state.level = (uint16_t)(MONITOR_EMF_SEEN * config.monitor.angle_fault_time_ms - 1);
        TEST_ASSERT_FALSE(monitor_emf_step(&state, &config, measured_of(&in)));
    }
}
