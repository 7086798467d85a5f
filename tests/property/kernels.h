/* SPDX-License-Identifier: Apache-2.0 */
/*
 * kernels.h: every box of the fast loop by itself, in plain C types that C++ may include. The twin
 * (twin.hpp) has a function of the same name for each.
 */
#ifndef PROPERTY_KERNELS_H
#define PROPERTY_KERNELS_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"

#ifdef __cplusplus
extern "C" {
#endif

extern const config_t CONFIG_LU2013;

typedef struct {
    int32_t x, y; /* alpha beta, d q, or cos sin */
} pair_t;

typedef struct {
    int32_t a, b, c;
} triple_t;

pair_t kernel_cos_sin(uint16_t theta_turn);
/* Clarke as sense_step does it. */
pair_t kernel_clarke(triple_t phases);
pair_t kernel_park(pair_t ab, pair_t cos_sin);
pair_t kernel_inverse_park(pair_t dq, pair_t cos_sin);
pair_t kernel_advance(pair_t cos_sin, pair_t by);
int32_t kernel_circle_other_q15(int32_t x);
int32_t kernel_circle_other(int32_t radius, int32_t x);
/* 1/n as a real number. */
double kernel_reciprocal(uint16_t n);

pair_t kernel_sense(const uint16_t codes[3], const int32_t offset_q4[3], const int32_t on_q16[3]);

typedef struct {
    int32_t proportional_q10, integral_q15, anti_windup_q15;
} kernel_pi_gains_t;

int32_t kernel_pi_largest_proportional_q10(void);
int32_t kernel_pi_largest_integral_q15(void);
int32_t kernel_pi_largest_anti_windup_q15(void);

typedef struct {
    kernel_pi_gains_t d, q;
    int32_t w_l_d_q10, w_l_q_q10, forward_d_q25, forward_q_q25;
    pair_t advance; /* cos sin */
} kernel_tuning_t;

kernel_tuning_t kernel_tuning(const config_t *config, int32_t modulation_limit_q15, int32_t v_dc_pu,
                              int32_t speed_q32);

typedef struct {
    pair_t wanted, realised; /* dq, modulation units Q15 */
    pair_t integrator_q30;   /* afterwards */
} kernel_voltage_t;

kernel_voltage_t kernel_current_loop(pair_t integrator_q30, const kernel_tuning_t *tuning,
                                     pair_t reference, pair_t i);

typedef struct {
    int32_t centre_q16, trim_doubled_counts, alpha_counts, beta_counts, modulation_limit_q15;
} kernel_svpwm_t;

kernel_svpwm_t kernel_svpwm_init(int32_t period_counts, int32_t min_pulse_counts,
                                 int32_t trim_counts, int32_t limit_q15);
triple_t kernel_svpwm(const kernel_svpwm_t *svpwm, pair_t u, triple_t trim_q15);

typedef struct {
    int32_t full_counts, slope_alpha_q8, slope_beta_q8;
} kernel_dead_time_t;

kernel_dead_time_t kernel_dead_time_init(const config_t *config);

/* Of the model's timer (config/bases.h). */
int32_t kernel_pwm_period_counts(const config_t *config);
int32_t kernel_min_pulse_counts(const config_t *config);
triple_t kernel_dead_time(kernel_dead_time_t dead_time, pair_t i);

int32_t kernel_field_weakening(int32_t current_q28, pair_t wanted, int32_t gain_q15,
                               int32_t most_q15);

/* The current loop proper, from codes to on-times, with everything it keeps given and taken. */
typedef struct {
    int32_t offset_q4[3];
    pair_t integrator_q30;
    kernel_svpwm_t svpwm;
    kernel_dead_time_t dead_time;
    int32_t on_q16[3]; /* before: during the sample; after: result */
} kernel_loop_t;

typedef struct {
    pair_t i_dq;
    kernel_voltage_t voltage;
} kernel_loop_out_t;

kernel_loop_out_t kernel_loop(kernel_loop_t *loop, const kernel_tuning_t *tuning,
                              const uint16_t codes[3], uint16_t theta_turn, pair_t reference);

#ifdef __cplusplus
}
#endif

#endif
