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
    const double margin_v2 = 70.3125 * 70.3125 - 53.0 * 53.0;
    const double limit_mA = 1e3 * sqrt(margin_v2 * 1e-3 / (2.25 * 76e-6));
    for (int k = 0; k < 24; k++) {
        for (int beyond = 0; beyond < 2; beyond++) {
            const double i_mA = limit_mA * (beyond != 0 ? 1.01 : 0.99);
            const short_exit_input_t in = {.i_d_mA = (int32_t)(i_mA * cos(k * 0.2618)),
                                           .i_q_mA = (int32_t)(i_mA * sin(k * 0.2618)),
                                           .bus_mV = 53000};
            TEST_ASSERT_TRUE(short_exit_fits(&CONFIG_LU2013, &in) == (beyond == 0));
        }
    }
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
