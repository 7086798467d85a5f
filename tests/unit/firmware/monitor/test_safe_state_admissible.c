/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Short circuit and freewheel of motors whose currents are whole numbers, from where the diodes
 * conduct, and what makes either of the two admissible, on both sides of each condition.
 */
#include <math.h>

#include "paper_vehicle.h"
#include "safe_state_case.h"
#include "unity.h"

static config_t config;
static safe_state_case_t in;

void setUp(void)
{
    config = paper_vehicle();
    config.motor.pole_pairs = 1;
    config.battery.undervoltage_trip_mV = 500;
    config.drive.diode_drop_mV = 0;
    config.drive.voltage_full_scale_mV = 2000000;
    config.drive.device_voltage_mV = 2000000;
    config.motor.max_phase_current_mA = 3000000;
    config.battery.max_charge_current_mA = 2000000;
    const safe_state_case_t quiet = {
        .winding_temperature_cC = 2500, .charge_current_mA = 2000000, .before = BRIDGE_OFF};
    in = quiet;
    config.motor.reference_temperature_cC = 2500; /* the resistance is the configured one */
}

void tearDown(void) {}

static void set_inductances(int32_t d_nH, int32_t q_nH)
{
    config.motor.d_inductance_nH = d_nH;
    config.motor.q_inductance_nH = q_nH;
}

/* A magnitude of the EMF, mV, with a flux linkage of 1 Wb: as many electrical mrad/s. */
static void set_emf(int32_t emf_mV)
{
    config.motor.flux_linkage_nWb = 1000000000;
    in.bound_mrad_s = emf_mV;
}

/* ---- the machine ---- */

void test_the_direction_of_rotation_does_not_matter(void)
{
    in.bus_voltage_mV = 53000;
    for (int32_t mrad_s = 100000; mrad_s < 4000000; mrad_s += 300000) {
        in.bound_mrad_s = mrad_s;
        const safe_state_t forward = choice_of(&config, &in);
        const steady_state_t shorted = short_of(&config, &in);
        in.bound_mrad_s = -mrad_s;
        const safe_state_t back = choice_of(&config, &in);
        TEST_ASSERT_EQUAL_INT32(forward.emf_mV, back.emf_mV);
        TEST_ASSERT_EQUAL_INT32(forward.torque_mNm, back.torque_mNm);
        TEST_ASSERT_EQUAL_INT32(forward.freewheel.current_mA, back.freewheel.current_mA);
        TEST_ASSERT_EQUAL_INT32(shorted.current_mA, short_of(&config, &in).current_mA);
        TEST_ASSERT_EQUAL_INT32(shorted.torque_mNm, short_of(&config, &in).torque_mNm);
    }
}

/* R is 10 uOhm against w L of at least 400 Ohm: the ratio is zero in 24 fraction bits, and the
 * current is psi / L_d, rounded down; 4 294 967 nH is the last inductance below which 1000 times
 * any rest fits into 32 bits. */
void test_a_short_circuit_without_resistance_carries_flux_over_inductance_exactly(void)
{
    static const struct {
        int32_t flux_nWb, l_nH;
    } MOTORS[] = {{1999999999, 1000000000}, {999999999, 1000000000}, {987654321, 4294967},
                  {4294966, 4294967},       {8589935, 4294968},      {1999999999, 6000000},
                  {123456789, 12345678},    {12345677, 12345678},    {2000000000, 500000}};
    config.motor.phase_resistance_uOhm = 10;
    in.bound_mrad_s = INT32_MAX;
    for (unsigned k = 0; k < sizeof MOTORS / sizeof MOTORS[0]; k++) {
        set_inductances(MOTORS[k].l_nH, MOTORS[k].l_nH);
        config.motor.flux_linkage_nWb = MOTORS[k].flux_nWb;
        const int64_t expected_mA = (int64_t)MOTORS[k].flux_nWb * 1000 / MOTORS[k].l_nH;
        TEST_ASSERT_EQUAL_INT32(expected_mA, short_of(&config, &in).current_mA);
    }
}

/* The reactance of standstill counts as 1 uOhm: beside 10 uOhm 1/sqrt(1 + 10^2) of psi / L_d. */
void test_a_reactance_of_less_than_a_microohm_counts_as_one(void)
{
    set_inductances(1000000, 1000000);
    config.motor.flux_linkage_nWb = 1000000000;
    config.motor.phase_resistance_uOhm = 10;
    in.bound_mrad_s = 0;
    const double expected_mA = 1e6 / sqrt(101.0);
    TEST_ASSERT_DOUBLE_WITHIN(2e-4 * expected_mA, expected_mA, short_of(&config, &in).current_mA);
}

/* ---- rectified current ---- */

/* 1/sqrt(3) is 37837/65536 less 6.1e-6 of itself: the current of u = 0.9995, sqrt(1 - u^2), within
 * 7e-6 u^2/sqrt(1 - u^2). */
void test_the_rectified_current_follows_the_root_of_three(void)
{
    set_inductances(1000000, 1000000);
    config.motor.phase_resistance_uOhm = 10;
    set_emf(1000000);
    in.bus_voltage_mV = 1731185; /* 0.9995 sqrt(3) kV */
    const double expected_mA = 1e6 * sqrt(1.0 - 0.9995 * 0.9995);
    TEST_ASSERT_DOUBLE_WITHIN(1e6 * 7e-6 / 0.0316, expected_mA,
                              freewheel_of(&config, &in).current_mA);
}

/* ---- where diodes conduct ---- */

static bool conducts(void)
{
    return freewheel_of(&config, &in).current_mA > 0;
}

/* Onto an empty bus sqrt(3) 1.001 V is 1.7338 V, a millivolt above two diodes of 0.866 V. */
void test_a_bus_reading_below_zero_counts_as_an_empty_bus(void)
{
    config.drive.diode_drop_mV = 866;
    in.battery_gone = true;
    set_emf(1001);
    in.bus_voltage_mV = 0;
    TEST_ASSERT_EQUAL_INT32(1, freewheel_of(&config, &in).bus_mV);
    set_emf(1000);
    in.bus_voltage_mV = -5;
    TEST_ASSERT_EQUAL_INT32(-5, freewheel_of(&config, &in).bus_mV);
    in.bus_voltage_mV = -1000;
    TEST_ASSERT_EQUAL_INT32(-1000, freewheel_of(&config, &in).bus_mV);
}

/* 4095 of 4096 codes of 409.6 V: 409.5 V. */
void test_a_bus_reading_at_the_last_code_is_a_lower_bound(void)
{
    set_inductances(1000000, 1000000);
    config.drive.voltage_full_scale_mV = 409600;
    set_emf(400000);
    in.bus_voltage_mV = 409499;
    TEST_ASSERT_TRUE(conducts());
    in.bus_voltage_mV = 409500;
    TEST_ASSERT_FALSE(conducts());
}

/* ---- the choice ---- */

static bridge_mode_t chosen(void)
{
    return choice_of(&config, &in).bridge;
}

/* 1 mH, 0.1 Ohm at 1000 rad/s, just above the EMF limit: less torque on the diodes. */
static void conduct_a_little(void)
{
    set_inductances(1000000, 1000000);
    config.motor.phase_resistance_uOhm = 100000;
    set_emf(1000000);
    in.bus_voltage_mV = 1731880;
    TEST_ASSERT_LESS_THAN_INT32(short_of(&config, &in).torque_mNm,
                                freewheel_of(&config, &in).torque_mNm);
}

void test_a_charging_current_of_all_that_is_admissible_is_admissible(void)
{
    conduct_a_little();
    in.charge_current_mA = freewheel_of(&config, &in).charging_mA;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, chosen());
    in.charge_current_mA--;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, chosen());
}

/* Where nothing is admissible and the bus stays below the devices' rating, the bridge opens. */
void test_the_largest_phase_current_is_admissible_in_a_short_circuit(void)
{
    conduct_a_little();
    in.charge_current_mA = 0;
    config.motor.max_phase_current_mA = short_of(&config, &in).current_mA;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, chosen());
    config.motor.max_phase_current_mA--;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, chosen());
}

/* At half of the EMF the short circuit brakes less, but is chosen with an admissible current only.
 */
void test_a_short_circuit_of_less_torque_needs_an_admissible_current(void)
{
    conduct_a_little();
    in.bus_voltage_mV = 866025;
    const steady_state_t shorted = short_of(&config, &in);
    TEST_ASSERT_GREATER_THAN_INT32(shorted.torque_mNm, freewheel_of(&config, &in).torque_mNm);
    config.motor.max_phase_current_mA = shorted.current_mA;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, chosen());
    config.motor.max_phase_current_mA--;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, chosen());
}

/* 100 uWb and 1 mH: 100 mA, and a torque of less than a millinewtonmetre in either state. */
static void conduct_without_torque(int32_t q_nH)
{
    set_inductances(1000000, q_nH);
    config.motor.flux_linkage_nWb = 100000;
    in.bound_mrad_s = 100000000; /* 10 V, 17.3 V line to line */
    in.bus_voltage_mV = 10000;
    TEST_ASSERT_TRUE(conducts());
    TEST_ASSERT_EQUAL_INT32(0, freewheel_of(&config, &in).torque_mNm);
    TEST_ASSERT_EQUAL_INT32(0, short_of(&config, &in).torque_mNm);
}

/* With L_q = s L_d and s below 1/2 the rectified current first rises with the bus voltage:
 * y = sqrt(g + s^2)/(g + s), dy/dg = 1/(2 s^2) - 1/s at g = 0. */
void test_a_rectified_current_beyond_the_phase_s_is_not_admissible(void)
{
    conduct_without_torque(250000);
    const int32_t off_mA = freewheel_of(&config, &in).current_mA;
    TEST_ASSERT_LESS_THAN_INT32(off_mA, short_of(&config, &in).current_mA);
    config.motor.max_phase_current_mA = off_mA;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, chosen());
    config.motor.max_phase_current_mA--;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, chosen());
}

void test_a_bus_that_settles_at_the_devices_rating_selects_the_short_circuit(void)
{
    set_inductances(1000000, 1000000);
    set_emf(40000); /* 69.28 V */
    in.bus_voltage_mV = 53000;
    in.battery_gone = true;
    for (int admissible = 0; admissible < 2; admissible++) {
        config.motor.max_phase_current_mA = admissible != 0 ? 3000000 : 100;
        config.drive.device_voltage_mV = 69280;
        TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, chosen());
        config.drive.device_voltage_mV = 69281;
        TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, chosen());
    }
}

/* Opened where it conducts at 90 % of the bus voltage, with a current that no short circuit is
 * preferred to: its torque and current are those at the bus voltage itself. */
void test_a_short_circuit_that_ends_reports_the_freewheel_at_the_bus_voltage(void)
{
    conduct_a_little();
    config.monitor.short_release_permille = 900;
    config.motor.max_phase_current_mA = short_of(&config, &in).current_mA - 1;
    in.before = BRIDGE_SHORT;
    for (int32_t bus_mV = 1731880; bus_mV < 1740000; bus_mV += 8000) {
        in.bus_voltage_mV = bus_mV;
        const steady_state_t off = freewheel_of(&config, &in);
        const safe_state_t out = choice_of(&config, &in);
        TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, out.bridge);
        TEST_ASSERT_EQUAL_INT32(off.current_mA, out.freewheel.current_mA);
        TEST_ASSERT_EQUAL_INT32(bus_mV, out.freewheel.bus_mV);
        TEST_ASSERT_EQUAL_INT32(off.torque_mNm, out.torque_mNm);
    }
}

/* ---- the surge ---- */

/* Half of the current sensors' range is the trip. With the settled current, and so nothing that
 * circles, it counts alone. */
void test_a_settled_current_at_the_trip_is_no_surge_and_one_beyond_is(void)
{
    set_inductances(1000000, 1000000);
    config.motor.phase_resistance_uOhm = 100000;
    config.monitor.overcurrent_pu_q15 = 16384;
    set_emf(100000);
    const steady_state_t off = {.bus_mV = 53000};
    const int32_t settled_mA = short_of(&config, &in).current_mA;
    in.latest_i_d_mA = -settled_mA;
    config.drive.current_full_scale_mA = 2 * settled_mA;
    TEST_ASSERT_FALSE(short_surges(&config, &in, &off));
    config.drive.current_full_scale_mA = 2 * (settled_mA - 1);
    TEST_ASSERT_TRUE(short_surges(&config, &in, &off));
    config.drive.current_full_scale_mA = 2 * (settled_mA - 2);
    TEST_ASSERT_TRUE(short_surges(&config, &in, &off));
}
