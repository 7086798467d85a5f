/* SPDX-License-Identifier: Apache-2.0 */
#include "config/bases.h"
#include "controller_rig.h"
#include "unity.h"

static rig_t rig;

void setUp(void)
{
    rig_start(&rig);
}

void tearDown(void) {}

/* ---- start-up ---- */

void test_start_up_passes_self_test_calibration_and_ready_before_run(void)
{
    operating_mode_t seen[8];
    int count = 0;
    for (int n = 0; n < 200; n++) {
        rig.slow_in.demand.enable = n >= 150;
        rig_run(&rig, 1);
        if (count == 0 || seen[count - 1] != rig.out.mode) {
            TEST_ASSERT_LESS_THAN_INT(8, count);
            seen[count++] = rig.out.mode;
        }
    }
    const operating_mode_t order[] = {MODE_SELFTEST, MODE_OFFSET_CAL, MODE_READY, MODE_RUN};
    TEST_ASSERT_EQUAL_INT(4, count);
    for (int k = 0; k < 4; k++) {
        TEST_ASSERT_EQUAL_INT(order[k], seen[k]);
    }
}

void test_run_waits_for_a_zero_drive_demand(void)
{
    rig.slow_in.demand.enable = true;
    rig.slow_in.demand.drive_torque_mNm = 1;
    rig_run(&rig, 500);
    TEST_ASSERT_EQUAL_INT(MODE_READY, rig.out.mode);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, rig.pwm.bridge);
    rig.slow_in.demand.drive_torque_mNm = 0;
    rig.slow_in.demand.brake_torque_mNm = 10000;
    rig_run(&rig, 1);
    TEST_ASSERT_EQUAL_INT(MODE_RUN, rig.out.mode);
}

void test_the_bridge_does_not_switch_before_run(void)
{
    while (rig.out.mode != MODE_RUN) {
        rig.slow_in.demand.enable = true;
        for (int k = 0; k < RIG_FAST_PER_SLOW; k++) {
            rig_fast(&rig);
            TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, rig.pwm.bridge);
        }
        rig_slow(&rig);
    }
    rig_fast(&rig);
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, rig.pwm.bridge);
}

void test_calibration_averages_1024_samples_which_take_51_2_ms(void)
{
    int milliseconds = 0;
    while (rig.out.mode != MODE_READY) {
        rig_run(&rig, 1);
        milliseconds++;
        TEST_ASSERT_LESS_THAN_INT(100, milliseconds);
    }
    /* two steps to get there, 51.2 ms, and up to two steps until the order and the answer have
     * crossed */
    TEST_ASSERT_INT_WITHIN(2, 55, milliseconds);
}

void test_hydraulic_brake_has_the_whole_demand_before_run(void)
{
    rig.slow_in.demand.brake_torque_mNm = 20000;
    for (int n = 0; n < 200; n++) {
        rig_run(&rig, 1);
        TEST_ASSERT_EQUAL_INT32(20000, rig.out.hydraulic_torque_mNm);
        TEST_ASSERT_EQUAL_INT32(0, rig.out.motor_torque_command_mNm);
        TEST_ASSERT_EQUAL_INT32(0, rig.out.electric_brake_available_mNm);
        TEST_ASSERT_TRUE(rig.out.stop_lamp);
    }
}

void test_a_refused_configuration_keeps_the_controller_in_boot_with_the_bridge_off(void)
{
    rig.slow_in.config_accepted = false;
    rig.slow_in.demand.enable = true;
    rig.slow_in.demand.brake_torque_mNm = 20000;
    rig_set_speed_rpm(&rig, 300.0);
    rig_run(&rig, 1000);
    TEST_ASSERT_EQUAL_INT(MODE_BOOT, rig.out.mode);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, rig.pwm.bridge);
    TEST_ASSERT_EQUAL_INT32(20000, rig.out.hydraulic_torque_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_CONFIG_INVALID, rig.out.available_reason);
}

/* ---- calibration ---- */

static void put_codes(uint16_t a, uint16_t b, uint16_t c)
{
    rig.fast_in.phase_current_code[0] = a;
    rig.fast_in.phase_current_code[1] = b;
    rig.fast_in.phase_current_code[2] = c;
}

void test_current_at_the_calibrated_offsets_is_zero(void)
{
    put_codes(2148, 1948, 2198); /* 100, -100 and 150 codes off: within the tolerance of 200 */
    rig_run(&rig, 200);
    TEST_ASSERT_EQUAL_INT(MODE_READY, rig.out.mode);
    TEST_ASSERT_EQUAL_INT32(2148 * 16, rig.to_slow.offset_q4[0]);
    TEST_ASSERT_EQUAL_INT32(1948 * 16, rig.to_slow.offset_q4[1]);
    TEST_ASSERT_EQUAL_INT32(2198 * 16, rig.to_slow.offset_q4[2]);
    TEST_ASSERT_EQUAL_INT32(0, rig.out.i_d_mA);
    TEST_ASSERT_EQUAL_INT32(0, rig.out.i_q_mA);
}

void test_offsets_of_equal_sign_are_calibrated(void)
{
    put_codes(2238, 2238, 2238); /* the sum of what is read before is 28 % of full scale */
    rig_run(&rig, 200);
    TEST_ASSERT_EQUAL_INT(MODE_READY, rig.out.mode);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, rig.out.fault_reason);
}

void test_an_offset_beyond_the_tolerance_is_a_fault(void)
{
    for (int x = 0; x < 3; x++) {
        rig_start(&rig);
        rig.fast_in.phase_current_code[x] = 2048 + 201;
        rig_run(&rig, 200);
        TEST_ASSERT_EQUAL_INT(MODE_FAULT, rig.out.mode);
        TEST_ASSERT_EQUAL_INT(REASON_OFFSET_IMPLAUSIBLE, rig.out.fault_reason);
    }
}

/* ---- measured values ---- */

void test_codes_are_converted_to_volts_amperes_and_rad_per_second(void)
{
    rig_start_running(&rig);
    rig.follows = true;
    rig_set_speed_rpm(&rig, 300.0);
    rig.fast_in.bus_voltage_code = rig_bus_code(&rig, 48.0);
    rig_run(&rig, 500);
    TEST_ASSERT_INT32_WITHIN(mrad_s_of_rpm(300.0) / 200, mrad_s_of_rpm(300.0),
                             rig.out.speed_mrad_s);              /* 0.5 % */
    TEST_ASSERT_INT32_WITHIN(30, 48000, rig.out.bus_voltage_mV); /* two converter codes */
}

void test_phase_currents_are_transformed_to_d_and_q(void)
{
    /* The rotor stands at 90 electrical degrees, where d is the beta axis and q is minus alpha. i_a
     * = -40 A and i_b = i_c = 20 A are alpha = -40 A: i_d = 0, i_q = 40 A. */
    rig_start_running(&rig);
    rig.angle_turn = 0.25;
    rig_run(&rig, 300); /* the tracking loop gets there */
    const double codes_per_a = 2048e3 / rig.config.drive.current_full_scale_mA;
    put_codes((uint16_t)lround(2048 - 40 * codes_per_a), (uint16_t)lround(2048 + 20 * codes_per_a),
              (uint16_t)lround(2048 + 20 * codes_per_a));
    rig_run(&rig, 10);
    TEST_ASSERT_INT32_WITHIN(100, 0, rig.out.i_d_mA); /* a code is 81 mA */
    TEST_ASSERT_INT32_WITHIN(100, 40000, rig.out.i_q_mA);
    /* at rest 0.7038 Nm/A, no iron current */
    TEST_ASSERT_INT32_WITHIN(100, 28152, rig.out.motor_torque_estimate_mNm);
}

/* Running, without field weakening: where no current answers the voltage it would turn all of it
 * into the d axis. */
static void start_running_at(double angle_turn)
{
    rig_start(&rig);
    rig.config.current_loop.field_weakening_current_pu_q15 = 0;
    controller_init(&rig.controller, &rig.config, BASES_MODEL_TIMER_Hz);
    rig.slow_in.demand.enable = true;
    rig.angle_turn = angle_turn;
    rig_run(&rig, 300);
}

void test_bus_current_is_that_of_applied_voltage_and_measured_current(void)
{
    /* 40 A of i_q against a reference of none: the loop answers with all the voltage there is, u_q
     * = -limit v_dc/sqrt 3. P = 3/2 u_q i_q, so i_dc = -sqrt(3)/2 * limit * 40 A, into the battery.
     */
    start_running_at(0.25);
    const double codes_per_a = 2048e3 / rig.config.drive.current_full_scale_mA;
    put_codes((uint16_t)lround(2048 - 40 * codes_per_a), (uint16_t)lround(2048 + 20 * codes_per_a),
              (uint16_t)lround(2048 + 20 * codes_per_a));
    rig_run(&rig, 20);
    const double limit = rig.config.current_loop.modulation_limit_pu_q15 / 32768.0;
    TEST_ASSERT_INT32_WITHIN(600, (int32_t)lround(-0.5 * sqrt(3.0) * limit * 40e3),
                             rig.out.bus_current_mA);
}

void test_initial_bus_voltage_is_the_middle_of_the_battery_s_range(void)
{
    rig_slow(&rig);
    TEST_ASSERT_INT32_WITHIN(2, (40000 + 58400) / 2, rig.out.bus_voltage_mV);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, rig.out.fault_reason);
}

/* Bound of the driving torque by voltage, on the circle of the phase current or inside it, at
 * 588 r/min and 42 V: about 33 N m, less than the motor's 40 N m. w = 1416 /s, w L = 0.108 Ohm,
 * EMF 28.9 V, i_d = -75 A; 47 A of i_q (33 N m) take u_q = 28.9 - 8.1 + 1.5 V and u_d = -2.3 - 5.1
 * V, 23.5 V of 0.969 * 42/sqrt(3) V. */
static int32_t voltage_bound_mNm(int32_t target_q15, int32_t reserve_q15)
{
    rig_start(&rig);
    rig.config.current_loop.modulation_target_pu_q15 = target_q15;
    rig.config.current_loop.modulation_reserve_pu_q15 = reserve_q15;
    rig.fast_in.bus_voltage_code = rig_bus_code(&rig, 42.0);
    rig_set_speed_rpm(&rig, 588.0);
    rig_run(&rig, 100);
    const limit_t *lines = controller_limits(&rig.controller.slow)->driving;
    return torque_limits_tightest(lines, TORQUE_LINE_PHASE_CURRENT, TORQUE_LINE_DRAWN).torque_mNm;
}

void test_torque_limits_use_the_modulation_target_less_its_reserve(void)
{
    const int32_t whole_mNm = voltage_bound_mNm(31748, 0);
    const int32_t less_mNm = voltage_bound_mNm(31748, 248);
    TEST_ASSERT_TRUE(0 < less_mNm && less_mNm < whole_mNm);
    TEST_ASSERT_EQUAL_INT32(less_mNm, voltage_bound_mNm(31500, 0));
    TEST_ASSERT_EQUAL_INT32(less_mNm, voltage_bound_mNm(32112, 612));
}

/* ---- what is commanded ---- */

void test_each_phase_gets_its_own_compare_value(void)
{
    /* q lies a quarter turn before d. With d at a quarter turn beyond phase a, a positive i_q
     * points against a: the loop, which sees no current, gives a the least on-time and b and c the
     * same. So with the others in turn. */
    for (int phase = 0; phase < 3; phase++) {
        start_running_at(0.25 + phase / 3.0);
        rig.slow_in.demand.drive_torque_mNm = 20000;
        rig_run(&rig, 100);
        const uint16_t *counts = rig.pwm.compare_counts;
        const uint16_t least = counts[phase];
        const uint16_t next = counts[(phase + 1) % 3];
        const uint16_t last = counts[(phase + 2) % 3];
        TEST_ASSERT_LESS_THAN_INT32(bases_pwm_period_counts(&rig.config, BASES_MODEL_TIMER_Hz) / 4,
                                    least);
        TEST_ASSERT_INT_WITHIN(
            (uint32_t)bases_pwm_period_counts(&rig.config, BASES_MODEL_TIMER_Hz) / 50U, next, last);
        TEST_ASSERT_GREATER_THAN_INT32(
            bases_pwm_period_counts(&rig.config, BASES_MODEL_TIMER_Hz) / 2, next);
    }
}

void test_the_torque_demand_reaches_the_current_loop_as_a_per_unit_reference(void)
{
    rig_start_running(&rig);
    rig.follows = true;
    rig.slow_in.demand.drive_torque_mNm = 20000;
    rig_run(&rig, 100);
    TEST_ASSERT_EQUAL_INT32(20000, rig.out.motor_torque_command_mNm);
    /* 20 Nm / 0.7038 Nm/A = 28.417 A of 165 A = 5643.5 in Q15 */
    TEST_ASSERT_INT_WITHIN(5, 5643, rig.to_fast.i_reference_pu.q);
    TEST_ASSERT_EQUAL_INT(0, rig.to_fast.i_reference_pu.d);
}

void test_missing_motor_torque_is_moved_to_the_hydraulic_brake(void)
{
    rig_start_running(&rig);
    rig_set_speed_rpm(&rig, 300.0);
    rig_run(&rig, 300);
    rig.slow_in.demand.brake_torque_mNm = 30000;
    rig_run(&rig, 300); /* the currents stay at zero, whatever the compare values: the voltage runs
                           to its limit */
    TEST_ASSERT_EQUAL_INT32(0, rig.out.motor_torque_command_mNm);
    TEST_ASSERT_EQUAL_INT32(30000, rig.out.hydraulic_torque_mNm);
}

void test_shown_reason_is_that_of_the_tightest_line(void)
{
    rig_start_running(&rig);
    rig.follows = true;
    rig.slow_in.temperature.winding_cC = (rig.config.motor.derate_winding_temperature_cC +
                                          rig.config.motor.max_winding_temperature_cC) /
                                         2;
    rig.slow_in.demand.drive_torque_mNm = 2 * rig.config.motor.max_torque_mNm;
    rig_run(&rig, 500);
    const limit_t *driving = controller_limits(&rig.controller.slow)->driving;
    const torque_line_t tightest = torque_limits_tightest_line(driving);
    TEST_ASSERT_EQUAL_INT(TORQUE_LINE_WINDING, tightest);
    TEST_ASSERT_EQUAL_INT(driving[tightest].reason, rig.out.torque_reason);
    TEST_ASSERT_EQUAL_INT32(driving[tightest].torque_mNm, rig.out.motor_torque_command_mNm);
}

void test_lost_driving_demand_ends_at_once_with_a_warning(void)
{
    rig_start_running(&rig);
    rig.follows = true;
    rig.slow_in.demand.drive_torque_mNm = 10000;
    rig_run(&rig, 100);
    rig.slow_in.demand_age_ms = 101;
    rig_run(&rig, 1);
    TEST_ASSERT_EQUAL_INT32(0, rig.out.motor_torque_command_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_DEMAND_TIMEOUT, rig.out.torque_reason);
    TEST_ASSERT_EQUAL_INT(REASON_DEMAND_TIMEOUT, rig.out.warning_reason);
    TEST_ASSERT_EQUAL_INT(MODE_RUN, rig.out.mode);
    TEST_ASSERT_TRUE(rig.out.hydraulic_valid);
    rig_run(&rig, rig.config.driver.lost_hold_ms);
    TEST_ASSERT_FALSE(rig.out.hydraulic_valid);
    rig.slow_in.demand_age_ms = 0;
    rig_run(&rig, 100);
    TEST_ASSERT_EQUAL_INT32(10000, rig.out.motor_torque_command_mNm);
    TEST_ASSERT_TRUE(rig.out.hydraulic_valid);
    TEST_ASSERT_EQUAL_INT(REASON_DEMAND_TIMEOUT, rig.out.warning_reason); /* latched */
}

void test_a_broken_pedal_sensor_is_a_warning_and_limits_the_drive_while_it_lasts(void)
{
    rig_start_running(&rig);
    rig.follows = true;
    rig.slow_in.demand.drive_torque_mNm = 40000;
    rig.slow_in.demand.reason = REASON_BRAKE_PEDAL_SENSOR;
    rig_run(&rig, 200);
    TEST_ASSERT_EQUAL_INT(MODE_LIMP, rig.out.mode);
    TEST_ASSERT_EQUAL_INT(REASON_BRAKE_PEDAL_SENSOR, rig.out.warning_reason);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, rig.out.fault_reason);
    TEST_ASSERT_INT32_WITHIN(2, 12000, rig.out.motor_torque_command_mNm); /* 0.3 of 40 N m */
    rig.slow_in.demand.reason = REASON_ACCELERATOR_LOCKED;                /* a limit, no warning */
    rig_run(&rig, 200);
    TEST_ASSERT_EQUAL_INT(MODE_RUN, rig.out.mode);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, rig.out.warning_reason);
    TEST_ASSERT_EQUAL_INT32(40000, rig.out.motor_torque_command_mNm);
}

void test_lift_off_braking_of_a_released_accelerator_does_not_keep_the_drive_from_starting(void)
{
    rig_start(&rig);
    rig.slow_in.demand.enable = true;
    rig.slow_in.demand.drive_torque_mNm = -10000;
    rig_run(&rig, 100);
    TEST_ASSERT_EQUAL_INT(MODE_RUN, rig.out.mode);
    rig_start(&rig);
    rig.slow_in.demand.enable = true;
    rig.slow_in.demand.direction = DRIVE_DIRECTION_REVERSE; /* the same torque drives */
    rig.slow_in.demand.drive_torque_mNm = -10000;
    rig_run(&rig, 100);
    TEST_ASSERT_EQUAL_INT(MODE_READY, rig.out.mode);
    rig.slow_in.demand.drive_torque_mNm = 0;
    rig_run(&rig, 2);
    TEST_ASSERT_EQUAL_INT(MODE_RUN, rig.out.mode);
}

void test_the_sensor_that_made_the_demand_be_lost_is_the_latched_warning(void)
{
    rig_start_running(&rig);
    rig.slow_in.demand_age_ms = UINT32_MAX;
    rig.slow_in.demand.reason = REASON_BRAKE_PEDAL_SENSOR;
    rig_run(&rig, 2);
    TEST_ASSERT_EQUAL_INT(REASON_BRAKE_PEDAL_SENSOR, rig.out.warning_reason);
    rig.slow_in.demand_age_ms = 0;
    rig.slow_in.demand.reason = REASON_NONE;
    rig_run(&rig, 1000);
    TEST_ASSERT_EQUAL_INT(REASON_BRAKE_PEDAL_SENSOR, rig.out.warning_reason);
}

void test_disable_while_rolling_keeps_electric_braking(void)
{
    rig_start_running(&rig);
    rig.follows = true;
    rig_set_speed_rpm(&rig, 300.0);
    rig_run(&rig, 300);
    rig.slow_in.demand.enable = false;
    rig.slow_in.demand.brake_torque_mNm = 20000;
    rig_run(&rig, 100);
    TEST_ASSERT_EQUAL_INT(MODE_RUN, rig.out.mode);
    TEST_ASSERT_EQUAL_INT32(-20000, rig.out.motor_torque_command_mNm);
    rig.slow_in.demand.brake_torque_mNm = 0;
    rig.slow_in.demand.drive_torque_mNm = 20000;
    rig_run(&rig, 100);
    TEST_ASSERT_EQUAL_INT32(0, rig.out.motor_torque_command_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_TORQUE_ENABLE, rig.out.torque_reason);
}
