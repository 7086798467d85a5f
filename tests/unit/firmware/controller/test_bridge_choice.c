/* SPDX-License-Identifier: Apache-2.0 */
/* PWM or safe state while torque is enabled. */
#include "config/finding_times.h"
#include "controller/bridge_choice.h"
#include "core/q15.h"
#include "paper_vehicle.h"
#include "unity.h"

enum { WARNING_ms = 1000 /* until it heals */ };

/* What bridge_choice_step() reads of its records, and how it is called. */
typedef struct {
    bool torque_enabled;
    bool demanded;
    int32_t command_mNm;
    bool torque_feasible;
    int32_t forced_mNm; /* braking torque that PWM makes whatever is commanded, magnitude */
    bool angle_valid, observer_used;
    bridge_mode_t bridge; /* actual mode */
    bridge_mode_t safe_bridge;
    int32_t safe_torque_mNm;
    int32_t emf_mV;
    int32_t phase_voltage_mV;
    int32_t i_d_mA, i_q_mA; /* of the latest period */
} bridge_case_t;

static config_t config;
static bridge_choice_state_t state;
static findings_t findings;
static bridge_case_t in;

void setUp(void)
{
    config = paper_vehicle();
    bridge_choice_init(&state);
    finding_times_t times[FINDING_COUNT];
    finding_times(&config, times);
    findings_init(&findings, times, false);
    const bridge_case_t driving = {.torque_enabled = true,
                                   .demanded = true,
                                   .torque_feasible = true,
                                   .angle_valid = true,
                                   .bridge = BRIDGE_PWM,
                                   .safe_bridge = BRIDGE_OFF,
                                   .emf_mV = 10000,
                                   .phase_voltage_mV = 27000};
    in = driving;
}

void tearDown(void) {}

static bridge_mode_t step(void)
{
    const fast_report_t report = {.bridge = in.bridge};
    const measured_t now = {.report = &report,
                            .angle_valid = in.angle_valid,
                            .angle_by = in.observer_used ? ANGLE_BY_OBSERVER : ANGLE_BY_SENSOR,
                            .latest_i_d_mA = in.i_d_mA,
                            .latest_i_q_mA = in.i_q_mA};
    const monitored_t watch = {
        .safe = {.bridge = in.safe_bridge, .emf_mV = in.emf_mV, .torque_mNm = in.safe_torque_mNm}};
    const torque_output_t torque = {
        .current = {.feasible = in.torque_feasible, .forced_mNm = in.forced_mNm},
        .command_mNm = in.command_mNm,
        .phase_voltage_mV = in.phase_voltage_mV};
    const torque_enable_t enable = {.brake_q15 = (int16_t)(in.torque_enabled ? Q15_ONE : 0)};
    in.bridge =
        bridge_choice_step(&state, &config, &now, &watch, &torque, &enable, in.demanded, &findings);
    return in.bridge;
}

/* The warning: no current makes the commanded torque. */
static bool warns(void)
{
    return findings_present(&findings, FINDING_FORCED_TORQUE);
}

static bridge_mode_t run(int steps)
{
    for (int n = 1; n < steps; n++) {
        (void)step();
    }
    return step();
}

void test_a_demand_switches_in_the_same_step(void)
{
    in.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, step());
}

void test_without_enable_the_bridge_is_in_its_safe_state(void)
{
    in.torque_enabled = false;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, step());
    in.safe_bridge = BRIDGE_SHORT;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, step());
}

void test_the_bridge_opens_after_the_configured_time_without_demand(void)
{
    config.modes.coast_delay_ms = 70;
    in.demanded = false;
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, run(69));
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, step());
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, run(1000));
    in.demanded = true;
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, step());
    in.demanded = false;
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, run(69));
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, step());
}

/* What was demanded leaves in a ramp. */
void test_a_torque_command_without_a_demand_keeps_the_bridge_switching(void)
{
    in.demanded = false;
    for (int sign = -1; sign <= 1; sign += 2) {
        in.command_mNm = sign;
        TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, run(1000));
    }
    in.command_mNm = 0;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, run(config.modes.coast_delay_ms));
}

void test_a_delay_of_zero_keeps_the_bridge_switching(void)
{
    config.modes.coast_delay_ms = 0;
    in.demanded = false;
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, run(100000));
}

/* It opens up to 15/16 of the voltage that PWM makes, and closes where the EMF reaches all of it:
 * before a demagnetising current is needed. */
void test_the_open_bridge_closes_before_the_emf_needs_field_weakening(void)
{
    in.demanded = false;
    in.emf_mV = 25400; /* 0.941 */
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, run(1000));
    in.emf_mV = 25200; /* 0.933 */
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, run(config.modes.coast_delay_ms));
    in.emf_mV = 26999;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, step());
    in.emf_mV = 27000;
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, step());
}

void test_a_safe_state_that_brakes_is_no_coasting(void)
{
    in.demanded = false;
    in.safe_torque_mNm = 1;
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, run(1000));
    in.safe_torque_mNm = 0;
    in.safe_bridge = BRIDGE_SHORT;
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, run(1000));
}

void test_with_an_invalid_rotor_angle_the_bridge_keeps_switching(void)
{
    in.demanded = false;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, run(1000));
    in.angle_valid = false;
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, run(1000));
}

void test_an_infeasible_torque_takes_the_safe_state_and_warns_and_comes_back(void)
{
    in.torque_feasible = false;
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, step()); /* one may be a disturbed mean */
    TEST_ASSERT_FALSE(warns());
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, step());
    TEST_ASSERT_TRUE(warns());
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, run(1000));
    in.torque_feasible = true;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, run(BRIDGE_CHOICE_RETURN_STEPS - 1));
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, step());
    TEST_ASSERT_TRUE(warns());
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, run(WARNING_ms));
    TEST_ASSERT_FALSE(warns());
}

/* A feasible step among infeasible ones is a disturbed mean as well. */
void test_pwm_returns_after_consecutive_feasible_steps_only(void)
{
    in.torque_feasible = false;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, run(2));
    for (int n = 0; n < 100; n++) {
        in.torque_feasible = true;
        TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, run(BRIDGE_CHOICE_RETURN_STEPS - 1));
        in.torque_feasible = false;
        TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, step());
    }
}

/* PWM that brakes with 13 N m whatever is commanded beside a freewheel with 40, and the other way
 * round; the warning names both. */
void test_of_pwm_and_the_safe_state_the_one_that_brakes_less_is_taken(void)
{
    in.forced_mNm = 13000;
    in.safe_torque_mNm = 40000;
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, run(1000));
    TEST_ASSERT_TRUE(warns());
    in.safe_torque_mNm = 6500; /* half as much: hysteresis */
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, run(1000));
    in.safe_torque_mNm = 6499;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, run(2));
    in.safe_torque_mNm = 12999;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, run(1000));
    in.safe_torque_mNm = 13000;
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, run(BRIDGE_CHOICE_RETURN_STEPS));
    TEST_ASSERT_TRUE(warns());
    in.forced_mNm = 0;
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, run(WARNING_ms));
    TEST_ASSERT_FALSE(warns());
}

/* Its current does not decay: with less than the limit switching would never begin. */
void test_switching_begins_on_the_settled_current_of_a_short_circuit(void)
{
    in.safe_bridge = BRIDGE_SHORT;
    in.bridge = BRIDGE_SHORT;
    in.i_d_mA = -75001;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, run(100));
    in.i_d_mA = -75000;
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, step());
}

/* 75 A; (45 A, 60 A) are 75 A. */
void test_switching_does_not_begin_on_a_current_beyond_the_limit(void)
{
    in.bridge = BRIDGE_OFF;
    in.i_d_mA = -45000;
    in.i_q_mA = -60001;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, run(100));
    in.i_q_mA = -60000;
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, step());
    in.i_q_mA = -70000; /* and does not end on one */
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, step());
}

/* The EMF observer knows the angle of an open bridge well enough until there is a demand. */
void test_a_coasting_bridge_stays_open_without_its_sensor_while_the_observer_is_used(void)
{
    config.modes.coast_delay_ms = 1;
    in.demanded = false;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, run(2));
    in.angle_valid = false;
    in.observer_used = true;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, run(100));
    in.observer_used = false;
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, step());
    /* A bridge that switches goes on: its currents show the angle. */
    in.observer_used = true;
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, step());
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, run(100));
    /* An open bridge with a demand closes. */
    in.angle_valid = true;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, run(2));
    in.angle_valid = false;
    in.demanded = true;
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, step());
}
