/* SPDX-License-Identifier: Apache-2.0 */
/* The plausibility of the rotor angle by the back-EMF: a motor in double precision, in a dq frame
 * with an angle error. */
#include "config/finding_times.h"
#include "monitor/monitor.h"

#include <math.h>

#include "emf_motor.h"
#include "random_values.h"
#include "unity.h"

void setUp(void)
{
    config = paper_vehicle();
    state.level = 0;
}

void tearDown(void) {}

void test_angle_error_of_60_degrees_is_a_fault_within_20_ms_at_every_checked_speed_and_current(void)
{
    static const double OFFSETS_DEG[] = {60.0, -60.0, 90.0, -120.0, 180.0};
    for (int o = 0; o < 5; o++) {
        for (double rpm = 200.0; rpm <= 640.0; rpm += 20.0) {
            for (double i_q = -60.0; i_q <= 60.0; i_q += 20.0) {
                for (int back = -1; back <= 1; back += 2) {
                    const monitor_case_t in =
                        measured(back * rpm, -20.0, i_q, OFFSETS_DEG[o], &AS_CONFIGURED);
                    const int expected = fabs(i_q) < 50.0 || rpm > 300.0 ? 20 : 0;
                    TEST_ASSERT_TRUE(expected == 0 || time_to_fault(&in) == 20);
                }
            }
        }
    }
}

/* monitor_emf.h: 57 r/min at zero current, 172 r/min at i_q = 60 A. */
void test_check_starts_at_the_derived_speed(void)
{
    /* U = 2/3 * 1 us * 20 kHz * 53 V = 0.707 V; 4 U / psi / 23 = 57.5 r/min. */
    const monitor_case_t slow = measured(56.0, 0.0, 0.0, 90.0, &AS_CONFIGURED);
    const monitor_case_t fast = measured(59.0, 0.0, 0.0, 90.0, &AS_CONFIGURED);
    TEST_ASSERT_EQUAL_INT(-1, time_to_fault(&slow));
    TEST_ASSERT_EQUAL_INT(20, time_to_fault(&fast));
    /* 4 (0.707 + 0.0155 * 60 + w * 19 uH * 60) = w * 20.4 mWb: w = 6.548 / 0.01584 = 413 rad/s =
     * 171.6 r/min. */
    const monitor_case_t slower = measured(169.0, 0.0, 60.0, 90.0, &AS_CONFIGURED);
    const monitor_case_t faster = measured(174.0, 0.0, 60.0, 90.0, &AS_CONFIGURED);
    TEST_ASSERT_EQUAL_INT(-1, time_to_fault(&slower));
    TEST_ASSERT_EQUAL_INT(20, time_to_fault(&faster));
}

/* Parameter errors of a healthy vehicle are no fault: resistance at 120 degC with the bridge's,
 * saturated or badly measured inductance, warm or wrong magnets, half of the dead-time voltage, and
 * a rotor angle error of 15 degrees. */
void test_parameter_errors_are_no_fault(void)
{
    random_t random = random_seeded(3);
    for (int n = 0; n < 200000; n++) {
        const plant_t plant = {
            .resistance = random_real(&random, 0.7, 1.5),
            .inductance = random_real(&random, 0.75, 1.25),
            .flux = random_real(&random, 0.7, 1.3),
            .dead_time_share = random_real(&random, -0.5, 0.5),
        };
        const double rpm = random_real(&random, -640.0, 640.0);
        const double i_d = random_real(&random, -40.0, 10.0);
        const double i_q = random_real(&random, -75.0, 75.0);
        const monitor_case_t in =
            measured(rpm, i_d, i_q, random_real(&random, -15.0, 15.0), &plant);
        state.level = (uint16_t)(MONITOR_EMF_SEEN * config.monitor.angle_fault_time_ms - 1);
        TEST_ASSERT_FALSE(monitor_emf_step(&state, &config, measured_of(&in)));
    }
}

/* The speed estimate has the wrong sign: the EMF rotates in the estimated frame at twice the speed.
 */
void test_reversed_direction_of_rotation_is_a_fault_within_40_ms(void)
{
    for (double rpm = 100.0; rpm <= 640.0; rpm += 13.0) {
        state = emf_steady_at(mrad_s_of_rpm(rpm));
        const double w = rpm * 2.0 * PI / 60.0 * config.motor.pole_pairs;
        int n = 0;
        bool fault = false;
        while (!fault && n < 1000) {
            n++;
            monitor_case_t in =
                measured(rpm, 0.0, 0.0, 2.0 * w * 1e-3 * n * 180.0 / PI, &AS_CONFIGURED);
            in.now.speed_mrad_s = -in.now.speed_mrad_s;
            fault = monitor_emf_step(&state, &config, measured_of(&in));
        }
        /* On average three of four evaluations count against the angle. The phase changes slowly
         * where two turns per evaluation are close to a multiple of a quarter turn. */
        const double turns = 2.0 * w * 1e-3 / (2.0 * PI);
        const double phase_step = fabs(turns - floor(turns * 4.0 + 0.5) / 4.0);
        TEST_ASSERT_TRUE(fault);
        TEST_ASSERT_TRUE(n <= 48 || phase_step < 0.03);
    }
}

void test_check_is_off_without_pwm_at_the_voltage_limit_and_with_an_invalid_angle(void)
{
    monitor_case_t in = measured(400.0, 0.0, 0.0, 90.0, &AS_CONFIGURED);
    in.report.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT(-1, time_to_fault(&in));
    in.report.bridge = BRIDGE_PWM;
    in.report.voltage_limited = true;
    TEST_ASSERT_EQUAL_INT(-1, time_to_fault(&in));
    in.report.voltage_limited = false;
    in.now.angle_valid = false;
    TEST_ASSERT_EQUAL_INT(-1, time_to_fault(&in));
}

/* A negative i_d reduces the terminal voltage by w L_d i_d, which the check adds to the EMF again.
 * With i_d = -0.6 psi/L_d, -161 A, and the opposite sign the EMF would be -0.2 psi w. The check
 * acts from psi w >= 4 (R/2 + w L/4) i on: 26 V of 40.8 V at 2000 rad/s without dead time. */
void test_demagnetising_current_of_60_percent_of_the_flux_is_no_fault(void)
{
    config.drive.dead_time_ns = 0;
    const double i_d = -0.6 * config.motor.flux_linkage_nWb / config.motor.d_inductance_nH;
    const double rpm = 2000.0 * 60.0 / (2.0 * PI) / config.motor.pole_pairs;
    for (int back = -1; back <= 1; back += 2) {
        const monitor_case_t right = measured(back * rpm, i_d, 0.0, 0.0, &AS_CONFIGURED);
        TEST_ASSERT_EQUAL_INT(-1, time_to_fault(&right));
        const monitor_case_t wrong = measured(back * rpm, i_d, 0.0, 180.0, &AS_CONFIGURED);
        TEST_ASSERT_EQUAL_INT(20, time_to_fault(&wrong)); /* the check is active at this point */
    }
}

void test_check_is_off_at_standstill_also_without_dead_time(void)
{
    config.drive.dead_time_ns = 0;
    const monitor_case_t in = measured(0.0, 0.0, 0.0, 0.0, &AS_CONFIGURED);
    TEST_ASSERT_EQUAL_INT(-1, time_to_fault(&in));
}

static int steps_to_fault(const monitor_case_t *wrong)
{
    int n = 1;
    while (!monitor_emf_step(&state, &config, measured_of(wrong))) {
        n++;
    }
    return n;
}

void test_qualify_counter_restarts_after_a_healthy_interval(void)
{
    const monitor_case_t wrong = measured(400.0, 0.0, 10.0, 90.0, &AS_CONFIGURED);
    monitor_case_t right = measured(400.0, 0.0, 10.0, 0.0, &AS_CONFIGURED);
    for (int n = 0; n < 10; n++) {
        (void)monitor_emf_step(&state, &config, measured_of(&wrong));
    }
    for (int n = 0; n < 10; n++) {
        (void)monitor_emf_step(&state, &config, measured_of(&right));
    }
    TEST_ASSERT_EQUAL_INT(20, steps_to_fault(&wrong));
    /* The counter also starts again when the bridge stops switching or the angle is invalid. */
    for (int k = 0; k < 2; k++) {
        right.report.bridge = pwm_if(k != 0);
        right.now.angle_valid = k != 1;
        (void)monitor_emf_step(&state, &config, measured_of(&right));
        TEST_ASSERT_EQUAL_INT(20, steps_to_fault(&wrong));
    }
}

void test_fault_heals_in_the_first_step_with_a_plausible_angle(void)
{
    const monitor_case_t wrong = measured(400.0, 0.0, 10.0, 90.0, &AS_CONFIGURED);
    const monitor_case_t right = measured(400.0, 0.0, 10.0, 0.0, &AS_CONFIGURED);
    for (int n = 0; n < 100000; n++) {
        (void)monitor_emf_step(&state, &config, measured_of(&wrong));
    }
    int n = 0;
    while (monitor_emf_step(&state, &config, measured_of(&right))) {
        n++;
    }
    TEST_ASSERT_EQUAL_INT(0, n);
}

void test_slow_monitor_reports_the_fault(void)
{
    monitor_state_t slow;
    monitor_init(&slow);
    finding_times_t times[FINDING_COUNT];
    finding_times(&config, times);
    findings_t findings;
    findings_init(&findings, times, false);
    config.rotor.sensor = CONFIG_ROTOR_ANGLE; /* whose speed is known at once */
    monitor_case_t wrong = measured(400.0, 0.0, 10.0, 90.0, &AS_CONFIGURED);
    for (int n = 1; n <= 30; n++) {
        wrong.report.sequence = (uint16_t)(wrong.report.sequence + 20U);
        (void)monitor_step(&slow, &config, measured_of(&wrong), &wrong.last, &findings);
        const reason_t fault = findings_reason(&findings, findings_fault(&findings));
        TEST_ASSERT_EQUAL_INT(n < 20 ? REASON_NONE : REASON_ROTOR_IMPLAUSIBLE, fault);
    }
}

void test_any_input_is_accepted(void)
{
    /* The sanitizer build detects undefined behaviour. */
    random_t random = random_seeded(5);
    for (int n = 0; n < 100000; n++) {
        monitor_case_t in = {.report = {.bridge = BRIDGE_PWM}, .now = {.angle_valid = true}};
        in.now.latest_u_d_mV = random_wild(&random);
        in.now.latest_u_q_mV = random_wild(&random);
        in.now.latest_i_d_mA = random_wild(&random);
        in.now.latest_i_q_mA = random_wild(&random);
        in.now.bus_voltage_mV = random_wild(&random);
        in.now.speed_mrad_s = random_wild(&random);
        (void)monitor_emf_step(&state, &config, measured_of(&in));
        TEST_ASSERT_TRUE(state.level <= MONITOR_EMF_SEEN * config.monitor.angle_fault_time_ms);
    }
}

/* Flux: the same motor. What is named after a second at a share of the configured flux and a gain
 * of the bus voltage's reading, with which the applied voltage is computed. */
static monitor_emf_flux_t named(double rpm, double i_q_a, double flux, double reading)
{
    plant_t plant = AS_CONFIGURED;
    plant.flux = flux;
    monitor_case_t in = measured(rpm, 0.0, i_q_a, 0.0, &plant);
    in.now.latest_u_d_mV = (int32_t)lround(reading * in.now.latest_u_d_mV);
    in.now.latest_u_q_mV = (int32_t)lround(reading * in.now.latest_u_q_mV);
    in.now.winding_temperature_cC = config.motor.reference_temperature_cC;
    const monitor_emf_state_t fresh = {.level = 0};
    state = fresh;
    for (int n = 0; n < 1000; n++) {
        monitor_emf_step(&state, &config, measured_of(&in));
    }
    return state.flux;
}

/* At 500 r/min w psi = 24.6 V; U_q is 0.71 V without a current, 1.33 V with 40 A: 15 % and U_q are
 * 18 and 20.4 % of w psi. */
void test_weak_magnets_and_a_bus_voltage_that_reads_high_are_distinguished(void)
{
    config.monitor.flux_tolerance_permille = 150;
    TEST_ASSERT_EQUAL_INT(MONITOR_EMF_FLUX_PLAUSIBLE, named(500.0, 0.0, 0.85, 1.0));
    TEST_ASSERT_EQUAL_INT(MONITOR_EMF_FLUX_WEAK, named(500.0, 0.0, 0.80, 1.0));
    TEST_ASSERT_EQUAL_INT(MONITOR_EMF_FLUX_PLAUSIBLE, named(500.0, -40.0, 0.81, 1.0));
    TEST_ASSERT_EQUAL_INT(MONITOR_EMF_FLUX_WEAK, named(500.0, -40.0, 0.78, 1.0));
    TEST_ASSERT_EQUAL_INT(MONITOR_EMF_FLUX_WEAK, named(500.0, -40.0, 0.70, 1.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 0.3, state.missing_q20 / 1048576.0);
    TEST_ASSERT_EQUAL_INT(MONITOR_EMF_FLUX_STRONG, named(500.0, 0.0, 1.0, 1.25));
    TEST_ASSERT_EQUAL_INT(MONITOR_EMF_FLUX_STRONG, named(-500.0, 0.0, 1.0, 1.25));
    TEST_ASSERT_EQUAL_INT32(0, state.missing_q20);
    /* A bus voltage that reads low looks like weak magnets. */
    TEST_ASSERT_EQUAL_INT(MONITOR_EMF_FLUX_WEAK, named(500.0, 0.0, 1.0, 0.75));
}

void test_flux_is_named_after_200_ms_and_heals_after_200_ms(void)
{
    config.monitor.flux_tolerance_permille = 150;
    TEST_ASSERT_EQUAL_INT(MONITOR_EMF_FLUX_WEAK, named(500.0, 0.0, 0.7, 1.0));
    monitor_case_t in = measured(500.0, 0.0, 0.0, 0.0, &AS_CONFIGURED);
    in.now.winding_temperature_cC = config.motor.reference_temperature_cC;
    for (int n = 1; n < MONITOR_EMF_FLUX_STEPS; n++) {
        monitor_emf_step(&state, &config, measured_of(&in));
    }
    TEST_ASSERT_EQUAL_INT(MONITOR_EMF_FLUX_WEAK, state.flux);
    monitor_emf_step(&state, &config, measured_of(&in));
    TEST_ASSERT_EQUAL_INT(MONITOR_EMF_FLUX_PLAUSIBLE, state.flux);
    plant_t weak = AS_CONFIGURED;
    weak.flux = 0.7;
    in = measured(500.0, 0.0, 0.0, 0.0, &weak);
    in.now.winding_temperature_cC = config.motor.reference_temperature_cC;
    for (int n = 1; n < MONITOR_EMF_FLUX_STEPS; n++) {
        monitor_emf_step(&state, &config, measured_of(&in));
    }
    TEST_ASSERT_EQUAL_INT(MONITOR_EMF_FLUX_PLAUSIBLE, state.flux);
    monitor_emf_step(&state, &config, measured_of(&in));
    TEST_ASSERT_EQUAL_INT(MONITOR_EMF_FLUX_WEAK, state.flux);
    weak.flux = 0.82; /* with 40 A within the tolerance and U_q, but not within the tolerance */
    in = measured(500.0, 0.0, -40.0, 0.0, &weak);
    in.now.winding_temperature_cC = config.motor.reference_temperature_cC;
    for (int n = 0; n < 1000; n++) {
        monitor_emf_step(&state, &config, measured_of(&in));
    }
    TEST_ASSERT_EQUAL_INT(MONITOR_EMF_FLUX_WEAK, state.flux);
    in.report.bridge = BRIDGE_OFF; /* not judged: it stays */
    for (int n = 0; n < 1000; n++) {
        monitor_emf_step(&state, &config, measured_of(&in));
    }
    TEST_ASSERT_EQUAL_INT(MONITOR_EMF_FLUX_WEAK, state.flux);
}

/* R and dead time a half, L a quarter wrong, magnets 14 % apart from the configuration; the angle
 * is 10 degrees off, of which the cosine shows, and what L is wrong: 2 % with magnets 12 % apart.
 */
void test_a_motor_within_its_tolerances_is_never_named(void)
{
    config.monitor.flux_tolerance_permille = 150;
    random_t random = random_seeded(11);
    for (int n = 0; n < 2000; n++) {
        const plant_t plant = {.resistance = random_real(&random, 0.5, 1.5),
                               .inductance = random_real(&random, 0.75, 1.25),
                               .flux = n % 2 == 0 ? random_real(&random, 0.86, 1.14)
                                                  : random_real(&random, 0.88, 1.12),
                               .dead_time_share = random_real(&random, -0.5, 0.5)};
        monitor_case_t in =
            measured(random_real(&random, -640.0, 640.0), random_real(&random, -40.0, 0.0),
                     random_real(&random, -60.0, 60.0),
                     n % 2 == 0 ? 0.0 : random_real(&random, -10.0, 10.0), &plant);
        in.now.winding_temperature_cC = config.motor.reference_temperature_cC;
        const monitor_emf_state_t fresh = {.level = 0};
        state = fresh;
        for (int step = 0; step < 300; step++) {
            monitor_emf_step(&state, &config, measured_of(&in));
        }
        TEST_ASSERT_EQUAL_INT(MONITOR_EMF_FLUX_PLAUSIBLE, state.flux);
    }
}

/* NdFeB, 100 K warmer: 11 % less flux is as it should be, the cold flux then reads as too much. */
void test_the_flux_is_expected_at_the_winding_temperature(void)
{
    config.monitor.flux_tolerance_permille = 50;
    config.motor.flux_coefficient_ppm_K = -1100;
    plant_t plant = AS_CONFIGURED;
    plant.flux = 0.89;
    monitor_case_t in = measured(500.0, 0.0, 0.0, 0.0, &plant);
    in.now.winding_temperature_cC = config.motor.reference_temperature_cC + 10000;
    const monitor_emf_state_t fresh = {.level = 0};
    state = fresh;
    for (int n = 0; n < 300; n++) {
        monitor_emf_step(&state, &config, measured_of(&in));
    }
    TEST_ASSERT_EQUAL_INT(MONITOR_EMF_FLUX_PLAUSIBLE, state.flux);
    in = measured(500.0, 0.0, 0.0, 0.0, &AS_CONFIGURED);
    in.now.winding_temperature_cC = config.motor.reference_temperature_cC + 10000;
    for (int n = 0; n < 300; n++) {
        monitor_emf_step(&state, &config, measured_of(&in));
    }
    TEST_ASSERT_EQUAL_INT(MONITOR_EMF_FLUX_STRONG, state.flux);
}

/* Named strong after 200 ms and healed after 200 ms, as weak is. */
void test_strong_flux_has_the_same_times(void)
{
    config.monitor.flux_tolerance_permille = 150;
    monitor_case_t strong = measured(500.0, 0.0, 0.0, 0.0, &AS_CONFIGURED);
    strong.now.winding_temperature_cC = config.motor.reference_temperature_cC;
    const monitor_case_t right = strong;
    strong.now.latest_u_q_mV += strong.now.latest_u_q_mV / 4;
    state = emf_steady_at(strong.now.speed_mrad_s);
    for (int n = 1; n <= MONITOR_EMF_FLUX_STEPS; n++) {
        TEST_ASSERT_EQUAL_INT(MONITOR_EMF_FLUX_PLAUSIBLE, state.flux);
        monitor_emf_step(&state, &config, measured_of(&strong));
    }
    TEST_ASSERT_EQUAL_INT(MONITOR_EMF_FLUX_STRONG, state.flux);
    monitor_emf_step(&state, &config, measured_of(&strong)); /* no more than that */
    for (int n = 1; n <= MONITOR_EMF_FLUX_STEPS; n++) {
        TEST_ASSERT_EQUAL_INT(MONITOR_EMF_FLUX_STRONG, state.flux);
        monitor_emf_step(&state, &config, measured_of(&right));
    }
    TEST_ASSERT_EQUAL_INT(MONITOR_EMF_FLUX_PLAUSIBLE, state.flux);
    monitor_emf_step(&state, &config, measured_of(&right));
    TEST_ASSERT_EQUAL_INT16(0, state.flux_level);
}

/* Halls at the end of a hard stop show the mean of a turn, several times the rotor's speed: a speed
 * that falls by a seventh in half a turn. Then it stays, and a turn later the flux is judged. */
void test_flux_is_not_judged_while_the_speed_moves_by_an_eighth_within_a_turn(void)
{
    config.monitor.flux_tolerance_permille = 150;
    plant_t weak = AS_CONFIGURED;
    weak.flux = 0.3;
    double rpm = 600.0;
    state = emf_steady_at(mrad_s_of_rpm(rpm));
    monitor_case_t in;
    for (double turns = 0.5; rpm > 300.0; turns += rpm / 60e3 * config.motor.pole_pairs) {
        while (turns >= 0.5) {
            rpm *= 6.0 / 7.0;
            turns -= 0.5;
        }
        in = measured(rpm, 0.0, 0.0, 0.0, &weak);
        in.now.winding_temperature_cC = config.motor.reference_temperature_cC;
        monitor_emf_step(&state, &config, measured_of(&in));
        TEST_ASSERT_EQUAL_INT16(0, state.flux_level);
    }
    const int turn_ms = (int)ceil(60e3 / (rpm * config.motor.pole_pairs));
    for (int n = 1; n < turn_ms; n++) {
        monitor_emf_step(&state, &config, measured_of(&in));
        TEST_ASSERT_EQUAL_INT16(0, state.flux_level);
    }
    monitor_emf_step(&state, &config, measured_of(&in));
    TEST_ASSERT_EQUAL_INT16(-1, state.flux_level);
}

/* Without PWM, with an invalid angle, below the least EMF, and with an angle that is wrong itself.
 */
void test_flux_is_not_judged_where_the_angle_is_not(void)
{
    config.monitor.flux_tolerance_permille = 150;
    plant_t weak = AS_CONFIGURED;
    weak.flux = 0.05;
    for (int k = 0; k < 5; k++) {
        monitor_case_t in = measured(k == 3 ? 50.0 : 500.0, 0.0, 0.0, k == 4 ? 90.0 : 0.0, &weak);
        state = emf_steady_at(in.now.speed_mrad_s);
        in.now.winding_temperature_cC = config.motor.reference_temperature_cC;
        in.report.bridge = pwm_if(k != 1);
        in.now.angle_valid = k != 2;
        for (int n = 0; n < 10; n++) {
            monitor_emf_step(&state, &config, measured_of(&in));
        }
        TEST_ASSERT_EQUAL_INT16(k == 0 ? -10 : 0, state.flux_level);
    }
}

/* 1.5 us at 20 kHz are 3 %, two thirds of that of 50 V are U = 1 V: judged from 4 V on, which are
 * 4 mWb at 1000 rad/s. There the tolerance is 15 % of 4 V and U, 1.6 V. */
void test_thresholds_of_emf_and_flux_are_exact(void)
{
    config.drive.dead_time_ns = 1500;
    config.drive.pwm_frequency_Hz = 20000;
    config.motor.pole_pairs = 1;
    config.motor.flux_linkage_nWb = 4000000;
    config.motor.flux_coefficient_ppm_K = 0;
    config.monitor.flux_tolerance_permille = 150;
    const monitor_emf_state_t fresh = emf_steady_at(1000000);
    monitor_case_t in = {.report = {.bridge = BRIDGE_PWM},
                         .now = {.latest_u_d_mV = 4000,
                                 .bus_voltage_mV = 50000,
                                 .speed_mrad_s = 1000000,
                                 .angle_valid = true}};
    for (int32_t less = 0; less < 2; less++) {
        state = fresh;
        in.now.speed_mrad_s = 1000000 - less;
        monitor_emf_step(&state, &config, measured_of(&in));
        TEST_ASSERT_EQUAL_UINT16(MONITOR_EMF_SEEN * (1 - less), state.level);
    }
    in.now.speed_mrad_s = 1000000;
    in.now.latest_u_d_mV = 0;
    for (int32_t apart_mV = 1599; apart_mV <= 1601; apart_mV++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            state = fresh;
            in.now.latest_u_q_mV = 4000 + sign * apart_mV;
            monitor_emf_step(&state, &config, measured_of(&in));
            TEST_ASSERT_EQUAL_INT16(apart_mV > 1600 ? sign : 0, state.flux_level);
        }
    }
}
