/* SPDX-License-Identifier: Apache-2.0 */
/* The library's interface: order of calls, names, ranges, error messages, rows. */
#include "bench/engine.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench/external.h"
#include "plant_values.h"
#include "unity.h"
#include "vehicle_fixture.h"

static hubsim_t *sim;
static config_t config;

void setUp(void)
{
    sim = hubsim_new();
    TEST_ASSERT_NOT_NULL(sim);
    config = fixture_config(CONFIG_STRATEGY_SERIES_OPTIMAL);
}

void tearDown(void)
{
    hubsim_delete(sim);
}

static void set(const char *name, double value)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(HUBSIM_OK, hubsim_set(sim, name, value), hubsim_error(sim));
}

static void load_vehicle(void)
{
    for (int k = 0; k < PLANT_DRIVES[0].count; k++) {
        set(PLANT_DRIVES[0].values[k].name, PLANT_DRIVES[0].values[k].value);
    }
    set("road.gravity_m_per_s2", 9.81);
    set("driver.bandwidth_rad_per_s", 1.0);
    set("driver.preview_s", 0.4);
    set("driver.enable", 1.0);
    set("driver.direction", 1.0);
    set("run.record_interval_s", 0.01);
    set("run.initial_speed_m_per_s", 3.0);
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_set_voltage_curve(sim, PLANT_DRIVES[0].soc,
                                                              PLANT_DRIVES[0].voltage_v,
                                                              PLANT_DRIVES[0].voltage_points));
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_load_config(sim, &config, sizeof(config)));
}

void test_signals_of_a_running_vehicle_are_read_by_name(void)
{
    load_vehicle();
    set("driver.brake_demand_nm", 20.0);
    TEST_ASSERT_EQUAL_INT_MESSAGE(HUBSIM_OK, hubsim_start(sim), hubsim_error(sim));
    const int chosen[] = {0};
    double rows[20];
    int64_t written = 0;
    double remaining_s = 0.0;
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_choose(sim, chosen, 1));
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_run(sim, 0.1, rows, 20, &written, &remaining_s));
    TEST_ASSERT_EQUAL_INT64(11, written);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.1, rows[10]);
    double speed = 0.0;
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_value(sim, "vehicle.speed_m_per_s", &speed));
    TEST_ASSERT_TRUE(speed > 2.5 && speed < 3.0);
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_NAME, hubsim_value(sim, "vehicle.colour", &speed));
}

/* A vehicle of these parameters with rear drives of the same ones, which differ where the argument
 * is not 1. */
static hubsim_t *with_rear(double resistance_factor)
{
    load_vehicle();
    set("driver.brake_demand_nm", 20.0);
    hubsim_t *front = sim;
    sim = hubsim_new();
    load_vehicle();
    double ohm = 0.0;
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_get(sim, "motor.phase_resistance_ohm", &ohm));
    set("motor.phase_resistance_ohm", resistance_factor * ohm);
    hubsim_t *rear = sim;
    sim = front;
    TEST_ASSERT_EQUAL_INT_MESSAGE(HUBSIM_OK, hubsim_set_rear(sim, rear), hubsim_error(sim));
    return rear;
}

static double value_of(const char *name)
{
    double out = NAN;
    TEST_ASSERT_EQUAL_INT_MESSAGE(HUBSIM_OK, hubsim_value(sim, name, &out), name);
    return out;
}

static void braked(double *speed_m_per_s, double *copper0_j, double *copper2_j)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(HUBSIM_OK, hubsim_start(sim), hubsim_error(sim));
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_advance(sim, 0.2));
    *speed_m_per_s = value_of("vehicle.speed_m_per_s");
    *copper0_j = value_of("wheel0.copper_w");
    *copper2_j = value_of("wheel2.copper_w");
}

void test_rear_drives_that_equal_those_in_front_change_nothing(void)
{
    double speed[2];
    double copper0_j[2];
    double copper2_j[2];
    load_vehicle();
    set("driver.brake_demand_nm", 20.0);
    braked(&speed[0], &copper0_j[0], &copper2_j[0]);
    hubsim_delete(sim);
    sim = hubsim_new();
    (void)with_rear(1.0);
    braked(&speed[1], &copper0_j[1], &copper2_j[1]);
    TEST_ASSERT_EQUAL_DOUBLE(speed[0], speed[1]);
    TEST_ASSERT_EQUAL_DOUBLE(copper0_j[0], copper0_j[1]);
    TEST_ASSERT_EQUAL_DOUBLE(copper2_j[0], copper2_j[1]);
}

/* The controllers hold the same currents in both axles. */
void test_rear_windings_of_twice_the_resistance_lose_twice_the_heat(void)
{
    double speed = 0.0;
    double copper0_j = 0.0;
    double copper2_j = 0.0;
    (void)with_rear(2.0);
    braked(&speed, &copper0_j, &copper2_j);
    TEST_ASSERT_TRUE(copper0_j > 1.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * copper2_j, 2.0 * copper0_j, copper2_j);
}

/* The mean of the wheels is the demand. */
void test_a_bias_moves_torque_to_the_front_wheels(void)
{
    load_vehicle();
    set("driver.brake_demand_nm", 20.0);
    set("driver.front_bias", 0.25);
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_start(sim));
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_advance(sim, 0.3));
    TEST_ASSERT_DOUBLE_WITHIN(0.05, -25.0, value_of("wheel1.estimate_nm"));
    TEST_ASSERT_DOUBLE_WITHIN(0.05, -15.0, value_of("wheel3.estimate_nm"));
}

void test_rear_drives_are_refused_out_of_order(void)
{
    hubsim_t *rear = with_rear(1.0);
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_set_rear(sim, rear));
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_start(sim));
    hubsim_t *late = hubsim_new();
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_set_rear(sim, late));
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_set_rear(late, late));
    hubsim_delete(late);
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_set(sim, "fault.config_bit", 1.0));
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_external_take(sim, 0));
}

static void refused_rear(const char *name, double value, const char *why)
{
    hubsim_t *rear = with_rear(1.0);
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_set(rear, name, value));
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_start(sim));
    TEST_ASSERT_NOT_NULL(strstr(hubsim_error(sim), why));
    hubsim_delete(sim);
    sim = hubsim_new();
}

void test_rear_drives_need_the_period_of_those_in_front_and_two_axles(void)
{
    refused_rear("inverter.pwm_frequency_hz", 10000.0, "the same inverter.pwm_frequency_hz");
    refused_rear("inverter.switching", 1.0, "the same inverter.switching");
    (void)with_rear(1.0);
    set("chassis.rear_driven", 1.0);
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_start(sim));
    TEST_ASSERT_NOT_NULL(strstr(hubsim_error(sim), "chassis.rear_driven"));
    set("chassis.rear_driven", 0.0);
    set("vehicle.driven_wheels", 2.0);
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_start(sim));
    TEST_ASSERT_NOT_NULL(strstr(hubsim_error(sim), "vehicle.driven_wheels"));
}

void test_a_parameter_set_during_the_run_is_that_of_both_axles(void)
{
    (void)with_rear(2.0);
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_start(sim));
    set("thermal.winding_temperature_c", 90.0);
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_advance(sim, 0.01));
    TEST_ASSERT_EQUAL_DOUBLE(90.0, value_of("wheel0.winding_temperature_c"));
    TEST_ASSERT_EQUAL_DOUBLE(90.0, value_of("wheel3.winding_temperature_c"));
}

/* 20 N m at 3 m/s move no thousandth of the pack's charge in 0.1 s. */
void test_a_state_of_charge_set_during_a_run_holds_from_then_on(void)
{
    load_vehicle();
    set("battery.initial_soc", 0.5);
    set("driver.brake_demand_nm", 20.0);
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_start(sim));
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_advance(sim, 0.1));
    double soc = 0.0;
    set("battery.initial_soc", 0.9);
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_value(sim, "battery.soc", &soc));
    TEST_ASSERT_EQUAL_DOUBLE(0.9, soc);
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_advance(sim, 0.2));
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_value(sim, "battery.soc", &soc));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.9, soc);
    set("battery.initial_soc", 0.9);
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_value(sim, "battery.soc", &soc));
    TEST_ASSERT_EQUAL_DOUBLE(0.9, soc);
}

void test_a_full_buffer_pauses_the_run_and_reading_it_resumes_the_run(void)
{
    load_vehicle();
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_start(sim));
    const int chosen[] = {0};
    double rows[4];
    int64_t written = 0;
    double remaining_s = 0.0;
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_choose(sim, chosen, 1));
    TEST_ASSERT_EQUAL_INT(HUBSIM_FULL, hubsim_run(sim, 0.1, rows, 4, &written, &remaining_s));
    TEST_ASSERT_EQUAL_INT64(4, written);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.06, remaining_s);
    TEST_ASSERT_EQUAL_INT(HUBSIM_FULL,
                          hubsim_run(sim, remaining_s, rows, 4, &written, &remaining_s));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.04, rows[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.07, rows[3]);
}

void test_run_that_ends_at_standstill_reports_it(void)
{
    load_vehicle();
    set("run.stop_at_standstill", 1.0);
    set("driver.brake_demand_nm", 60.0);
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_start(sim));
    int64_t written = 0;
    double remaining_s = 1.0;
    TEST_ASSERT_EQUAL_INT(HUBSIM_ENDED, hubsim_run(sim, 100.0, NULL, 0, &written, &remaining_s));
    double time_s = 0.0;
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_value(sim, "time_s", &time_s));
    TEST_ASSERT_TRUE(time_s > 1.0 && time_s < 5.0);
}

enum { CHOSEN = 40, ROWS = 30 };

static void start_braking(void)
{
    load_vehicle();
    set("driver.brake_demand_nm", 20.0);
    TEST_ASSERT_EQUAL_INT_MESSAGE(HUBSIM_OK, hubsim_start(sim), hubsim_error(sim));
    int chosen[CHOSEN];
    for (int k = 0; k < CHOSEN; k++) {
        chosen[k] = k;
    }
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_choose(sim, chosen, CHOSEN));
}

void test_recorded_rows_are_independent_of_the_step_length(void)
{
    static double run[ROWS][CHOSEN];
    static double sampled[ROWS][CHOSEN];
    start_braking();
    int64_t written = 0;
    double remaining_s = 0.0;
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_run(sim, 0.29, run[0], ROWS, &written, &remaining_s));
    TEST_ASSERT_EQUAL_INT64(ROWS, written);
    hubsim_delete(sim);
    sim = hubsim_new();
    start_braking();
    for (int k = 0; k < ROWS; k++) {
        TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_advance(sim, 0.01 * k));
        TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_sample(sim, sampled[k]));
    }
    TEST_ASSERT_EQUAL_INT(0, memcmp(run, sampled, sizeof(run)));
}

void test_a_restored_vehicle_continues_from_the_saved_state_also_in_another_handle(void)
{
    double first[CHOSEN];
    double again[CHOSEN];
    double elsewhere[CHOSEN];
    start_braking();
    void *state = malloc(hubsim_state_bytes());
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_advance(sim, 0.1));
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_save(sim, state));
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_advance(sim, 0.25));
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_sample(sim, first));
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_restore(sim, state));
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_advance(sim, 0.25));
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_sample(sim, again));
    hubsim_delete(sim);
    sim = hubsim_new();
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_restore(sim, state));
    start_braking();
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_restore(sim, state));
    free(state);
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_advance(sim, 0.25));
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_sample(sim, elsewhere));
    TEST_ASSERT_EQUAL_INT(0, memcmp(first, again, sizeof(first)));
    TEST_ASSERT_EQUAL_INT(0, memcmp(first, elsewhere, sizeof(first)));
}

static void give_map(void)
{
    double parabola[16]; /* 500 x^2, a quarter of 1/(2 L): c = 500 (x^2 - h^2/3) */
    for (int k = 0; k < 16; k++) {
        const double steps = k / 4 - 1.5;
        parabola[k] = 500.0 * (steps * steps - 1.0 / 3.0) * 0.04;
    }
    const hubsim_energy_map_t map = {.d_first_wb = -0.1,
                                     .d_step_wb = 0.2,
                                     .q_first_wb = -0.1,
                                     .q_step_wb = 0.2,
                                     .d_cells = 1,
                                     .q_cells = 1,
                                     .coefficient_j = parabola};
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_set_energy_map(sim, &map));
}

void test_an_energy_map_belongs_to_its_handle_also_after_a_restored_state(void)
{
    double first[CHOSEN];
    double elsewhere[CHOSEN];
    give_map();
    start_braking();
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_set_energy_map(sim, NULL));
    void *state = malloc(hubsim_state_bytes());
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_advance(sim, 0.1));
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_save(sim, state));
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_advance(sim, 0.25));
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_sample(sim, first));
    hubsim_delete(sim);
    sim = hubsim_new();
    give_map();
    start_braking();
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_restore(sim, state));
    free(state);
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_advance(sim, 0.25));
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_sample(sim, elsewhere));
    TEST_ASSERT_EQUAL_INT(0, memcmp(first, elsewhere, sizeof(first)));
}

void test_calls_out_of_order_are_refused_with_a_message(void)
{
    int64_t written = 0;
    double remaining_s = 0.0;
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_run(sim, 1.0, NULL, 0, &written, &remaining_s));
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_start(sim));
    TEST_ASSERT_EQUAL_STRING("no configuration was loaded", hubsim_error(sim));
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_load_config(sim, &config, sizeof(config)));
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_start(sim));
    TEST_ASSERT_NOT_NULL(strstr(hubsim_error(sim), "motor.pole_pairs: never set"));
    TEST_ASSERT_EQUAL_INT(0, hubsim_signal_count(sim));
}

void test_invalid_names_and_values_are_refused_with_the_accepted_ones(void)
{
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_NAME, hubsim_set(sim, "motor.colour", 1.0));
    TEST_ASSERT_EQUAL_STRING("motor.colour: no such parameter", hubsim_error(sim));
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_VALUE, hubsim_set(sim, "road.slope", 3.0));
    TEST_ASSERT_EQUAL_STRING("road.slope: 3 1, accepted: -1 to 1", hubsim_error(sim));
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_VALUE, hubsim_set(sim, "road.slope", NAN));
    const double falling[] = {1.0, 0.5};
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_VALUE, hubsim_set_trace(sim, falling, falling, 2));
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_VALUE, hubsim_set_voltage_curve(sim, falling, falling, 2));
    const double zeros[16] = {0.0};
    hubsim_energy_map_t map = {
        .d_step_wb = 1e-3, .q_step_wb = 1e-3, .d_cells = 1, .q_cells = 0, .coefficient_j = zeros};
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_VALUE, hubsim_set_energy_map(sim, &map));
    map.q_cells = 1;
    map.d_step_wb = -1e-3;
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_VALUE, hubsim_set_energy_map(sim, &map));
}

void test_a_refused_configuration_is_reported_with_the_field(void)
{
    config.motor.pole_pairs = 0;
    config.crc32 = 0;
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_CONFIG, hubsim_load_config(sim, &config, sizeof(config)));
    TEST_ASSERT_NOT_NULL(strstr(hubsim_error(sim), "crc32"));
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_CONFIG, hubsim_load_config(sim, &config, 100));
    TEST_ASSERT_NOT_NULL(strstr(hubsim_error(sim), "size_bytes"));
}

void test_collapse_of_the_pack_voltage_ends_the_run_with_a_message(void)
{
    load_vehicle();
    set("driver.drive_demand_nm", 30.0);
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_start(sim));
    int64_t written = 0;
    double remaining_s = 0.0;
    TEST_ASSERT_EQUAL_INT(
        HUBSIM_OK, hubsim_run(sim, 0.5, NULL, 0, &written, &remaining_s)); /* well over 1 kW */
    set("battery.series_resistance_ohm", 10.0);                            /* 70 W at most */
    TEST_ASSERT_EQUAL_INT(HUBSIM_FAILED, hubsim_run(sim, 1.0, NULL, 0, &written, &remaining_s));
    TEST_ASSERT_NOT_NULL(strstr(hubsim_error(sim), "the battery cannot give the power"));
}

void test_a_contactor_is_not_opened_without_a_capacitor_or_before_the_run(void)
{
    load_vehicle();
    set("bus.contactor_open", 1.0);
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_start(sim));
    set("bus.contactor_open", 0.0);
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_start(sim));
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_set(sim, "bus.contactor_open", 1.0));
    TEST_ASSERT_NOT_NULL(strstr(hubsim_error(sim), "accepted: 0 as long as"));
    double value = 1.0;
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_get(sim, "bus.contactor_open", &value));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, value);
}

void test_switching_bridge_and_partial_periods_exclude_each_other_before_and_during_a_run(void)
{
    load_vehicle();
    set("inverter.switching", 1.0);
    set("run.pieces", 2.0);
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_start(sim));
    TEST_ASSERT_EQUAL_STRING("run.pieces: accepted: 0 or 1 while inverter.switching is 1",
                             hubsim_error(sim));
    set("inverter.switching", 0.0);
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_start(sim));
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_set(sim, "inverter.switching", 1.0));
    TEST_ASSERT_EQUAL_STRING("inverter.switching: accepted: 0 as long as run.pieces is more than 1",
                             hubsim_error(sim));
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_set(sim, "run.pieces", 1.0));
    double value = 1.0;
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_get(sim, "inverter.switching", &value));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, value);
}

void test_impossible_effects_are_refused_with_a_message_before_and_during_a_run(void)
{
    static const struct {
        const char *name;
        double value;
        const char *words;
    } BAD[] = {
        {"sensors.sampling_delay_s", 30e-6,
         "sensors.sampling_delay_s: accepted: less than half a period"},
        {"motor.magnet_bias_current_a", 90.0,
         "motor.magnet_bias_current_a: accepted: less than 0.28"},
        {"motor.cogging_per_turn", 2.5, "motor.cogging_per_turn: accepted: a whole number from 1"},
        {"anti_lock.slip_dump", 0.01, "anti_lock.slip_dump: accepted: from anti_lock.slip_hold"}};
    load_vehicle();
    set("motor.d_saturation_current_a", 100.0);
    set("motor.cogging_torque_nm", 0.5);
    set("motor.cogging_per_turn", 276.0);
    set("anti_lock.active", 1.0);
    for (int k = 0; k < 4; k++) {
        double good = 0.0;
        TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_get(sim, BAD[k].name, &good));
        set(BAD[k].name, BAD[k].value);
        TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_start(sim));
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(hubsim_error(sim), BAD[k].words), hubsim_error(sim));
        set(BAD[k].name, good);
    }
    TEST_ASSERT_EQUAL_INT(HUBSIM_OK, hubsim_start(sim));
    for (int k = 0; k < 4; k++) {
        TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_ORDER, hubsim_set(sim, BAD[k].name, BAD[k].value));
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(hubsim_error(sim), BAD[k].words), hubsim_error(sim));
    }
    TEST_ASSERT_EQUAL_INT(HUBSIM_BAD_VALUE, hubsim_set(sim, "motor.cross_saturation", 1.5));
    TEST_ASSERT_EQUAL_STRING("motor.cross_saturation: 1.5 1, accepted: 0 to 1", hubsim_error(sim));
}
