/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The safe state at its limits: the smallest difference on both sides of each condition, and the
 * ends of the number formats. Motors are chosen so that the expected values are whole numbers.
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

/* 2 Wb at 2 147 483 rad/s is 4.3 MV, twice what 32 bits hold; diodes subtract 10 V of it. */
void test_an_emf_beyond_the_number_format_saturates(void)
{
    config.motor.flux_linkage_nWb = 2000000000;
    config.drive.diode_drop_mV = 5000;
    in.bound_mrad_s = INT32_MAX;
    in.battery_gone = true;
    const safe_state_t out = choice_of(&config, &in);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, out.emf_mV);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX - 10000, freewheel_of(&config, &in).bus_mV);
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

/* 1 H at 4 294 968 rad/s, 4295 Ohm: 704 uOhm more than 32 bits count. Beside it 1 Ohm is little. */
void test_a_reactance_beyond_the_number_format_leaves_the_resistance_small(void)
{
    set_inductances(1000000000, 1000000000);
    config.motor.flux_linkage_nWb = 1000000000;
    config.motor.phase_resistance_uOhm = 1000000;
    in.bound_mrad_s = 4294968;
    TEST_ASSERT_INT32_WITHIN(1, 1000, short_of(&config, &in).current_mA);
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

/* Diodes that conduct from 0.5 V at an EMF of 2 MV short the winding. */
void test_diodes_at_a_bus_far_below_the_emf_carry_flux_over_inductance_exactly(void)
{
    set_inductances(1000000, 1000000);
    config.motor.phase_resistance_uOhm = 10;
    set_emf(2000000000);
    in.bus_voltage_mV = 500;
    TEST_ASSERT_EQUAL_INT32(1000000, freewheel_of(&config, &in).current_mA);
}

/* With R = 11.29 w L and u = 1/2: (sqrt(rho^2 + 1 - u^2) - rho u)/(1 + rho^2). The square of rho is
 * within half of one of the format's end. */
void test_a_resistance_at_the_end_of_its_format_leaves_the_rectified_current(void)
{
    set_inductances(1000000, 1000000);
    config.motor.phase_resistance_uOhm = 11290000; /* w L is 1 Ohm */
    set_emf(1000000);
    in.bus_voltage_mV = 866025;
    const double rho = 11.29;
    const double y = (sqrt(rho * rho + 0.75) - 0.5 * rho) / (1.0 + rho * rho);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * y * 1e6, y * 1e6, freewheel_of(&config, &in).current_mA);
}

void test_a_resistance_beyond_its_format_never_makes_a_rectified_current_negative(void)
{
    set_inductances(1000000, 1000000);
    config.motor.phase_resistance_uOhm = 60000000;
    set_emf(1000000);
    in.bus_voltage_mV = 1500000;
    const steady_state_t off = freewheel_of(&config, &in);
    TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, off.current_mA);
    TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, off.torque_mNm);
}

/* Diodes as a resistance U/|i| without that of the windings; SI. */
static double salient_current(double sigma, double u)
{
    double low = 1e-9;
    double high = 2.0 / sigma + 2.0;
    for (int n = 0; n < 200; n++) {
        const double y = 0.5 * (low + high);
        const double r = u / y; /* over w L_d */
        const double d = sigma / (r * r + sigma);
        const double q = r / (r * r + sigma);
        *(hypot(d, q) > y ? &low : &high) = y;
    }
    return low;
}

/* L_q / L_d from 1/5 to 10, up to which their square is within its format. */
void test_the_rectified_current_of_a_salient_motor_without_resistance_is_that_of_the_circuit(void)
{
    static const int32_t Q_nH[] = {2000000, 5000000, 20000000, 34000000, 50000000, 100000000};
    config.motor.phase_resistance_uOhm = 10; /* w L_d is 10 000 Ohm */
    set_emf(1000000);
    for (unsigned k = 0; k < sizeof Q_nH / sizeof Q_nH[0]; k++) {
        set_inductances(10000000, Q_nH[k]);
        for (int32_t bus_mV = 90000; bus_mV < 1730000; bus_mV += 80000) {
            in.bus_voltage_mV = bus_mV;
            const double expected_mA =
                1e5 * salient_current(Q_nH[k] * 1e-7, bus_mV * 1e-6 / sqrt(3.0));
            TEST_ASSERT_DOUBLE_WITHIN(1e-3 * expected_mA, expected_mA,
                                      freewheel_of(&config, &in).current_mA);
        }
    }
}

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

/* sqrt(3) 1 V is 1.73205 V: a millivolt above 1.731 V, and not above 1.732 V. */
void test_diodes_conduct_from_a_millivolt_above_the_bus(void)
{
    set_inductances(1000000, 1000000);
    config.motor.phase_resistance_uOhm = 10;
    set_emf(1000);
    in.bus_voltage_mV = 1731;
    TEST_ASSERT_TRUE(conducts());
    in.bus_voltage_mV = 1732;
    TEST_ASSERT_FALSE(conducts());
    /* sqrt(3) kV within a part in 10 000 */
    set_emf(1000000);
    in.bus_voltage_mV = 1731880;
    TEST_ASSERT_TRUE(conducts());
    in.bus_voltage_mV = 1732220;
    TEST_ASSERT_FALSE(conducts());
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

void test_a_bus_below_its_trip_has_no_battery_that_takes_a_current(void)
{
    set_inductances(1000000, 1000000);
    config.battery.undervoltage_trip_mV = 36000;
    set_emf(60000);
    in.bus_voltage_mV = 36000;
    TEST_ASSERT_TRUE(conducts());
    in.bus_voltage_mV = 35999;
    TEST_ASSERT_FALSE(conducts());
}

/* L_q = L_d/10 000 with a resistance of 64 w L_d: the model without resistance gives a current of
 * many times psi / L_d, whose voltage drop is beyond its format. */
void test_a_voltage_drop_beyond_its_format_leaves_a_braking_torque(void)
{
    set_inductances(1000000, 1000);
    config.motor.phase_resistance_uOhm = 64000000;
    set_emf(1000000);
    for (int32_t bus_mV = 20000; bus_mV < 1730000; bus_mV += 20000) {
        in.bus_voltage_mV = bus_mV;
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, freewheel_of(&config, &in).torque_mNm);
    }
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

void test_of_two_states_with_equal_torque_the_bridge_opens(void)
{
    conduct_without_torque(1000000);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, chosen());
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

/* 1 H and 0.2 Wb: 200 mA, of which sqrt(1 - u^2) = 0.9 % flow: between 1 and 2 mA, and 1.5 * 60
 * pole pairs * 0.2 Wb are 18 N m/A. */
void test_a_rectified_current_of_a_milliampere_makes_its_torque(void)
{
    set_inductances(1000000000, 1000000000);
    config.motor.pole_pairs = 60;
    config.motor.flux_linkage_nWb = 200000000;
    in.bound_mrad_s = 83333; /* 1 kV */
    in.bus_voltage_mV = 1731980;
    config.motor.max_phase_current_mA = 100; /* no short circuit */
    const safe_state_t out = choice_of(&config, &in);
    TEST_ASSERT_EQUAL_INT32(1, out.freewheel.current_mA);
    TEST_ASSERT_INT32_WITHIN(9, 27, out.torque_mNm);
}

/* What does not fit into the bus keeps a short circuit, and begins none. */
void test_a_current_that_does_not_fit_into_the_bus_begins_no_short_circuit(void)
{
    conduct_a_little();
    in.latest_i_d_mA = -10000000;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, chosen());
    in.before = BRIDGE_SHORT;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, chosen());
}

/* Fifteen sixteenths of 1.066 V are 1 V, of which 1 F takes 0.5 J more on an empty bus and none at
 * 1 mV above (whole V^2); 1 A in 76 uH store 0.1 mJ. */
void test_a_short_circuit_ends_onto_a_bus_whose_reading_is_zero_or_below(void)
{
    static const int32_t BUS_mV[] = {0, -1, -5, -70000};
    config.drive.device_voltage_mV = 1066;
    config.drive.bus_capacitance_nF = 1000000000;
    set_inductances(76000, 76000);
    in.latest_i_d_mA = -1000;
    in.before = BRIDGE_SHORT;
    for (unsigned k = 0; k < sizeof BUS_mV / sizeof BUS_mV[0]; k++) {
        in.bus_voltage_mV = BUS_mV[k];
        TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, chosen());
    }
    in.bus_voltage_mV = 1;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, chosen());
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

/* sqrt(3) 100 V is 90 % of 192.45 V, and 90.09 % of 192.26 V. */
void test_a_short_circuit_ends_at_the_configured_permille_of_its_limit(void)
{
    conduct_a_little();
    config.monitor.short_release_permille = 900;
    set_emf(100000);
    in.charge_current_mA = 0;
    in.before = BRIDGE_SHORT;
    in.bus_voltage_mV = 192390;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, chosen());
    in.bus_voltage_mV = 192480;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, chosen());
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
