/* SPDX-License-Identifier: Apache-2.0 */
/* The fields that follow from others, against the generator's equations in double precision. */
#include "config/derived.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

#include "random_values.h"
#include "refusal.h"
#include "unity.h"

extern const config_t CONFIG_EBIKE36V, CONFIG_SCOOTER48V, CONFIG_IPM400V, CONFIG_WHEEL24V;

void setUp(void)
{
    config = CONFIG_LU2013;
}

void tearDown(void) {}

static const double PI = 3.14159265358979323846;

static int32_t *field_of(config_derived_t field)
{
    const config_derived_range_t range = config_derived_range(&config, field);
    return (int32_t *)(void *)&config + range.offset_bytes / sizeof(int32_t);
}

/* What the generator writes: the numbers of the TOML file before their rounding, by the equations
 * of foc/DERIVATIONS.md. */
typedef struct {
    double values[CONFIG_DERIVED_FIELDS];
} generated_t;

typedef struct {
    double resistance_ohm, switch_ohm, inductance_h[2], flux_wb;
    double bandwidth_hz, pll_hz, current_a, voltage_v, pwm_hz;
} drive_t;

static double proportional(const drive_t *d, double gain, double inductance_h)
{
    const double resistance = d->resistance_ohm + d->switch_ohm;
    return gain * resistance / -expm1(-resistance / d->pwm_hz / inductance_h) * d->current_a /
           d->voltage_v * 65536.0;
}

static generated_t generated(const drive_t *d)
{
    const double base = 2.0 * PI * d->pwm_hz / 16.0;
    const double impedance = d->current_a / d->voltage_v;
    const double pole = exp(-2.0 * PI * d->bandwidth_hz / d->pwm_hz);
    const double gain = pole * (1.0 - pole);
    const double integral = gain * (d->resistance_ohm + d->switch_ohm) * impedance * 16777216.0;
    const double natural = 2.0 * PI * d->pll_hz / d->pwm_hz;
    const generated_t out = {{
        [CONFIG_DERIVED_FLUX] = base * d->flux_wb / d->voltage_v * 65536.0,
        [CONFIG_DERIVED_INDUCTANCE_D] = base * d->inductance_h[0] * impedance * 65536.0,
        [CONFIG_DERIVED_INDUCTANCE_Q] = base * d->inductance_h[1] * impedance * 65536.0,
        [CONFIG_DERIVED_INTEGRAL_D] = integral,
        [CONFIG_DERIVED_INTEGRAL_Q] = integral,
        [CONFIG_DERIVED_PROPORTIONAL_D] = proportional(d, gain, d->inductance_h[0]),
        [CONFIG_DERIVED_PROPORTIONAL_Q] = proportional(d, gain, d->inductance_h[1]),
        [CONFIG_DERIVED_PLL_PROPORTIONAL] = 2.0 * natural * 65536.0,
        [CONFIG_DERIVED_PLL_INTEGRAL] = natural * natural * 16777216.0,
    }};
    return out;
}

static double decades(random_t *random, double low, double high)
{
    return exp(random_real(random, log(low), log(high)));
}

/* Any drive within the ranges, its electrical time constant above four periods. */
static drive_t random_drive(random_t *random)
{
    drive_t d = {.resistance_ohm = decades(random, 1e-3, 10.0),
                 .switch_ohm = 0.0,
                 .flux_wb = decades(random, 1e-4, 1.0),
                 .bandwidth_hz = 0.0,
                 .pll_hz = random_real(random, 1.0, 1000.0),
                 .current_a = decades(random, 1.0, 4000.0),
                 .voltage_v = decades(random, 5.0, 2000.0),
                 .pwm_hz = floor(random_real(random, 4000.0, 100000.0))};
    d.switch_ohm = d.resistance_ohm * random_real(random, 0.0, 0.37);
    d.bandwidth_hz = decades(random, 10.0, d.pwm_hz / 12.5);
    for (int axis = 0; axis < 2; axis++) {
        d.inductance_h[axis] =
            (d.resistance_ohm + d.switch_ohm) * decades(random, 5.0, 1000.0) / d.pwm_hz;
    }
    return d;
}

static void store_physical(const drive_t *d)
{
    config.motor.phase_resistance_uOhm = (int32_t)lround(d->resistance_ohm * 1e6);
    config.motor.d_inductance_nH = (int32_t)lround(d->inductance_h[0] * 1e9);
    config.motor.q_inductance_nH = (int32_t)lround(d->inductance_h[1] * 1e9);
    config.motor.flux_linkage_nWb = (int32_t)lround(d->flux_wb * 1e9);
    config.drive.current_full_scale_mA = (int32_t)lround(d->current_a * 1e3);
    config.drive.voltage_full_scale_mV = (int32_t)lround(d->voltage_v * 1e3);
    config.drive.pwm_frequency_Hz = (int32_t)lround(d->pwm_hz);
    config.drive.loss_resistance_uOhm = 0;
    config.current_loop.bandwidth_Hz = (int32_t)lround(d->bandwidth_hz);
    config.rotor.pll_bandwidth_Hz = (int32_t)lround(d->pll_hz);
}

static void assert_in_range(config_derived_t field, int32_t value, const char *drive)
{
    const config_derived_range_t range = config_derived_range(&config, field);
    char text[120];
    (void)snprintf(text, sizeof text, "%s, field %d: %ld, accepted: %ld to %ld", drive, (int)field,
                   (long)value, (long)range.lowest, (long)range.highest);
    TEST_ASSERT_TRUE_MESSAGE(value >= range.lowest && value <= range.highest, text);
}

/* Within the ranges of the fields. */
static bool fits(const drive_t *d, const generated_t *all)
{
    bool good = true;
    for (int axis = 0; axis < 2; axis++) {
        good = good && d->inductance_h[axis] >= 1e-7 && d->inductance_h[axis] <= 1.0;
    }
    for (int k = 0; k < CONFIG_DERIVED_FIELDS; k++) {
        good = good && all->values[k] >= 1.0 && all->values[k] <= 1048576.0;
    }
    return good;
}

/* 20 000 drives over the decades of the ranges: what the generator writes is accepted, and what is
 * farther away than the rounding of the numbers in the image allows is not. */
void test_what_the_generator_writes_is_accepted_and_nothing_beside_it(void)
{
    random_t random = random_seeded(11);
    int compared[CONFIG_DERIVED_FIELDS] = {0};
    for (int n = 0; n < 20000; n++) {
        const drive_t d = random_drive(&random);
        const generated_t all = generated(&d);
        if (!fits(&d, &all)) {
            continue;
        }
        store_physical(&d);
        for (int k = 0; k < CONFIG_DERIVED_FIELDS; k++) {
            const double exact = all.values[k];
            *field_of((config_derived_t)k) = (int32_t)lround(exact);
            assert_in_range((config_derived_t)k, (int32_t)lround(exact), "random");
            const config_derived_range_t range = config_derived_range(&config, (config_derived_t)k);
            /* Half a hertz of the bandwidths, half a unit of the rest, 3/8 of the resistance. */
            const double bandwidth = k == CONFIG_DERIVED_PLL_PROPORTIONAL ? 0.5 / d.pll_hz
                                     : k == CONFIG_DERIVED_PLL_INTEGRAL
                                         ? 2.0 / config.rotor.pll_proportional_q16
                                     : k > CONFIG_DERIVED_INDUCTANCE_Q ? 0.5 / d.bandwidth_hz
                                                                       : 0.0;
            const double rounding = 0.5e-9 / d.inductance_h[0] + 0.5e-9 / d.inductance_h[1] +
                                    0.5e-6 / d.resistance_ohm + 0.5e-9 / d.flux_wb +
                                    0.5e-3 / d.current_a + 0.5e-3 / d.voltage_v + 0.5 / d.pwm_hz +
                                    1e-4;
            const double resistance = k == CONFIG_DERIVED_INTEGRAL_D ? 0.4 : 0.0;
            const double most = exact * 2.2 * (bandwidth + rounding + resistance) + 5.0;
            TEST_ASSERT_TRUE(range.highest <= exact + most);
            TEST_ASSERT_TRUE(range.lowest >= exact - most);
            compared[k]++;
        }
    }
    for (int k = 0; k < CONFIG_DERIVED_FIELDS; k++) {
        TEST_ASSERT_GREATER_THAN_INT(2000, compared[k]);
    }
}

void test_every_shipped_image_agrees_with_itself(void)
{
    const config_t *const shipped[] = {&CONFIG_LU2013, &CONFIG_EBIKE36V, &CONFIG_SCOOTER48V,
                                       &CONFIG_IPM400V, &CONFIG_WHEEL24V};
    for (unsigned n = 0; n < sizeof shipped / sizeof shipped[0]; n++) {
        config = *shipped[n];
        for (int k = 0; k < CONFIG_DERIVED_FIELDS; k++) {
            assert_in_range((config_derived_t)k, *field_of((config_derived_t)k), config.name);
        }
    }
}

static void assert_refused(const char *section, const char *name)
{
    const config_result_t result = sealed_result();
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_RANGE, result.code);
    TEST_ASSERT_EQUAL_STRING(section, result.section);
    TEST_ASSERT_EQUAL_STRING(name, result.field);
    config = CONFIG_LU2013;
}

/* Fourteen times less flux for the torque than for the EMF: 51 N m where 30 are asked for. */
void test_a_motor_that_is_another_one_for_the_slow_loop_is_refused(void)
{
    config.motor.flux_linkage_nWb /= 14;
    assert_refused("current_loop.", "flux_pu_q16");
    config.motor.d_inductance_nH = config.motor.d_inductance_nH * 101 / 100;
    config.motor.q_inductance_nH = config.motor.d_inductance_nH;
    assert_refused("current_loop.", "inductance_d_pu_q16");
    config.motor.type = CONFIG_MOTOR_IPMSM;
    config.motor.q_inductance_nH = config.motor.q_inductance_nH * 101 / 100;
    assert_refused("current_loop.", "inductance_q_pu_q16");
    config.motor.phase_resistance_uOhm = config.motor.phase_resistance_uOhm * 12 / 10;
    assert_refused("current_loop.", "integral_d_pu_q24");
}

void test_a_gain_that_is_not_what_the_bandwidth_says_is_refused(void)
{
    config.current_loop.integral_d_pu_q24 *= 2;
    assert_refused("current_loop.", "integral_d_pu_q24");
    config.current_loop.integral_q_pu_q24++;
    assert_refused("current_loop.", "integral_q_pu_q24");
    config.current_loop.proportional_d_pu_q16 =
        config.current_loop.proportional_d_pu_q16 * 101 / 100;
    assert_refused("current_loop.", "proportional_d_pu_q16");
    config.current_loop.proportional_q_pu_q16 =
        config.current_loop.proportional_q_pu_q16 * 99 / 100;
    assert_refused("current_loop.", "proportional_q_pu_q16");
    config.rotor.pll_proportional_q16 = config.rotor.pll_proportional_q16 * 11 / 10;
    assert_refused("rotor.", "pll_proportional_q16");
    config.rotor.pll_integral_q24 = config.rotor.pll_integral_q24 * 11 / 10;
    assert_refused("rotor.", "pll_integral_q24");
    config.current_loop.bandwidth_Hz = config.drive.pwm_frequency_Hz / 12 + 1;
    assert_relation("current_loop.bandwidth_Hz at most a twelfth of drive.pwm_frequency_Hz");
}
