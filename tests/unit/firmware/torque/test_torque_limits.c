/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include "motor/current_setpoint.h"
#include "motor/loss_maps.h"
#include "random_values.h"
#include "reference_motor.h"
#include "torque_limits_rig.h"
#include "unity.h"

void setUp(void)
{
    rig_up(paper_vehicle_without_i_d());
}

void tearDown(void) {}

static bounds_t at_rpm(double rpm)
{
    return at_speed(mrad_s_of_rpm(rpm));
}

static void assert_limit(int32_t expected_mNm, reason_t reason, limit_t limit)
{
    TEST_ASSERT_INT32_WITHIN(30, expected_mNm, limit.torque_mNm); /* 0.1 % of rated torque */
    TEST_ASSERT_EQUAL_INT(reason, limit.reason);
}

/* Airgap torque magnitude, mNm, at which the power at the terminals is power_w (negative:
 * returned), smaller root of 3/2 (A x^2 + B x) = P at i_d = 0; by bisection on the circuit, not by
 * the formula. */
static double torque_at_power_mNm(double rpm, double power_w)
{
    const reference_motor_t motor =
        reference_motor(&config, mrad_s_of_rpm(rpm), winding_temperature_cC);
    const double idle_qt_a = -motor.w_rad_s * motor.psi_wb * motor.iron_siemens;
    double near_a = idle_qt_a; /* close to zero terminal current */
    double far_a = power_w < 0.0 ? -200.0 : 200.0;
    for (int n = 0; n < 200; n++) {
        const double middle_a = 0.5 * (near_a + far_a);
        const double p = reference_point_without_i_d(&motor, middle_a).power_w;
        const bool beyond = power_w < 0.0 ? p < power_w : p > power_w;
        far_a = beyond ? middle_a : far_a;
        near_a = beyond ? near_a : middle_a;
    }
    return fabs(reference_point_without_i_d(&motor, far_a).torque_nm) * 1e3;
}

void test_without_other_limits_max_torque_bounds_driving_and_braking(void)
{
    const bounds_t out = at_rpm(150.0); /* T_opt is 74.7 Nm there */
    assert_limit(40000, REASON_MAX_TORQUE, out.driving);
    assert_limit(40000, REASON_MAX_TORQUE, out.regenerating);
    assert_limit(40000, REASON_MAX_TORQUE, out.optimal);
}

void test_loss_optimum_bounds_only_the_optimal_braking_torque(void)
{
    const bounds_t out = at_rpm(50.0);
    assert_limit(40000, REASON_MAX_TORQUE, out.driving);
    assert_limit(40000, REASON_MAX_TORQUE, out.regenerating);
    TEST_ASSERT_EQUAL_INT(REASON_LOSS_OPTIMUM, out.optimal.reason);
    TEST_ASSERT_EQUAL_INT32(loss_maps_torque_mNm(&config, mrad_s_of_rpm(50.0), 2500),
                            out.optimal.torque_mNm);
    /* 24.19 Nm at 25 degC (physics section 6). Three temperatures leave the interpolated torque up
     * to 5 % off, which costs its square, a quarter of a per cent, of the returned power. */
    TEST_ASSERT_INT32_WITHIN(24190 / 20, 24190, out.optimal.torque_mNm);
}

void test_friction_adds_to_the_airgap_optimum_at_the_shaft(void)
{
    const int32_t without_mNm = at_rpm(50.0).optimal.torque_mNm;
    config.motor.friction_torque_mNm = 700;
    TEST_ASSERT_INT32_WITHIN(2, without_mNm + 700, at_rpm(50.0).optimal.torque_mNm);
    TEST_ASSERT_INT32_WITHIN(2, without_mNm + 700, at_rpm(-50.0).optimal.torque_mNm);
}

void test_power_limit_bounds_driving_and_braking_at_high_speed(void)
{
    /* 2094 W at 600 r/min = 62.832 rad/s: 33.327 Nm */
    const bounds_t out = at_rpm(600.0);
    assert_limit(33327, REASON_MAX_POWER, out.driving);
    assert_limit(33327, REASON_MAX_POWER, out.regenerating);
}

void test_phase_current_limit_includes_the_iron_current(void)
{
    config.motor.max_phase_current_mA = 30000;
    /* The reserve leaves 255/256 of 30 A, 29.883 A. Standstill: 3/2 * 23 * 0.0204 * 29.883 =
     * 21.032 Nm */
    assert_limit(21032, REASON_PHASE_CURRENT, at_speed(0).driving);
    assert_limit(21032, REASON_PHASE_CURRENT, at_speed(0).regenerating);
    /* 300 r/min: iron current 2.5260 A, 1 + a^2 = 1.0000886: 0.7038 * (29.883 -+ 2.526)/1.0000886
     */
    assert_limit(19252, REASON_PHASE_CURRENT, at_rpm(300.0).driving);
    assert_limit(22807, REASON_PHASE_CURRENT, at_rpm(300.0).regenerating);
}

void test_charge_current_of_the_pack_is_divided_by_the_wheels_and_bounds_only_braking(void)
{
    conditions.bms_charge_current_mA = 40000; /* four wheels: 10 A * 53 V = 530 W each */
    const bounds_t out = at_rpm(300.0);
    assert_limit((int32_t)lround(torque_at_power_mNm(300.0, -530.0)), REASON_CHARGE_CURRENT,
                 out.regenerating);
    assert_limit(40000, REASON_MAX_TORQUE, out.driving);
}

void test_configured_charge_current_bounds_the_current_the_bms_allows(void)
{
    config.battery.max_charge_current_mA = 8000; /* 424 W */
    const bounds_t out = at_rpm(300.0);
    assert_limit((int32_t)lround(torque_at_power_mNm(300.0, -424.0)), REASON_CHARGE_CURRENT,
                 out.regenerating);
}

void test_with_hall_sensors_the_charge_limit_is_reduced_by_the_power_of_the_angle_error(void)
{
    /* 640 r/min: w = 1541.5 rad/s, EMF 31.45 V. At 20 kHz half a period is an angle of
     * 1541.5/40000 = 38.5 mrad. With field weakening of d amperes this angle error returns up to
     * 3/2 * 31.45 V * d * 0.0385 more power, by which the limit is reduced. */
    config.battery.max_charge_current_mA = 10000;
    phase_mV = 28500;
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    const limit_t with_hall = at_rpm(640.0).regenerating;
    TEST_ASSERT_EQUAL_INT(REASON_CHARGE_CURRENT, with_hall.reason);
    config.rotor.sensor = CONFIG_ROTOR_ANGLE;
    const limit_t with_angle = at_rpm(640.0).regenerating;
    const reference_motor_t m = reference_motor(&config, mrad_s_of_rpm(640.0), 2500);
    /* i_d on the voltage ellipse at the torque limit, by bisection on the circuit. */
    const double i_qt_a = -with_hall.torque_mNm * 1e-3 / (1.5 * m.pole_pairs * m.psi_wb);
    double d_a = 0.0;
    double deep_a = -60.0;
    for (int n = 0; n < 60; n++) {
        const double middle_a = 0.5 * (d_a + deep_a);
        const double i_dt_a = middle_a + m.w_rad_s * m.l_q_h * m.iron_siemens * i_qt_a;
        const reference_point_t at = reference_point(&m, i_dt_a, i_qt_a);
        const double u_d = m.resistance_ohm * at.i_d_a - m.w_rad_s * m.l_q_h * i_qt_a;
        const double u_q = m.resistance_ohm * at.i_q_a + m.w_rad_s * (m.l_d_h * i_dt_a + m.psi_wb);
        const bool over = hypot(u_d, u_q) > 28.5;
        d_a = over ? middle_a : d_a;
        deep_a = over ? deep_a : middle_a;
    }
    TEST_ASSERT_TRUE(d_a < -20.0);
    const double kept_w = 1.5 * m.w_rad_s * m.psi_wb * -d_a * m.w_rad_s / 40000.0;
    config.battery.max_charge_current_mA = (int32_t)lround(10000.0 * (1.0 - kept_w / 530.0));
    TEST_ASSERT_INT32_WITHIN(60, at_rpm(640.0).regenerating.torque_mNm, with_hall.torque_mNm);
    TEST_ASSERT_TRUE(with_angle.torque_mNm > with_hall.torque_mNm + 500);
}

/* ---- a limit of the battery management that comes and goes ---- */

typedef struct {
    limit_t driving, braking;
} sides_t;

/* The tightest bounds after some milliseconds with these currents of the pack, mA. */
static sides_t sides_after(int milliseconds, int32_t charge_mA, int32_t discharge_mA)
{
    config.brake.loss_braking = 0;
    conditions.bms_charge_current_mA = charge_mA;
    conditions.bms_discharge_current_mA = discharge_mA;
    const motor_model_t model = model_at(&config, mrad_s_of_rpm(300.0), winding_temperature_cC);
    const feasible_set_t set = feasible_set_at(&model, phase_mV);
    for (int n = 0; n < milliseconds; n++) {
        torque_limits_case_step(&state, &set, &conditions, &table);
    }
    const sides_t out = {
        .driving = torque_limits_tightest(table.driving, 0, TORQUE_LINE_COUNT),
        .braking = torque_limits_tightest(table.braking, 0, TORQUE_LINE_LOSS_OPTIMUM),
    };
    return out;
}

/* Of 8 A, which come back in 2^11 ms, 2 A are there after 512 ms: 106 W at 53 V. */
void test_a_limit_that_was_zero_comes_back_slowly_for_braking_and_driving(void)
{
    config.battery.max_charge_current_mA = 8000;
    config.battery.max_discharge_current_mA = 8000;
    (void)sides_after(1, 40000, 40000);
    sides_t out = sides_after(1, 0, 0);
    assert_limit(1778, REASON_CHARGE_CURRENT, out.braking);
    assert_limit(0, REASON_DISCHARGE_CURRENT, out.driving);
    out = sides_after(512, 40000, 40000);
    const int32_t charged_mNm = (int32_t)lround(torque_at_power_mNm(300.0, -106.0));
    const int32_t drawn_mNm = (int32_t)lround(torque_at_power_mNm(300.0, 106.0));
    TEST_ASSERT_INT32_WITHIN(charged_mNm / 20, charged_mNm, out.braking.torque_mNm);
    TEST_ASSERT_INT32_WITHIN(drawn_mNm / 20, drawn_mNm, out.driving.torque_mNm);
    out = sides_after(2100, 40000, 40000);
    assert_limit((int32_t)lround(torque_at_power_mNm(300.0, -424.0)), REASON_CHARGE_CURRENT,
                 out.braking);
}

void test_a_limit_comes_back_at_once_where_there_is_no_other_brake(void)
{
    config.driver.no_other_brake = 1;
    config.battery.max_charge_current_mA = 8000;
    (void)sides_after(1, 0, 40000);
    assert_limit((int32_t)lround(torque_at_power_mNm(300.0, -424.0)), REASON_CHARGE_CURRENT,
                 sides_after(1, 40000, 40000).braking);
}

/* Of a short-time limit, which is hard, nothing is held back. */
void test_the_peak_of_the_charge_current_comes_back_at_once(void)
{
    config.battery.max_charge_current_mA = 8000;
    (void)sides_after(1, 0, 40000);
    conditions.bms_charge_peak_mA = 40000;
    (void)sides_after(1, 0, 40000);
    const int32_t whole_mNm = (int32_t)lround(torque_at_power_mNm(300.0, -424.0));
    TEST_ASSERT_INT32_WITHIN(10, whole_mNm, table.braking[TORQUE_LINE_RETURNED_PEAK].torque_mNm);
}

void test_zero_charge_current_leaves_only_the_iron_drag(void)
{
    /* At 300 r/min and zero terminal current iron loss brakes with 1.778 Nm. It heats the motor and
     * returns no power to the battery. */
    conditions.bms_charge_current_mA = 0;
    assert_limit(1778, REASON_CHARGE_CURRENT, at_rpm(300.0).regenerating);
    conditions.bms_charge_current_mA = INT32_MIN;
    assert_limit(1778, REASON_CHARGE_CURRENT, at_rpm(300.0).regenerating);
}

void test_zero_charge_current_does_not_bound_braking_near_standstill(void)
{
    /* At 0.2 rad/s the EMF is 94 mV. The motor returns at most 3/2 * 0.094^2/(4 * 0.031) = 0.11 W,
     * less than the inverter's losses. Zero torque would let a vehicle roll back on a slope. */
    conditions.bms_charge_current_mA = 0;
    assert_limit(40000, REASON_MAX_TORQUE, at_speed(-200).regenerating);
    assert_limit(40000, REASON_MAX_TORQUE, at_speed(200).regenerating);
    assert_limit(40000, REASON_MAX_TORQUE, at_speed(0).regenerating);
}

void test_charge_current_folds_back_near_max_voltage(void)
{
    /* The middle between 57.232 V and 58.4 V: half of 50 A at 57.816 V is 1445.4 W. */
    conditions.bus_voltage_mV =
        (config.battery.foldback_voltage_mV + config.battery.max_voltage_mV) / 2;
    settle_foldback(20000);
    const bounds_t half = at_rpm(450.0);
    TEST_ASSERT_EQUAL_INT(REASON_BUS_VOLTAGE_HIGH, half.regenerating.reason);
    TEST_ASSERT_DOUBLE_WITHIN(100.0, torque_at_power_mNm(450.0, -1445.4),
                              half.regenerating.torque_mNm);
    assert_limit(40000, REASON_MAX_TORQUE, half.driving);
    conditions.bus_voltage_mV = config.battery.max_voltage_mV;
    settle_foldback(20000);
    const limit_t none = at_rpm(450.0).regenerating;
    TEST_ASSERT_EQUAL_INT(REASON_BUS_VOLTAGE_HIGH, none.reason);
    TEST_ASSERT_DOUBLE_WITHIN(100.0, torque_at_power_mNm(450.0, -1e-9), none.torque_mNm);
}

/* 57.5 V open circuit, 48 milliohm for a quarter of the pack: 0.9 V = (1.168 + 2.4) V I / 50 A
 * leave 12.61 A, whatever flows when the voltage is measured: none, 10 A in or 20 A out. */
void test_fold_back_counts_the_voltage_of_the_current_itself(void)
{
    config.battery.resistance_uOhm = 48000;
    static const int32_t FLOWING_mA[3] = {0, -10000, 20000};
    for (int k = 0; k < 3; k++) {
        conditions.bus_current_mA = FLOWING_mA[k];
        conditions.bus_voltage_mV = 57500 - 48 * FLOWING_mA[k] / 1000;
        settle_foldback(20000);
        TEST_ASSERT_DOUBLE_WITHIN(50.0, 12612.0, 50000.0 * state.charge.allowed_q24 / 16777216.0);
    }
    /* 41 V: 1 V = (1.168 + 3) V I / 62.5 A leave 15.0 A. */
    conditions.bus_current_mA = 5000;
    conditions.bus_voltage_mV = 41000 - 48 * 5;
    settle_foldback(20000);
    TEST_ASSERT_DOUBLE_WITHIN(60.0, 14995.0, 62500.0 * state.discharge.allowed_q24 / 16777216.0);
}

void test_discharge_current_of_the_pack_is_divided_by_the_wheels_and_bounds_driving(void)
{
    conditions.bms_discharge_current_mA = 40000; /* 530 W each */
    const bounds_t out = at_rpm(300.0);
    assert_limit((int32_t)lround(torque_at_power_mNm(300.0, 530.0)), REASON_DISCHARGE_CURRENT,
                 out.driving);
    assert_limit(40000, REASON_MAX_TORQUE, out.regenerating);
}

void test_discharge_current_folds_back_near_min_voltage(void)
{
    /* As generated the fold-back is as wide as the upper one, 1.168 V above 40 V; half of 62.5 A at
     * 40.584 V is 1268.3 W. */
    conditions.bus_voltage_mV = 40584;
    settle_foldback(20000);
    const bounds_t half = at_rpm(300.0);
    TEST_ASSERT_EQUAL_INT(REASON_BUS_VOLTAGE_LOW, half.driving.reason);
    TEST_ASSERT_DOUBLE_WITHIN(100.0, torque_at_power_mNm(300.0, 1268.25), half.driving.torque_mNm);
    assert_limit(40000, REASON_MAX_TORQUE, half.regenerating);
    conditions.bus_voltage_mV = 40000;
    settle_foldback(20000);
    TEST_ASSERT_EQUAL_INT(REASON_BUS_VOLTAGE_LOW, at_rpm(300.0).driving.reason);
    TEST_ASSERT_LESS_OR_EQUAL_INT32(100, at_rpm(300.0).driving.torque_mNm);
    open_foldback();
    conditions.bus_current_mA = 62500;
    conditions.bus_voltage_mV = 38830; /* one width below the end: zero in the first step */
    assert_limit(0, REASON_BUS_VOLTAGE_LOW, at_rpm(300.0).driving);
}

void test_each_fold_back_has_its_own_width(void)
{
    config.battery.discharge_foldback_voltage_mV = 42000; /* half is allowed at 41 V: 1281.25 W */
    conditions.bus_voltage_mV = 41000;
    settle_foldback(20000);
    const limit_t half = at_rpm(300.0).driving;
    TEST_ASSERT_EQUAL_INT(REASON_BUS_VOLTAGE_LOW, half.reason);
    TEST_ASSERT_DOUBLE_WITHIN(100.0, torque_at_power_mNm(300.0, 1281.25), half.torque_mNm);
    TEST_ASSERT_INT32_WITHIN(1 << 14, 1 << 23, state.discharge.allowed_q24); /* 31.25 of 62.5 A */
    config.battery.foldback_voltage_mV = 56400; /* 2 V wide; a quarter of 50 A at 57.9 V */
    conditions.bus_voltage_mV = 57900;
    settle_foldback(20000);
    TEST_ASSERT_INT32_WITHIN(1 << 14, 1 << 22, state.charge.allowed_q24); /* 12.5 of 50 A */
    TEST_ASSERT_EQUAL_INT32(1 << 24, state.discharge.allowed_q24);
}

/* Charging ends at the higher of two voltages that contradict each other and driving at the lower,
 * of which a current has less power too: 25 A at 53 V, half of 62.5 A at 40.584 V. */
void test_each_limit_takes_the_more_dangerous_of_two_voltages(void)
{
    conditions.bus_voltage_mV = 53000;
    conditions.battery_voltage_mV = 57816;
    settle_foldback(20000);
    const limit_t charging = at_rpm(450.0).regenerating;
    TEST_ASSERT_EQUAL_INT(REASON_BUS_VOLTAGE_HIGH, charging.reason);
    TEST_ASSERT_DOUBLE_WITHIN(100.0, torque_at_power_mNm(450.0, -1325.0), charging.torque_mNm);
    TEST_ASSERT_EQUAL_INT32(1 << 24, state.discharge.allowed_q24);
    conditions.battery_voltage_mV = 40584;
    settle_foldback(20000);
    const limit_t driving = at_rpm(300.0).driving;
    TEST_ASSERT_EQUAL_INT(REASON_BUS_VOLTAGE_LOW, driving.reason);
    TEST_ASSERT_DOUBLE_WITHIN(100.0, torque_at_power_mNm(300.0, 1268.25), driving.torque_mNm);
    TEST_ASSERT_EQUAL_INT32(1 << 24, state.charge.allowed_q24);
}

/* Returned power grows with braking torque up to the optimum, then falls. Beyond T_zero the motor
 * draws power: at 5 r/min and 40 Nm 3/2 * 0.031 * 56.8^2 = 150 W of copper loss, 21 W mechanical.
 */
void test_braking_that_draws_power_is_bounded_by_the_discharge_limit(void)
{
    assert_limit(40000, REASON_MAX_TORQUE, at_rpm(5.0).regenerating);
    conditions.bms_discharge_current_mA = 4000; /* 53 W each */
    const bounds_t out = at_rpm(5.0);
    TEST_ASSERT_EQUAL_INT(REASON_DISCHARGE_CURRENT, out.regenerating.reason);
    const reference_motor_t m = reference_motor(&config, mrad_s_of_rpm(5.0), 2500);
    const double i_qt_a = -out.regenerating.torque_mNm * 1e-3 / (1.5 * m.pole_pairs * m.psi_wb);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 53.0, reference_point_without_i_d(&m, i_qt_a).power_w);
    /* At 300 r/min braking returns power: a discharge limit of zero does not bound it. */
    conditions.bms_discharge_current_mA = 0;
    assert_limit(40000, REASON_MAX_TORQUE, at_rpm(300.0).regenerating);
}

void test_a_hot_winding_derates_both_directions(void)
{
    winding_temperature_cC = 14000; /* the middle between 130 and 150 degC */
    assert_limit(20000, REASON_WINDING_TEMPERATURE, at_rpm(150.0).driving);
    assert_limit(20000, REASON_WINDING_TEMPERATURE, at_rpm(150.0).regenerating);
    winding_temperature_cC = 15000;
    assert_limit(0, REASON_WINDING_TEMPERATURE, at_rpm(150.0).driving);
    assert_limit(0, REASON_WINDING_TEMPERATURE, at_rpm(150.0).regenerating);
}

void test_hot_switches_derate_both_directions(void)
{
    config.drive.derate_switch_temperature_cC = 8000;
    config.drive.max_switch_temperature_cC = 10000;
    conditions.switch_temperature_cC = 9500; /* a quarter of 20 K below the upper end */
    assert_limit(10000, REASON_SWITCH_TEMPERATURE, at_rpm(150.0).driving);
    assert_limit(10000, REASON_SWITCH_TEMPERATURE, at_rpm(150.0).regenerating);
}

void test_speed_limit_bounds_driving_and_never_braking(void)
{
    /* Driving torque falls to zero over the last 1/32 of 67.021 rad/s, from 64.927 on. It is half
     * at 65.974, where 2094 W allow more than half of 40 Nm. Braking torque stays at the power
     * limit, 2094 W / 65.974 and, beyond the speed limit, 2094 W / 80. */
    const bounds_t half = at_speed(65974);
    assert_limit(20000, REASON_MAX_SPEED, half.driving);
    assert_limit(31740, REASON_MAX_POWER, half.regenerating);
    const bounds_t beyond = at_speed(80000);
    assert_limit(0, REASON_MAX_SPEED, beyond.driving);
    assert_limit(26175, REASON_MAX_POWER, beyond.regenerating);
}

void test_drive_fades_over_speed_fade_share(void)
{
    config.motor.max_speed_mrad_s = 64000;
    config.motor.speed_fade_share_q15 = 8192; /* a quarter: from 48 rad/s on, 30 N m left at 52 */
    assert_limit(40000, REASON_MAX_TORQUE, at_speed(48000).driving);
    assert_limit(30000, REASON_MAX_SPEED, at_speed(52000).driving);
    assert_limit(0, REASON_MAX_SPEED, at_speed(64000).driving);
    config.motor.speed_fade_share_q15 = 0; /* a step: 2094 W / 64 rad/s up to the end */
    assert_limit(32719, REASON_MAX_POWER, at_speed(64000).driving);
    assert_limit(0, REASON_MAX_SPEED, at_speed(64001).driving);
}

void test_torque_is_zero_without_a_valid_rotor_angle(void)
{
    conditions.angle_valid = false;
    const bounds_t out = at_rpm(150.0);
    assert_limit(0, REASON_ROTOR_UNCERTAIN, out.driving);
    assert_limit(0, REASON_ROTOR_UNCERTAIN, out.regenerating);
    assert_limit(0, REASON_ROTOR_UNCERTAIN, out.optimal);
}

static void random_conditions(random_t *random)
{
    conditions.bus_voltage_mV = random_between(random, 0, 70000);
    conditions.bms_charge_current_mA = random_between(random, -10000, 300000);
    conditions.bms_discharge_current_mA = random_between(random, -10000, 300000);
    winding_temperature_cC = random_between(random, -4000, 20000);
    conditions.switch_temperature_cC = random_between(random, -4000, 12000);
    conditions.angle_valid = random_chance(random, 0.95);
}

void test_limits_are_magnitudes_up_to_max_torque_under_random_conditions(void)
{
    random_t random = random_seeded(1);
    for (int n = 0; n < 50000; n++) {
        random_conditions(&random);
        const bounds_t out = at_speed(random_between(&random, -100000, 100000));
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, out.driving.torque_mNm);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, out.regenerating.torque_mNm);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, out.optimal.torque_mNm);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(out.regenerating.torque_mNm, out.optimal.torque_mNm);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(config.motor.max_torque_mNm, out.driving.torque_mNm);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(config.motor.max_torque_mNm, out.regenerating.torque_mNm);
        TEST_ASSERT_NOT_EQUAL_INT(REASON_NONE, out.driving.reason);
        TEST_ASSERT_NOT_EQUAL_INT(REASON_NONE, out.regenerating.reason);
    }
}

/* Phase current for 0.7038 N m/A: 35 N m of 50 A. */
static void assert_current_line(int32_t max_torque_mNm, int32_t power_torque_mNm, bool open)
{
    enum { SPEED_rad_s = 30 };
    config.motor.max_phase_current_mA = 50000;
    config.motor.max_torque_mNm = max_torque_mNm;
    config.motor.max_power_mW = power_torque_mNm * SPEED_rad_s;
    (void)at_speed(SPEED_rad_s * 1000);
    const limit_t *const sides[] = {table.driving, table.braking};
    for (int n = 0; n < 2; n++) {
        TEST_ASSERT_EQUAL_INT32(max_torque_mNm, sides[n][TORQUE_LINE_MAX_TORQUE].torque_mNm);
        TEST_ASSERT_EQUAL_INT32(power_torque_mNm, sides[n][TORQUE_LINE_MAX_POWER].torque_mNm);
        const int32_t found_mNm = sides[n][TORQUE_LINE_PHASE_CURRENT].torque_mNm;
        TEST_ASSERT_INT32_WITHIN(open ? 0 : 3000, open ? FEASIBLE_UNBOUNDED : 35000, found_mNm);
    }
}

void test_no_bound_beyond_largest_torque_and_power_is_solved(void)
{
    assert_current_line(80000, 80000, false);
    assert_current_line(80000, 20000, true);
    assert_current_line(20000, 80000, true);
}

/* Only the fold-back and the anti-lock hold remember a step before: they are the state. */
void test_the_lines_of_a_step_do_not_depend_on_the_table_before(void)
{
    random_t random = random_seeded(31);
    for (int n = 0; n < 2000; n++) {
        random_conditions(&random);
        phase_mV = random_between(&random, 5000, 30000);
        const int32_t speed_mrad_s = random_between(&random, -100000, 100000);
        (void)at_speed(speed_mrad_s); /* from the table of the last conditions */
        const torque_limits_t used = table;
        torque_limits_state_t unused;
        torque_limits_init(&unused, &table);
        (void)at_speed(speed_mrad_s);
        TEST_ASSERT_EQUAL_MEMORY(&table, &used, sizeof used);
    }
}

void test_limits_are_symmetric_in_the_direction_of_rotation(void)
{
    random_t random = random_seeded(2);
    for (int n = 0; n < 20000; n++) {
        random_conditions(&random);
        const int32_t speed_mrad_s = random_between(&random, 1, 100000);
        const bounds_t forward = at_speed(speed_mrad_s);
        const bounds_t backward = at_speed(-speed_mrad_s);
        TEST_ASSERT_EQUAL_INT32(forward.driving.torque_mNm, backward.driving.torque_mNm);
        TEST_ASSERT_EQUAL_INT32(forward.regenerating.torque_mNm, backward.regenerating.torque_mNm);
        TEST_ASSERT_EQUAL_INT32(forward.optimal.torque_mNm, backward.optimal.torque_mNm);
        TEST_ASSERT_EQUAL_INT(forward.regenerating.reason, backward.regenerating.reason);
    }
}

void test_smaller_battery_currents_never_raise_a_limit(void)
{
    random_t random = random_seeded(3);
    for (int n = 0; n < 20000; n++) {
        random_conditions(&random);
        const int32_t speed_mrad_s = random_between(&random, -100000, 100000);
        const bounds_t before = at_speed(speed_mrad_s);
        conditions.bms_charge_current_mA -= random_between(&random, 0, 50000);
        conditions.bms_discharge_current_mA -= random_between(&random, 0, 50000);
        const bounds_t after = at_speed(speed_mrad_s);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(before.driving.torque_mNm, after.driving.torque_mNm);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(before.regenerating.torque_mNm,
                                        after.regenerating.torque_mNm);
    }
}

void test_higher_temperatures_never_raise_a_limit(void)
{
    config.drive.derate_switch_temperature_cC = 8000;
    config.drive.max_switch_temperature_cC = 10000;
    random_t random = random_seeded(4);
    for (int n = 0; n < 20000; n++) {
        random_conditions(&random);
        /* No charge limit: heat lowers the returned power and would raise it. */
        conditions.bms_charge_current_mA = 1000000;
        conditions.bms_discharge_current_mA = 1000000;
        conditions.bus_voltage_mV = 53000;
        const int32_t speed_mrad_s = random_between(&random, -60000, 60000);
        const bounds_t before = at_speed(speed_mrad_s);
        winding_temperature_cC += random_between(&random, 0, 5000);
        conditions.switch_temperature_cC += random_between(&random, 0, 5000);
        const bounds_t after = at_speed(speed_mrad_s);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(before.driving.torque_mNm, after.driving.torque_mNm);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(before.regenerating.torque_mNm,
                                        after.regenerating.torque_mNm);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(before.optimal.torque_mNm, after.optimal.torque_mNm);
    }
}

void test_no_permitted_braking_torque_exceeds_the_charge_current(void)
{
    random_t random = random_seeded(5);
    for (int n = 0; n < 50000; n++) {
        conditions.bus_voltage_mV = random_between(&random, 40000, 57000);
        conditions.bms_charge_current_mA = random_between(&random, 0, 200000);
        winding_temperature_cC = random_between(&random, -2000, 13000);
        const int32_t speed_mrad_s = random_between(&random, 900, 67000);
        const limit_t limit = at_speed(speed_mrad_s).regenerating;
        const reference_motor_t motor =
            reference_motor(&config, speed_mrad_s, winding_temperature_cC);
        const double torque_nm = random_fraction(&random) * limit.torque_mNm * 1e-3;
        const double i_qt = -torque_nm / (1.5 * motor.pole_pairs * motor.psi_wb);
        const double returned_w = -reference_point_without_i_d(&motor, i_qt).power_w;
        const double share_ma =
            fmin(conditions.bms_charge_current_mA / 4.0, config.battery.max_charge_current_mA);
        const double allowed_w = share_ma * 1e-3 * conditions.bus_voltage_mV * 1e-3;
        /* Whole milliamperes and millivolts: half a watt of two thousand. Charge power below 0.1 %
         * of the largest power, 2.1 W, is not limited. */
        TEST_ASSERT_TRUE(returned_w <= allowed_w + 0.5 + 2.1);
    }
}

/* ---- looking at the table ---- */

void test_the_tightest_line_is_the_one_whose_reason_wins_also_on_a_tie(void)
{
    random_t random = random_seeded(11);
    for (int n = 0; n < 20000; n++) {
        limit_t lines[TORQUE_LINE_COUNT];
        for (int at = 0; at < (int)TORQUE_LINE_COUNT; at++) {
            lines[at] = limit_init(random_between(&random, 0, 5), (reason_t)(at + 1));
        }
        const limit_t winner = torque_limits_tightest(lines, (torque_line_t)0, TORQUE_LINE_COUNT);
        const torque_line_t line = torque_limits_tightest_line(lines);
        TEST_ASSERT_EQUAL_INT32(winner.torque_mNm, lines[line].torque_mNm);
        TEST_ASSERT_EQUAL_INT(winner.reason, lines[line].reason);
    }
}

void test_every_line_has_a_name_of_its_own(void)
{
    for (int at = 0; at < (int)TORQUE_LINE_COUNT; at++) {
        for (int other = 0; other < at; other++) {
            TEST_ASSERT_TRUE(strcmp(torque_limits_line_text((torque_line_t)at),
                                    torque_limits_line_text((torque_line_t)other)) != 0);
        }
    }
    TEST_ASSERT_EQUAL_STRING("LOSS_OPTIMUM", torque_limits_line_text(TORQUE_LINE_LOSS_OPTIMUM));
    TEST_ASSERT_EQUAL_STRING("unknown line", torque_limits_line_text(TORQUE_LINE_COUNT));
}
