/* SPDX-License-Identifier: Apache-2.0 */

#include "coasting.h"
#include "random_values.h"
#include "torque_rig.h"
#include "unity.h"

void setUp(void)
{
    torque_rig_reset();
}

void tearDown(void) {}

void test_driving_demand_gives_the_current_of_its_torque(void)
{
    in.drive_torque_mNm = 30000;
    const torque_output_t out = run(200);
    TEST_ASSERT_EQUAL_INT32(30000, out.command_mNm);
    TEST_ASSERT_INT32_WITHIN(30, 30000, out.estimate_mNm);
    /* 42.626 A for the torque and the iron current at 150 r/min, w = 361.28: 7.3702 V / 3.6677 Ohm
     * = 2.0095 A */
    TEST_ASSERT_INT32_WITHIN(20, 44636, out.current.i_q_mA);
    TEST_ASSERT_EQUAL_INT32(0, out.hydraulic_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, out.reason);
    TEST_ASSERT_FALSE(out.stop_lamp);
}

void test_motor_brakes_alone_below_the_loss_optimum(void)
{
    in.brake_torque_mNm = 30000;
    const torque_output_t out = run(200);
    TEST_ASSERT_EQUAL_INT32(-30000, out.command_mNm);
    TEST_ASSERT_EQUAL_INT32(0, out.hydraulic_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, out.reason);
    TEST_ASSERT_EQUAL_INT32(40000, out.available.torque_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_MAX_TORQUE, out.available.reason);
    TEST_ASSERT_TRUE(out.stop_lamp);
}

void test_reason_is_torque_rate_while_the_torque_rises(void)
{
    in.brake_torque_mNm = 30000;
    TEST_ASSERT_EQUAL_INT(REASON_TORQUE_RATE, run(10).reason);
    in.brake_torque_mNm = 0;
    in.drive_torque_mNm = 30000;
    TEST_ASSERT_EQUAL_INT(REASON_TORQUE_RATE, run(10).reason);
}

void test_braking_demand_above_the_loss_optimum_is_split_with_reason_loss_optimum(void)
{
    in.speed_mrad_s = mrad_s_of_rpm(50.0);
    in.brake_torque_mNm = 60000;
    const torque_output_t out = run(200);
    TEST_ASSERT_EQUAL_INT32(out.available.torque_mNm, -out.command_mNm);
    TEST_ASSERT_EQUAL_INT32(60000, out.hydraulic_mNm - out.command_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_LOSS_OPTIMUM, out.reason);
}

/* Largest sum of both brakes in a stop past loss optimum and blend-out down to standstill. */
static int32_t most_in_a_stop_mNm(int32_t slowing_mrad_s)
{
    hydraulic_model_t brake; /* the vehicle's hydraulic brake, with dead time and lag */
    hydraulic_model_init(&brake);
    torque_rig_reset();
    in.brake_torque_mNm = 60000;
    int32_t most_mNm = 0;
    for (int n = 0; n < 2500; n++) {
        in.speed_mrad_s = q_max(in.speed_mrad_s - slowing_mrad_s, 0);
        const torque_output_t out = step();
        hydraulic_model_step(&brake, &config, out.hydraulic_mNm);
        most_mNm = q_max(most_mNm, hydraulic_model_torque_mNm(&brake) - out.command_mNm);
    }
    TEST_ASSERT_INT32_WITHIN(5, 60000, hydraulic_model_torque_mNm(&brake));
    return most_mNm;
}

/* In the blend-out 40 N m leave within 1.78 rad/s: at 17 rad/s2 with the torque rate of 400 N m/s.
 * In a harder stop, here 50 rad/s2 or 12.5 m/s2, the motor leaves later than the hydraulic brake,
 * whose lag of 60 ms is as fast as (60 - 28) N m / 60 ms, arrives. */
void test_motor_plus_hydraulic_torque_never_exceeds_the_demand_during_a_stop(void)
{
    TEST_ASSERT_LESS_OR_EQUAL_INT32(60000, most_in_a_stop_mNm(10));
    TEST_ASSERT_LESS_OR_EQUAL_INT32(60000, most_in_a_stop_mNm(17));
    TEST_ASSERT_LESS_OR_EQUAL_INT32(61000, most_in_a_stop_mNm(50));
}

void test_hydraulic_brake_brakes_alone_below_the_blend_out_speed(void)
{
    in.brake_torque_mNm = 20000;
    run(100);
    in.speed_mrad_s = 500;
    const torque_output_t out = run(200);
    TEST_ASSERT_EQUAL_INT32(0, out.command_mNm);
    TEST_ASSERT_EQUAL_INT32(20000, out.hydraulic_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_BLEND_OUT, out.reason);
}

void test_hydraulic_brake_replaces_a_motor_without_current(void)
{
    in.brake_torque_mNm = 30000;
    torque_output_t out = {0};
    for (int n = 0; n < 200; n++) {
        out = torque_case_step(); /* the measured current stays zero */
    }
    /* Iron loss brakes with 0.7038 Nm/A * 2.0095 A = 1.414 Nm, and 2 Nm of shortfall are tolerated:
     * 30 - 1.414 - 2 = 26.586 Nm. */
    TEST_ASSERT_INT32_WITHIN(20, -1414, out.estimate_mNm);
    TEST_ASSERT_INT32_WITHIN(20, 26586, out.hydraulic_mNm);
}

void test_zero_torque_enable_moves_the_demand_to_the_hydraulic_brake_in_one_step(void)
{
    in.brake_torque_mNm = 30000;
    run(200);
    in.torque_enable.drive_q15 = 0;
    in.torque_enable.brake_q15 = 0;
    in.torque_enable.reason = REASON_OVERCURRENT;
    const torque_output_t out = step();
    TEST_ASSERT_EQUAL_INT32(0, out.command_mNm);
    TEST_ASSERT_EQUAL_INT32(30000, out.hydraulic_mNm);
    TEST_ASSERT_EQUAL_INT32(0, out.available.torque_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, out.reason);
}

void test_demand_beyond_both_brakes_has_reason_hydraulic_limit(void)
{
    config.brake.max_hydraulic_torque_mNm = 50000;
    in.brake_torque_mNm = 80000;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(200).hydraulic_reason);
    in.brake_torque_mNm = 100000;
    const torque_output_t out = run(10);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_LIMIT, out.hydraulic_reason);
    TEST_ASSERT_EQUAL_INT32(50000, out.hydraulic_mNm);
}

/* The motor of 24 to 40 N m leaves with the lag of the path that arrives: exp(-1) of it is left
 * after the time constant, and a command of no more than the falling demand beside it. */
void test_both_brakes_are_kept_and_the_motor_then_leaves_as_the_brake_systems_own_path_arrives(void)
{
    in.brake_torque_mNm = 20000;
    in.drive_torque_mNm = 40000; /* beneath it */
    run(200);
    in.demand_age_ms = 1000;
    const torque_output_t kept = run(config.driver.lost_hold_ms);
    TEST_ASSERT_EQUAL_INT32(20000, kept.hydraulic_mNm - kept.command_mNm);
    TEST_ASSERT_TRUE(kept.hydraulic_valid);
    const torque_output_t waiting = run(config.brake.hydraulic_dead_time_ms);
    TEST_ASSERT_FALSE(waiting.hydraulic_valid);
    TEST_ASSERT_EQUAL_INT32(kept.command_mNm, waiting.command_mNm);
    const torque_output_t later = run(config.brake.hydraulic_time_constant_ms);
    TEST_ASSERT_DOUBLE_WITHIN(-0.02 * kept.command_mNm, exp(-1.0) * kept.command_mNm,
                              later.command_mNm);
    const torque_output_t gone = run(600);
    TEST_ASSERT_EQUAL_INT32(0, gone.hydraulic_mNm);
    TEST_ASSERT_EQUAL_INT32(0, gone.command_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_DEMAND_TIMEOUT, gone.reason);
}

void test_reason_is_phase_current_where_that_limit_is_the_tightest(void)
{
    in.drive_torque_mNm = 30000;
    run(200);
    config.motor.max_phase_current_mA = 20000;
    TEST_ASSERT_EQUAL_INT(REASON_PHASE_CURRENT, step().reason);
}

void test_reason_is_voltage_only_while_no_other_limit_bounds_the_torque(void)
{
    in.drive_torque_mNm = 10000;
    run(200);
    in.voltage_limited = true;
    TEST_ASSERT_EQUAL_INT(REASON_VOLTAGE, step().reason);
    in.drive_torque_mNm = 60000;
    TEST_ASSERT_EQUAL_INT(REASON_MAX_TORQUE, run(200).reason);
}

/* w = 361.28 /s: EMF 7.37 V, w L 27.5 mOhm, R 31 mOhm. With 75 A, 30 N m (42.6 A) take 7.0 V or
 * more in the q-axis and 3.1 V in the d-axis, 10 A at most 5.7 V and 2.6 V: with 6.5 V a smaller
 * torque is left, and the command falls to it at the torque rate. With 1 V none is: 75 A lower the
 * EMF by 2.1 V. */
void test_torque_that_falls_to_a_feasible_one_counts_as_feasible(void)
{
    in.drive_torque_mNm = 30000;
    TEST_ASSERT_TRUE(run(200).current.feasible);
    in.phase_voltage_mV = 6500;
    torque_output_t out = step();
    TEST_ASSERT_INT32_WITHIN(config.brake.torque_rate_mNm_s / 1000, 30000, out.command_mNm);
    for (int n = 0; n < 200; n++) {
        TEST_ASSERT_TRUE(out.current.feasible);
        out = step();
    }
    TEST_ASSERT_GREATER_THAN_INT32(7000, out.command_mNm); /* 10 A */
    TEST_ASSERT_LESS_THAN_INT32(30000, out.command_mNm);
    in.phase_voltage_mV = 1000;
    TEST_ASSERT_FALSE(step().current.feasible);
}

void test_torque_estimate_is_that_of_the_measured_current(void)
{
    in.drive_torque_mNm = 30000;
    in.current.q_mA = -10000;
    /* -0.7038 Nm/A * (10 + 2.0095) A */
    TEST_ASSERT_INT32_WITHIN(30, -8452, torque_case_step().estimate_mNm);
    in.flux_missing_q15 = 1 << 13; /* a quarter; at most a half counts */
    TEST_ASSERT_INT32_WITHIN(30, -6339, torque_case_step().estimate_mNm);
    in.flux_missing_q15 = INT32_MAX;
    TEST_ASSERT_INT32_WITHIN(30, -4226, torque_case_step().estimate_mNm);
    in.flux_missing_q15 = -1;
    TEST_ASSERT_INT32_WITHIN(30, -8452, torque_case_step().estimate_mNm);
}

/* Limits of 0.05, 0.02 and 0.2: magnets 0.7038 Nm/A (12.01 + 2.01) A 0.05, gain 7.04 Nm 0.02, drag
 * 1.414 Nm 0.2; the root of the squares' sum is 0.586 Nm, over sqrt(3). */
void test_uncertainty_is_that_of_the_measured_current_and_the_sensor_s_angle(void)
{
    in.current.q_mA = -10000;
    TEST_ASSERT_INT32_WITHIN(2, 338, torque_case_step().uncertainty_mNm);
    in.sensor_wrong = true;
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, torque_case_step().uncertainty_mNm);
    in.sensor_wrong = false;
    in.angle_by = ANGLE_BY_OBSERVER;
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, torque_case_step().uncertainty_mNm);
    in.angle_by = ANGLE_BY_SENSOR;
    in.angle_valid = false;
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, torque_case_step().uncertainty_mNm);
}

/* Without current magnets 0.7038 Nm/A (2.01 + 2.01) A 0.05 and drag 1.414 Nm 0.2 are left: 0.316
 * Nm, over sqrt(3). */
void test_uncertainty_follows_the_current_within_16_steps(void)
{
    in.current.q_mA = -10000;
    torque_case_step();
    in.current.q_mA = 0;
    int32_t stated_mNm = 0;
    for (int n = 0; n < 16; n++) {
        stated_mNm = torque_case_step().uncertainty_mNm;
    }
    TEST_ASSERT_INT32_WITHIN(2, 183, stated_mNm);
}

/* Demand, battery, temperatures and torque enable jump at random; the speed changes slowly. */
static void random_conditions(random_t *random)
{
    if (random_chance(random, 0.02)) {
        in.drive_torque_mNm =
            random_chance(random, 0.5) ? 0 : random_between(random, -60000, 60000);
        in.brake_torque_mNm = random_chance(random, 0.5) ? 0 : random_between(random, 0, 200000);
    }
    if (random_chance(random, 0.01)) {
        in.abs_active = random_chance(random, 0.1);
        in.bms_charge_current_mA = random_between(random, 0, 200000);
        in.bms_discharge_current_mA = random_between(random, 0, 200000);
        in.bus_voltage_mV = random_between(random, 35000, 60000);
        in.winding_temperature_cC = random_between(random, -2000, 16000);
        in.angle_valid = random_chance(random, 0.9);
        in.torque_enable = FULL_ENABLE;
        if (random_chance(random, 0.2)) {
            in.torque_enable.drive_q15 = (int16_t)random_between(random, 0, Q15_ONE);
            in.torque_enable.brake_q15 = (int16_t)random_between(random, 0, Q15_ONE);
            in.torque_enable.reason = REASON_TORQUE_ENABLE;
        }
    }
    in.speed_mrad_s = q_clamp(in.speed_mrad_s + random_between(random, -300, 300), 0, 70000);
}

void test_command_stays_between_zero_its_last_value_and_the_demand(void)
{
    random_t random = random_seeded(1);
    int32_t before_mNm = 0;
    for (int n = 0; n < 200000; n++) {
        random_conditions(&random);
        const torque_output_t out = step();
        const int32_t lift_off_mNm = q_max(-in.drive_torque_mNm, 0);
        const int32_t demand_mNm = in.brake_torque_mNm > 0 || lift_off_mNm > 0
                                       ? -in.brake_torque_mNm - lift_off_mNm
                                       : in.drive_torque_mNm;
        /* The speed is positive, so braking is negative. The command lies within the range of its
         * last value, zero and the demand beside coasting. */
        const int32_t coasting_mNm =
            coasting_most_mNm(&config, in.speed_mrad_s, in.winding_temperature_cC);
        const bool brakes = demand_mNm < 0 || before_mNm < 0;
        const int32_t more_mNm = brakes ? q_max(coasting_mNm + demand_mNm / 2, 0) : 0;
        const int32_t low = q_min(q_min(before_mNm, 0), demand_mNm - more_mNm);
        const int32_t high = q_max(q_max(before_mNm, 0), demand_mNm);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(low, out.command_mNm);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(high, out.command_mNm);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, out.hydraulic_mNm);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(in.brake_torque_mNm + lift_off_mNm, out.hydraulic_mNm);
        if (in.brake_torque_mNm > 0 && in.speed_mrad_s > 0) { /* no driving command while braking */
            TEST_ASSERT_LESS_OR_EQUAL_INT32(0, out.command_mNm);
        }
        before_mNm = out.command_mNm;
    }
}

void test_both_brakes_together_settle_on_the_braking_demand(void)
{
    random_t random = random_seeded(2);
    for (int n = 0; n < 300; n++) {
        torque_rig_start();
        in.speed_mrad_s = random_between(&random, 0, 67000);
        in.brake_torque_mNm = random_between(&random, 1, 300000);
        in.bms_charge_current_mA = random_between(&random, 0, 200000);
        in.winding_temperature_cC = random_between(&random, -2000, 16000);
        config.brake.strategy = random_between(&random, 0, 2);
        const torque_output_t out = run(110);
        /* In the beginning the sum may exceed the demand: the motor's torque is still rising. */
        const torque_output_t settled = run(600);
        /* A small demand adds to coasting. */
        const int32_t sum_mNm = settled.hydraulic_mNm - settled.command_mNm;
        const int32_t coasting_mNm =
            coasting_most_mNm(&config, in.speed_mrad_s, in.winding_temperature_cC);
        if (in.brake_torque_mNm >= 2 * coasting_mNm) {
            TEST_ASSERT_INT32_WITHIN(2, in.brake_torque_mNm, sum_mNm); /* the trim settles */
        } else {
            TEST_ASSERT_GREATER_OR_EQUAL_INT32(in.brake_torque_mNm, sum_mNm);
            TEST_ASSERT_LESS_OR_EQUAL_INT32(coasting_mNm + in.brake_torque_mNm / 2, sum_mNm);
        }
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(in.brake_torque_mNm,
                                           out.hydraulic_mNm - out.command_mNm);
    }
}

void test_outputs_are_bounded_for_any_input(void)
{
    /* The sanitizer build detects undefined behaviour; the assertions are bounds of the outputs. */
    random_t random = random_seeded(3);
    for (int n = 0; n < 100000; n++) {
        in.drive_torque_mNm = random_wild(&random);
        in.brake_torque_mNm = random_wild(&random);
        in.demand_age_ms = (uint32_t)random_u64(&random) % 200U;
        in.speed_mrad_s = random_wild(&random);
        in.current.d_mA = random_wild(&random);
        in.current.q_mA = random_wild(&random);
        in.bus_voltage_mV = random_wild(&random);
        in.phase_voltage_mV = random_wild(&random);
        in.voltage_use_q15 = random_wild(&random);
        in.bms_charge_current_mA = random_wild(&random);
        in.bms_discharge_current_mA = random_wild(&random);
        in.winding_temperature_cC = random_wild(&random);
        in.switch_temperature_cC = random_wild(&random);
        in.i_d_weakening_mA = random_wild(&random);
        const torque_output_t out = torque_case_step();
        TEST_ASSERT_INT32_WITHIN(config.motor.max_phase_current_mA, 0, out.current.i_q_mA);
        TEST_ASSERT_INT32_WITHIN(config.motor.max_torque_mNm, 0, out.command_mNm);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, out.hydraulic_mNm);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(config.brake.max_hydraulic_torque_mNm, out.hydraulic_mNm);
    }
}

static double drawn_w(void)
{
    const reference_point_t at = torque_rig_point();
    return at.power_w + reference_bridge_w(&config, at);
}

/* Half of the fold-back's width inside the end of the voltage, half of the current is allowed.
 * Without a hydraulic brake, whose estimate would bound the motor. Tolerance: the integrator stops
 * below a step of 1 mA, 8 * 18.4 V * 1 mA/32 A = 4.6 mV or 0.8 % of the half width, the torque of a
 * power is rounded to 1 mN m, and 0.3 A of switching, which the applied voltage does not show,
 * count as not flowing: 0.3 A 48 mOhm are 2.5 % of the half width. */
void test_half_of_the_battery_current_is_allowed_at_half_of_the_foldback_width(void)
{
    config.brake.max_hydraulic_torque_mNm = 0;
    const int32_t half_width_mV =
        (config.battery.max_voltage_mV - config.battery.foldback_voltage_mV) / 2;

    in.speed_mrad_s = mrad_s_of_rpm(450.0);
    in.brake_torque_mNm = 40000;
    (void)run(200);
    in.bus_voltage_mV = config.battery.max_voltage_mV - half_width_mV;
    TEST_ASSERT_EQUAL_INT(REASON_BUS_VOLTAGE_HIGH, run(4000).available.reason);
    TEST_ASSERT_DOUBLE_WITHIN(0.03 * 1445.4, -25.0 * 1e-3 * in.bus_voltage_mV, drawn_w());

    torque_rig_start();
    in.brake_torque_mNm = 0;
    in.drive_torque_mNm = 40000;
    in.bus_voltage_mV = 53000;
    (void)run(200);
    in.bus_voltage_mV = config.battery.min_voltage_mV + half_width_mV;
    TEST_ASSERT_EQUAL_INT(REASON_BUS_VOLTAGE_LOW, run(4000).reason);
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * 1268.3, 31.25 * 1e-3 * in.bus_voltage_mV, drawn_w());
}

/* Initialised again during a stop, at 2.6 m/s^2 and at the end of the battery's voltage, without a
 * message: both brakes release. */
void test_init_resets_demand_limits_and_stop_lamp(void)
{
    in.brake_torque_mNm = 30000;
    in.bus_voltage_mV = config.battery.max_voltage_mV;
    for (int n = 0; n < 400; n++) {
        in.speed_mrad_s -= 10;
        (void)step();
    }
    torque_rig_start();
    in.brake_torque_mNm = 0;
    in.demand_age_ms = 1000000;
    const torque_output_t out = step();
    TEST_ASSERT_EQUAL_INT32(0, out.command_mNm);
    TEST_ASSERT_EQUAL_INT32(0, out.hydraulic_mNm);
    TEST_ASSERT_FALSE(out.stop_lamp);
}

/* ---- the shown reason ---- */

static void draw_state(random_t *random)
{
    in.speed_mrad_s = random_chance(random, 0.1) ? 0 : random_between(random, -90000, 90000);
    in.bus_voltage_mV = random_between(random, 38000, 61000);
    in.phase_voltage_mV = random_between(random, 5000, 100000);
    in.bms_charge_current_mA = random_chance(random, 0.2) ? 0 : random_between(random, 0, 200000);
    in.bms_discharge_current_mA =
        random_chance(random, 0.2) ? 0 : random_between(random, 0, 400000);
    in.winding_temperature_cC = random_between(random, 0, 16000);
    in.switch_temperature_cC = random_between(random, 0, 20000);
    in.i_d_weakening_mA = random_chance(random, 0.5) ? 0 : random_between(random, -60000, 0);
    in.voltage_limited = random_chance(random, 0.3);
    in.angle_valid = random_chance(random, 0.9);
    in.abs_active = random_chance(random, 0.1);
    in.torque_enable.drive_q15 = random_chance(random, 0.8) ? Q15_ONE : 0;
    in.torque_enable.brake_q15 = random_chance(random, 0.8) ? Q15_ONE : 0;
    in.torque_enable.reason = REASON_TORQUE_ENABLE;
    const bool brakes = random_chance(random, 0.5);
    in.brake_torque_mNm = brakes ? random_between(random, 1, 150000) : 0;
    in.drive_torque_mNm = brakes ? 0 : random_between(random, -100000, 100000);
    in.direction = in.drive_torque_mNm < 0 ? DRIVE_DIRECTION_REVERSE : DRIVE_DIRECTION_FORWARD;
}

/* Where the command lies on the tightest line of the table and the demand beyond it, that line's
 * reason is shown, whatever else limits. */
void test_the_reason_shown_on_a_bound_is_that_of_the_table_s_tightest_line(void)
{
    random_t random = random_seeded(11);
    config.driver.direction_change_mrad_s = 1000000; /* none is refused */
    int on_bound[256] = {0};
    for (int n = 0; n < 20000; n++) {
        if (n % 100 == 0) {
            config.brake.strategy = n / 100 % 3;
            config.motor.max_phase_current_mA = n / 100 % 2 == 0 ? 8000 : 90000;
            torque_rig_start();
        }
        draw_state(&random);
        torque_output_t out = run(1);
        for (int more = 0; more < 20 && random_chance(&random, 0.9); more++) {
            out = step();
        }
        const int32_t demand_mNm =
            in.brake_torque_mNm > 0 ? in.brake_torque_mNm : q_abs(in.drive_torque_mNm);
        const bool against = (int64_t)in.drive_torque_mNm * in.speed_mrad_s < 0;
        limit_t winner =
            in.brake_torque_mNm > 0
                ? torque_limits_tightest(state.table.braking, 0, TORQUE_LINE_COUNT)
                : (against
                       ? torque_limits_tightest(state.table.braking, 0, TORQUE_LINE_LOSS_OPTIMUM)
                       : torque_limits_tightest(state.table.driving, 0, TORQUE_LINE_COUNT));
        if (in.brake_torque_mNm == 0 && against) {
            limit_tighten(&winner, state.table.braking[TORQUE_LINE_ABS].torque_mNm, REASON_ABS);
        }
        /* From zero to what the motor makes without a current, whatever line permits less. */
        const bool rises = (against || in.brake_torque_mNm > 0) && out.reason != winner.reason &&
                           out.coasting_mNm > winner.torque_mNm;
        if (demand_mNm > winner.torque_mNm && q_abs(out.command_mNm) == winner.torque_mNm &&
            !rises) {
            TEST_ASSERT_EQUAL_INT(winner.reason, out.reason);
            on_bound[winner.reason]++;
        }
    }
    static const reason_t MET[] = {REASON_VOLTAGE,
                                   REASON_PHASE_CURRENT,
                                   REASON_CHARGE_CURRENT,
                                   REASON_DISCHARGE_CURRENT,
                                   REASON_TORQUE_ENABLE,
                                   REASON_ROTOR_UNCERTAIN,
                                   REASON_ABS,
                                   REASON_WINDING_TEMPERATURE,
                                   REASON_SWITCH_TEMPERATURE,
                                   REASON_LOSS_OPTIMUM};
    for (unsigned k = 0; k < sizeof MET / sizeof MET[0]; k++) {
        TEST_ASSERT_GREATER_THAN_INT(10, on_bound[MET[k]]);
    }
}

/* The battery takes or gives nothing from the step on in which a demand comes: the bound of its
 * side is of that step, whichever side was demanded before. */
void test_a_new_demand_meets_a_bound_of_the_same_step(void)
{
    enum { BRAKE, LIFT_OFF, ROLLING_BACK, DRIVE, DEMANDS };
    for (int kind = 0; kind < DEMANDS; kind++) {
        torque_rig_reset();
        in.drive_torque_mNm = kind == DRIVE ? 0 : 10000;
        in.brake_torque_mNm = kind == DRIVE ? 10000 : 0;
        (void)run(100);
        in.bms_charge_current_mA = 0;
        in.bms_discharge_current_mA = 0;
        in.drive_torque_mNm = kind == LIFT_OFF ? -10000 : kind == BRAKE ? 0 : 10000;
        in.brake_torque_mNm = kind == BRAKE ? 10000 : 0;
        in.speed_mrad_s = kind == ROLLING_BACK ? -in.speed_mrad_s : in.speed_mrad_s;
        (void)step();
        const torque_limits_t *now = torque_limits_of(&state);
        const limit_t *line =
            kind == DRIVE ? &now->driving[TORQUE_LINE_DRAWN] : &now->braking[TORQUE_LINE_RETURNED];
        TEST_ASSERT_LESS_THAN_INT32(2000, line->torque_mNm); /* its losses */
    }
}
