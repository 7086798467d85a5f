/* SPDX-License-Identifier: Apache-2.0 */
/* Limits of the slow monitor on both sides: torque, program flow, rotor, temperature, what the
 * missing flux is, and the wait before a short circuit that surges. */
#include "monitor_rig.h"
#include "safe_state_case.h"

enum { TOLERANCE_mNm = 4000 };

void setUp(void)
{
    rig_up(&TURNING);
    config.monitor.torque_tolerance_mNm = TOLERANCE_mNm;
    config.monitor.torque_fault_time_ms = 50;
}

void tearDown(void) {}

void test_a_fault_that_lasts_for_more_than_65_s_stays(void)
{
    in.report.adc_saturated = true;
    (void)run(100);
    for (int n = 0; n < UINT16_MAX + 50; n++) {
        TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SENSOR, step().fault);
    }
}

/* ---- torque ---- */

static reason_t with_torque(int32_t command_mNm, int32_t estimate_mNm)
{
    in.last.torque_command_mNm = command_mNm;
    in.last.torque_estimate_mNm = estimate_mNm;
    return run(60).fault;
}

void test_a_torque_against_the_command_is_tolerated_up_to_the_tolerance(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_NONE, with_torque(-10000, TOLERANCE_mNm));
    TEST_ASSERT_EQUAL_INT(REASON_NONE, with_torque(10000, -TOLERANCE_mNm));
}

/* 73 rad/s with a bus of 45 V: 50 V of EMF remain with 40 A of field weakening. */
void test_braking_that_the_voltage_forces_is_permitted_beyond_the_tolerance_by_any_amount(void)
{
    static const int32_t BEYOND_mNm[] = {1, 2, 1000};
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int k = 0; k < 3; k++) {
            setUp();
            in.now.speed_mrad_s = sign * 73000;
            in.now.latest_u_q_mV = sign * 34251;
            in.now.bus_voltage_mV = 45000;
            TEST_ASSERT_EQUAL_INT(REASON_NONE,
                                  with_torque(0, -sign * (TOLERANCE_mNm + BEYOND_mNm[k])));
            TEST_ASSERT_EQUAL_INT(REASON_TORQUE_IMPLAUSIBLE,
                                  with_torque(0, sign * (TOLERANCE_mNm + BEYOND_mNm[k])));
        }
    }
}

/* With an empty bus any voltage forces; a wheel at standstill counts as one that turns forwards. */
void test_a_negative_torque_brakes_at_standstill_and_drives_below_it(void)
{
    in.now.bus_voltage_mV = 0;
    in.now.speed_mrad_s = 0;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, with_torque(0, -TOLERANCE_mNm - 1));
    in.now.speed_mrad_s = -1;
    TEST_ASSERT_EQUAL_INT(REASON_TORQUE_IMPLAUSIBLE, with_torque(0, -TOLERANCE_mNm - 1));
}

/* ---- program flow ---- */

/* Every other slow step has the right number of fast steps, beginning with a wrong one: the step in
 * which it is a fault, 0 for none of 20. */
static int faulty_step(uint16_t wrong, uint16_t right)
{
    fast_steps_per_slow = right;
    (void)step();
    for (int n = 1; n <= 20; n++) {
        fast_steps_per_slow = n % 2 == 1 ? wrong : right;
        if (step().fault == REASON_PROGRAM_FLOW) {
            return n;
        }
    }
    return 0;
}

/* Of 20 fast steps 35 are wrong by 15, and twice the number from 36 on: 2 or 3 a step less 1, and
 * 6 are a fault. 2 1 3 2 4 3 5 4 6; 3 2 5 4 7. */
void test_twice_the_fast_steps_begin_a_quarter_below_twice_the_number(void)
{
    TEST_ASSERT_EQUAL_INT(9, faulty_step(35, 20));
    setUp();
    TEST_ASSERT_EQUAL_INT(5, faulty_step(36, 20));
    setUp();
    TEST_ASSERT_EQUAL_INT(5, faulty_step(40, 20));
}

/* Of 20 kHz 80 periods are the 4 ms for which the fast loop waits; a longer gap is a fault at once.
 */
void test_a_gap_beyond_what_the_fast_loop_waits_for_is_a_fault_at_once(void)
{
    TEST_ASSERT_EQUAL_INT(5, faulty_step(80, 20));
    setUp();
    TEST_ASSERT_EQUAL_INT(1, faulty_step(81, 20));
}

/* 29.999 kHz are 29 whole periods, of which a quarter is 7. */
void test_whole_periods_of_a_millisecond_are_expected(void)
{
    config.drive.pwm_frequency_Hz = 29999;
    TEST_ASSERT_EQUAL_INT(0, faulty_step(36, 29));
    setUp();
    config.drive.pwm_frequency_Hz = 29999;
    TEST_ASSERT_EQUAL_INT(9, faulty_step(37, 29));
}

/* ---- rotor ---- */

void test_a_long_ramp_of_the_torque_is_waited_for_exactly(void)
{
    config.motor.max_torque_mNm = 40000;
    config.brake.torque_rate_mNm_s = 20000; /* 2 s */
    in.now.angle_valid = false;
    assert_fault_after(2000 + config.monitor.rotor_fault_time_ms, REASON_ROTOR_LOST);
}

/* The longest time that is counted. */
void test_65535_steps_are_waited_for(void)
{
    config.motor.max_torque_mNm = UINT16_MAX - 250;
    config.brake.torque_rate_mNm_s = 1000;
    config.monitor.rotor_fault_time_ms = 250;
    in.now.angle_valid = false;
    for (int n = 1; n < UINT16_MAX; n++) {
        TEST_ASSERT_EQUAL_INT(REASON_NONE, step().fault);
    }
    TEST_ASSERT_EQUAL_INT(REASON_ROTOR_LOST, run(100).fault);
}

void test_a_skipped_sector_and_a_sudden_stop_in_one_step_are_a_warning(void)
{
    in.now.speed_mrad_s = 44000;
    (void)run(200);
    in.now.speed_mrad_s = 0;
    in.report.rotor_faults++;
    TEST_ASSERT_EQUAL_INT(REASON_ROTOR_UNCERTAIN, step().warning);
    TEST_ASSERT_EQUAL_UINT16(1, state.speed.sudden_stops);
}

/* ---- temperature ---- */

void test_a_temperature_limit_that_is_off_has_no_fault(void)
{
    config.monitor.highest_temperature_cC = 40000; /* beyond config_validate() */
    in.now.winding_temperature_cC = 35000;
    config.motor.max_winding_temperature_cC = MONITOR_TEMPERATURE_OFF_cC;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100).fault);
    config.motor.max_winding_temperature_cC = MONITOR_TEMPERATURE_OFF_cC - 1;
    TEST_ASSERT_EQUAL_INT(REASON_WINDING_OVERTEMPERATURE, run(100).fault);
}

/* ---- missing flux ---- */

/* 70 % of the flux: 0.3 * 32 768 are missing. */
static const int32_t MISSING_Q15 = 9830;

static void lose_flux(void)
{
    config.monitor.flux_tolerance_permille = 150;
    in.now.latest_u_q_mV = 9853;
    (void)run(3000);
}

void test_missing_flux_is_given_while_a_battery_confirms_the_bus(void)
{
    in.battery.voltage_mV = 53000;
    TEST_ASSERT_EQUAL_INT32(0, run(500).monitored.flux_missing_q15);
    lose_flux();
    const shown_t out = step();
    TEST_ASSERT_EQUAL_INT(REASON_FLUX_WEAK, out.flux_warning);
    TEST_ASSERT_INT32_WITHIN(98, MISSING_Q15, out.monitored.flux_missing_q15);
}

void test_missing_flux_is_not_given_without_a_battery_s_voltage(void)
{
    lose_flux();
    const shown_t out = step();
    TEST_ASSERT_EQUAL_INT(REASON_FLUX_WEAK, out.flux_warning);
    TEST_ASSERT_EQUAL_INT32(0, out.monitored.flux_missing_q15);
    in.battery.voltage_mV = 1; /* the least that is a message; not yet compared */
    TEST_ASSERT_INT32_WITHIN(98, MISSING_Q15, step().monitored.flux_missing_q15);
}

void test_missing_flux_is_not_given_while_the_battery_contradicts_the_bus(void)
{
    lose_flux();
    in.battery.voltage_mV = 40000;
    const shown_t out = run(1000);
    TEST_ASSERT_EQUAL_INT(REASON_BUS_SENSOR, out.flux_warning);
    TEST_ASSERT_EQUAL_INT32(0, out.monitored.flux_missing_q15);
}

/* ---- short circuit ---- */

static int32_t diode_current_mA(int32_t speed_mrad_s, int32_t bus_mV)
{
    const safe_state_case_t open = {.bound_mrad_s = speed_mrad_s,
                                    .winding_temperature_cC = 2500,
                                    .bus_voltage_mV = bus_mV,
                                    .charge_current_mA = 1000000};
    return freewheel_of(&config, &open).current_mA;
}

/* 1 ohm: a millivolt above the bus drives about half a milliampere through the diodes. */
void test_the_least_current_of_the_emf_conducts(void)
{
    config.motor.phase_resistance_uOhm = 1000000;
    in.battery.charge_current_mA = 1000000;
    in.report.bridge = BRIDGE_OFF;
    int32_t bus_mV = 0;
    int32_t speed_mrad_s = 66000;
    while (speed_mrad_s < 70000 && diode_current_mA(speed_mrad_s, bus_mV) != 1) {
        speed_mrad_s++;
        bus_mV = (int32_t)(0.0204 * 23.0 * 1.732 * speed_mrad_s) - 2 * config.drive.diode_drop_mV;
        while (diode_current_mA(speed_mrad_s, bus_mV) == 0) {
            bus_mV--;
        }
    }
    TEST_ASSERT_EQUAL_INT32(1, diode_current_mA(speed_mrad_s, bus_mV));
    in.now.speed_mrad_s = speed_mrad_s;
    in.now.bus_voltage_mV = bus_mV;
    TEST_ASSERT_TRUE(step().monitored.emf_conducts);
    in.now.bus_voltage_mV += 1;
    TEST_ASSERT_FALSE(step().monitored.emf_conducts);
}

/* 82 A settled: from zero up to 163 A, beyond the trip of 110 A. */
static void with_short_that_surges(void)
{
    config.motor.d_inductance_nH = 250000;
    config.motor.q_inductance_nH = 250000;
    config.motor.max_phase_current_mA = 85000;
    config.drive.diode_drop_mV = 0;
    config.monitor.overcurrent_pu_q15 = 32768 * 110 / (config.drive.current_full_scale_mA / 1000);
    in.last.torque_command_mNm = 0;
    in.last.torque_estimate_mNm = 0;
    in.battery.charge_current_mA = 0;
    in.report.bridge = BRIDGE_OFF;
}

static void assert_waits(void)
{
    in.now.speed_mrad_s = 70000;
    for (int n = 0; n < MONITOR_SHORT_WAIT_STEPS; n++) {
        const safe_state_case_t open = {.bound_mrad_s = 70000,
                                        .winding_temperature_cC = 2500,
                                        .bus_voltage_mV = in.now.bus_voltage_mV};
        const shown_t out = step();
        TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, out.monitored.safe.bridge);
        TEST_ASSERT_EQUAL_INT32(freewheel_of(&config, &open).torque_mNm,
                                out.monitored.safe.torque_mNm);
    }
    for (int n = 0; n < 20; n++) {
        TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, step().monitored.safe.bridge);
    }
}

void test_every_short_circuit_that_surges_waits_as_long(void)
{
    with_short_that_surges();
    in.now.speed_mrad_s = 10000;
    (void)run(10);
    assert_waits();
    in.now.speed_mrad_s = 10000; /* 1.2 g take 1.3 s */
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, run(2000).monitored.safe.bridge);
    assert_waits();
}

void test_a_short_circuit_that_was_chosen_while_switching_does_not_wait_with_an_open_bridge(void)
{
    with_short_that_surges();
    in.report.bridge = BRIDGE_PWM;
    in.now.speed_mrad_s = 70000;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, step().monitored.safe.bridge);
    in.report.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, step().monitored.safe.bridge);
}

/* 600 r/min, 0.963 of the limit, are reached with 1.2 g in 0.09 s. */
void test_a_short_circuit_lasts_below_the_speed_at_which_it_begins(void)
{
    with_short_that_surges();
    in.report.bridge = BRIDGE_PWM;
    in.now.speed_mrad_s = mrad_s_of_rpm(640.0);
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, step().monitored.safe.bridge);
    in.now.speed_mrad_s = mrad_s_of_rpm(600.0);
    const shown_t out = run(300);
    TEST_ASSERT_EQUAL_INT32(in.now.speed_mrad_s, out.monitored.bound_mrad_s);
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, out.monitored.safe.bridge);
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

/* 100 A fit into 1 mF with the 76 uH of the d axis, not with 152 uH of the q axis. */
void test_in_an_unknown_frame_the_larger_inductance_counts(void)
{
    for (int known = 0; known < 2; known++) {
        setUp();
        config.drive.bus_capacitance_nF = 1000000;
        config.motor.q_inductance_nH = 2 * config.motor.d_inductance_nH;
        in.last.safe_bridge = BRIDGE_SHORT;
        in.report.bridge = BRIDGE_SHORT;
        in.now.speed_mrad_s = 100;
        in.now.latest_i_d_mA = -100000;
        in.now.angle_by = known != 0 ? ANGLE_BY_SENSOR : ANGLE_BY_OBSERVER;
        TEST_ASSERT_EQUAL_INT(known != 0 ? BRIDGE_OFF : BRIDGE_SHORT, step().monitored.safe.bridge);
    }
}
