/* SPDX-License-Identifier: Apache-2.0 */
/* The slow monitor's safe state, freewheel or active short circuit, and its standstill flag. */
#include "monitor_rig.h"
#include "safe_state_case.h"

void setUp(void)
{
    rig_up(&SWITCHING);
}

void tearDown(void) {}

/* A motor whose short circuit is admissible: 250 uH instead of 76 uH, psi/L = 81.6 A; 85 A are
 * allowed. */
static void with_admissible_short(void)
{
    config.motor.d_inductance_nH = 250000;
    config.motor.q_inductance_nH = 250000;
    config.motor.max_phase_current_mA = 85000;
    config.drive.diode_drop_mV = 0;
    in.battery.charge_current_mA =
        0; /* nothing may be charged: the short circuit from the limit on */
}

void test_safe_state_has_hysteresis_from_step_to_step(void)
{
    with_admissible_short();
    in.now.speed_mrad_s = mrad_s_of_rpm(640.0);
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, step().monitored.safe.bridge);
    in.now.speed_mrad_s = mrad_s_of_rpm(600.0); /* 0.963 of the limit */
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, step().monitored.safe.bridge);
    in.now.speed_mrad_s = mrad_s_of_rpm(550.0); /* 0.883; 1.2 g take 0.2 s from 640 r/min */
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, run(200).monitored.safe.bridge);
    in.now.speed_mrad_s = mrad_s_of_rpm(600.0);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, step().monitored.safe.bridge);
}

/* At 70 rad/s the paper's motor makes 56.9 V between its terminals. */
void test_safe_state_stays_active_short_circuit_after_rotor_loss_above_the_limit(void)
{
    with_admissible_short();
    in.now.speed_mrad_s = 70000;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, run(10).monitored.safe.bridge);
    in.now.speed_mrad_s = 0;
    in.now.angle_valid = false;
    in.report.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, run(1000).monitored.safe.bridge);
    TEST_ASSERT_FALSE(step().monitored.standstill);
    /* Zero current in the active short circuit means standstill, or no motor. Two windows of 100
     * ms, and one step before the first. */
    in.report.bridge = BRIDGE_SHORT;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, run(201).monitored.safe.bridge);
    TEST_ASSERT_TRUE(step().monitored.standstill);
}

/* 82 A settled: from zero up to 163 A, beyond the trip of 110 A. */
static void with_short_that_surges(void)
{
    with_admissible_short();
    config.monitor.overcurrent_pu_q15 = 32768 * 110 / (config.drive.current_full_scale_mA / 1000);
    in.now.speed_mrad_s = 70000;
}

static void assert_waits(void)
{
    for (int n = 0; n < MONITOR_SHORT_WAIT_STEPS; n++) {
        const safe_state_case_t open = {.bound_mrad_s = in.now.speed_mrad_s,
                                        .winding_temperature_cC = in.now.winding_temperature_cC,
                                        .bus_voltage_mV = in.now.bus_voltage_mV};
        const shown_t out = step();
        TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, out.monitored.safe.bridge);
        TEST_ASSERT_EQUAL_INT32(freewheel_of(&config, &open).torque_mNm,
                                out.monitored.safe.torque_mNm);
    }
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, step().monitored.safe.bridge);
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, run(20).monitored.safe.bridge);
}

void test_every_short_circuit_that_surges_waits_as_long_while_the_bridge_is_open(void)
{
    with_short_that_surges();
    in.report.bridge = BRIDGE_OFF;
    assert_waits();
    in.now.speed_mrad_s = 10000; /* 1.2 g take 1.3 s */
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, run(2000).monitored.safe.bridge);
    in.now.speed_mrad_s = 70000;
    assert_waits();
}

/* From a current that is 71 A of it already, |i - i_s| is 11 A and the way within 93 A. */
void test_a_short_circuit_that_does_not_surge_does_not_wait(void)
{
    with_short_that_surges();
    in.report.bridge = BRIDGE_OFF;
    in.now.latest_i_d_mA = -71000;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, step().monitored.safe.bridge);
}

void test_a_short_circuit_chosen_while_switching_does_not_wait_nor_with_an_open_bridge_then(void)
{
    with_short_that_surges();
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, step().monitored.safe.bridge);
    in.report.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, step().monitored.safe.bridge);
}

/* No current now; but at 40 rad/s the flux that stands still in the stator becomes 119 A in the
 * next half millisecond, and 111 A fit into 1 mF at the bus. In an unknown frame the speed says
 * nothing. */
void test_the_exit_from_a_short_circuit_is_predicted_where_the_frame_is_known(void)
{
    for (int known = 0; known < 2; known++) {
        setUp();
        in.last.safe_bridge = BRIDGE_SHORT;
        in.report.bridge = BRIDGE_SHORT;
        config.drive.bus_capacitance_nF = 1000000;
        in.now.speed_mrad_s = 40000;
        in.now.angle_by = known != 0 ? ANGLE_BY_SENSOR : ANGLE_BY_OBSERVER;
        TEST_ASSERT_EQUAL_INT(known != 0 ? BRIDGE_SHORT : BRIDGE_OFF, step().monitored.safe.bridge);
    }
}

void test_current_or_overvoltage_in_freewheel_shows_a_turning_wheel(void)
{
    with_admissible_short();
    in.now.speed_mrad_s = 0;
    in.now.angle_valid = false;
    in.report.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, run(100).monitored.safe.bridge);
    in.now.latest_i_q_mA = 20000;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, run(MONITOR_SHORT_WAIT_STEPS + 20).monitored.safe.bridge);
    setUp();
    in.now.speed_mrad_s = 0;
    in.now.angle_valid = false;
    in.report.bridge = BRIDGE_OFF;
    in.now.bus_voltage_mV = 60565;
    TEST_ASSERT_FALSE(step().monitored.standstill);
}

/* The paper's motor: 268 A of short-circuit current are more than its 75 A, so freewheel, as long
 * as the devices stand the EMF. */
void test_safe_state_of_the_paper_s_motor_is_freewheel_up_to_110_percent_of_its_speed(void)
{
    for (int rpm = 0; rpm <= 704; rpm += 16) {
        in.now.speed_mrad_s = mrad_s_of_rpm(rpm);
        TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, step().monitored.safe.bridge);
    }
}

void test_standstill_is_a_speed_below_0_3_rad_s(void)
{
    in.now.speed_mrad_s = 299;
    TEST_ASSERT_TRUE(step().monitored.standstill);
    in.now.speed_mrad_s = -300;
    TEST_ASSERT_FALSE(step().monitored.standstill);
}
