/* SPDX-License-Identifier: Apache-2.0 */
/* motor_constants_init(), which no control step executes: compiled for size. */
#include "config/bases.h"
#include "config/flux_largest.h"
#include "core/q15.h"
#include "motor/motor_model.h"

enum {
    MILLION = 1000000,
    BILLION = 1000000000,
    SIZE_LOG2 = 22 /* the largest value of a quantity lies in [2^22, 2^23) */
};

/* The shift that brings x > 0 into [2^22, 2^23). */
static int32_t shift_to_size(int64_t x)
{
    int32_t shift = 0;
    for (int64_t y = x; y >= (INT64_C(2) << SIZE_LOG2); y >>= 1) {
        shift--;
    }
    for (int64_t y = x; y < (INT64_C(1) << SIZE_LOG2); y <<= 1) {
        shift++;
    }
    return shift;
}

static int64_t larger(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

/* Largest voltage of the scale: EMF and reactive drop at the highest speed, and the battery's. The
 * chords and tangents of a flux map have no more than a quarter of the range of a ratio. */
static int64_t largest_voltage_mV(const config_t *config, int64_t w_most_mrad_s)
{
    const config_motor_t *motor = &config->motor;
    const int64_t emf_mV = w_most_mrad_s * motor->flux_linkage_nWb / BILLION;
    const int64_t l_nH = larger(larger(motor->d_inductance_nH, motor->q_inductance_nH),
                                INT64_C(2) * config_flux_map_largest_nH(config));
    const int64_t x_uOhm = w_most_mrad_s * l_nH / MILLION;
    const int64_t z_uOhm = larger(q_saturate64(x_uOhm), motor->phase_resistance_uOhm);
    const int64_t drop_mV = z_uOhm * motor->max_phase_current_mA / MILLION;
    return larger(larger(emf_mV, drop_mV), config->battery.max_voltage_mV);
}

void motor_constants_init(motor_constants_t *constants, const config_t *config)
{
    const config_motor_t *motor = &config->motor;
    const int64_t w_most_mrad_s = (int64_t)motor->max_speed_mrad_s * motor->pole_pairs;
    const int32_t c = shift_to_size(motor->max_phase_current_mA);
    const int32_t v = shift_to_size(largest_voltage_mV(config, w_most_mrad_s));
    const int32_t w = shift_to_size(w_most_mrad_s);
    const int64_t resistance_ppm_K = motor->resistance_coefficient_ppm_K;
    const int64_t flux_ppm_K = motor->flux_coefficient_ppm_K;
    int32_t factor_shift = 0;
    while ((3 * motor->pole_pairs) >> factor_shift > 1) {
        factor_shift++;
    }
    const int32_t t = c + v - w + 1 - factor_shift;
    const motor_constants_t out = {
        .current_shift = c,
        .voltage_shift = v,
        .speed_shift = w,
        .torque_shift = t,
        .resistance_b =
            q_saturate27(scaled_constant(motor->phase_resistance_uOhm, MILLION, 24 + v - c)),
        .resistance_rise_b = scaled_constant(motor->phase_resistance_uOhm * resistance_ppm_K,
                                             INT64_C(100) * MILLION * MILLION, 40 + v - c),
        .inductance_d_b =
            scaled_constant(motor->d_inductance_nH, INT64_C(1000000000000), 48 + v - c - w),
        .inductance_q_b =
            scaled_constant(motor->q_inductance_nH, INT64_C(1000000000000), 48 + v - c - w),
        .flux_unit_shift = 34 - v + w,
        .inductance_unit_shift = 20 - v + c + w,
        .flux_b = scaled_constant(motor->flux_linkage_nWb, BILLION, 24 + v - w),
        .flux_fall_b =
            scaled_constant((int64_t)motor->flux_linkage_nWb * q_abs((int32_t)flux_ppm_K),
                            INT64_C(100) * MILLION * BILLION, 40 + v - w),
        .iron_q16_b = scaled_constant(motor->iron_loss_resistance_mOhm, 1000, 16 + v - c),
        .iron_slope_q16_b = scaled_constant(motor->iron_loss_resistance_slope_nOhm_s,
                                            INT64_C(1000) * BILLION, 40 + v - c - w),
        .coulomb_step_q8_b =
            scaled_constant(motor->friction_torque_mNm, MOTOR_MODEL_FRICTION_FULL_MRAD_S, 8 + t),
        .viscous_b = scaled_constant(motor->viscous_friction_uNm_s,
                                     (int64_t)MILLION * motor->pole_pairs, 24 + t - w),
        .torque_factor_q24 = (3 * motor->pole_pairs) << (24 - factor_shift),
        .torque_inverse_q24 = scaled_constant(1, INT64_C(3) * motor->pole_pairs, 24 + factor_shift),
        .current_most_b = scaled_shift(motor->max_phase_current_mA, c),
        .weakening_most_b = q_min(
            scaled_shift(
                bases_current_mA(config, config->current_loop.field_weakening_current_pu_q15), c),
            MOTOR_MODEL_MOST_CURRENT_b),
        .negligible_power_b = scaled_constant(INT64_C(2) * motor->max_power_mW, 3, v + c - 24),
        .loss_b =
            q_saturate27(scaled_constant(INT64_C(2) * config->drive.loss_per_ampere_uW_A, 3000, v)),
        .loss_resistance_b =
            q_saturate27(scaled_constant(config->drive.loss_resistance_uOhm, MILLION, 24 + v - c)),
        .hall_angle_b =
            config->rotor.sensor == CONFIG_ROTOR_HALL
                ? scaled_constant(1, INT64_C(2000) * config->drive.pwm_frequency_Hz, 48 - w)
                : 0,
    };
    *constants = out;
}
