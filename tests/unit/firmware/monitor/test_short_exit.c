/* SPDX-License-Identifier: Apache-2.0 */
/* The energy of a short circuit's current at the instant at which the bridge opens, against the
 * equations of the machine in double precision. */
#include "monitor/short_exit.h"

#include <math.h>
#include <stdio.h>

#include "random_values.h"
#include "unity.h"

extern const config_t CONFIG_LU2013, CONFIG_EBIKE36V, CONFIG_SCOOTER48V, CONFIG_IPM400V;
static const config_t *const CONFIGS[] = {&CONFIG_LU2013, &CONFIG_EBIKE36V, &CONFIG_SCOOTER48V,
                                          &CONFIG_IPM400V};
enum { CONFIGS_COUNT = 4, STATES = 2000 };

typedef struct {
    double r, l_d, l_q, psi;
} circuit_t;

void setUp(void) {}

void tearDown(void) {}

/* 3/4 (L_d i_d^2 + L_q i_q^2) of a shorted machine, in J, at its largest within the next 500 us:
 * the equations of the machine in steps of 5 us. */
static double largest_energy(const circuit_t *c, double i_d, double i_q, double w)
{
    double largest = 0.0;
    const double dt = 5e-6;
    for (int n = 0; n <= 100; n++) {
        largest = fmax(largest, 0.75 * (c->l_d * i_d * i_d + c->l_q * i_q * i_q));
        const double d_mid = i_d + 0.5 * dt * (w * c->l_q * i_q - c->r * i_d) / c->l_d;
        const double q_mid = i_q - 0.5 * dt * (w * (c->l_d * i_d + c->psi) + c->r * i_q) / c->l_q;
        i_d += dt * (w * c->l_q * q_mid - c->r * d_mid) / c->l_d;
        i_q -= dt * (w * (c->l_d * d_mid + c->psi) + c->r * q_mid) / c->l_q;
    }
    return largest;
}

/* The current circles, and the bridge opens up to half a millisecond later, so what counts is the
 * largest energy until then, half as much again for the EMF. Both directions of rotation; a
 * capacitor around the one that suffices; resistance, which the rule leaves out, takes some of it.
 */
void test_a_short_circuit_that_circles_ends_where_its_energy_fits_until_the_bridge_opens(void)
{
    random_t random = random_seeded(5);
    int ended[2] = {0, 0};
    for (int k = 0; k < CONFIGS_COUNT * STATES; k++) {
        config_t config = *CONFIGS[k % CONFIGS_COUNT];
        const bool back = random_chance(&random, 0.5);
        const int32_t speed_mrad_s = random_between(&random, 1000, config.motor.max_speed_mrad_s);
        const circuit_t circuit = {
            .r = config.motor.phase_resistance_uOhm * 1e-6,
            .l_d = config.motor.d_inductance_nH * 1e-9,
            .l_q = config.motor.q_inductance_nH * 1e-9,
            .psi = config.motor.flux_linkage_nWb * 1e-9,
        };
        circuit_t lossless = circuit;
        lossless.r = 0.0;
        const double infinite_a = circuit.psi / circuit.l_d;
        const double i_d = random_real(&random, -2.0, 0.5) * infinite_a;
        const double i_q = random_real(&random, -1.0, 1.0) * infinite_a;
        const short_exit_input_t in = {
            .i_d_mA = (int32_t)lround(1e3 * i_d),
            .i_q_mA = (int32_t)lround(1e3 * i_q),
            .turning_mrad_s = back ? -speed_mrad_s : speed_mrad_s,
            .bus_mV = config.battery.max_voltage_mV,
        };
        const double w = in.turning_mrad_s * 1e-3 * config.motor.pole_pairs;
        const double energy_j = 1.5 * largest_energy(&circuit, i_d, i_q, w);
        const double without_r_j = 1.5 * largest_energy(&lossless, i_d, i_q, w);
        const double most_v = config.drive.device_voltage_mV * 1e-3 * 15.0 / 16.0;
        const double bus_v = in.bus_mV * 1e-3;
        const double takes_j = energy_j * random_real(&random, 0.5, 2.0);
        if (takes_j > 0.97 * energy_j && takes_j < 1.03 * without_r_j) {
            continue;
        }
        config.drive.bus_capacitance_nF =
            (int32_t)(2e9 * takes_j / (most_v * most_v - bus_v * bus_v));
        const double share = takes_j / energy_j;
        const bool expected = share > 1.0;
        char text[120];
        snprintf(text, sizeof text, "%s %d mrad/s %d mA %d mA share %.2f", config.name,
                 (int)in.turning_mrad_s, (int)in.i_d_mA, (int)in.i_q_mA, share);
        TEST_ASSERT_TRUE_MESSAGE(short_exit_fits(&config, &in) == expected, text);
        ended[expected ? 1 : 0]++;
    }
    TEST_ASSERT_TRUE(ended[0] > STATES && ended[1] > STATES);
}

/* 2.25 L i^2/C at 53 V into 1 mF: 70.3 V, a sixteenth below 75 V, at 111 A in any direction. */
void test_in_an_unknown_frame_the_present_current_counts(void)
{
    config_t config = CONFIG_LU2013;
    config.drive.bus_capacitance_nF = 1000000;
    const double margin_v2 = 70.3125 * 70.3125 - 53.0 * 53.0;
    const double limit_mA = 1e3 * sqrt(margin_v2 * 1e-3 / (2.25 * 76e-6));
    for (int k = 0; k < 24; k++) {
        for (int beyond = 0; beyond < 2; beyond++) {
            const double i_mA = limit_mA * (beyond != 0 ? 1.01 : 0.99);
            const short_exit_input_t in = {.i_d_mA = (int32_t)(i_mA * cos(k * 0.2618)),
                                           .i_q_mA = (int32_t)(i_mA * sin(k * 0.2618)),
                                           .bus_mV = 53000};
            TEST_ASSERT_TRUE(short_exit_fits(&config, &in) == (beyond == 0));
        }
    }
}

/* The integral of i dpsi is between 1/2 L i^2 and, of iron that saturates in the magnets' flux,
 * twice that: the same current takes twice the capacitor. */
void test_iron_that_saturates_counts_with_twice_the_energy(void)
{
    config_t config = CONFIG_LU2013;
    config.flux_map.d_points = 3;
    const double margin_v2 = 70.3125 * 70.3125 - 53.0 * 53.0;
    const short_exit_input_t in = {.i_d_mA = -80000, .i_q_mA = -60000, .bus_mV = 53000};
    const double needed_nF = 2e9 * 2.25 * 76e-6 * 100.0 * 100.0 / margin_v2;
    config.drive.bus_capacitance_nF = (int32_t)(1.03 * needed_nF);
    TEST_ASSERT_TRUE(short_exit_fits(&config, &in));
    config.drive.bus_capacitance_nF = (int32_t)(0.97 * needed_nF);
    TEST_ASSERT_FALSE(short_exit_fits(&config, &in));
    config.flux_map.d_points = 0;
    config.drive.bus_capacitance_nF = (int32_t)(0.53 * needed_nF);
    TEST_ASSERT_TRUE(short_exit_fits(&config, &in));
}

/* A bus at or beyond fifteen sixteenths of the rating takes nothing but no current. */
void test_a_full_bus_takes_no_current_and_no_input_overflows(void)
{
    random_t random = random_seeded(6);
    for (int n = 0; n < 20000; n++) {
        config_t config = *CONFIGS[n % CONFIGS_COUNT];
        config.motor.d_inductance_nH = random_between(&random, 100, 1000000000);
        config.motor.q_inductance_nH = random_between(&random, 100, 1000000000);
        config.motor.flux_linkage_nWb = random_between(&random, 1000, 2000000000);
        config.drive.device_voltage_mV = random_between(&random, 1000, 2000000);
        config.drive.bus_capacitance_nF = random_between(&random, 0, 1000000000);
        const short_exit_input_t in = {
            .i_d_mA = random_wild(&random),
            .i_q_mA = random_wild(&random),
            .turning_mrad_s = random_wild(&random),
            .bus_mV = config.drive.device_voltage_mV,
        };
        TEST_ASSERT_FALSE(short_exit_fits(&config, &in));
    }
}

/* ---- exact limits: 9/8 L i^2 <= C/2 (15/16 v)^2, with 7/8 for the inverse ---- */

/* A capacitor of whole nanofarads that takes this energy from 0 V to 1875 V, 15/16 of 2 kV. */
static config_t with_bus_of_mJ(int32_t energy_mJ)
{
    config_t config = CONFIG_LU2013;
    config.drive.device_voltage_mV = 2000000;
    config.drive.bus_capacitance_nF = (int32_t)ceil(energy_mJ * 2e6 / (1875.0 * 1875.0));
    return config;
}

/* Half a turn in the window, and no current: that of twice the magnets' flux linkage, 4 psi^2 in
 * uWb^2 against 7/8 E L in mJ nH. 16 383 uWb, the most that 14 bits hold, and 0.1 uH. */
void test_the_current_of_half_a_turn_is_that_of_twice_the_flux_linkage(void)
{
    for (int fits = 0; fits < 2; fits++) {
        config_t config = with_bus_of_mJ(12269837 + fits); /* 4 psi^2 8/7 / 100 = 12 269 837.2 */
        config.motor.d_inductance_nH = 100;
        config.motor.q_inductance_nH = 100;
        config.motor.flux_linkage_nWb = 16383999;
        for (int back = 0; back < 2; back++) {
            const short_exit_input_t in = {.turning_mrad_s = back != 0 ? -INT32_MAX : INT32_MAX};
            TEST_ASSERT_EQUAL_INT(fits, short_exit_fits(&config, &in));
        }
    }
}

/* 4 * 0.032^2 / 1 uH / (7/8) = 4681 J: 15 bits of flux linkage. */
void test_the_flux_linkage_is_scaled_to_its_format(void)
{
    static const double SHARES[] = {0.25, 0.5, 0.999, 1.001, 2.0};
    for (int k = 0; k < 5; k++) {
        config_t config = with_bus_of_mJ((int32_t)(4681143 * SHARES[k]));
        config.motor.d_inductance_nH = 1000;
        config.motor.q_inductance_nH = 1000;
        config.motor.flux_linkage_nWb = 32000000;
        const short_exit_input_t in = {.turning_mrad_s = INT32_MAX};
        TEST_ASSERT_EQUAL_INT(SHARES[k] > 1.0, short_exit_fits(&config, &in));
    }
}

/* 4295 A in 1 H, 4295 Wb: 704 uWb more than 32 bits count. It is limited to 1000 Wb. */
void test_a_flux_linkage_beyond_its_format_does_not_fit(void)
{
    config_t config = with_bus_of_mJ(500000000);
    config.motor.d_inductance_nH = 1000000000;
    config.motor.q_inductance_nH = 1000000000;
    const short_exit_input_t d = {.i_d_mA = 4294968};
    const short_exit_input_t q = {.i_q_mA = 4294968};
    TEST_ASSERT_FALSE(short_exit_fits(&config, &d));
    TEST_ASSERT_FALSE(short_exit_fits(&config, &q));
}

/* 9/8 L i^2 of 1000 A in the inductance that counts. */
static void assert_inductance_counts_nH(config_t config, const short_exit_input_t *in, double l_nH)
{
    const double energy_mJ = l_nH * 1e-9 * 1e6 * 1e3 / 0.875;
    for (int fits = 0; fits < 2; fits++) {
        const config_t bus = with_bus_of_mJ((int32_t)(energy_mJ * (fits != 0 ? 1.002 : 0.998)));
        config.drive = bus.drive;
        TEST_ASSERT_EQUAL_INT(fits, short_exit_fits(&config, in));
    }
}

/* While the rotor hardly turns. In an unknown frame the larger one counts. */
void test_each_axis_counts_with_its_own_inductance(void)
{
    static const int32_t L_nH[][2] = {
        {400000, 100000}, {100000, 400000}, {1024000, 1000}, {1000, 1024000}};
    config_t config = CONFIG_LU2013;
    config.motor.flux_linkage_nWb = 1000;
    for (int k = 0; k < 4; k++) {
        config.motor.d_inductance_nH = L_nH[k][0];
        config.motor.q_inductance_nH = L_nH[k][1];
        for (int known = 0; known < 2; known++) {
            const short_exit_input_t d = {.i_d_mA = 1000000, .turning_mrad_s = known};
            const short_exit_input_t q = {.i_q_mA = 1000000, .turning_mrad_s = known};
            const double most_nH = fmax(L_nH[k][0], L_nH[k][1]);
            assert_inductance_counts_nH(config, &d, known != 0 ? L_nH[k][0] : most_nH);
            assert_inductance_counts_nH(config, &q, known != 0 ? L_nH[k][1] : most_nH);
        }
    }
}

/* 4096 A in 1 uH beside 1.024 mH, 9/8 * 16.8 J: a square of 24 bits that counts 1024-fold by the
 * larger inductance. */
void test_the_smaller_inductance_is_the_unit_of_the_comparison(void)
{
    config_t config = with_bus_of_mJ(10000);
    config.motor.flux_linkage_nWb = 1000;
    const short_exit_input_t d = {.i_d_mA = 4096000, .turning_mrad_s = 1};
    const short_exit_input_t q = {.i_q_mA = 4096000, .turning_mrad_s = 1};
    config.motor.d_inductance_nH = 1024000;
    config.motor.q_inductance_nH = 1000;
    TEST_ASSERT_FALSE(short_exit_fits(&config, &q));
    config.motor.d_inductance_nH = 1000;
    config.motor.q_inductance_nH = 1024000;
    TEST_ASSERT_FALSE(short_exit_fits(&config, &d));
}
