/* SPDX-License-Identifier: Apache-2.0 */
#include "config/derived.h"

#include <stddef.h>

#include "core/angle.h"
#include "core/q15.h"

/* A result, and how far beside it the generator may be, which computes with the numbers of the TOML
 * file before they are rounded to the units of the image. */
typedef struct {
    int64_t value;
    int64_t tolerance;
} derived_t;

#define ONE_Q30 (INT64_C(1) << 30)

/* Half a unit of x over x, in millionths; x > 0. */
static int64_t half_unit_ppm(int64_t x)
{
    return 500000 / x + 1;
}

static derived_t within_ppm(int64_t value, int64_t ppm)
{
    /* Two units: of the field's own rounding, and of the integers here. */
    const derived_t out = {value, value / 1000 * ppm / 1000 + value % 1000 * ppm / 1000000 + 2};
    return out;
}

/* a b / 2^shift for a, b >= 0 with 30 significant bits; saturates. */
static int64_t product(int64_t a, int64_t b, int shift)
{
    int64_t factors[2] = {a, b};
    for (int k = 0; k < 2; k++) {
        while (factors[k] >= ONE_Q30) {
            factors[k] >>= 1;
            shift--;
        }
    }
    const int64_t whole = factors[0] * factors[1];
    if (shift >= 0) {
        return whole >> q_min(shift, 62);
    }
    return whole > INT64_MAX >> q_min(-shift, 62) ? INT64_MAX : whole << -shift;
}

/* I_base / V_base in 1/ohm. */
static int64_t admittance_q30(const config_t *c)
{
    return (int64_t)c->drive.current_full_scale_mA * ONE_Q30 / c->drive.voltage_full_scale_mV;
}

static int64_t bases_ppm(const config_t *c)
{
    return half_unit_ppm(c->drive.current_full_scale_mA) +
           half_unit_ppm(c->drive.voltage_full_scale_mV) + half_unit_ppm(c->drive.pwm_frequency_Hz);
}

enum {
    OMEGA_BASE_Q16 = 25736, /* 2 pi / 16 of a hertz, times 2^16 */
    CONSTANT_ppm = 10       /* its rounding, and that of the products */
};

/* omega_base psi / V_base. */
static derived_t flux_q16(const config_t *c)
{
    const int64_t volts_q16_1e9 =
        (int64_t)c->drive.pwm_frequency_Hz * c->motor.flux_linkage_nWb * OMEGA_BASE_Q16;
    return within_ppm(volts_q16_1e9 / c->drive.voltage_full_scale_mV / 1000000,
                      bases_ppm(c) + half_unit_ppm(c->motor.flux_linkage_nWb) + CONSTANT_ppm);
}

/* omega_base L I_base / V_base. */
static derived_t inductance_q16(const config_t *c, int32_t inductance_nH)
{
    const int64_t ohm_q16_1e6 =
        (int64_t)c->drive.pwm_frequency_Hz * inductance_nH * OMEGA_BASE_Q16 / 1000;
    return within_ppm(product(ohm_q16_1e6, admittance_q30(c), 30) / 1000000,
                      bases_ppm(c) + half_unit_ppm(inductance_nH) + CONSTANT_ppm);
}

/* a (1 - a) with a = exp(-2 y), y = pi f / f_pwm; the frequency in half hertz. The second Pade
 * approximation of exp(-y), its error y^5 / 720 below 2e-6 up to a twelfth. */
static int64_t loop_gain_q30(const config_t *c, int64_t frequency_half_Hz)
{
    /* pi f / f_pwm in Q30 from pi in Q24: 2^6, less the half. */
    const int64_t exact_q30 = frequency_half_Hz * ANGLE_PI_Q24 * 32 / c->drive.pwm_frequency_Hz;
    const int64_t y_q30 = exact_q30 < ONE_Q30 ? exact_q30 : ONE_Q30;
    const int64_t even_q30 = ONE_Q30 + ((y_q30 * y_q30) >> 30) / 12;
    const int64_t half_q30 = ((even_q30 - y_q30 / 2) << 30) / (even_q30 + y_q30 / 2);
    const int64_t pole_q30 = (half_q30 * half_q30) >> 30;
    return (pole_q30 * (ONE_Q30 - pole_q30)) >> 30;
}

/* a (1 - a) R I_base / V_base. */
static int64_t integral_q24(const config_t *c, int64_t gain_q30, int64_t resistance_uOhm)
{
    return product(product(gain_q30, resistance_uOhm, 0), admittance_q30(c), 36) / 1000000;
}

/* The resistance is that of winding and switch. The image holds the switches' losses instead, of
 * which at most a quarter comes from the diodes in the dead time: the switch has at most 4/3 of
 * their resistance, and where they are not given, at most 3/8 of the winding's. */
static config_derived_range_t integral_range(const config_t *c)
{
    const int64_t winding_uOhm = c->motor.phase_resistance_uOhm;
    const int64_t switch_uOhm = (int64_t)c->drive.loss_resistance_uOhm * 4 / 3;
    const int64_t largest_uOhm = winding_uOhm + switch_uOhm + winding_uOhm * 3 / 8;
    const int64_t twice_Hz = (int64_t)c->current_loop.bandwidth_Hz * 2;
    const int64_t ppm = bases_ppm(c) + half_unit_ppm(winding_uOhm) + CONSTANT_ppm;
    const derived_t low =
        within_ppm(integral_q24(c, loop_gain_q30(c, twice_Hz - 1), winding_uOhm), ppm);
    const derived_t high =
        within_ppm(integral_q24(c, loop_gain_q30(c, twice_Hz + 1), largest_uOhm), ppm);
    const config_derived_range_t out = {.lowest = q_saturate64(low.value - low.tolerance),
                                        .highest = q_saturate64(high.value + high.tolerance)};
    return out;
}

/* k_i / (1 - exp(-x)), x = R T / L (firmware/foc/DERIVATIONS.md). With k_0 = K L / T, K the loop's
 * gain, that is k_0 + k_i / 2 + k_i^2 / (12 k_0); the next term is below 6e-6 for x up to 1/4. */
static int64_t proportional_q16(const config_t *c, int64_t gain_q30, int32_t inductance_nH,
                                int32_t integral)
{
    const int64_t nanoohm = (int64_t)inductance_nH * c->drive.pwm_frequency_Hz;
    const int64_t nanoohm_q16 = product(gain_q30, nanoohm, 14);
    const int64_t first_q16 = product(nanoohm_q16, admittance_q30(c), 30) / 1000000000;
    const int64_t square_q48 = (int64_t)integral * integral;
    const int64_t rest_q24 = first_q16 > 0 ? square_q48 / (INT64_C(12) * 256) / first_q16 : 0;
    return first_q16 + (integral / 2 + rest_q24) / 256;
}

static config_derived_range_t proportional_range(const config_t *c, int32_t inductance_nH,
                                                 int32_t integral)
{
    const int64_t twice_Hz = (int64_t)c->current_loop.bandwidth_Hz * 2;
    const int64_t ppm = bases_ppm(c) + half_unit_ppm(inductance_nH) + INT64_C(4) * CONSTANT_ppm;
    const derived_t low = within_ppm(
        proportional_q16(c, loop_gain_q30(c, twice_Hz - 1), inductance_nH, integral), ppm);
    const derived_t high = within_ppm(
        proportional_q16(c, loop_gain_q30(c, twice_Hz + 1), inductance_nH, integral), ppm);
    const config_derived_range_t out = {.lowest = q_saturate64(low.value - low.tolerance),
                                        .highest = q_saturate64(high.value + high.tolerance)};
    return out;
}

/* 2 w T of a bandwidth given to half a hertz. */
static config_derived_range_t pll_range(const config_t *c)
{
    const int64_t twice_Hz = (int64_t)c->rotor.pll_bandwidth_Hz * 2;
    /* 2 pi twice_Hz / f in Q16 from pi in Q24: 2^-7. */
    const int64_t f_Hz = c->drive.pwm_frequency_Hz;
    const config_derived_range_t out = {
        .lowest = q_saturate64((twice_Hz - 1) * ANGLE_PI_Q24 / 128 / f_Hz - 2),
        .highest = q_saturate64((twice_Hz + 1) * ANGLE_PI_Q24 / 128 / f_Hz + 2)};
    return out;
}

/* (w T)^2: a quarter of the square of 2 w T, which is known to half a unit. */
static derived_t pll_integral_q24(const config_t *c)
{
    const int64_t proportional = c->rotor.pll_proportional_q16;
    const derived_t out = {proportional * proportional / 1024, proportional / 1024 + 2};
    return out;
}

static config_derived_range_t range_of(derived_t found)
{
    const config_derived_range_t out = {.lowest = q_saturate64(found.value - found.tolerance),
                                        .highest = q_saturate64(found.value + found.tolerance)};
    return out;
}

static config_derived_range_t exactly(int32_t value)
{
    const config_derived_range_t out = {.lowest = value, .highest = value};
    return out;
}

#define PLACE(field) (uint32_t) offsetof(config_t, field)

static const uint32_t PLACES[CONFIG_DERIVED_FIELDS] = {
    [CONFIG_DERIVED_FLUX] = PLACE(current_loop.flux_pu_q16),
    [CONFIG_DERIVED_INDUCTANCE_D] = PLACE(current_loop.inductance_d_pu_q16),
    [CONFIG_DERIVED_INDUCTANCE_Q] = PLACE(current_loop.inductance_q_pu_q16),
    [CONFIG_DERIVED_INTEGRAL_D] = PLACE(current_loop.integral_d_pu_q24),
    [CONFIG_DERIVED_INTEGRAL_Q] = PLACE(current_loop.integral_q_pu_q24),
    [CONFIG_DERIVED_PROPORTIONAL_D] = PLACE(current_loop.proportional_d_pu_q16),
    [CONFIG_DERIVED_PROPORTIONAL_Q] = PLACE(current_loop.proportional_q_pu_q16),
    [CONFIG_DERIVED_PLL_PROPORTIONAL] = PLACE(rotor.pll_proportional_q16),
    [CONFIG_DERIVED_PLL_INTEGRAL] = PLACE(rotor.pll_integral_q24),
};

static config_derived_range_t recomputed(const config_t *c, config_derived_t field)
{
    const config_motor_t *motor = &c->motor;
    const config_current_loop_t *loop = &c->current_loop;
    switch (field) {
    case CONFIG_DERIVED_FLUX:
        return range_of(flux_q16(c));
    case CONFIG_DERIVED_INDUCTANCE_D:
        return range_of(inductance_q16(c, motor->d_inductance_nH));
    case CONFIG_DERIVED_INDUCTANCE_Q:
        return range_of(inductance_q16(c, motor->q_inductance_nH));
    case CONFIG_DERIVED_INTEGRAL_D:
        return integral_range(c);
    case CONFIG_DERIVED_INTEGRAL_Q:
        return exactly(loop->integral_d_pu_q24);
    case CONFIG_DERIVED_PROPORTIONAL_D:
        return proportional_range(c, motor->d_inductance_nH, loop->integral_d_pu_q24);
    case CONFIG_DERIVED_PROPORTIONAL_Q:
        return proportional_range(c, motor->q_inductance_nH, loop->integral_q_pu_q24);
    case CONFIG_DERIVED_PLL_PROPORTIONAL:
        return pll_range(c);
    case CONFIG_DERIVED_PLL_INTEGRAL:
    case CONFIG_DERIVED_FIELDS:
        break;
    }
    return range_of(pll_integral_q24(c));
}

config_derived_range_t config_derived_range(const config_t *config, config_derived_t field)
{
    config_derived_range_t out = recomputed(config, field);
    out.offset_bytes = PLACES[field < CONFIG_DERIVED_FIELDS ? field : CONFIG_DERIVED_PLL_INTEGRAL];
    return out;
}
