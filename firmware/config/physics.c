/* SPDX-License-Identifier: Apache-2.0 */
#include "physics.h"

#include <stdbool.h>
#include <stddef.h>

#include "config/bases.h"

enum {
    SALIENCY_MOST = 16,       /* L_q over L_d, of interior magnets and reluctance */
    INVERSE_MOST = 4,         /* L_d over L_q */
    RELUCTANCE_MOST = 16,     /* of the flux by saliency at the largest current over the magnets' */
    CROSS_COUPLING_PARTS = 2, /* w L / R_i at most one of these parts of one */
    DRAG_PARTS = 2,           /* of the largest torque */
    IRON_RESISTANCES_MOST = 2048,
    IRON_CONDUCTANCE_PARTS = 2,
    TIME_CONSTANT_PERIODS = 16384,
    BACK_EMF_PARTS = 32
};

static int64_t larger(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

/* Electrical, at motor.max_speed. */
static int64_t w_mrad_s(const config_motor_t *motor)
{
    return (int64_t)motor->max_speed_mrad_s * motor->pole_pairs;
}

/* At the largest speed; 0: no iron loss. */
static int64_t iron_mOhm(const config_motor_t *motor)
{
    return motor->iron_loss_resistance_mOhm +
           motor->iron_loss_resistance_slope_nOhm_s * w_mrad_s(motor) / 1000000000;
}

static bool has_iron_loss(const config_motor_t *motor)
{
    return motor->iron_loss_resistance_mOhm > 0 || motor->iron_loss_resistance_slope_nOhm_s > 0;
}

static bool saliency_possible(const config_motor_t *motor)
{
    const int64_t d = motor->d_inductance_nH;
    const int64_t q = motor->q_inductance_nH;
    return q <= SALIENCY_MOST * d && d <= INVERSE_MOST * q;
}

static int64_t saliency_nWb(const config_motor_t *motor)
{
    const int64_t d_nH = motor->d_inductance_nH;
    const int64_t q_nH = motor->q_inductance_nH;
    return (d_nH > q_nH ? d_nH - q_nH : q_nH - d_nH) * motor->max_phase_current_mA / 1000;
}

/* Magnets that assist a reluctance motor. Without any, a zero torque has no definite current. */
static bool magnets_strong_enough(const config_motor_t *motor)
{
    return saliency_nWb(motor) <= (int64_t)RELUCTANCE_MOST * motor->flux_linkage_nWb;
}

/* The iron branch takes a part of the torque-producing current only: w L / R_i, which grows with
 * the speed, at most 1/2. */
static bool iron_branch_weak(const config_motor_t *motor)
{
    const int64_t l_nH = larger(motor->d_inductance_nH, motor->q_inductance_nH);
    return !has_iron_loss(motor) ||
           w_mrad_s(motor) * l_nH / 1000000 * CROSS_COUPLING_PARTS <= iron_mOhm(motor) * 1000;
}

/* R_i in the scale of voltage over current keeps 16 fraction bits in 32. */
static bool iron_resistance_fits(const config_t *c)
{
    return iron_mOhm(&c->motor) * c->motor.max_phase_current_mA <=
           INT64_C(1000) * IRON_RESISTANCES_MOST * c->battery.max_voltage_mV;
}

/* Its conductance in the same scale, from a hundredth of the largest speed on: a resistance that
 * vanishes with the speed would leave the format while the wheel still turns. */
static bool iron_conductance_fits(const config_t *c)
{
    const config_motor_t *motor = &c->motor;
    const int64_t slow_mOhm =
        motor->iron_loss_resistance_mOhm +
        motor->iron_loss_resistance_slope_nOhm_s * (w_mrad_s(motor) / 100) / 1000000000;
    return !has_iron_loss(motor) ||
           IRON_CONDUCTANCE_PARTS * slow_mOhm * motor->max_phase_current_mA >=
               INT64_C(1000) * c->battery.max_voltage_mV;
}

/* w psi / R_i. */
static int64_t iron_current_mA(const config_motor_t *motor)
{
    const int64_t emf_mV = w_mrad_s(motor) * motor->flux_linkage_nWb / 1000000000;
    return has_iron_loss(motor) ? emf_mV * 1000 / larger(iron_mOhm(motor), 1) : 0;
}

/* Friction and iron loss at the largest speed. */
static int64_t drag_mNm(const config_motor_t *motor)
{
    const int64_t viscous_mNm =
        (int64_t)motor->viscous_friction_uNm_s * motor->max_speed_mrad_s / 1000000;
    const int64_t flux_nWb_pole_pairs = (int64_t)motor->flux_linkage_nWb * motor->pole_pairs;
    const int64_t current_mA = q_saturate64(iron_current_mA(motor));
    return motor->friction_torque_mNm + viscous_mNm +
           flux_nWb_pole_pairs / 1000 * 3 / 2 * current_mA / 1000000;
}

/* Of magnets and reluctance: 1.5 p (psi + |L_d - L_q| I / 2) I is more than the largest current
 * makes. */
static int64_t torque_of_current_mNm(const config_motor_t *motor)
{
    const int64_t current_mA = motor->max_phase_current_mA;
    const int64_t flux_uWb = (motor->flux_linkage_nWb + saliency_nWb(motor) / 2) / 1000;
    return flux_uWb * motor->pole_pairs * 3 / 2 * current_mA / 1000000;
}

static bool drag_below_torque(const config_motor_t *motor)
{
    const int64_t drag = drag_mNm(motor) * DRAG_PARTS;
    return drag <= motor->max_torque_mNm && drag <= torque_of_current_mNm(motor) &&
           iron_current_mA(motor) * DRAG_PARTS <= motor->max_phase_current_mA;
}

/* Without saliency the current of a torque is a quotient by the flux, which keeps its bits where
 * the EMF of the hot magnets at the largest speed is a part of the largest voltage there is. */
static bool back_emf_large_enough(const config_t *c)
{
    const config_motor_t *motor = &c->motor;
    const int64_t emf_mV = w_mrad_s(motor) * motor->flux_linkage_nWb / 1000000000;
    const int64_t hot_q24 =
        bases_share_at_q24(c, motor->flux_coefficient_ppm_K, motor->max_winding_temperature_cC);
    const int64_t reactance_uOhm = w_mrad_s(motor) * motor->d_inductance_nH / 1000000;
    const int64_t impedance_uOhm =
        q_saturate64(larger(reactance_uOhm, motor->phase_resistance_uOhm));
    const int64_t drop_mV = impedance_uOhm * motor->max_phase_current_mA / 1000000;
    const int64_t most_mV = larger(larger(drop_mV, c->battery.max_voltage_mV), emf_mV);
    return motor->d_inductance_nH != motor->q_inductance_nH ||
           ((emf_mV * hot_q24) >> 24) * BACK_EMF_PARTS >= most_mV;
}

/* The electrical time constant of either axis at most 16 384 PWM periods: R T / L of 1/16384 is a
 * unit of the tuning. */
static bool time_constants_short_enough(const config_t *c)
{
    const int64_t l_nH = larger(c->motor.d_inductance_nH, c->motor.q_inductance_nH);
    return l_nH * c->drive.pwm_frequency_Hz / 1000 <=
           (int64_t)c->motor.phase_resistance_uOhm * TIME_CONSTANT_PERIODS;
}

/* A tenth of flux and resistance is left at the ends of the temperatures. */
static bool temperature_coefficients_possible(const config_t *c)
{
    const int32_t flux_q24 =
        bases_share_at_q24(c, c->motor.flux_coefficient_ppm_K, c->motor.max_winding_temperature_cC);
    const int32_t cold_q24 =
        bases_share_at_q24(c, c->motor.resistance_coefficient_ppm_K, c->monitor.coldest_ambient_cC);
    return flux_q24 > SCALED_ONE / 10 && cold_q24 > SCALED_ONE / 10;
}

#define REQUIRE(relation, text)                                                                    \
    if (!(relation)) {                                                                             \
        return text;                                                                               \
    }

const char *physics_broken(const config_t *config)
{
    const config_motor_t *motor = &config->motor;
    REQUIRE(saliency_possible(motor),
            "motor.q_inductance_nH within a quarter of and 16 times motor.d_inductance_nH");
    REQUIRE(magnets_strong_enough(motor),
            "motor.flux_linkage_nWb at least 1/16 of the flux by saliency at "
            "motor.max_phase_current_mA");
    REQUIRE(time_constants_short_enough(config), "L / R at most 16384 PWM periods");
    REQUIRE(iron_branch_weak(motor),
            "motor.iron_loss_resistance at least twice the reactance at motor.max_speed_mrad_s");
    REQUIRE(iron_resistance_fits(config),
            "motor.iron_loss_resistance at most 2048 times battery.max_voltage_mV over "
            "motor.max_phase_current_mA");
    REQUIRE(iron_conductance_fits(config),
            "motor.iron_loss_resistance at a hundredth of motor.max_speed_mrad_s at least half of "
            "battery.max_voltage_mV over motor.max_phase_current_mA");
    REQUIRE(drag_below_torque(motor),
            "motor friction and iron loss at motor.max_speed_mrad_s within half of "
            "motor.max_torque_mNm and of what motor.max_phase_current_mA makes");
    REQUIRE(back_emf_large_enough(config),
            "back-EMF at motor.max_speed_mrad_s at least 1/32 of battery.max_voltage_mV and of the "
            "drop at motor.max_phase_current_mA");
    REQUIRE(temperature_coefficients_possible(config),
            "motor.flux_coefficient_ppm_K, resistance_coefficient_ppm_K leave a tenth at the ends "
            "of the temperatures");
    return NULL;
}
