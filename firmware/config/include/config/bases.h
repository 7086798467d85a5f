/* SPDX-License-Identifier: Apache-2.0 */
/*
 * bases.h: the per-unit bases, and every conversion between the fast loop's per-unit and the slow
 * loop's SI units.
 *
 *     current   1.0 pu = drive.current_full_scale_mA          peak phase current
 *     bus       1.0 pu = drive.voltage_full_scale_mV          bus voltage
 *     phase     1.0 pu = v_dc / sqrt(3)    "modulation": the largest phase voltage of SVPWM now
 *     speed     1.0 pu = 1/16 electrical turn per PWM period  (1250 Hz electrical at 20 kHz)
 *     angle     65 536 = one electrical turn
 *
 *     PWM       counts of the port's timer, whose clock the port states
 *
 * Q15 stands for 32 768 = 1.0. All functions divide or multiply in 64 bits: for the slow loop
 * only. They saturate.
 */
#ifndef CONFIG_BASES_H
#define CONFIG_BASES_H

#include <stdint.h>

#include "config/config.h"
#include "core/q15.h"
#include "core/scaled.h"

/* Timer clock where there is no timer (simulator, tests, ports without one). The STM32F405's, so
 * that their compare values and its are the same. */
enum { BASES_MODEL_TIMER_Hz = 168000000 };

/* Counts from 0 to the top of the centre-aligned count, to the nearest, 256 .. 16384. A port whose
 * timer misses the frequency by more than 0.1 % with them refuses it (hal/inverter.h). timer_Hz: at
 * most 2e9. */
static inline int32_t bases_pwm_period_counts(const config_t *config, int32_t timer_Hz)
{
    const int32_t frequency_Hz = config->drive.pwm_frequency_Hz;
    return q_clamp((timer_Hz + frequency_Hz) / (2 * frequency_Hz), 256, 16384);
}

/* Half of the shortest low-side pulse, never shorter than drive.min_pulse_ns. */
static inline int32_t bases_min_pulse_counts(const config_t *config, int32_t timer_Hz)
{
    const int64_t counts_1e9 = (int64_t)config->drive.min_pulse_ns * timer_Hz;
    return (int32_t)((counts_1e9 + 999999999) / 1000000000);
}

/* Within 4 times the base. */
static inline int32_t bases_current_mA(const config_t *config, int32_t current_pu_q15)
{
    const int64_t current_pu = q_saturate18(current_pu_q15);
    return (int32_t)((current_pu * config->drive.current_full_scale_mA) >> 15);
}

static inline int16_t bases_current_pu_q15(const config_t *config, int32_t current_mA)
{
    const int32_t ratio_q24 =
        scaled_ratio(current_mA, q_divisor(config->drive.current_full_scale_mA));
    return q15_saturate((ratio_q24 + (1 << 8)) >> 9);
}

static inline int32_t bases_bus_voltage_mV(const config_t *config, int32_t voltage_pu_q15)
{
    const int64_t voltage_pu = q_saturate18(voltage_pu_q15);
    return (int32_t)((voltage_pu * config->drive.voltage_full_scale_mV) >> 15);
}

/* Electrical speed as the fast loop keeps it, turns per PWM period in Q32, to mechanical mrad/s.
 *     omega_m = turns/period * f_pwm * 2 pi / pole_pairs;   2000 pi / 2^16 is 6433982 / 2^26 */
static inline int32_t bases_speed_mrad_s(const config_t *config, int32_t speed_turn_q32)
{
    const int64_t turns_per_s_q16 =
        ((int64_t)speed_turn_q32 * config->drive.pwm_frequency_Hz) / 65536;
    const int64_t electrical_mrad_s = turns_per_s_q16 * 6433982 / (1 << 26);
    return (int32_t)electrical_mrad_s / q_divisor(config->motor.pole_pairs);
}

/* Mechanical mrad/s to electrical mrad/s; saturates. */
static inline int32_t bases_electrical_mrad_s(const config_t *config, int32_t speed_mrad_s)
{
    return q_saturate64((int64_t)speed_mrad_s * config->motor.pole_pairs);
}

/*
 * Voltage that each phase loses by dead time, as a share of the bus voltage, in 1e-9.
 *
 * With i > 0 the leg lies at -V_f in both dead intervals of a period. In one of them the high side
 * was to conduct, which loses v_dc + V_f, in the other one the low side, which loses V_f; with i <
 * 0 the same the other way round:
 *     t_d f_pwm (v_dc + 2 V_f)        over v_dc        t_d f_pwm (1 + 2 V_f / v_dc)
 * v_dc is taken as (battery.min_voltage_mV + battery.max_voltage_mV) / 2. For V_f = 0.8 V and a bus
 * between 45 and 58 V the error of the share is at most 0.5 %.
 */
static inline int64_t bases_dead_time_share_1e9(const config_t *config)
{
    const int64_t dead_1e9 = (int64_t)config->drive.dead_time_ns * config->drive.pwm_frequency_Hz;
    const int64_t twice_v_dc_mV =
        (int64_t)config->battery.min_voltage_mV + config->battery.max_voltage_mV;
    const int64_t drops_mV = INT64_C(4) * config->drive.diode_drop_mV;
    return dead_1e9 + (dead_1e9 * drops_mV + twice_v_dc_mV / 2) / twice_v_dc_mV;
}

/* 1 + coefficient (T - T_reference), 24 fraction bits: the factor by which a quantity with a linear
 * temperature coefficient, |ppm/K| <= 10 000, changes. T - T_reference is limited to +-1000 K and
 * the result to at least 0.1, so that a broken thermistor cannot make the factor zero or negative.
 */
static inline int32_t bases_share_at_q24(const config_t *config, int32_t coefficient_ppm_K,
                                         int32_t winding_temperature_cC)
{
    const int32_t most_cK = 100000;
    const int32_t rise_cK = q_limit(
        q_subtract(winding_temperature_cC, config->motor.reference_temperature_cC), most_cK);
    /* ppm/K times hundredths of a kelvin is 1e-8: 2^56 / 1e8, and the upper half of the product. */
    const int64_t change = INT64_C(720575940) * rise_cK * coefficient_ppm_K;
    return q_max(SCALED_ONE + (int32_t)(change >> 32), SCALED_ONE / 10);
}

/* A winding's resistance, or a gain proportional to one, at a winding temperature, from its value
 * at the reference temperature: linear, as copper is. */
static inline int32_t bases_at_winding_temperature(const config_t *config, int32_t at_reference,
                                                   int32_t winding_temperature_cC)
{
    const int32_t coefficient_ppm_K = config->motor.resistance_coefficient_ppm_K;
    const int32_t share_q24 = bases_share_at_q24(config, coefficient_ppm_K, winding_temperature_cC);
    return q_saturate64(((int64_t)at_reference * share_q24) >> 24);
}

#endif
