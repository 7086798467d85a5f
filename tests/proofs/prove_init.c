/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Coefficients of the fast loop: initialisation, and the tuning that the slow loop computes every
 * millisecond. For every field in the validator's range no arithmetic overflows, and the results
 * are in the ranges that the proofs of the modules assume.
 */
#include "config/config.h"
#include "encoder.h"
#include "fast_ranges.h"
#include "modulation.h"
#include "observer_tuning.h"
#include "proof.h"
#include "tuning.h"

static bool usable(const pi_gains_t *gains)
{
    return gains->proportional_q10 >= 1 && gains->proportional_q10 <= PI_LARGEST_PROPORTIONAL_Q10 &&
           gains->integral_q15 >= 1 && gains->integral_q15 <= PI_LARGEST_INTEGRAL_Q15 &&
           gains->anti_windup_q15 >= 1 && gains->anti_windup_q15 <= PI_LARGEST_ANTI_WINDUP_Q15;
}

static winding_axis_t any_axis(void)
{
    const winding_axis_t out = {
        .proportional_pu_q16 = any_within(1, 1048576),
        .integral_pu_q24 = any_within(1, 16777216),
        .inductance_pu_q16 = any_within(1, 1048576),
        .flux_pu_q16 = any_within(-1048576, 1048576),
        .anti_windup_q28 = any_within(0, 1 << 30),
    };
    return out;
}

void prove_tuning(void)
{
    config_t config;
    config.motor.resistance_coefficient_ppm_K = any_within(0, 10000);
    config.motor.reference_temperature_cC = any_within(-5000, 15000);
    const winding_t winding = {.d = any_axis(), .q = any_axis()};
    const current_tuning_t out = current_tuning(&config, &winding, any_within(8192, 32767),
                                                nondet_int32(), nondet_int32(), nondet_int32());
    PROVE(usable(&out.d) && usable(&out.q));
    PROVE(out.w_l_d_q10 >= -16383 && out.w_l_d_q10 <= 16383);
    PROVE(out.w_l_q_q10 >= -16383 && out.w_l_q_q10 <= 16383);
    PROVE(within(out.forward_d_q25, -(1 << 28), 1 << 28));
    PROVE(within(out.forward_q_q25, -(1 << 28), 1 << 28));
    PROOF_END();
}

void prove_dead_time_counts(void)
{
    config_t config;
    config.drive.pwm_frequency_Hz = any_within(4000, 100000);
    config.drive.dead_time_ns = any_within(0, 10000);
    config.drive.diode_drop_mV = any_within(0, 5000);
    config.battery.min_voltage_mV = any_within(1000, 2000000);
    config.battery.max_voltage_mV = any_within(1000, 2000000);
    const int32_t counts = modulation_dead_time_counts(&config, any_within(1000000, 2000000000));
    PROVE(counts >=
          0); /* and an eighth of the longest period at most, 2048: the validator's relation */
    PROOF_END();
}

/* Constants as observer_design clamps them. */
void prove_observer_tuning(void)
{
    config_t config;
    config.motor.resistance_coefficient_ppm_K = any_within(0, 10000);
    config.motor.reference_temperature_cC = any_within(-5000, 15000);
    const observer_constants_t constants = {.resistance_q15 = any_within(0, MOST_STEP_Q15),
                                            .volt_q15 = any_within(0, MOST_STEP_Q15)};
    const winding_t winding = {.chord_q_q15 = any_within(0, MOST_INDUCTANCE_Q15)};
    const observer_leak_t leak = {.leak_q24 = any_within(0, 1 << 21)};
    const observer_tuning_t out =
        observer_tuning(&constants, &winding, &leak, &config, nondet_int32(), nondet_uint16(),
                        any_within(-100000, 100000));
    PROVE(observer_tuning_holds(&out));
    PROOF_END();
}

void prove_dead_time_slope(void)
{
    config_t config;
    config.drive.voltage_full_scale_mV = any_within(5000, 2000000);
    config.drive.diode_drop_mV = any_within(0, 5000);
    config.battery.min_voltage_mV = any_within(1000, 2000000);
    config.battery.max_voltage_mV = any_within(1000, 2000000);
    config.current_loop.dead_time_zone_pu_q15 = any_within(128, 32767);
    const dead_time_slope_t out = dead_time_slope_at(&config, nondet_int32());
    PROVE(out.alpha_q8 >= 0 && out.alpha_q8 <= 65000);
    PROVE(out.beta_q8 >= 0 && out.beta_q8 <= 56292);
    PROOF_END();
}

void prove_modulation_of(void)
{
    const int32_t period = any_within(256, 16384);
    const int32_t min_pulse = any_within(0, 4096);
    const int32_t trim = any_within(0, 2048);
    ASSUME(min_pulse * 5 <= period && trim * 8 <= period);
    const modulation_t out = modulation_of(period, min_pulse, trim, any_within(8192, 32767));
    PROVE(out.trim_doubled_counts >= 0 && out.trim_doubled_counts <= 4096);
    PROVE(out.beta_counts >= 61 && out.beta_counts <= 16384);
    PROVE(out.alpha_counts >= 106 && out.alpha_counts <= 28378);
    PROVE(out.limit_q15 <= 32767);
    PROOF_END();
}

void prove_encoder_init(void)
{
    config_t config;
    config.rotor.encoder_counts = any_within(0, 65536);
    config.rotor.encoder_index_turn = any_within(0, 65535);
    config.rotor.encoder_index_tolerance_counts = any_within(0, 1024);
    config.rotor.encoder_reversed = any_within(0, 1);
    config.motor.pole_pairs = any_within(1, 60);
    config.rotor.sensor = CONFIG_ROTOR_ENCODER;
    ASSUME(config.rotor.encoder_counts >= 32 * config.motor.pole_pairs);
    encoder_t out;
    encoder_init(&out, &config);
    PROVE(out.max_counts >= 5 && out.max_counts <= out.counts / 8 + 1);
    PROVE(out.count_turn >= 1 && out.count_turn <= 2049);
    PROOF_END();
}
