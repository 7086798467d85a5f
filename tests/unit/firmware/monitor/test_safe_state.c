/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Freewheel and active short circuit of the four shipped configurations against the circuit in
 * double precision, and the choice between them.
 */
#include <math.h>
#include <stdio.h>

#include "random_values.h"
#include "safe_state_case.h"
#include "unity.h"

extern const config_t CONFIG_LU2013, CONFIG_EBIKE36V, CONFIG_SCOOTER48V, CONFIG_IPM400V;
static const config_t *const CONFIGS[] = {&CONFIG_LU2013, &CONFIG_EBIKE36V, &CONFIG_SCOOTER48V,
                                          &CONFIG_IPM400V};
enum { CONFIGS_COUNT = 4, STATES = 3000 };

static config_t config;
static safe_state_case_t in;

void setUp(void)
{
    config = CONFIG_LU2013;
    const safe_state_case_t quiet = {.winding_temperature_cC = 2500,
                                     .bus_voltage_mV = 53000,
                                     .charge_current_mA = 50000,
                                     .before = BRIDGE_OFF};
    in = quiet;
}

void tearDown(void) {}

/* ---- the circuit, SI ---- */

typedef struct {
    double r, x_d, x_q, e, psi, l_d, l_q, p, i_most;
} circuit_t;

typedef struct {
    double d, q, length, torque_nm;
} flow_t;

/* Magnets in a cold motor are as cold; in a warm winding they may be as at the reference. */
static circuit_t circuit_of(const config_t *c, double speed_rad_s, double winding_c)
{
    const config_motor_t *m = &c->motor;
    const double w = speed_rad_s * m->pole_pairs;
    const double rise = winding_c - m->reference_temperature_cC * 1e-2;
    const double psi =
        m->flux_linkage_nWb * 1e-9 * (1.0 + m->flux_coefficient_ppm_K * 1e-6 * fmin(rise, 0.0));
    const circuit_t out = {
        .r =
            m->phase_resistance_uOhm * 1e-6 * (1.0 + m->resistance_coefficient_ppm_K * 1e-6 * rise),
        .x_d = w * m->d_inductance_nH * 1e-9,
        .x_q = w * m->q_inductance_nH * 1e-9,
        .e = w * psi,
        .psi = psi,
        .l_d = m->d_inductance_nH * 1e-9,
        .l_q = m->q_inductance_nH * 1e-9,
        .p = m->pole_pairs,
        .i_most = m->max_phase_current_mA * 1e-3,
    };
    return out;
}

/* r i_d - x_q i_q = 0, x_d i_d + r i_q = -e, with a resistance r in the phases. */
static flow_t with_resistance(const circuit_t *c, double r)
{
    const double determinant = r * r + c->x_d * c->x_q;
    flow_t out = {.d = -c->e * c->x_q / determinant, .q = -c->e * r / determinant};
    out.length = hypot(out.d, out.q);
    out.torque_nm = -1.5 * c->p * (c->psi + (c->l_d - c->l_q) * out.d) * out.q;
    return out;
}

/* Diodes: a voltage of constant length against the current is a resistance U/|i|. */
static flow_t on_diodes(const circuit_t *c, double bus_v, double drop_v)
{
    const double u = (bus_v + 2.0 * drop_v) / sqrt(3.0);
    flow_t out = {.length = 0.0};
    if (u >= c->e) {
        return out;
    }
    double low = 1e-9;
    double high = c->psi / c->l_d + 1.0;
    for (int n = 0; n < 200; n++) {
        const double i = 0.5 * (low + high);
        out = with_resistance(c, c->r + u / i);
        if (out.length > i) {
            low = i;
        } else {
            high = i;
        }
    }
    return out;
}

/* ---- the two states ---- */

static void take_random_state(random_t *random, const config_t *c)
{
    in.bound_mrad_s = random_between(random, 0, c->motor.max_speed_mrad_s / 10 * 11);
    in.bus_voltage_mV =
        random_between(random, c->battery.min_voltage_mV, c->battery.max_voltage_mV);
    in.winding_temperature_cC = random_between(random, -2000, 14000);
}

void test_short_circuit_of_every_configuration_is_that_of_the_circuit(void)
{
    random_t random = random_seeded(1);
    for (int k = 0; k < CONFIGS_COUNT * STATES; k++) {
        const config_t *c = CONFIGS[k % CONFIGS_COUNT];
        take_random_state(&random, c);
        in.bound_mrad_s /= random_chance(&random, 0.3) ? 100 : 1;
        const circuit_t circuit =
            circuit_of(c, in.bound_mrad_s * 1e-3, in.winding_temperature_cC * 1e-2);
        const flow_t expected = with_resistance(&circuit, circuit.r);
        const double stall_nm = 1.5 * circuit.p * circuit.psi * circuit.psi / circuit.l_d;
        const steady_state_t found = short_of(c, &in);
        TEST_ASSERT_DOUBLE_WITHIN(2e-3 * circuit.psi / circuit.l_d, expected.length,
                                  found.current_mA * 1e-3);
        TEST_ASSERT_DOUBLE_WITHIN(2e-3 * stall_nm, expected.torque_nm, found.torque_mNm * 1e-3);
        if (circuit.r > 10.5 * circuit.x_d && circuit.x_d > 1e-4) { /* it holds a vehicle */
            TEST_ASSERT_DOUBLE_WITHIN(0.02 * expected.torque_nm + 5e-3, expected.torque_nm,
                                      found.torque_mNm * 1e-3);
        }
        TEST_ASSERT_EQUAL_INT32(0, found.charging_mA);
    }
}

void test_freewheel_of_every_configuration_is_that_of_the_circuit(void)
{
    random_t random = random_seeded(2);
    int conducts = 0;
    for (int k = 0; k < CONFIGS_COUNT * STATES; k++) {
        const config_t *c = CONFIGS[k % CONFIGS_COUNT];
        take_random_state(&random, c);
        /* Also far above the range, so that every configuration conducts somewhere. */
        in.bound_mrad_s = in.bound_mrad_s / 2 * (1 + k % 5);
        const circuit_t circuit =
            circuit_of(c, in.bound_mrad_s * 1e-3, in.winding_temperature_cC * 1e-2);
        const flow_t expected =
            on_diodes(&circuit, in.bus_voltage_mV * 1e-3, c->drive.diode_drop_mV * 1e-3);
        const double infinite_a = circuit.psi / circuit.l_d;
        const double stall_nm = 1.5 * circuit.p * circuit.psi * infinite_a;
        /* With saliency the resistance is left out: rho is the error. */
        const bool salient = c->motor.d_inductance_nH != c->motor.q_inductance_nH;
        const double share = 4e-3 + (salient ? 1.2 * circuit.r / circuit.x_d : 0.0);
        const steady_state_t found = freewheel_of(c, &in);
        char text[160];
        snprintf(text, sizeof text, "%s %d mrad/s %d mV: %.2f A %.2f N m", c->name,
                 (int)in.bound_mrad_s, (int)in.bus_voltage_mV, expected.length, expected.torque_nm);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(share * infinite_a, expected.length,
                                          found.current_mA * 1e-3, text);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(share * stall_nm, expected.torque_nm,
                                          found.torque_mNm * 1e-3, text);
        TEST_ASSERT_DOUBLE_WITHIN(2.0, sqrt(0.75) * found.current_mA, found.charging_mA);
        conducts += found.current_mA > 0 ? 1 : 0;
    }
    TEST_ASSERT_TRUE(conducts > STATES);
}

/* Power balance: what brakes goes into bus, diodes and windings. */
void test_power_of_the_rectified_current_is_the_braking_power(void)
{
    in.bound_mrad_s = 73000;
    in.bus_voltage_mV = 50000;
    const steady_state_t found = freewheel_of(&config, &in);
    const double i = found.current_mA * 1e-3;
    const double heat_w = 1.5 * config.motor.phase_resistance_uOhm * 1e-6 * i * i;
    const double diodes_w = 2.0 * 0.8 * found.charging_mA * 1e-3;
    const double bus_w = 50.0 * found.charging_mA * 1e-3;
    TEST_ASSERT_DOUBLE_WITHIN(20.0, heat_w + diodes_w + bus_w, found.torque_mNm * 1e-3 * 73.0);
}

/* ---- the choice ---- */

static safe_state_t choose(void)
{
    return choice_of(&config, &in);
}

/* sqrt(3) 0.0204 Wb 23 w = 53 V + 1.6 V at w = 67.2 rad/s = 641.6 r/min. */
void test_below_the_emf_limit_the_bridge_is_open_and_makes_no_torque(void)
{
    for (int32_t mrad_s = 0; mrad_s < 67100; mrad_s += 500) {
        in.bound_mrad_s = mrad_s;
        const safe_state_t out = choose();
        TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, out.bridge);
        TEST_ASSERT_EQUAL_INT32(0, out.torque_mNm);
        TEST_ASSERT_EQUAL_INT32(0, out.freewheel.current_mA);
    }
    in.bound_mrad_s = 67500;
    TEST_ASSERT_TRUE(choose().freewheel.current_mA > 0);
}

void test_the_state_with_less_torque_is_chosen_among_those_admissible(void)
{
    random_t random = random_seeded(3);
    int chosen[3] = {0, 0, 0};
    for (int k = 0; k < CONFIGS_COUNT * STATES; k++) {
        config = *CONFIGS[k % CONFIGS_COUNT];
        take_random_state(&random, &config);
        in.bound_mrad_s = in.bound_mrad_s / 2 * (2 + k % 2);
        in.charge_current_mA = random_between(&random, 0, config.battery.max_charge_current_mA);
        in.before = BRIDGE_OFF;
        const steady_state_t off = freewheel_of(&config, &in);
        const steady_state_t shorted = short_of(&config, &in);
        const safe_state_t out = choose();
        const bool off_good = off.current_mA <= config.motor.max_phase_current_mA &&
                              off.charging_mA <= in.charge_current_mA &&
                              off.bus_mV < config.drive.device_voltage_mV;
        const bool short_good = shorted.current_mA <= config.motor.max_phase_current_mA;
        chosen[out.bridge]++;
        if (off_good && short_good) {
            TEST_ASSERT_EQUAL_INT(off.torque_mNm <= shorted.torque_mNm ? BRIDGE_OFF : BRIDGE_SHORT,
                                  out.bridge);
        } else if (off_good || short_good) {
            TEST_ASSERT_EQUAL_INT(off_good ? BRIDGE_OFF : BRIDGE_SHORT, out.bridge);
        } else { /* the bus stays below the devices' rating either way */
            TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, out.bridge);
        }
        TEST_ASSERT_EQUAL_INT32(out.bridge == BRIDGE_OFF ? off.torque_mNm : shorted.torque_mNm,
                                out.torque_mNm);
    }
    TEST_ASSERT_TRUE(chosen[BRIDGE_OFF] > STATES && chosen[BRIDGE_SHORT] > 100);
}

/* The bus of an opened contactor falls to the EMF: freewheel makes no torque there. */
void test_a_bus_collapsed_onto_the_emf_does_not_select_the_short_circuit(void)
{
    for (int k = 0; k < CONFIGS_COUNT; k++) {
        config = *CONFIGS[k];
        in.bound_mrad_s = config.motor.max_speed_mrad_s;
        in.charge_current_mA = 0;
        in.battery_gone = true;
        in.bus_voltage_mV = 1000;
        const safe_state_t out = choose();
        TEST_ASSERT_EQUAL_INT_MESSAGE(BRIDGE_OFF, out.bridge, config.name);
        TEST_ASSERT_EQUAL_INT32(0, out.torque_mNm);
    }
}

void test_a_reading_at_the_end_of_the_sensor_s_range_takes_no_current(void)
{
    config.drive.voltage_full_scale_mV = 50000;
    in.bound_mrad_s = 70000; /* 56.9 V */
    in.bus_voltage_mV = 49900;
    TEST_ASSERT_TRUE(choose().freewheel.current_mA > 0);
    in.bus_voltage_mV = 50000;
    TEST_ASSERT_EQUAL_INT32(0, choose().freewheel.current_mA);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, choose().bridge);
}

void test_an_emf_beyond_the_devices_selects_the_short_circuit(void)
{
    in.battery_gone = true;
    in.bound_mrad_s = 93000; /* 75.6 V, less two diodes 74.0 V */
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, choose().bridge);
    in.bound_mrad_s = 95000; /* 77.2 V, 75.6 V */
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, choose().bridge);
}

/* 2.25 L i^2/C at 53 V into 1 mF: 70.3 V, a sixteenth below 75 V, at 111 A. */
void test_a_short_circuit_ends_only_when_its_energy_fits_into_the_bus(void)
{
    config.drive.bus_capacitance_nF = 1000000;
    in.before = BRIDGE_SHORT;
    in.bound_mrad_s = 10000;
    config.drive.bus_capacitance_nF = 1000000;
    const double margin_v2 = 70.3125 * 70.3125 - 53.0 * 53.0;
    const int32_t limit_mA = (int32_t)(0.99e3 * sqrt(margin_v2 * 1e-3 / (2.25 * 76e-6)));
    in.latest_i_d_mA = -limit_mA / 5 * 3;
    in.latest_i_q_mA = -limit_mA / 5 * 4;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, choose().bridge);
    in.latest_i_d_mA -= limit_mA / 50;
    in.latest_i_q_mA -= limit_mA / 50;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, choose().bridge);
    config.drive.bus_capacitance_nF = 0; /* unknown */
    in.latest_i_d_mA = -1000;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, choose().bridge);
    in.latest_i_d_mA = 0;
    in.latest_i_q_mA = 0;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, choose().bridge);
}

void test_a_short_circuit_ends_at_the_configured_share_of_its_limit(void)
{
    config = CONFIG_IPM400V;
    in.bus_voltage_mV = 300000;
    in.charge_current_mA = 150000;
    config.monitor.short_release_permille = 900;
    /* sqrt(3) 66 mWb 3 w = 300 V + 2.4 V at w = 881.8 rad/s; of 270 V + 2.4 V at 794.3 rad/s */
    in.bound_mrad_s = 883000;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, choose().bridge);
    in.before = BRIDGE_SHORT;
    in.bound_mrad_s = 796000;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, choose().bridge);
    in.bound_mrad_s = 793000;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, choose().bridge);
    in.before = BRIDGE_OFF;
    in.bound_mrad_s = 880000;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, choose().bridge);
}

void test_any_input_gives_one_of_the_two_states(void)
{
    random_t random = random_seeded(4);
    for (int n = 0; n < 100000; n++) {
        config = *CONFIGS[n % CONFIGS_COUNT];
        in.bound_mrad_s = random_wild(&random);
        in.bus_voltage_mV = random_wild(&random);
        in.winding_temperature_cC = random_wild(&random);
        in.charge_current_mA = random_wild(&random);
        in.battery_gone = random_chance(&random, 0.2);
        in.latest_i_d_mA = random_wild(&random);
        in.latest_i_q_mA = random_wild(&random);
        in.turning_mrad_s = random_wild(&random);
        in.before = (bridge_mode_t)random_between(&random, 0, 2);
        const safe_state_t out = choose();
        TEST_ASSERT_NOT_EQUAL_INT(BRIDGE_PWM, out.bridge);
        TEST_ASSERT_TRUE(out.torque_mNm >= 0 && out.freewheel.current_mA >= 0);
    }
}

/* Down to L_q/L_d = 1e-7, two units of its number format. */
void test_states_of_any_accepted_motor_are_bounded(void)
{
    random_t random = random_seeded(7);
    config = CONFIG_IPM400V;
    for (int n = 0; n < STATES; n++) {
        const bool extreme = random_chance(&random, 0.1);
        const double most = extreme ? 9.0 : random_real(&random, 2.0, 9.0);
        const double least = extreme ? 2.0 : random_real(&random, 2.0, 9.0);
        config.motor.d_inductance_nH = (int32_t)pow(10.0, most);
        config.motor.q_inductance_nH = (int32_t)pow(10.0, least);
        config.motor.flux_linkage_nWb = (int32_t)pow(10.0, random_real(&random, 3.0, 9.3));
        config.motor.pole_pairs = random_between(&random, 1, 60);
        config.drive.diode_drop_mV = random_between(&random, 0, 2) * 500;
        in.winding_temperature_cC = random_between(&random, -10000, 50000);
        in.bound_mrad_s = random_wild(&random);
        in.bus_voltage_mV = random_chance(&random, 0.2) ? 0 : random_between(&random, 1, 450000);
        in.latest_i_d_mA = random_wild(&random);
        in.latest_i_q_mA = random_wild(&random);
        in.turning_mrad_s = random_wild(&random);
        in.before = random_chance(&random, 0.5) ? BRIDGE_SHORT : BRIDGE_OFF;
        const safe_state_t chosen = choice_of(&config, &in);
        TEST_ASSERT_TRUE(chosen.bridge == BRIDGE_SHORT || chosen.bridge == BRIDGE_OFF);
        const steady_state_t states[] = {short_of(&config, &in), freewheel_of(&config, &in)};
        for (int k = 0; k < 2; k++) {
            TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, states[k].torque_mNm);
            TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, states[k].current_mA);
            TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, states[k].charging_mA);
        }
    }
}
