/* SPDX-License-Identifier: Apache-2.0 */
/* The plant alone: with the firmware's outputs as external inputs the vehicle moves
 * bit-identically; invalid inputs are refused with a message. */
#include "bench/external.h"
#include "config/bases.h"

#include <math.h>
#include <string.h>

#include "bench/handle.h"
#include "plant_values.h"
#include "unity.h"
#include "vehicle_fixture.h"

enum { MILLI = 1000 };

static hubsim_t *firmware; /* drives its vehicle itself */
static hubsim_t *outside;  /* driven from outside */

static void set(hubsim_t *sim, const char *name, double value)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(HUBSIM_OK, hubsim_set(sim, name, value), hubsim_error(sim));
}

static hubsim_t *braking_vehicle(void)
{
    const config_t config = fixture_config(CONFIG_STRATEGY_SERIES_OPTIMAL);
    hubsim_t *sim = hubsim_new();
    TEST_ASSERT_NOT_NULL(sim);
    for (int k = 0; k < PLANT_DRIVES[0].count; k++) {
        set(sim, PLANT_DRIVES[0].values[k].name, PLANT_DRIVES[0].values[k].value);
    }
    set(sim, "road.gravity_m_per_s2", 9.81);
    set(sim, "driver.bandwidth_rad_per_s", 1.0);
    set(sim, "driver.preview_s", 0.4);
    set(sim, "driver.enable", 1.0);
    set(sim, "driver.direction", 1.0);
    set(sim, "run.record_interval_s", 0.01);
    set(sim, "run.initial_speed_m_per_s", 3.0);
    set(sim, "run.stop_at_standstill", 1.0);
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_set_voltage_curve(sim, PLANT_DRIVES[0].soc,
                                                              PLANT_DRIVES[0].voltage_v,
                                                              PLANT_DRIVES[0].voltage_points));
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_load_config(sim, &config, sizeof(config)));
    TEST_ASSERT_EQUAL_INT_MESSAGE(HUBSIM_OK, hubsim_start(sim), hubsim_error(sim));
    return sim;
}

void setUp(void)
{
    firmware = braking_vehicle();
    outside = braking_vehicle();
}

void tearDown(void)
{
    hubsim_delete(firmware);
    hubsim_delete(outside);
}

static void one_period(hubsim_t *sim)
{
    const bench_t *bench = &sim->bench;
    hubsim_advance(sim, bench->time_s + 0.5 * bench->world.step_s);
}

static hubsim_command_t switched(const wheel_t *wheel, const config_t *config)
{
    hubsim_command_t out = {.bridge = (int32_t)wheel->next.bridge};
    for (int i = 0; i < 3; i++) {
        out.duty[i] = (double)wheel->next.compare_counts[i] /
                      bases_pwm_period_counts(config, BASES_MODEL_TIMER_Hz);
    }
    return out;
}

/* Bit-identical. */
static void same(double expected, double actual)
{
    TEST_ASSERT_EQUAL_MEMORY(&expected, &actual, sizeof(expected));
}

/* The firmware's vehicle is a period ahead: the hydraulic torque that it asks for there is given
 * with the step before. */
void test_external_commands_equal_to_the_firmwares_give_a_bit_identical_run(void)
{
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_external_take(outside, 1));
    const int wheels = hubsim_external_wheels(outside);
    TEST_ASSERT_EQUAL_INT(firmware->bench.wheels, wheels);
    one_period(firmware);
    int status = HUBSIM_OK;
    int periods = 0;
    while (status == HUBSIM_OK) {
        const bench_t here = firmware->bench;
        if (periods == 100) { /* more than the motors give */
            set(firmware, "driver.brake_demand_nm", 90.0);
            set(outside, "driver.brake_demand_nm", 90.0);
        }
        hubsim_command_t commands[BENCH_WHEELS_MAX];
        for (int k = 0; k < wheels; k++) {
            commands[k] = switched(&here.wheel[k], &here.config);
        }
        one_period(firmware);
        for (int k = 0; k < wheels; k++) {
            commands[k].hydraulic_nm =
                (double)firmware->bench.wheel[k].slow.hydraulic_torque_mNm / MILLI;
        }
        status = hubsim_external_step(outside, commands);
        periods++;
        hubsim_vehicle_t vehicle;
        hubsim_wheel_t seen[BENCH_WHEELS_MAX];
        TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_external_read(outside, &vehicle, seen));
        same(here.time_s, vehicle.time_s);
        same(here.vehicle.speed_m_per_s, vehicle.speed_m_per_s);
        same(here.bus.voltage_v, vehicle.bus_voltage_v);
        same(here.battery.current_a, vehicle.battery_current_a);
        for (int k = 0; k < wheels; k++) {
            same(here.wheel[k].rotor.theta_turn, seen[k].rotor_turn);
            same(here.wheel[k].rotor.terminal.alpha, seen[k].phase_current_a[0]);
        }
    }
    TEST_ASSERT_EQUAL_INT(HUBSIM_ENDED, status);
    TEST_ASSERT_GREATER_THAN_INT(5000, periods); /* a quarter of a second and more */
    double theirs = 0.0;
    double ours = 0.0;
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_value(firmware, "energy.hydraulic_j", &theirs));
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_value(outside, "energy.hydraulic_j", &ours));
    TEST_ASSERT_TRUE(ours > 100.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * theirs, theirs, ours);
}

static hubsim_command_t command_of(double a, double b, double c)
{
    const hubsim_command_t out = {.duty = {a, b, c}, .bridge = HUBSIM_BRIDGE_PWM};
    return out;
}

static void step_all(const hubsim_command_t *command, int periods)
{
    hubsim_command_t commands[BENCH_WHEELS_MAX];
    for (int k = 0; k < BENCH_WHEELS_MAX; k++) {
        commands[k] = *command;
    }
    for (int n = 0; n < periods; n++) {
        TEST_ASSERT_EQUAL_INT_MESSAGE(HUBSIM_OK, hubsim_external_step(outside, commands),
                                      hubsim_error(outside));
    }
}

static double phase_current_a(void)
{
    hubsim_vehicle_t vehicle;
    hubsim_wheel_t wheels[BENCH_WHEELS_MAX];
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_external_read(outside, &vehicle, wheels));
    return wheels[0].phase_current_a[0];
}

/* In a period a twentieth more on phase a lets its current rise by what the voltage does to
 * inductance and iron; all currents are far from zero, where the dead time changes its sign. */
static double rise_after_one_step(int delay_periods)
{
    const hubsim_command_t level = command_of(0.7, 0.4, 0.4);
    const hubsim_command_t more = command_of(0.75, 0.4, 0.4);
    double current_a[2];
    for (int k = 0; k < 2; k++) {
        hubsim_delete(outside);
        outside = braking_vehicle();
        TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_external_take(outside, delay_periods));
        step_all(&level, 4);
        step_all(k == 0 ? &level : &more, 1);
        current_a[k] = phase_current_a();
    }
    return current_a[1] - current_a[0];
}

void test_duties_act_without_delay_or_one_period_later(void)
{
    const bench_params_t *params = &outside->bench.params;
    const double volts = 0.05 * 2.0 / 3.0 * outside->bench.bus.voltage_v;
    const pmsm_params_t *motor = &params->motor;
    const double omega_rad_s = outside->bench.wheel[0].motion.speed_rad_s * motor->pole_pairs;
    const double iron_ohm = motor->iron_loss_resistance_ohm +
                            motor->iron_loss_resistance_slope_ohm_s * fabs(omega_rad_s);
    const double period_s = 1.0 / params->inverter.pwm_frequency_hz;
    const double expected_a = volts * (period_s / motor->d_inductance_h + 1.0 / iron_ohm);
    const double at_once_a = rise_after_one_step(0);
    /* Resistance and rotation take a few per cent of it. */
    TEST_ASSERT_DOUBLE_WITHIN(0.05 * expected_a, expected_a, at_once_a);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, rise_after_one_step(1));
}

void test_sensor_currents_are_quantised_as_by_their_converters(void)
{
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_external_take(outside, 0));
    const hubsim_command_t some = command_of(0.6, 0.5, 0.45);
    step_all(&some, 5);
    hubsim_vehicle_t vehicle;
    hubsim_wheel_t wheels[BENCH_WHEELS_MAX];
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_external_read(outside, &vehicle, wheels));
    const sensors_params_t *sensors = &outside->bench.params.sensors;
    const double step_a = 2.0 * sensors->current_full_scale_a / exp2(sensors->adc_bits);
    for (int i = 0; i < 3; i++) {
        const double error_a = wheels[0].phase_current_measured_a[i] - wheels[0].phase_current_a[i];
        TEST_ASSERT_DOUBLE_WITHIN(step_a + 6.0 * sensors->current_noise_a +
                                      fabs(sensors->current_offset_a),
                                  0.0, error_a);
        const double codes = wheels[0].phase_current_measured_a[i] / step_a;
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, round(codes), codes);
    }
    TEST_ASSERT_TRUE(fabs(wheels[0].phase_current_a[0]) > 1.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.5, vehicle.bus_voltage_v, vehicle.bus_voltage_measured_v);
}

void test_calls_out_of_order_and_invalid_commands_are_refused_with_a_message(void)
{
    hubsim_command_t commands[BENCH_WHEELS_MAX] = {command_of(0.5, 0.5, 0.5)};
    hubsim_vehicle_t vehicle;
    hubsim_wheel_t wheels[BENCH_WHEELS_MAX];
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_external_step(outside, commands));
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_external_read(outside, &vehicle, wheels));
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_VALUE, hubsim_external_take(outside, 2));
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_external_take(outside, 1));
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_external_take(outside, 1));
    TEST_ASSERT_NOT_NULL(strstr(hubsim_error(outside), "once, after hubsim_start"));
    int64_t written = 0;
    double remaining_s = 0.0;
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER,
                          hubsim_run(outside, 0.1, NULL, 0, &written, &remaining_s));
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_advance(outside, 1.0));
    for (int k = 0; k < BENCH_WHEELS_MAX; k++) {
        commands[k] = command_of(0.5, 0.5, 0.5);
    }
    commands[1].duty[2] = NAN;
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_VALUE, hubsim_external_step(outside, commands));
    TEST_ASSERT_NOT_NULL(strstr(hubsim_error(outside), "wheel 1"));
    commands[1] = command_of(0.5, 0.5, 0.5);
    commands[2].bridge = HUBSIM_BRIDGE_SHORT_HIGH + 1;
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_VALUE, hubsim_external_step(outside, commands));
    commands[2].bridge = HUBSIM_BRIDGE_SHORT_HIGH;
    commands[3].hydraulic_nm = -1.0;
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_VALUE, hubsim_external_step(outside, commands));
    commands[3].hydraulic_nm = 0.0;
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_external_step(outside, commands));
}
