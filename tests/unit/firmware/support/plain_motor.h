/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plain_motor.h: a motor model of powers of two for tests: a flux of one, so that torque and torque
 * current are the same number of units and of millinewton-metres; no saliency, losses or friction.
 */
#ifndef PLAIN_MOTOR_H
#define PLAIN_MOTOR_H

#include <math.h>
#include <string.h>

#include "config/config.h"
#include "motor/feasible_torque.h"

typedef struct {
    config_t config;
    motor_constants_t constants;
    motor_model_t model;
    feasible_set_t set;
    int16_t map_lsb[18]; /* i_d at a torque of -2^20, 0 and 2^20 mN m; two speeds, up to 9 points */
} plain_motor_t;

/* Any voltage suffices; a phase current limit of 2^22. */
static inline void plain_motor_init(plain_motor_t *motor)
{
    memset(motor, 0, sizeof *motor);
    motor->constants = (motor_constants_t){
        .current_shift = 1,
        .torque_factor_q24 = SCALED_ONE,
        .torque_inverse_q24 = SCALED_ONE,
        .current_most_b = 1 << 22,
    };
    motor->model = (motor_model_t){
        .constants = &motor->constants,
        .config = &motor->config,
        .flux_b = SCALED_ONE,
        .slope_flux_b = SCALED_ONE,
        .x_per_airgap_q23 = 1 << 23,
        .one_plus_a2 = SCALED_ONE,
        .inverse_one_plus_a2 = SCALED_ONE,
    };
    motor->set = (feasible_set_t){
        .model = &motor->model,
        .row = {.cold_lsb = motor->map_lsb,
                .hot_lsb = motor->map_lsb,
                .weights = {.at_00 = 1 << 16, .shift = 15},
                .points = 3,
                .step_log2 = 20,
                .zero_mNm = 1 << 20},
        .voltage_squared = INT64_C(1) << 60,
    };
}

enum { PLAIN_UNIT_LOG2 = 20 };

/* A unit is 2^20 of the binary scale; ratios have 24 fraction bits. */
static inline int32_t plain_units(double x)
{
    return (int32_t)lround(ldexp(x, PLAIN_UNIT_LOG2));
}

static inline double plain_value(int32_t x_b)
{
    return ldexp(x_b, -PLAIN_UNIT_LOG2);
}

static inline int32_t plain_ratio(double x)
{
    return (int32_t)lround(ldexp(x, 24));
}

/* A reference that compares two numbers too near for the roundings of the firmware says so. */
static bool plain_unclear;

static inline bool plain_is_above(double a, double b)
{
    plain_unclear = plain_unclear || fabs(a - b) < 4e-3;
    return a > b;
}

/* An entry of the map: an i_d between -8 and 8, to 2^-12. One is 2^unit_log2 units, and half as
 * many milliamperes (current_shift). */
static inline int16_t plain_entry(plain_motor_t *motor, int32_t unit_log2, double i_d)
{
    motor->set.row.weights.shift = 15 - (unit_log2 - 1 - 12);
    return (int16_t)lround(ldexp(i_d, 12));
}

/* The nearest i_d that an entry has. */
static inline double plain_entry_value(double i_d)
{
    return ldexp(round(ldexp(i_d, 12)), -12);
}

/* Up to a torque current, with an i_d of zero. */
static inline feasible_side_t plain_side(const plain_motor_t *motor, side_t sign, int32_t cap_b)
{
    const feasible_side_t out = {
        .set = &motor->set,
        .sign = (int32_t)sign,
        .cap_mNm = cap_b,
        .cap = {.d_b = 0, .x_b = (int32_t)sign * cap_b},
        .cap_has_voltage = true,
    };
    return out;
}

#endif
