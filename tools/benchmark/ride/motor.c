/* SPDX-License-Identifier: Apache-2.0 */
#include "motor.h"
#include "config/bases.h"

#include <math.h>

enum { SUBSTEPS = 4 };

static const double TURN_rad = 6.283185307179586;

/* Cosines and sines of the angles from the three phases' axes to the rotor's d axis. */
typedef struct {
    double cos[3], sin[3];
} axes_t;

/* Addition theorem: two functions of the library instead of six, which an emulated core without
 * floating point computes for as long as the firmware runs. */
static axes_t axes_at(double theta_rad)
{
    static const double COS_OF_PHASE[3] = {1.0, -0.5, -0.5};
    static const double SIN_OF_PHASE[3] = {0.0, 0.8660254037844386, -0.8660254037844386};
    const double c = cos(theta_rad);
    const double s = sin(theta_rad);
    axes_t axes;
    for (int x = 0; x < 3; x++) {
        axes.cos[x] = c * COS_OF_PHASE[x] + s * SIN_OF_PHASE[x];
        axes.sin[x] = s * COS_OF_PHASE[x] - c * SIN_OF_PHASE[x];
    }
    return axes;
}

static double noise_codes(motor_t *motor)
{
    motor->random = motor->random * 1664525U + 1013904223U;
    return (double)(motor->random >> 16) / 32768.0 - 1.0;
}

static uint16_t code(double value)
{
    const double rounded = floor(value + 0.5);
    return (uint16_t)(rounded < 0.0 ? 0.0 : rounded > 4095.0 ? 4095.0 : rounded);
}

/* The index is at a mechanical angle of zero, in either direction. */
static encoder_input_t encoder_at(motor_t *motor, const config_t *config)
{
    const double turns = motor->theta_rad / TURN_rad / config->motor.pole_pairs;
    const int32_t whole = (int32_t)floor(turns);
    const int32_t passed = whole > motor->turns ? whole : motor->turns;
    const encoder_input_t out = {
        .count = (uint16_t)(int32_t)floor(turns * config->rotor.encoder_counts),
        .index_count = (uint16_t)(passed * config->rotor.encoder_counts),
        .index = whole != motor->turns,
    };
    motor->turns = whole;
    return out;
}

fast_input_t motor_sample(motor_t *motor, const config_t *config, double bus_V)
{
    static const uint8_t HALL_OF_SECTOR[6] = {5, 1, 3, 2, 6, 4};
    const double full_A = 0.001 * config->drive.current_full_scale_mA;
    const double full_V = 0.001 * config->drive.voltage_full_scale_mV;
    fast_input_t in = {.power_stage_fault = false};
    const axes_t axes = axes_at(motor->theta_rad);
    for (int x = 0; x < 3; x++) {
        const double i_A = motor->i_d_A * axes.cos[x] - motor->i_q_A * axes.sin[x];
        in.phase_current_code[x] = code(2048.0 + 2048.0 * i_A / full_A + noise_codes(motor));
    }
    in.bus_voltage_code = code(4096.0 * bus_V / full_V + noise_codes(motor));
    const double turns = motor->theta_rad / TURN_rad - floor(motor->theta_rad / TURN_rad);
    in.rotor_angle_turn = (uint16_t)(turns * 65536.0);
    in.hall_state = HALL_OF_SECTOR[(int)(turns * 6.0) % 6];
    in.encoder = encoder_at(motor, config);
    return in;
}

static void integrate(motor_t *motor, const config_t *config, double u_d, double u_q, double w,
                      double dt)
{
    const double r = 1e-6 * config->motor.phase_resistance_uOhm;
    const double l_d = 1e-9 * config->motor.d_inductance_nH;
    const double l_q = 1e-9 * config->motor.q_inductance_nH;
    const double psi = 1e-9 * config->motor.flux_linkage_nWb;
    const double i_d = motor->i_d_A;
    const double i_q = motor->i_q_A;
    motor->i_d_A += dt * (u_d - r * i_d + w * l_q * i_q) / l_d;
    motor->i_q_A += dt * (u_q - r * i_q - w * l_d * i_d - w * psi) / l_q;
}

void motor_step(motor_t *motor, const config_t *config, const fast_output_t *out, double bus_V,
                double w_rad_s)
{
    const double dt = 1.0 / config->drive.pwm_frequency_Hz / SUBSTEPS;
    const double volts_per_count = bus_V / bases_pwm_period_counts(config, BASES_MODEL_TIMER_Hz);
    double volt[3];
    for (int x = 0; x < 3; x++) {
        volt[x] = 2.0 / 3.0 * volts_per_count * out->compare_counts[x];
    }
    for (int i = 0; i < SUBSTEPS; i++) {
        if (out->bridge == BRIDGE_PWM) {
            const axes_t axes = axes_at(motor->theta_rad);
            double u_d = 0.0;
            double u_q = 0.0;
            for (int x = 0; x < 3; x++) {
                u_d += volt[x] * axes.cos[x];
                u_q -= volt[x] * axes.sin[x];
            }
            integrate(motor, config, u_d, u_q, w_rad_s, dt);
        } else {
            motor->i_d_A = 0.0; /* off: below the bus voltage nothing flows */
            motor->i_q_A = 0.0;
        }
        motor->theta_rad += dt * w_rad_s;
    }
}
