/* SPDX-License-Identifier: Apache-2.0 */
/* Current limits of the battery management and the timing of its message. */
#include "plant/bms.h"

#include <math.h>

#include "unity.h"

static battery_params_t pack;
static bms_params_t params;
static battery_state_t battery;

void setUp(void)
{
    const battery_params_t p = {.series_resistance_ohm = 0.012,
                                .polarisation_resistance_ohm = 0.010,
                                .polarisation_capacitance_f = 3000.0,
                                .capacity_ah = 100.0,
                                .initial_soc = 0.9,
                                .max_charge_current_a = 200.0,
                                .max_discharge_current_a = 250.0,
                                .open_circuit_voltage_v = curve_constant(53.0)};
    const bms_params_t b = {.fade_soc = 0.02};
    pack = p;
    params = b;
    battery = battery_init(&pack, 50e-6);
}

void tearDown(void) {}

static double charge_at(double soc)
{
    battery.soc = soc;
    return bms_limits(&params, &pack, &battery).charge_a;
}

static double discharge_at(double soc)
{
    battery.soc = soc;
    return bms_limits(&params, &pack, &battery).discharge_a;
}

void test_charge_and_discharge_limits_fall_to_zero_at_full_and_empty_pack(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(200.0, charge_at(0.9));
    TEST_ASSERT_EQUAL_DOUBLE(250.0, discharge_at(0.9));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 100.0, charge_at(0.99));
    TEST_ASSERT_EQUAL_DOUBLE(250.0, discharge_at(0.99));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, charge_at(1.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 125.0, discharge_at(0.01));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, discharge_at(0.0));
}

void test_without_derating_the_charge_limit_is_constant_up_to_full_charge(void)
{
    params.fade_soc = 0.0;
    TEST_ASSERT_EQUAL_DOUBLE(200.0, charge_at(0.9999));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, charge_at(1.0));
}

void test_the_charge_limit_keeps_the_settled_voltage_below_the_end_of_charge(void)
{
    params.max_voltage_v = 55.0;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 2.0 / 0.022, charge_at(0.9));
    /* After ten time constants of the RC branch at that current the terminal voltage is the end
     * voltage. */
    for (int k = 0; k < 10 * 30 * 20; k++) {
        battery.step_s = 2.5e-3;
        battery.decay = exp(-2.5e-3 / 30.0);
        battery.mean_decay = -expm1(-2.5e-3 / 30.0) / (2.5e-3 / 30.0);
        for (int n = 0; n < 20; n++) {
            const battery_source_t source = battery_source(&pack, &battery);
            battery_carry(&pack, &battery, &source, -2.0 / 0.022);
        }
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 55.0, battery.terminal_v);
    params.max_voltage_v = 52.0;
    TEST_ASSERT_EQUAL_DOUBLE(0.0, charge_at(0.9));
}

void test_the_discharge_limit_keeps_the_settled_voltage_above_the_end_of_discharge(void)
{
    params.min_voltage_v = 49.7;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 3.3 / 0.022, discharge_at(0.9));
}

void test_cold_cells_reduce_the_charge_limit_and_not_the_discharge_limit(void)
{
    params.coldest_charge_c = -5.0;
    params.full_charge_c = 15.0;
    params.temperature_c = -10.0;
    TEST_ASSERT_EQUAL_DOUBLE(0.0, charge_at(0.9));
    params.temperature_c = 5.0;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 100.0, charge_at(0.9));
    TEST_ASSERT_EQUAL_DOUBLE(250.0, discharge_at(0.9));
    params.temperature_c = 25.0;
    TEST_ASSERT_EQUAL_DOUBLE(200.0, charge_at(0.9));
}

void test_message_values_are_rounded_towards_zero_current(void)
{
    params.current_step_a = 7.0;
    TEST_ASSERT_EQUAL_DOUBLE(196.0, charge_at(0.9));
    TEST_ASSERT_EQUAL_DOUBLE(245.0, discharge_at(0.9));
}

void test_message_gives_the_contactor_state_of_its_sending_or_none(void)
{
    params.period_s = 0.1;
    bms_state_t state = {.next_s = 0.0};
    (void)bms_step(&params, &state, &pack, &battery, false, 0.0);
    TEST_ASSERT_EQUAL_INT(BMS_CLOSED, state.contactor);
    (void)bms_step(&params, &state, &pack, &battery, true, 0.099);
    TEST_ASSERT_EQUAL_INT(BMS_CLOSED, state.contactor);
    (void)bms_step(&params, &state, &pack, &battery, true, 0.100);
    TEST_ASSERT_EQUAL_INT(BMS_OPEN, state.contactor);
    params.contactor_silent = 1.0;
    (void)bms_step(&params, &state, &pack, &battery, true, 0.200);
    TEST_ASSERT_EQUAL_INT(BMS_NOT_REPORTED, state.contactor);
}

void test_limits_are_constant_between_messages(void)
{
    params.period_s = 0.1;
    bms_state_t state = {.next_s = 0.0};
    TEST_ASSERT_EQUAL_DOUBLE(200.0,
                             bms_step(&params, &state, &pack, &battery, false, 0.0).charge_a);
    battery.soc = 1.0;
    TEST_ASSERT_EQUAL_DOUBLE(200.0,
                             bms_step(&params, &state, &pack, &battery, false, 0.099).charge_a);
    TEST_ASSERT_EQUAL_DOUBLE(0.0,
                             bms_step(&params, &state, &pack, &battery, false, 0.100).charge_a);
    battery.soc = 0.5;
    TEST_ASSERT_EQUAL_DOUBLE(0.0,
                             bms_step(&params, &state, &pack, &battery, false, 0.199).charge_a);
    TEST_ASSERT_EQUAL_DOUBLE(200.0,
                             bms_step(&params, &state, &pack, &battery, false, 0.201).charge_a);
}

/* 40 A for two time constants, of which a filter has shown 1 - 1/e^2, then a gain and an offset. */
void test_measured_current_is_filtered_and_has_a_gain_error_and_an_offset(void)
{
    bms_state_t state = {.next_s = 0.0};
    bms_limits_t sent = {.current_a = 0.0};
    params.current_filter_s = 1.0;
    params.current_error = 0.25;
    params.current_offset_a = -5.0;
    battery.current_a = 40.0;
    for (int ms = 0; ms < 2000; ms++) {
        sent = bms_step(&params, &state, &pack, &battery, false, ms * 1e-3);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 50.0 * (1.0 - exp(-2.0)) - 5.0, sent.current_a);
}

void test_the_short_time_limit_is_sent_as_given_whatever_the_pack_takes_for_long(void)
{
    params.peak_charge_a = 150.25;
    params.current_step_a = 0.5;
    battery.soc = 1.0;
    TEST_ASSERT_EQUAL_DOUBLE(150.0, bms_limits(&params, &pack, &battery).peak_charge_a);
    params.peak_charge_a = 0.0;
    TEST_ASSERT_EQUAL_DOUBLE(0.0, bms_limits(&params, &pack, &battery).peak_charge_a);
}
